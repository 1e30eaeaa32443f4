//! The known answers of the library, each by a second route.

use featherbench_contact::library::{BoxOnBalls, Feet, Incline, RockingBlock, Section, SlidingSphere, Stack, Table};
use featherbench_contact::{
    Admm, Convex, Enumeration, Friction, GaussSeidel, Lemke, Newton, Outcome, Penalty, Point, Problem, Residuals, Solver, library,
};

/// Direct solvers: ≤ 1e-10 on every residual, as the issue asks.
const DIRECT: f64 = 1e-10;

fn solved(solver: &dyn Solver, problem: &Problem) -> Point {
    let solution = solver.solve(problem).unwrap();
    solution.point().unwrap_or_else(|| panic!("{} on {}: {}", solver.name(), problem.name(), solution.status())).clone()
}

/// The speed along the slope in every heading is that of the friction law; round cones for every heading, pyramids at 45°.
#[test]
fn inclines_slide_as_fast_as_their_cone_lets_them() {
    let acceleration = 9.81 * (40.0_f64.to_radians().sin() - 0.5 * 40.0_f64.to_radians().cos());
    assert!((acceleration - 2.548298).abs() < 1e-6);
    for heading in [0.0, 0.3, std::f64::consts::FRAC_PI_4, 1.2] {
        let incline = Incline { heading, ..Incline::default() };
        for solver in [&Newton::default() as &dyn Solver, &Enumeration::default()] {
            let point = solved(solver, &incline.problem().unwrap());
            // 0.01 s: speeds of 0.025 with a few roundings of b = 0.075.
            assert!((point.velocities.rows(1, 2).norm() - 0.01 * acceleration).abs() < 1e-15, "{} {heading}", solver.name());
            assert!(point.residuals.largest() <= DIRECT);
        }
    }
    for section in [Section::Inscribed, Section::Box] {
        let incline = Incline { section, ..Incline::default() };
        let point = solved(&Lemke::default(), &incline.problem().unwrap());
        let speed = incline.speed_after(incline.felt_friction().unwrap());
        assert!((point.velocities.rows(1, 2).norm() - speed).abs() < 1e-14, "{section:?}");
        assert!(point.residuals.largest() <= DIRECT, "{section:?} {:?}", point.residuals);
    }
}

