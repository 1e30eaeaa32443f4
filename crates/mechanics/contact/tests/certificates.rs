//! What "no solution", "several" and "undecided" mean, checked from the data.

use featherbench_contact::{Certificate, Contact, Enumeration, Friction, Lemke, Level, Outcome, Problem, Residuals, Solver, Unsupported};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

/// Two sliding contacts with any friction: Lemke's proofs and answers against enumeration.
#[test]
fn sliding_pairs() {
    let mut random = Random::named(8, "sliding pairs");
    let (mut none, mut several, mut undecided) = (0, 0, 0);
    for number in 0..600 {
        let factor = DMatrix::from_fn(4, 4, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose();
        let free = DVector::from_fn(4, |_, _| random.uniform(-1.0, 1.0));
        let contacts = (0..2).map(|k| Contact::sliding(format!("{k}"), random.uniform(0.0, 4.0), [1.0, -1.0][random.below(2)])).collect();
        let problem = Problem::from_delassus("pair", Level::Force, contacts, matrix, free).unwrap();
        let all = Enumeration::default().solve(&problem).unwrap();
        let lemke = Lemke::default().solve(&problem).unwrap();
        match &lemke.outcome {
            Outcome::Converged(point) => {
                let near =
                    all.points().iter().any(|known| (&known.impulses - &point.impulses).amax() < 1e-8 * (1.0 + point.impulses.amax()));
                assert!(near, "{number}: {all:?} {lemke:?}");
            }
            Outcome::NoSolution(Certificate::Ray { direction, .. }) => {
                assert_eq!(all.status(), "no_solution", "{number}");
                // The condition in f64, which the proof has checked with bounds.
                let u = DVector::from_vec(vec![direction[0], 0.0, direction[1], 0.0]);
                let g = problem.delassus() * &u;
                for (k, contact) in problem.contacts().iter().enumerate() {
                    let Friction::Sliding { coefficient, direction } = &contact.friction else { panic!() };
                    assert!(g[2 * k] - coefficient * direction[0] * g[2 * k + 1] <= 1e-12, "{number}");
                }
                assert!(u.min() >= 0.0 && problem.free().dot(&u) < 0.0, "{number}");
            }
            Outcome::Undecided => undecided += 1,
            other => panic!("{number}: {other:?}"),
        }
        none += usize::from(all.status() == "no_solution");
        several += usize::from(all.status() == "several");
        assert!(all.points().iter().all(|point| Residuals::of(&problem, &point.impulses).largest() < 1e-9), "{number}: {all:?}");
    }
    assert!(none > 20 && several > 20, "{none} {several}");
    assert!(undecided < 300, "{undecided}");
}

/// The same pairs by brute force: four modes by Cramer's rule in f64, away from the boundaries.
#[test]
fn enumeration_counts_what_four_modes_count() {
    let mut random = Random::named(9, "four modes");
    for _ in 0..400 {
        let factor = DMatrix::from_fn(4, 4, |_, _| random.uniform(-1.0, 1.0));
        let g = &factor * factor.transpose();
        let b = DVector::from_fn(4, |_, _| random.uniform(-1.0, 1.0));
        let mu = [random.uniform(0.0, 4.0), random.uniform(0.0, 4.0)];
        let contacts = (0..2).map(|k| Contact::sliding(format!("{k}"), mu[k], 1.0)).collect();
        let entry = |row: usize, column: usize| g[(2 * row, 2 * column)] - mu[column] * g[(2 * row, 2 * column + 1)];
        let (m, q) = ([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]], [b[0], b[2]]);
        let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        let both = [(m[0][1] * q[1] - m[1][1] * q[0]) / determinant, (m[1][0] * q[0] - m[0][0] * q[1]) / determinant];
        let first = [-q[0] / m[0][0], q[1] - m[1][0] * q[0] / m[0][0]];
        let second = [q[0] - m[0][1] * q[1] / m[1][1], -q[1] / m[1][1]];
        let modes = [q, both, first, second];
        if modes.iter().flatten().any(|x| x.abs() < 1e-6) {
            continue;
        }
        let count = modes.iter().filter(|pair| pair[0] > 0.0 && pair[1] > 0.0).count();
        let problem = Problem::from_delassus("pair", Level::Force, contacts, g, b).unwrap();
        assert_eq!(Enumeration::default().solve(&problem).unwrap().points().len(), count);
    }
}

