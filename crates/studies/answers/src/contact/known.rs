//! Quantities of contact problems with closed forms.

use super::problems::answer;
use super::{Case, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_contact::systems::{BoxOnBalls, Feet, Incline, RockingBlock, Section, SlidingSphere, Stack, Table};
use featherbench_contact::{Convex, Outcome, Residuals, Solver};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_4;

const QUANTITY: &str = "contact_quantity";

/// Makes a solver of usual settings by its name.
fn solver(name: &str) -> Option<Box<dyn Solver>> {
    featherbench_contact::solver::all().into_iter().find(|solver| solver.name() == name)
}

const DIRECT: [&str; 3] = ["lemke", "newton", "enumeration"];

/// A quantity of a scene, judged by its error.
fn judged(
    name: &str,
    method: &str,
    params: Value,
    evaluate: impl Fn(&dyn Solver) -> Result<f64, NoAnswer> + Send + Sync + 'static,
) -> Case {
    let first_order = ["gauss_seidel", "admm"].contains(&method);
    let metric = if first_order { "first_order_error" } else { "error" };
    let by = method.to_owned();
    Case {
        name: name.into(),
        quantity: QUANTITY,
        method: method.into(),
        params,
        numbers: vec![error(metric, "closed form")],
        evaluate: Box::new(move |_| {
            let solver = solver(&by).ok_or_else(|| NoAnswer::Failed(format!("there is no solver '{by}'")))?;
            Ok(vec![evaluate(solver.as_ref())?])
        }),
    }
}

fn relative(found: f64, known: f64) -> f64 {
    (found / known - 1.0).abs()
}

pub(super) fn cases() -> Vec<Case> {
    [inclines(), pyramids(), spheres(), tables(), stacks(), blocks(), boxes(), feet()].into_iter().flatten().collect()
}

/// a = g (sin θ − μ cos θ) in every heading.
fn inclines() -> Vec<Case> {
    let mut cases = Vec::new();
    for heading in [0.0, 0.3, FRAC_PI_4, 1.2] {
        let incline = Incline { heading, ..Incline::default() };
        for method in ["newton", "enumeration"] {
            let params = json!({"heading": heading, "angle": incline.angle, "friction": incline.friction});
            cases.push(judged(&format!("incline, heading {heading:.2}"), method, params, move |solver| {
                let point = answer(solver, &incline.problem().map_err(failed)?)?;
                Ok(relative(point.velocities.rows(1, 2).norm(), incline.speed_after(incline.friction)))
            }));
        }
    }
    // Where the relaxation lets a sliding contact open, in closed form.
    let sliding = Incline { speed: 1.0, ..Incline::default() };
    cases.push(judged("incline, relaxed", "convex", json!({"speed": 1.0}), move |_| {
        let point = answer(&Convex::default(), &sliding.problem().map_err(failed)?)?;
        let (slip, opening) = sliding.relaxed();
        Ok(largest([relative(point.velocities.rows(1, 2).norm(), slip), relative(point.velocities[0], opening)]))
    }));
    cases
}

/// The friction that a body feels on a pyramid of friction, over that of the cone, as its heading turns.
///
/// By the laws: it slides against the vertex of least power, and so the felt friction is that of the nearest side.
fn pyramids() -> Vec<Case> {
    let mut cases = Vec::new();
    for (section, name) in [(Section::Round, "round"), (Section::Inscribed, "inscribed"), (Section::Box, "box")] {
        for step in 0..=12 {
            let heading = f64::from(step) * FRAC_PI_4 / 6.0;
            let method = if section == Section::Round { "newton" } else { "lemke" };
            let incline = Incline { section, heading, ..Incline::default() };
            cases.push(Case {
                name: format!("incline, {name} cone, heading {}°", 15.0 * f64::from(step) / 2.0),
                quantity: "felt_friction",
                method: method.into(),
                params: json!({"section": name, "heading": heading}),
                numbers: vec![told("over_cone", "1"), error("residual", "laws")],
                evaluate: Box::new(move |_| {
                    let solver = solver(method).ok_or_else(|| NoAnswer::Failed("there is no such solver".into()))?;
                    let point = answer(solver.as_ref(), &incline.problem().map_err(failed)?)?;
                    // λ_t along the direction of motion down the slope, over λ_n and μ.
                    let down = [incline.heading.cos(), incline.heading.sin()];
                    let held = -(point.impulses[1] * down[0] + point.impulses[2] * down[1]);
                    Ok(vec![held / (point.impulses[0] * incline.friction), point.residuals.largest()])
                }),
            });
        }
    }
    cases
}

/// Sliding until t* = 2v₀/(7μg), then 5v₀/7, in one step of any length.
fn spheres() -> Vec<Case> {
    let mut cases = Vec::new();
    for part in [0.1, 0.5, 0.99, 1.01, 3.0] {
        let sphere = SlidingSphere { duration: part * SlidingSphere::default().slides(), ..SlidingSphere::default() };
        for method in DIRECT {
            cases.push(judged(&format!("sphere after {part} t*"), method, json!({"part": part}), move |solver| {
                let point = answer(solver, &sphere.problem().map_err(failed)?)?;
                Ok(relative(sphere.speed + point.impulses[1] / sphere.mass, sphere.speed_after()))
            }));
        }
    }
    cases
}

/// The forces of four legs: their distance to the line of all forces, over the weight. And the ends of the line.
fn tables() -> Vec<Case> {
    let table = Table::default();
    let mut cases: Vec<Case> = ["lemke", "newton", "gauss_seidel", "admm"]
        .into_iter()
        .map(|method| {
            judged("table", method, json!({"weight": table.weight, "centre": table.centre}), move |solver| {
                let point = answer(solver, &table.problem().map_err(failed)?)?;
                Ok(table.distance(point.impulses.as_slice()) / table.weight)
            })
        })
        .collect();
    cases.push(judged("table, ends", "enumeration", json!({"weight": table.weight}), move |solver| {
        let solution = solver.solve(&table.problem().map_err(failed)?).map_err(failed)?;
        let Outcome::Several(points) = solution.outcome else { return Err(NoAnswer::Failed("the forces are not unique".into())) };
        let unloaded =
            |point: &featherbench_contact::Point| point.impulses.iter().map(|x| x.abs()).reduce(|a, b| if b < a { b } else { a });
        let distances = points.iter().flat_map(|point| [table.distance(point.impulses.as_slice()), unloaded(point).unwrap_or(f64::NAN)]);
        Ok(largest(distances) / table.weight)
    }));
    cases
}

/// Each contact of a stack carries the weight above it.
fn stacks() -> Vec<Case> {
    let stacks = [
        ("stack of two, 10", Stack::two(10.0)),
        ("stack of two, 1000", Stack::two(1000.0)),
        ("stack of eight", Stack::equal(8)),
        ("stack, uneven", Stack { masses: vec![3.0, 1.0, 4.0, 1.5], gravity: 9.81 }),
    ];
    let mut cases = Vec::new();
    for (name, stack) in stacks {
        for method in DIRECT {
            let stack = stack.clone();
            cases.push(judged(name, method, json!({"masses": stack.masses}), move |solver| {
                let point = answer(solver, &stack.problem().map_err(failed)?)?;
                Ok(largest(point.impulses.iter().zip(stack.forces()).map(|(found, known)| relative(*found, known))))
            }));
        }
    }
    cases
}

/// Housner's ratio r = 1 − (3/2) sin²α: the rate after an impact, and r² of the energy.
fn blocks() -> Vec<Case> {
    let mut cases = Vec::new();
    for (half_width, ratio) in [(0.25, 31.0 / 34.0), (0.2, 49.0 / 52.0)] {
        let block = RockingBlock { half_width, ..RockingBlock::default() };
        for method in DIRECT {
            cases.push(judged(&format!("rocking block, {half_width}"), method, json!({"half_width": half_width}), move |solver| {
                let problem = block.problem().map_err(failed)?;
                let point = answer(solver, &problem)?;
                let energy = problem.free_energy().ok_or_else(|| NoAnswer::Failed("the problem has no mass".into()))?;
                let kept = 1.0 + problem.energy_change(&point.impulses) / energy;
                Ok(largest([relative(point.velocities[0], 2.0 * half_width * ratio), relative(kept, ratio * ratio)]))
            }));
        }
    }
    cases
}

/// A box on one ball has one answer. On many it has several; that with even loads accelerates by F/(M + 7nm/20).
fn boxes() -> Vec<Case> {
    let one = BoxOnBalls { balls: 1, force: 6.0, ..BoxOnBalls::default() };
    let mut cases: Vec<Case> = DIRECT
        .into_iter()
        .map(|method| {
            judged("box on a ball", method, json!({"force": one.force}), move |solver| {
                let point = answer(solver, &one.problem().map_err(failed)?)?;
                let known = one.even_forces();
                Ok((&point.impulses - &known).amax() / known.amax())
            })
        })
        .collect();
    let many = BoxOnBalls::default();
    cases.push(Case {
        name: "box on balls, even loads".into(),
        quantity: QUANTITY,
        method: "closed form".into(),
        params: json!({"balls": many.balls, "force": many.force}),
        numbers: vec![error("residual", "laws"), told("acceleration", "m/s²")],
        evaluate: Box::new(move |_| {
            let forces = many.even_forces();
            let residual = Residuals::of(&many.problem().map_err(failed)?, &forces).largest();
            // The box feels the friction of its contacts: rows 4k + 3.
            let friction: f64 = (0..many.balls).map(|ball| forces[4 * ball + 3]).sum();
            Ok(vec![residual, (many.force + friction) / many.box_mass])
        }),
    });
    cases
}

/// Two flat feet: 24 rows of rank 12, and 8 normals of rank 6. What sticks loses its momentum.
fn feet() -> Vec<Case> {
    let rank = Case {
        name: "two flat feet".into(),
        quantity: QUANTITY,
        method: "rank".into(),
        params: json!({"tolerance": 1e-10}),
        numbers: vec![count("rank", 12.0, "theory"), count("rank_of_normals", 6.0, "theory")],
        evaluate: Box::new(|_| {
            let problem = Feet::default().problem().map_err(failed)?;
            let normals: Vec<usize> = (0..8).map(|contact| 3 * contact).collect();
            let g = problem.delassus();
            let of_normals = g.select_rows(&normals).select_columns(&normals);
            Ok([g.rank(1e-10), of_normals.rank(1e-10)].map(|rank| rank as f64).to_vec())
        }),
    };
    let stops = ["newton", "gauss_seidel", "admm", "convex"].into_iter().map(|method| {
        judged("two flat feet", method, json!({}), |solver| {
            let problem = Feet::default().problem().map_err(failed)?;
            let point = answer(solver, &problem)?;
            let Some(mechanism) = problem.mechanism() else { return Err(NoAnswer::Failed("the problem has no mass".into())) };
            let before = &mechanism.mass * &mechanism.free;
            Ok((&before + mechanism.jacobian.tr_mul(&point.impulses)).amax() / before.amax())
        })
    });
    [rank].into_iter().chain(stops).collect()
}
