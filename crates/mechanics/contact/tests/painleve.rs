//! Painlevé's rod: the numbers of the page, the map, and the impact that is always possible.

use featherbench_contact::systems::{Answers, PainleveRod};
use featherbench_contact::{Certificate, Enumeration, GaussSeidel, Lemke, Newton, Outcome, Solver};

fn rod(friction: f64, rate: f64) -> PainleveRod {
    PainleveRod { friction, rate, ..PainleveRod::default() }
}

/// What enumeration finds, in the words of the closed form.
fn found(rod: &PainleveRod) -> Answers {
    let solution = Enumeration::default().solve(&rod.problem().unwrap()).unwrap();
    match solution.outcome {
        Outcome::Converged(point) if point.impulses[0] > 0.0 => Answers::Contact,
        Outcome::Converged(_) => Answers::LiftOff,
        Outcome::Several(points) => {
            assert_eq!(points.len(), 2);
            Answers::Two
        }
        Outcome::NoSolution(Certificate::Enumeration { modes, margin }) => {
            assert_eq!(modes, 2);
            assert!(margin > 0.0);
            Answers::None
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_four_cases() {
    let solution = Enumeration::default().solve(&rod(1.0, 0.0).problem().unwrap()).unwrap();
    // N = −b/p with p = 1 + 3·(1/5 − 2/5) = 0.4 and b = −9.81.
    assert!((solution.point().unwrap().impulses[0] - 24.525).abs() < 1e-12);
    assert!((rod(1.5, 0.0).effective().0 + 0.2).abs() < 1e-15);
    assert_eq!(found(&rod(1.5, 0.0)), Answers::None);
    let Outcome::Several(points) = Enumeration::default().solve(&rod(1.5, 4.0).problem().unwrap()).unwrap().outcome else { panic!() };
    let mut forces: Vec<f64> = points.iter().map(|point| point.impulses[0]).collect();
    forces.sort_by(f64::total_cmp);
    // N = b/0.2 with b = 16·2/√5 − 9.81: 16 sin θ at tan θ = 2.
    assert!(forces[0] == 0.0 && (forces[1] - (32.0 / 5.0_f64.sqrt() - 9.81) / 0.2).abs() < 1e-12);
    assert!((forces[1] - 22.50417528).abs() < 1e-8);
    assert_eq!(found(&rod(1.0, 4.0)), Answers::LiftOff);
}

/// Lemke's method says "no solution" with a proof, or gives one of the solutions; it never gives a number where there is none.
#[test]
fn lemke_ends_with_a_ray() {
    let solution = Lemke::default().solve(&rod(1.5, 0.0).problem().unwrap()).unwrap();
    let Outcome::NoSolution(Certificate::Ray { direction, growth, descent }) = &solution.outcome else { panic!("{solution:?}") };
    assert_eq!(direction, &[1.0]);
    assert!(*growth < 0.0 && *descent < 0.0);
    assert_eq!(Lemke::default().solve(&rod(1.5, 4.0).problem().unwrap()).unwrap().point().unwrap().impulses[0], 0.0);
}

/// Iterative solvers do not answer where nothing can be answered.
#[test]
fn no_solution_is_never_a_number() {
    let mut random = featherbench_robots::Random::named(1, "no solution");
    let mut cases = 0;
    while cases < 200 {
        let rod = PainleveRod {
            friction: random.uniform(1.4, 3.0),
            angle: random.uniform(0.7, 1.5),
            rate: random.uniform(0.0, 3.0),
            ..PainleveRod::default()
        };
        if rod.answers() != Answers::None {
            continue;
        }
        cases += 1;
        let problem = rod.problem().unwrap();
        let gauss_seidel = GaussSeidel { sweeps: 2000, ..GaussSeidel::default() };
        for solver in [&Lemke::default() as &dyn Solver, &Enumeration::default(), &Newton::default(), &gauss_seidel] {
            let solution = solver.solve(&problem).unwrap();
            assert!(solution.points().is_empty(), "{}: {solution:?}", solver.name());
            let proves = ["lemke", "enumeration"].contains(&solver.name());
            assert_eq!(solution.status() == "no_solution", proves, "{}: {solution:?}", solver.name());
        }
    }
}

/// The paradox: where tan θ is between the roots of t² − 3μ t + 4. The study has p = 0 there.
#[test]
fn the_paradox_has_its_angles() {
    let (low, high) = rod(1.5, 0.0).paradox().unwrap();
    assert!((low.to_degrees() - 50.6415981605).abs() < 1e-10 && (high.to_degrees() - 73.0484693655).abs() < 1e-10);
    assert!(rod(4.0 / 3.0 - 1e-9, 0.0).paradox().is_none() && rod(4.0 / 3.0 + 1e-9, 0.0).paradox().is_some());
}

/// The map of existence and uniqueness: 400 random rods of any mass and length, closed form against enumeration.
#[test]
fn the_map_is_what_enumeration_finds() {
    let mut random = featherbench_robots::Random::named(2, "map");
    let mut seen = [0; 4];
    for _ in 0..400 {
        let rod = PainleveRod {
            mass: random.uniform(0.1, 10.0),
            half_length: random.uniform(0.1, 3.0),
            gravity: random.uniform(1.0, 20.0),
            friction: random.uniform(0.0, 3.0),
            angle: random.uniform(0.05, 1.5),
            rate: random.uniform(0.0, 8.0),
        };
        assert_eq!(found(&rod), rod.answers(), "{rod:?}");
        seen[rod.answers() as usize] += 1;
    }
    assert!(seen.iter().all(|count| *count > 10), "{seen:?}");
}

/// At the level of impulses the rod always has an answer: an impact without collision where there is no force.
#[test]
fn an_impact_without_collision_is_always_possible() {
    let mut random = featherbench_robots::Random::named(3, "impact without collision");
    for _ in 0..200 {
        let rod = PainleveRod { friction: random.uniform(1.4, 3.0), angle: random.uniform(0.7, 1.5), ..PainleveRod::default() };
        let problem = rod.impact(random.uniform(0.1, 2.0), 1e-3).unwrap();
        for solver in [&Lemke::default() as &dyn Solver, &Enumeration::default()] {
            let solution = solver.solve(&problem).unwrap();
            assert!(!solution.points().is_empty(), "{}", solver.name());
            assert!(solution.points().iter().all(|point| point.residuals.largest() < 1e-10));
        }
    }
}

/// A short step leaves nearly no free normal velocity, and the merit function of Newton's method has a local minimum where the tip still
/// slides. The answer exists, is the only one by enumeration, and is known: the tip sticks, so G λ = −b.
#[test]
fn newton_leaves_the_local_minimum_of_a_sliding_tip() {
    let rod = rod(1.5, 0.0);
    // G of (n, t) at tan θ = 2 and m = l = 1: 1 + 3 cos² θ, 3 sin θ cos θ, 1 + 3 sin² θ.
    let (nn, nt, tt) = (1.6, 1.2, 3.4);
    let determinant = nn * tt - nt * nt;
    for duration in [1e-2, 1e-3, 2e-4, 1e-4, 1e-5, 1e-6, 1e-8] {
        let problem = rod.impact(1.0, duration).unwrap();
        let [normal, slip] = [-9.81 * duration, 1.0];
        let due = [(-normal * tt + slip * nt) / determinant, (normal * nt - slip * nn) / determinant];
        for solver in [&Newton::default() as &dyn Solver, &Enumeration::default()] {
            let solution = solver.solve(&problem).unwrap();
            let point = solution.point().unwrap_or_else(|| panic!("{} at {duration:e}: {}", solver.name(), solution.status()));
            assert!(point.residuals.largest() <= 1e-10, "{} at {duration:e}: {:?}", solver.name(), point.residuals);
            // Newton ends at 1e-12 of the scale; λ = G⁻¹ b has the condition of G, 4.6.
            assert!((point.impulses[0] - due[0]).abs() < 1e-11 && (point.impulses[1] - due[1]).abs() < 1e-11, "{duration:e} {point:?}");
        }
    }
}
