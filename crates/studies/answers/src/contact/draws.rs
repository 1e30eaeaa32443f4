//! Contact problems with random numbers, 200 draws of each, against enumeration in double-double arithmetic.
//!
//! Where the answer is unique, a solver must find it. Where redundant rows leave a family, the residuals show that an answer is in it. A
//! first-order solver may end at its cap, which it then says.

use super::{Case, count, error, failed, larger, told};
use featherbench_bench::NoAnswer;
use featherbench_contact::systems::{Cradle, Incline, Kane, RockingBlock, Section, SlidingSphere, Stack, Table};
use featherbench_contact::{Enumeration, Malformed, Point, Problem, Solver, solver};
use featherbench_robots::Random;
use serde_json::json;

/// Draws of each scene.
const DRAWS: usize = 200;

/// A scene with random numbers.
type Draw = fn(&mut Random) -> Result<Problem, Malformed>;

/// The scenes, and whether their contacts are planar.
const SCENES: [(&str, bool, Draw); 7] = [
    ("kane", true, kane),
    ("sphere", true, sphere),
    ("incline", false, incline),
    ("table", true, table),
    ("stack", true, stack),
    ("block", true, block),
    ("cradle", true, cradle),
];

pub(super) fn cases() -> Vec<Case> {
    let of = |(name, planar, draw): (&'static str, bool, Draw)| {
        let solvers = if planar { &["lemke", "newton", "gauss_seidel", "admm"][..] } else { &["newton", "gauss_seidel", "admm"] };
        solvers.iter().map(move |solver| case(name, solver, draw))
    };
    SCENES.into_iter().flat_map(of).collect()
}

fn case(scene: &'static str, method: &'static str, draw: Draw) -> Case {
    let first_order = ["gauss_seidel", "admm"].contains(&method);
    let [residual, distance] = if first_order { ["first_order_residual", "first_order_distance"] } else { ["residual", "distance"] };
    let wrong = count("without_answer", 0.0, "enumeration");
    let numbers = vec![
        if first_order { told("without_answer", "1") } else { wrong },
        told("unique", "1"),
        error(residual, "laws"),
        error(distance, "enumeration"),
    ];
    Case {
        name: format!("{scene}, drawn"),
        quantity: "contact_draws",
        method: method.into(),
        params: json!({"draws": DRAWS}),
        numbers,
        evaluate: Box::new(move |seed| compared(scene, method, draw, seed)),
    }
}

/// How many draws have no answer, how many a unique one, the largest residual, and the largest distance of velocities from the unique answer.
fn compared(scene: &str, method: &str, draw: Draw, seed: u64) -> Result<Vec<f64>, NoAnswer> {
    let solver = solver::all().into_iter().find(|solver| solver.name() == method);
    let solver = solver.ok_or_else(|| NoAnswer::Failed(format!("there is no solver '{method}'")))?;
    let mut random = Random::named(seed, scene);
    let mut numbers = [0.0; 4];
    for _ in 0..DRAWS {
        let problem = draw(&mut random).map_err(failed)?;
        let all = Enumeration::default().solve(&problem).map_err(failed)?;
        let solution = solver.solve(&problem).map_err(failed)?;
        let Some(point) = solution.point() else {
            numbers[0] += 1.0;
            continue;
        };
        numbers[2] = larger(point.residuals.largest(), numbers[2]);
        if let Some(known) = all.point() {
            numbers[1] += 1.0;
            numbers[3] = larger(distance(&problem, point, known), numbers[3]);
        }
    }
    Ok(numbers.to_vec())
}

/// Impulses need not be unique, velocities are.
fn distance(problem: &Problem, point: &Point, known: &Point) -> f64 {
    (&point.velocities - &known.velocities).amax() / problem.scales().velocity
}

fn kane(random: &mut Random) -> Result<Problem, Malformed> {
    let kane = Kane {
        angles: [random.uniform(0.1, 1.3), random.uniform(0.1, 1.3)],
        rates: [-random.uniform(0.1, 1.0), -random.uniform(0.1, 1.0)],
        friction: random.uniform(0.0, 1.0),
        restitution: 0.0,
    };
    kane.problem()
}

fn sphere(random: &mut Random) -> Result<Problem, Malformed> {
    let sphere = SlidingSphere {
        mass: random.uniform(0.1, 5.0),
        radius: random.uniform(0.05, 1.0),
        speed: random.uniform(-5.0, 5.0),
        friction: random.uniform(0.05, 1.0),
        duration: random.uniform(0.01, 2.0),
        ..SlidingSphere::default()
    };
    sphere.problem()
}

fn incline(random: &mut Random) -> Result<Problem, Malformed> {
    let second = random.uniform(0.1, 1.0);
    let incline = Incline {
        angle: random.uniform(0.0, 1.3),
        friction: random.uniform(0.1, 1.0),
        section: if random.below(2) == 0 { Section::Round } else { Section::Elliptic(second) },
        heading: random.uniform(-3.0, 3.0),
        mass: random.uniform(0.1, 10.0),
        ..Incline::default()
    };
    incline.problem()
}

/// The centre is within the square of the legs, often outside that of three of them.
fn table(random: &mut Random) -> Result<Problem, Malformed> {
    let half_side = random.uniform(0.2, 1.0);
    let centre = [random.uniform(-0.95, 0.95) * half_side, random.uniform(-0.95, 0.95) * half_side];
    Table { weight: random.uniform(1.0, 100.0), centre, half_side }.problem()
}

fn stack(random: &mut Random) -> Result<Problem, Malformed> {
    let count = 2 + random.below(4);
    Stack { masses: (0..count).map(|_| random.uniform(0.3, 3.0)).collect(), gravity: 9.81 }.problem()
}

fn block(random: &mut Random) -> Result<Problem, Malformed> {
    let block = RockingBlock {
        mass: random.uniform(0.1, 10.0),
        half_width: random.uniform(0.1, 1.0),
        half_height: random.uniform(0.1, 2.0),
        rate: random.uniform(0.1, 3.0),
        friction: random.uniform(0.05, 1.5),
    };
    block.problem()
}

fn cradle(random: &mut Random) -> Result<Problem, Malformed> {
    let count = 2 + random.below(4);
    let masses = (0..count).map(|_| random.uniform(0.3, 3.0)).collect();
    let velocities = (0..count).map(|_| random.uniform(-1.0, 1.0)).collect();
    Cradle { masses, velocities, restitution: random.unit() }.problem()
}