/// A body wedged between two walls: forces that hold each other are a family without an end.
#[test]
fn a_wedged_body_has_endless_forces() {
    // Two frictionless contacts with opposite normals and no load: any equal pair of forces.
    let contacts = vec![Contact::frictionless("left"), Contact::frictionless("right")];
    let problem = Problem::from_delassus(
        "wedge",
        Level::Force,
        contacts,
        DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]),
        DVector::from_vec(vec![0.0, 0.0]),
    )
    .unwrap();
    let Outcome::Several(points) = Enumeration::default().solve(&problem).unwrap().outcome else { panic!() };
    assert!(points.iter().any(|point| point.impulses.amax() == 0.0) && points.iter().any(|point| point.impulses.amax() > 0.1));
    assert!(points.iter().all(|point| point.residuals.largest() < 1e-12));
}

/// Impulses that no body can take up: without a solution, and proven.
#[test]
fn closing_walls_have_no_solution() {
    let contacts = || vec![Contact::frictionless("left"), Contact::frictionless("right")];
    let matrix = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]);
    // Both contacts close with the same body between them: c_1 + c_2 = −2 whatever the impulses are.
    let problem = Problem::from_delassus("press", Level::Impulse, contacts(), matrix, DVector::from_vec(vec![-1.0, -1.0])).unwrap();
    for solver in [&Lemke::default() as &dyn Solver, &Enumeration::default()] {
        let solution = solver.solve(&problem).unwrap();
        assert_eq!(solution.status(), "no_solution", "{}: {solution:?}", solver.name());
    }
    for solver in featherbench_contact::solver::all() {
        // A compliant contact has an answer: of its own equations, with a large residual.
        let solution = solver.solve(&problem).unwrap();
        assert!(solver.name() == "penalty" || solution.points().is_empty(), "{}: {solution:?}", solver.name());
        assert!(solution.points().iter().all(|point| point.residuals.signorini > 0.5));
    }
}

#[test]
fn solvers_refuse_by_name() {
    let spatial = |count: usize| {
        let contacts = (0..count).map(|k| Contact::spatial(format!("corner {k}"), 0.5)).collect();
        let free = DVector::from_fn(3 * count, |_, _| -1.0);
        Problem::from_delassus("corners", Level::Impulse, contacts, DMatrix::identity(3 * count, 3 * count), free).unwrap()
    };
    let error = Enumeration::default().solve(&spatial(2)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "enumeration does not take contact 'corner 0': it enumerates a round cone only if it is the only contact"
    );
    let planar = |count: usize| {
        let contacts = (0..count).map(|k| Contact::planar(format!("{k}"), 0.5)).collect();
        Problem::from_delassus("many", Level::Impulse, contacts, DMatrix::identity(2 * count, 2 * count), DVector::zeros(2 * count))
            .unwrap()
    };
    assert!(matches!(Enumeration::default().solve(&planar(20)), Err(Unsupported::TooMany { .. })));
    let square = Friction::Pyramid { vertices: vec![[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] };
    let pyramid = Problem::from_delassus(
        "p",
        Level::Impulse,
        vec![Contact::new("p", square)],
        DMatrix::identity(3, 3),
        DVector::from_vec(vec![-1.0, 0.1, 0.0]),
    );
    let pyramid = pyramid.unwrap();
    for solver in featherbench_contact::solver::all() {
        let takes = solver.name() == "lemke";
        assert_eq!(solver.solve(&pyramid).is_ok(), takes, "{}", solver.name());
    }
    assert!(matches!(Lemke { directions: 2, ..Lemke::default() }.solve(&spatial(1)), Err(Unsupported::Setting { .. })));
}

/// A contact with one coefficient zero has friction in one direction only.
#[test]
fn one_zero_coefficient() {
    let contact = vec![Contact::new("skate", Friction::Coulomb { coefficients: vec![0.0, 0.5] })];
    let problem =
        Problem::from_delassus("skate", Level::Impulse, contact, DMatrix::identity(3, 3), DVector::from_vec(vec![-1.0, 0.3, 0.4])).unwrap();
    for solver in [&Enumeration::default() as &dyn Solver, &featherbench_contact::Newton::default()] {
        let point = solver.solve(&problem).unwrap().point().unwrap().clone();
        assert!((point.impulses - DVector::from_vec(vec![1.0, 0.0, -0.4])).amax() < 1e-14, "{}", solver.name());
        assert!(point.residuals.largest() < 1e-14);
    }
}