/// Along an axis both pyramids are as wide as the cone: an axis-aligned test hides them.
#[test]
fn pyramids_hide_along_their_axes() {
    for section in [Section::Inscribed, Section::Box] {
        let incline = Incline { section, heading: 0.0, ..Incline::default() };
        let point = solved(&Lemke::default(), &incline.problem().unwrap());
        assert!((point.velocities[1] - incline.speed_after(incline.friction)).abs() < 1e-14, "{section:?}");
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

/// The relaxation opens with μ times the slip; its answer in closed form, and the true one beside it.
#[test]
fn the_relaxation_opens_sliding_contacts() {
    let incline = Incline { speed: 1.0, ..Incline::default() };
    let problem = incline.problem().unwrap();
    let point = solved(&Convex::default(), &problem);
    let (slip, opening) = incline.relaxed();
    assert!((point.velocities[0] - opening).abs() < 1e-12);
    assert!((point.velocities.rows(1, 2).norm() - slip).abs() < 1e-12);
    assert!(point.residuals.signorini > 0.1, "the residuals are those of the true laws");
    let exact = solved(&Newton::default(), &problem);
    assert!(exact.velocities[0].abs() < 1e-15 && exact.residuals.largest() <= DIRECT);
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

/// One step of any length: the sphere slides until t*, and rolls with 5/7 of its speed.
#[test]
fn a_sphere_slides_then_rolls() {
    let sphere = SlidingSphere::default();
    for part in [0.1, 0.5, 0.99, 1.01, 3.0] {
        let sphere = SlidingSphere { duration: part * sphere.slides(), ..sphere };
        for solver in [&Lemke::default() as &dyn Solver, &Newton::default(), &Enumeration::default()] {
            let problem = sphere.problem().unwrap();
            let point = solved(solver, &problem);
            let speed = sphere.speed + point.impulses[1] / sphere.mass;
            assert!((speed - sphere.speed_after()).abs() < 1e-13, "{} {part}", solver.name());
            assert!(point.residuals.largest() <= DIRECT);
        }
    }
}

/// A box on balls. One ball: the answer is unique, and rolls. Several: rolling with even loads obeys the laws, and so do uneven loads with
/// another acceleration, which a solver may find.
#[test]
fn a_box_rolls_on_balls() {
    let scene = BoxOnBalls { balls: 1, force: 6.0, ..BoxOnBalls::default() };
    let problem = scene.problem().unwrap();
    for solver in [&Newton::default() as &dyn Solver, &Enumeration::default(), &Lemke::default()] {
        let point = solved(solver, &problem);
        assert!((&point.impulses - scene.even_forces()).amax() < 1e-11, "{}", solver.name());
    }
    let scene = BoxOnBalls::default();
    let problem = scene.problem().unwrap();
    assert!(Residuals::of(&problem, &scene.even_forces()).largest() < 1e-13);
    let acceleration = |forces: &nalgebra::DVector<f64>| {
        // The box feels the friction of its contacts: rows 4k + 3.
        (scene.force + (0..scene.balls).map(|ball| forces[4 * ball + 3]).sum::<f64>()) / scene.box_mass
    };
    assert!((acceleration(&scene.even_forces()) - 8.0).abs() < 1e-13);
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
fn a_table_has_a_line_of_forces() {
    let table = Table::default();
    assert!(table.least_forces().iter().zip([3.25, 2.25, 1.75, 2.75]).all(|(a, b)| (a - b).abs() < 1e-15));
    let problem = table.problem().unwrap();
    // The least forces by a second route: the pseudo-inverse of the equations of balance.
    let equations = problem.mechanism().unwrap().jacobian.transpose();
    let load = nalgebra::DVector::from_vec(vec![table.weight, 0.0, 0.0]);
    let least = equations.pseudo_inverse(1e-12).unwrap() * load;
    assert!(least.iter().zip(table.least_forces()).all(|(a, b)| (a - b).abs() < 1e-14), "{least}");
    assert_eq!(problem.delassus().rank(1e-12), 3);
    for solver in [&Lemke::default() as &dyn Solver, &Newton::default(), &GaussSeidel::default(), &Admm::default()] {
        let point = solved(solver, &problem);
        assert!(table.distance(point.impulses.as_slice()) < 1e-8, "{}", solver.name());
    }
    // Enumeration gives the ends of the line: a step of ±1.75 or ∓2.25 along (1, −1, 1, −1) unloads a leg.
    let Outcome::Several(points) = Enumeration::default().solve(&problem).unwrap().outcome else { panic!("the forces are not unique") };
    assert_eq!(points.len(), 2);
    for point in points {
        assert!(point.impulses.iter().any(|force| force.abs() < 1e-12) && table.distance(point.impulses.as_slice()) < 1e-12);
        assert!(point.residuals.largest() <= DIRECT);
    }
}

#[test]
fn stacks_carry_their_weight() {
    for stack in [Stack::two(10.0), Stack::two(1000.0), Stack::equal(8), Stack { masses: vec![3.0, 1.0, 4.0, 1.5], gravity: 9.81 }] {
        let problem = stack.problem().unwrap();
        for solver in [&Lemke::default() as &dyn Solver, &Newton::default(), &Enumeration::default()] {
            let point = solved(solver, &problem);
            for (found, known) in point.impulses.iter().zip(stack.forces()) {
                // G is rounded, and its condition is up to 1e3.
                assert!((found - known).abs() <= 1e-11 * known, "{}", solver.name());
            }
        }
    }
}

/// The rocking block keeps Housner's part of its rate if the landing corner does not slip, and another one if it does.
#[test]
fn blocks_rock_by_housners_ratio() {
    for (half_width, ratio) in [(0.25, 31.0 / 34.0), (0.2, 49.0 / 52.0)] {
        let block = RockingBlock { half_width, ..RockingBlock::default() };
        assert!((block.ratio() - ratio).abs() < 1e-15);
        let problem = block.problem().unwrap();
        for solver in [&Lemke::default() as &dyn Solver, &Newton::default(), &Enumeration::default()] {
            let point = solved(solver, &problem);
            // The left corner rises with the rate after times the width.
            assert!((point.velocities[0] - 2.0 * half_width * ratio).abs() < 1e-13, "{}", solver.name());
            let kept = 1.0 + problem.energy_change(&point.impulses) / problem.free_energy().unwrap();
            assert!((kept - ratio * ratio).abs() < 1e-13, "{}: {kept}", solver.name());
        }
        assert!(block.least_friction() < 1.0);
        let slippery = RockingBlock { friction: 0.9 * block.least_friction(), ..block };
        let point = solved(&Enumeration::default(), &slippery.problem().unwrap());
        assert!(point.velocities[3].abs() > 1e-3, "it slips");
    }
    assert!(((31.0_f64 / 34.0).powi(2) - 0.831314878893).abs() < 1e-12);
}

/// 24 rows of rank 12, and 8 normals of rank 6. What sticks has one velocity, and the impulses act as one wrench per foot.
#[test]
fn flat_feet_have_half_the_rank() {
    let feet = Feet::default();
    let problem = feet.problem().unwrap();
    let normals = problem
        .delassus()
        .select_rows(&(0..8).map(|k| 3 * k).collect::<Vec<_>>())
        .select_columns(&(0..8).map(|k| 3 * k).collect::<Vec<_>>());
    assert_eq!((problem.delassus().rank(1e-10), normals.rank(1e-10)), (12, 6));
    for solver in [&Newton::default() as &dyn Solver, &GaussSeidel::default(), &Admm::default(), &Convex::default()] {
        let point = solved(solver, &problem);
        let momentum = &problem.mechanism().unwrap().jacobian.transpose() * &point.impulses;
        let mechanism = problem.mechanism().unwrap();
        let stopped = &mechanism.mass * &mechanism.free + momentum;
        // The feet stop: their momentum is cancelled, to the tolerance of first-order solvers.
        assert!(stopped.amax() < 1e-8, "{}: {stopped}", solver.name());
    }
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

/// Every solver on every case: an answer obeys the laws of the solver's model, or the outcome says what is known.
#[test]
fn every_solver_is_honest_on_every_case() {
    let mut answers = 0;
    for problem in library::all().unwrap() {
        for solver in featherbench_contact::solver::all() {
            let Ok(solution) = solver.solve(&problem) else { continue };
            for point in solution.points() {
                let exact = match solver.name() {
                    "lemke" => !problem
                        .contacts()
                        .iter()
                        .any(|c| matches!(&c.friction, Friction::Coulomb { coefficients } if coefficients.len() == 2)),
                    name => name == "newton" || name == "enumeration",
                };
                if exact {
                    assert!(point.residuals.largest() <= DIRECT, "{} on {}: {:?}", solver.name(), problem.name(), point.residuals);
                    answers += 1;
                }
            }
        }
    }
    assert!(answers > 30, "{answers} answers");
}
