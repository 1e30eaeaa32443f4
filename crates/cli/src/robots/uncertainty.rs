//! `featherbench uncertainty`: what uncertain parameters do to a robot's accelerations, or torques, at a state.

use crate::args::{Propagation, UncertaintyArgs};
use crate::fail::Fail;
use crate::message::{say, tell};
use crate::robots;
use crate::robots::sections::{Taker, heed};
use crate::root::Root;
use featherbench_bench::measure::{ratio, worst};
use featherbench_model::{Description, Model};
use featherbench_robots::StateBatch;
use featherbench_uncertainty::{
    Estimate, Indices, Points, QUANTILES, Quantile, Quantity, RobotResponse, Route, Sampling, Space, State, chaos, first_order,
    largest_order, sample, sensitivity, spread, unscented,
};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Deserialize;
use serde_json::{Value, json};
use std::time::Instant;

/// Nodes of a tensor rule of polynomial chaos, at most.
const NODES: usize = 100_000;

/// A state as a file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StateFile {
    q: Vec<f64>,
    v: Vec<f64>,
    /// Joint forces; with --torque accelerations.
    drive: Vec<f64>,
}

/// What is told of a degree of freedom. A method without samples has no errors and no quantiles.
struct Line {
    mean: Estimate,
    deviation: Estimate,
    quantiles: Option<[Quantile; QUANTILES.len()]>,
    more: Value,
}

