//! What is known of `systems` beside the cases of the study `contact`.

use featherbench_contact::systems::{BoxOnBalls, Incline, Section, Table};
use featherbench_contact::{Admm, Convex, Enumeration, GaussSeidel, Lemke, Newton, Penalty, Point, Problem, Solver};

/// Direct solvers: ≤ 1e-10 on every residual, as the issue asks.
const DIRECT: f64 = 1e-10;

fn solved(solver: &dyn Solver, problem: &Problem) -> Point {
    let solution = solver.solve(problem).unwrap();
    solution.point().unwrap_or_else(|| panic!("{} on {}: {}", solver.name(), problem.name(), solution.status())).clone()
}

/// A pyramid is felt at 45°: μ/√2 or √2 μ. Along an axis both are as wide as the cone, and an axis-aligned test hides them.
#[test]
fn pyramids_hide_along_their_axes() {
    for (section, factor) in [(Section::Inscribed, std::f64::consts::FRAC_1_SQRT_2), (Section::Box, std::f64::consts::SQRT_2)] {
        let turned = Incline { section, ..Incline::default() };
        for (incline, felt) in [(turned, factor * turned.friction), (Incline { heading: 0.0, ..turned }, turned.friction)] {
            let point = solved(&Lemke::default(), &incline.problem().unwrap());
            assert!((point.velocities.rows(1, 2).norm() - incline.speed_after(felt)).abs() < 1e-14, "{section:?}");
            assert!(point.residuals.largest() <= DIRECT, "{section:?} {:?}", point.residuals);
        }
    }
}

/// An elliptic cone: the answer satisfies the optimality of maximum dissipation, found here by a search over the ellipse.
#[test]
fn elliptic_cones_dissipate_most() {
    for heading in [0.2, 0.8, 1.3] {
        let incline = Incline { section: Section::Elliptic(0.2), heading, ..Incline::default() };
        let problem = incline.problem().unwrap();
        let point = solved(&Newton::default(), &problem);
        assert!(point.residuals.largest() <= DIRECT);
        let (normal, slip) = (point.impulses[0], [point.velocities[1], point.velocities[2]]);
        let power = |angle: f64| normal * (0.5 * angle.cos() * slip[0] + 0.2 * angle.sin() * slip[1]);
        let best =
            (0..100_000).map(|k| power(std::f64::consts::TAU * f64::from(k) / 1e5)).fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let found = point.impulses[1] * slip[0] + point.impulses[2] * slip[1];
        // The search misses the minimum by the square of half its step, 3e-5: 1e-9 of the value.
        assert!((found - best).abs() < 1e-8 * best.abs(), "{found} {best}");
    }
}

/// Sticking: all models agree, since c = 0 has no De Saxcé term.
#[test]
fn sticking_is_the_same_in_all_models() {
    let incline = Incline { angle: 0.2, ..Incline::default() };
    let problem = incline.problem().unwrap();
    for solver in
        [&Newton::default() as &dyn Solver, &Convex::default(), &Enumeration::default(), &Admm::default(), &GaussSeidel::default()]
    {
        let point = solved(solver, &problem);
        // ADMM and Gauss–Seidel end at 1e-10 of the scale.
        assert!(point.velocities.amax() < 1e-9, "{}", solver.name());
    }
}

/// On many balls rolling with even loads obeys the laws, and so do uneven loads with another acceleration, which a solver may find.
#[test]
fn a_box_has_other_motions_on_many_balls() {
    let scene = BoxOnBalls::default();
    let problem = scene.problem().unwrap();
    let acceleration = |forces: &nalgebra::DVector<f64>| {
        // The box feels the friction of its contacts: rows 4k + 3.
        (scene.force + (0..scene.balls).map(|ball| forces[4 * ball + 3]).sum::<f64>()) / scene.box_mass
    };
    let other = solved(&Newton::default(), &problem);
    assert!(
        other.residuals.largest() <= DIRECT && acceleration(&other.impulses) > 8.1,
        "another answer: {}",
        acceleration(&other.impulses)
    );
}

/// SCIENCE's page has (150 − 137.34)/(10 + 50/7) = 0.7385 for the box, and 0.2110 for the balls: friction of the ground would pull all balls
/// back with 0.4 of all weight. No ball can do that. With friction f_t ≥ 0 of the box and f ≥ 0 back by the ground its lowest point would
/// accelerate with (f_t − f) − 5/2 (f_t + f) < 0: backwards, and friction would push it forwards.
#[test]
fn the_balls_cannot_be_pulled_back() {
    let scene = BoxOnBalls { balls: 1, ..BoxOnBalls::default() };
    let mut random = featherbench_robots::Random::named(4, "balls");
    for _ in 0..200 {
        let scene = BoxOnBalls {
            force: random.uniform(0.1, 300.0),
            ground_friction: random.uniform(0.05, 1.0),
            box_friction: random.uniform(0.05, 1.0),
            ..scene
        };
        let all = Enumeration::default().solve(&scene.problem().unwrap()).unwrap();
        let point = all.point().expect("one ball: a unique answer");
        assert!(point.impulses[1] >= 0.0, "the ground pushes the ball forwards");
    }
}

#[test]
fn a_table_has_least_forces() {
    let table = Table::default();
    assert!(table.least_forces().iter().zip([3.25, 2.25, 1.75, 2.75]).all(|(a, b)| (a - b).abs() < 1e-15));
    let problem = table.problem().unwrap();
    // The least forces by a second route: the pseudo-inverse of the equations of balance.
    let equations = problem.mechanism().unwrap().jacobian.transpose();
    let load = nalgebra::DVector::from_vec(vec![table.weight, 0.0, 0.0]);
    let least = equations.pseudo_inverse(1e-12).unwrap() * load;
    assert!(least.iter().zip(table.least_forces()).all(|(a, b)| (a - b).abs() < 1e-14), "{least}");
    assert_eq!(problem.delassus().rank(1e-12), 3);
}

/// The compliant answer differs from the rigid one by a part proportional to 1/k.
#[test]
fn penalty_errors_fall_with_the_stiffness() {
    let problem = Incline::default().problem().unwrap();
    let rigid = solved(&Newton::default(), &problem);
    let error = |stiffness: f64| {
        let point = solved(&Penalty { stiffness, ..Penalty::default() }, &problem);
        (&point.velocities - &rigid.velocities).norm()
    };
    let errors: Vec<f64> = [1e2, 1e3, 1e4, 1e5].into_iter().map(error).collect();
    for pair in errors.windows(2) {
        // 1/(1 + k): ten times the stiffness is between 9.9 and 10 times less error.
        let ratio = pair[0] / pair[1];
        assert!((9.85..10.01).contains(&ratio), "{ratio}");
    }
}
