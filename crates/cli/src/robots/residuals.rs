//! `featherbench residuals`: what the section `residuals` of a description does to a robot's torques and accelerations at a state.

use crate::args::ResidualsArgs;
use crate::fail::Fail;
use crate::message::say;
use crate::robots;
use crate::robots::sections::{Taker, heed};
use crate::root::Root;
use featherbench_model::Model;
use featherbench_residuals::{Described, Nominal, Residual, Rigid, State};
use featherbench_robots::StateBatch;
use serde::Deserialize;
use serde_json::{Value, json};

/// A state as a file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StateFile {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// The joint forces, which are the command of drives too.
    tau: Vec<f64>,
    /// The inner states of drives, in the order of the residuals.
    inner: Option<Vec<f64>>,
}

/// Corrects the torques and accelerations of a robot by its own residuals, and tells them.
pub fn correct(root: impl Fn() -> Result<Root, Fail>, args: &ResidualsArgs) -> Result<(), Fail> {
    let bad = |error: &dyn std::error::Error| Fail::input(format!("{}: {error}", args.robot));
    let robot = robots::named(root, &args.robot)?;
    if robot.residuals.is_empty() {
        return Err(Fail::input(format!(
            "{}: the robot has no residuals; write a section 'residuals' into its description (datasets/models/FORMAT.md lists the laws)",
            args.robot
        )));
    }
    let not_used = heed(&robot, &args.robot, Taker::Residuals)?;
    let described = Described::of(&robot).map_err(|error| bad(&error))?;
    let model: Model<f64> = Model::build(&robot).map_err(|error| bad(&error))?;
    let StateFile { q, v, a, tau, inner } = state(&model, described.inner(), args)?;
    let inner = inner.map_or_else(|| described.settled(&q, &v, &tau), Ok).map_err(|error| bad(&error))?;
    let mut rigid = Rigid::new(&model);
    let (mut nominal_tau, mut nominal_a) = (vec![0.0; described.nv()], vec![0.0; described.nv()]);
    rigid.inverse(&q, &v, &a, &mut nominal_tau).map_err(|error| bad(&error))?;
    rigid.forward(&q, &v, &tau, &mut nominal_a).map_err(|error| bad(&error))?;
    let state = State::new(&q, &v, &a).with_command(&tau).with_inner(&inner);
    let true_tau = described.inverse(&mut rigid, &state).map_err(|error| bad(&error))?;
    let found = described.forward(&mut rigid, &q, &v, &tau, &inner).map_err(|error| bad(&error))?;
    let posed = described.well_posed(&mut rigid, &state).map_err(|error| bad(&error))?;
    let at = State { a: &found.a, ..state };
    let parts = described.each(&at).map_err(|error| bad(&error))?;
    if args.json {
        let parts: Vec<Value> = parts.iter().map(|(name, r)| json!({"name": name, "r": r})).collect();
        say!(
            "{}",
            json!({
                "robot": robot.name, "seed": args.state.is_none().then_some(args.seed), "q": q, "v": v, "a": a, "tau": tau, "inner": inner,
                "nominal_torque": nominal_tau, "true_torque": true_tau, "nominal_acceleration": nominal_a, "true_acceleration": found.a,
                "dry_friction": found.friction, "stuck": found.stuck, "parts": parts, "not_used": not_used,
                "reciprocal_condition": posed.reciprocal_condition, "smallest_eigenvalue": posed.smallest_eigenvalue,
            })
        );
        return Ok(());
    }
    let from = args.state.as_ref().map_or_else(|| format!("the state of seed {}", args.seed), |path| path.display().to_string());
    say!("{}: {} residuals at {from}", robot.name, robot.residuals.len());
    say!("{:>4} {:>16} {:>16} {:>16} {:>16}", "dof", "torque, nominal", "true", "accel., nominal", "true");
    for dof in 0..described.nv() {
        let torque = bounds(&true_tau[dof]);
        let held = if found.stuck.contains(&dof) { ", held by dry friction" } else { "" };
        say!("{dof:>4} {:>16.6} {torque:>16} {:>16.6} {:>16.6}{held}", nominal_tau[dof], nominal_a[dof], found.a[dof]);
    }
    say!("r of each at the true acceleration:");
    for (name, r) in &parts {
        let r: Vec<String> = r.iter().map(bounds).collect();
        say!("  {name}: {}", r.join("  "));
    }
    say!(
        "M + ∂r/∂a, scaled by the diagonal of M: reciprocal condition {:.3e}, smallest eigenvalue {:.3e}",
        posed.reciprocal_condition,
        posed.smallest_eigenvalue
    );
    say!("units: N·m or N, rad/s² or m/s²; true = nominal + r");
    Ok(())
}

/// A number, or an interval.
fn bounds([low, high]: &[f64; 2]) -> String {
    if low == high { format!("{low:.6}") } else { format!("{low:.3} … {high:.3}") }
}

/// The state of a file, or a drawn one.
fn state(model: &Model<f64>, inner: usize, args: &ResidualsArgs) -> Result<StateFile, Fail> {
    if let Some(path) = &args.state {
        let bad = |error: &dyn std::fmt::Display| Fail::input(format!("{}: {error}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| bad(&error))?;
        let file: StateFile = serde_json::from_str(&text).map_err(|error| bad(&error))?;
        let (nq, nv) = (model.topology.nq(), model.topology.nv());
        let lists = [("q", &file.q, nq), ("v", &file.v, nv), ("a", &file.a, nv), ("tau", &file.tau, nv)];
        let lists = lists.into_iter().chain(file.inner.iter().map(|own| ("inner", own, inner)));
        for (field, list, due) in lists {
            if list.len() != due {
                let found = list.len();
                return Err(bad(&format!("field '{field}' has {found} numbers; the robot '{}' needs {due}", args.robot)));
            }
        }
        return Ok(file);
    }
    let drawn = StateBatch::random(model, 1, args.seed);
    Ok(StateFile { q: drawn.q(0).into(), v: drawn.v(0).into(), a: drawn.a(0).into(), tau: drawn.tau(0).into(), inner: None })
}