/// Propagates the uncertain parameters of a robot and tells what comes of it.
pub fn propagate(root: impl Fn() -> Result<Root, Fail>, args: &UncertaintyArgs) -> Result<(), Fail> {
    let bad = |error: featherbench_uncertainty::Error| Fail::input(format!("{}: {error}", args.robot));
    let mut robot = robots::named(root, &args.robot)?;
    let own = args.spread.is_none() && !robot.uncertain.variables.is_empty();
    let not_used = heed(&robot, &args.robot, Taker::Uncertainty { own })?;
    let source = match (args.spread, robot.uncertain.variables.is_empty()) {
        (None, false) => "the description's own parameters".to_owned(),
        (given, _) => {
            let relative = given.unwrap_or(0.2);
            robot.uncertain = spread(&robot, relative).map_err(bad)?;
            format!("each mass uniform within {} % of its value", 100.0 * relative)
        }
    };
    let state = state(&robot, args)?;
    let (quantity, unit) = if args.torque { (Quantity::Torque, "N·m or N") } else { (Quantity::Acceleration, "rad/s² or m/s²") };
    let response = RobotResponse::new(&robot, &state, quantity, None).map_err(bad)?;
    let space = Space::of(&robot.uncertain).map_err(bad)?;
    let linear = response.linear().map_err(bad)?;
    let settings = Sampling {
        points: if args.method == Propagation::Random { Points::Random } else { Points::Sobol },
        samples: args.samples,
        seed: args.seed,
        threads: args.threads,
        ..Sampling::default()
    };
    let start = Instant::now();
    let exact = |value| Estimate { value, error: 0.0, freedom: f64::INFINITY };
    let plain = |mean: f64, variance: f64| Line {
        mean: exact(mean),
        deviation: exact(variance.max(0.0).sqrt()),
        quantiles: None,
        more: Value::Null,
    };
    let (lines, evaluations): (Vec<Line>, u64) = match args.method {
        Propagation::FirstOrder => {
            let found = first_order(&space, &linear).map_err(bad)?;
            (found.mean.iter().enumerate().map(|(k, mean)| plain(*mean, found.covariance[(k, k)])).collect(), 1)
        }
        Propagation::Unscented => {
            let kappa = (3.0 - space.len() as f64).max(0.0);
            let found = unscented(&space, &response, kappa).map_err(bad)?;
            let points = 2 * space.len() as u64 + 1;
            (found.mean.iter().enumerate().map(|(k, mean)| plain(*mean, found.covariance[(k, k)])).collect(), points)
        }
        Propagation::Chaos => {
            let order = args.order.unwrap_or_else(|| largest_order(space.len(), NODES).min(6));
            let found = chaos(&space, &response, order).map_err(bad)?;
            let of = |k| Line { more: json!({"order": order}), ..plain(found.mean(k), found.variance(k)) };
            ((0..linear.value.len()).map(of).collect(), found.nodes as u64)
        }
        Propagation::Random | Propagation::Sobol => {
            let bar = ProgressBar::new(args.samples);
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {human_pos}/{human_len} samples, {per_sec}, {eta}") {
                bar.set_style(style);
            }
            let found = sample(&space, &response, Some(&linear), &settings, &|done| bar.set_position(done)).map_err(bad)?;
            bar.finish_and_clear();
            let of = |output: &featherbench_uncertainty::Output| {
                let density: Vec<[f64; 2]> = output.histogram.density(64).into_iter().map(|(at, density)| [at, density]).collect();
                Line {
                    // To take the one with the smaller error would make the interval too narrow: errors are estimates too.
                    mean: output.controlled.unwrap_or(output.mean),
                    deviation: output.deviation,
                    quantiles: Some(output.quantiles),
                    more: json!({
                        "skewness": output.moments.skewness(), "excess": output.moments.excess(), "reduction": output.reduction,
                        "resolution": output.histogram.width(), "density": density,
                    }),
                }
            };
            (found.outputs.iter().map(of).collect(), found.samples)
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    let indices = if args.indices {
        let pairs = Sampling { samples: (args.samples / (space.len() as u64 + 2)).max(32), points: Points::Sobol, ..settings };
        Some(sensitivity(&space, &response, &pairs).map_err(bad)?)
    } else {
        None
    };
    let names: Vec<&str> = robot.uncertain.variables.iter().map(|variable| variable.name.as_str()).collect();
    if args.json {
        let dofs: Vec<Value> = lines.iter().map(described).collect();
        let found = indices.as_ref().map(|all| all.iter().map(|own| of_indices(own, &names)).collect::<Vec<Value>>());
        say!(
            "{}",
            json!({
                "robot": robot.name, "quantity": if args.torque { "torque" } else { "acceleration" }, "method": args.method.name(),
                "seed": args.seed, "evaluations": evaluations, "seconds": seconds, "variables": names, "dofs": dofs, "indices": found,
                "losses": response.is_lossy(), "not_used": not_used,
            })
        );
        return Ok(());
    }
    let what = if args.torque { "torques" } else { "accelerations" };
    let widest = lines.iter().map(|line| ratio(line.deviation.value, line.mean.value.abs())).fold(0.0, worst);
    say!("{}: {what} deviate by up to {:.3} of their mean, from {} uncertain parameters ({source})", robot.name, widest, names.len());
    say!("{:>4} {:>14} {:>8} {:>14} {:>8} {:>14} {:>8} {:>14} {:>8}", "dof", "mean", "±", "deviation", "±", "5 %", "±", "95 %", "±");
    for (dof, line) in lines.iter().enumerate() {
        let quantile = |k: usize| line.quantiles.as_ref().and_then(|all| all[k].found);
        let numbers = [Some(line.mean), Some(line.deviation), quantile(1), quantile(3)].map(|number| {
            let error = number.filter(|_| line.quantiles.is_some()).map_or_else(String::new, |x| format!("{:.1e}", x.error));
            format!(" {:>14} {error:>8}", number.map_or_else(String::new, |x| format!("{:.6}", x.value)))
        });
        say!("{dof:>4}{}", numbers.concat());
    }
    for (dof, own) in indices.iter().flatten().enumerate() {
        let total = |i: usize| own.total[i].value;
        let mut order: Vec<usize> = (0..names.len()).collect();
        order.sort_by(|a, b| total(*b).total_cmp(&total(*a)));
        let first: Vec<String> =
            order.iter().take(3).map(|i| format!("{} {:.3} (alone {:.3})", names[*i], total(*i), own.first[*i].value)).collect();
        say!("dof {dof}, parts of the variance: {}", first.join(", "));
    }
    match lines.first().filter(|line| line.quantiles.is_some()) {
        Some(Line { mean, .. }) => {
            let student = featherbench_uncertainty::student(mean.freedom);
            say!("units: {unit}; ± is a standard error, and {student:.2} of it to both sides of the number are a 95 % interval");
        }
        None => say!("units: {unit}"),
    }
    if response.is_lossy() {
        say!("damping and dry friction are part of it, because one of them is uncertain");
    }
    let route = if response.route() == Route::Affine { "precomputed columns" } else { "recursion" };
    tell!(
        "{} by {route}: {evaluations} evaluations in {seconds:.3} s, {:.3e} per second",
        args.method.name(),
        evaluations as f64 / seconds
    );
    Ok(())
}

fn described(line: &Line) -> Value {
    let error = |number: &Estimate| line.quantiles.map(|_| number.error);
    let half = |number: &Estimate| line.quantiles.map(|_| number.half_width());
    let of = |quantile: &Quantile, number: &dyn Fn(Estimate) -> f64| json!([quantile.probability, quantile.found.map(number)]);
    let list = |number: &dyn Fn(Estimate) -> f64| line.quantiles.map(|all| all.iter().map(|own| of(own, number)).collect::<Vec<Value>>());
    json!({
        "mean": line.mean.value, "mean_error": error(&line.mean), "mean_half_width": half(&line.mean),
        "deviation": line.deviation.value, "deviation_error": error(&line.deviation), "deviation_half_width": half(&line.deviation),
        "quantiles": list(&|own| own.value), "quantile_errors": list(&|own| own.error), "quantile_half_widths": list(&|own| own.half_width()),
        "more": line.more,
    })
}

fn of_indices(own: &Indices, names: &[&str]) -> Value {
    let one = |(i, name): (usize, &&str)| {
        let (first, total) = (own.first[i], own.total[i]);
        json!({
            "variable": name, "first": first.value, "first_error": first.error, "first_half_width": first.half_width(),
            "total": total.value, "total_error": total.error, "total_half_width": total.half_width(),
        })
    };
    names.iter().enumerate().map(one).collect()
}

/// The state of a file, or a drawn one.
fn state(robot: &Description, args: &UncertaintyArgs) -> Result<State, Fail> {
    if let Some(path) = &args.state {
        let bad = |error: &dyn std::fmt::Display| Fail::input(format!("{}: {error}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| bad(&error))?;
        let StateFile { q, v, drive } = serde_json::from_str(&text).map_err(|error| bad(&error))?;
        return Ok(State { q, v, drive });
    }
    let model: Model<f64> = Model::build(robot).map_err(|error| Fail::input(format!("{}: {error}", args.robot)))?;
    let drawn = StateBatch::random(&model, 1, args.seed);
    let drive = if args.torque { drawn.a(0) } else { drawn.tau(0) };
    Ok(State { q: drawn.q(0).into(), v: drawn.v(0).into(), drive: drive.into() })
}
