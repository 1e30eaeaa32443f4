//! Direct solvers against enumeration in double-double arithmetic, 200 draws each, of contacts that the study's quantity `contact_draws` does
//! not have.

use featherbench_contact::systems::{BoxOnBalls, Feet};
use featherbench_contact::{Contact, Enumeration, Lemke, Level, Newton, Problem, Solver};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

const DRAWS: usize = 200;

/// How far an answer's velocities are from the nearest of all answers, in the problem's scale. Impulses need not be unique, velocities are.
fn distance(problem: &Problem, velocities: &DVector<f64>, all: &[featherbench_contact::Point]) -> f64 {
    let distances = all.iter().map(|point| (&point.velocities - velocities).amax() / problem.scales().velocity);
    distances.reduce(|a, b| if b < a { b } else { a }).unwrap()
}

/// Each draw by enumeration and by a direct solver, which must answer with small residuals. Where the answer is unique, it must be that one.
/// Where it is not, redundant rows leave a family whose corners are enumerated, and the residuals are what shows that an answer is in it.
fn compare(name: &str, solver: &dyn Solver, mut draw: impl FnMut(&mut Random) -> Problem) {
    let mut random = Random::named(7, name);
    for number in 0..DRAWS {
        let problem = draw(&mut random);
        let all = Enumeration::default().solve(&problem).unwrap();
        assert!(!all.points().is_empty(), "{name} {number}: {all:?}");
        // Enumeration rounds its answers to f64: residuals are roundings of G λ.
        assert!(all.points().iter().all(|point| point.residuals.largest() <= 1e-10), "{name} {number}: {all:?}");
        let solution = solver.solve(&problem).unwrap();
        let point = solution.point().unwrap_or_else(|| panic!("{name} {number}: {solution:?}"));
        assert!(point.residuals.largest() <= 1e-10, "{name} {number}: {:?}", point.residuals);
        // The velocity is as far as the conditioning of G makes it.
        let found = distance(&problem, &point.velocities, all.points());
        assert!(found <= 1e-9 || all.point().is_none(), "{name} {number}: {found:e} from the answer");
    }
}

/// One round cone with any regular G.
#[test]
fn spatial_contacts() {
    compare("spatial", &Newton { tolerance: 1e-12, steps: 500 }, |random| {
        let factor = DMatrix::from_fn(3, 3, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose() + DMatrix::identity(3, 3) * 0.1;
        let free = DVector::from_vec(vec![random.uniform(-1.0, 0.2), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]);
        Problem::from_delassus("spatial", Level::Impulse, vec![Contact::spatial("tip", random.uniform(0.1, 0.8))], matrix, free).unwrap()
    });
}

/// Redundant rows with friction: the enumeration goes over the corners of families.
#[test]
fn boxes_on_two_balls() {
    compare("boxes", &Newton { tolerance: 1e-12, steps: 500 }, |random| {
        let scene = BoxOnBalls {
            box_mass: random.uniform(1.0, 20.0),
            balls: 1 + random.below(2),
            ball_mass: random.uniform(0.2, 3.0),
            force: random.uniform(0.0, 40.0),
            ..BoxOnBalls::default()
        };
        scene.problem().unwrap()
    });
}

/// Flat feet that stick, slide, turn and tip: 12 rows of rank 6 each. Enumeration does not take them; the residuals judge.
#[test]
fn feet() {
    let mut random = Random::named(7, "feet");
    let mut slides = 0;
    for number in 0..DRAWS {
        let free = std::array::from_fn(|k| if k == 2 { -random.uniform(0.02, 0.2) } else { random.uniform(-0.3, 0.3) });
        let problem = Feet { count: 1 + random.below(2), friction: random.uniform(0.1, 1.0), free, ..Feet::default() }.problem().unwrap();
        let solution = Newton::default().solve(&problem).unwrap();
        let point = solution.point().unwrap_or_else(|| panic!("{number}: {}", solution.status()));
        assert!(point.residuals.largest() <= 1e-10, "{number}: {:?}", point.residuals);
        slides += usize::from(point.velocities.amax() > 1e-3);
    }
    assert!(slides > 50, "{slides}");
}

/// Two planar contacts with any G and b: where Lemke's method ends with an answer, it is one of all answers.
#[test]
fn planar_contacts() {
    compare("planar", &Lemke::default(), |random| {
        let factor = DMatrix::from_fn(4, 4, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose();
        let free = DVector::from_fn(4, |_, _| random.uniform(-1.0, 1.0));
        let contacts = (0..2).map(|k| Contact::planar(format!("{k}"), random.uniform(0.0, 1.0))).collect();
        Problem::from_delassus("planar", Level::Impulse, contacts, matrix, free).unwrap()
    });
}
