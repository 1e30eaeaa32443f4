//! `featherbench reduce`: the worst cells of a run as a catalogue of small robots, each with a program in the engine's own interface.
//!
//! It is a command of its own and no part of a sweep: it asks engines some hundred times for each case, and any run with errors against the
//! truth has cells for it.

mod program;

use crate::args::{ReduceArgs, RunArgs};
use crate::fail::Fail;
use crate::oracles;
use crate::robots;
use crate::root::Root;
use crate::say::say;
use ::featherbench_results::{Row, RunInfo, atomic_write, words};
use featherbench_bench::truth::TruthModel;
use featherbench_bench::{Engine, HarnessError, OWN, Quantity, Robot};
use featherbench_engines::{Featherbench, Limits};
use featherbench_formats::{OnLoss, mjcf, neutral, urdf};
use featherbench_studies::reduce::{self, Case, Reduced};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// The folder of the catalogue in a run.
const CATALOGUE: &str = "catalogue";
/// Errors of inverse dynamics and M below this are rounding: 45 ε, the gate of the study `accuracy`.
const ROUNDING: f64 = 1e-14;
/// Errors of forward dynamics up to this multiple of the conditioning bound are no finding: ten for each of some ten levels of a tree.
const OVER_FLOOR: f64 = 100.0;

/// What is reduced: the cell with the largest error of an engine's method for a quantity.
struct Worst<'a> {
    row: &'a Row,
    quantity: Quantity,
    value: f64,
}

/// Writes the catalogue of a run.
pub fn reduce(root: &Root, args: &ReduceArgs) -> Result<(), Fail> {
    let (info, rows) = ::featherbench_results::read_run(&args.folder)?;
    let found = worst(&rows, &args.cells);
    if found.is_empty() {
        let message = format!(
            "{}: there is nothing to reduce: no {} has an error against the truth above rounding; studies with such rows are accuracy and sweep",
            args.folder.display(),
            if args.cells.is_empty() { "row" } else { "row of these cells" }
        );
        return Err(Fail::input(message));
    }
    let robots = robots_of(root, &info)?;
    let folder = args.folder.join(CATALOGUE);
    let mut engines: BTreeMap<&str, Box<dyn Engine>> = BTreeMap::new();
    let mut lines = Vec::new();
    for Worst { row, quantity, value } in found {
        if !engines.contains_key(row.engine.as_str()) {
            engines.insert(&row.engine, open(root, &row.engine)?);
        }
        let Some(engine) = engines.get(row.engine.as_str()) else { continue };
        let Some(robot) = robots.iter().find(|robot| robot.name == row.robot) else {
            return Err(Fail::input(format!("{}: the suite has no robot '{}' now; run it again", args.folder.display(), row.robot)));
        };
        // The state with the largest error.
        let state = |k: usize| Case::of(robot, k);
        let of = |robot: &Robot| reduce::severity(engine.as_ref(), robot, quantity, &row.method);
        let states = (0..robot.states.count()).filter_map(|k| Some((of(&state(k).robot()?)?, k)));
        let Some((_, k)) = states.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            eprintln!("note: {} {} {}: no answer now", row.engine, row.quantity, row.method);
            continue;
        };
        let Some(reduced) = reduce::reduce(state(k), least(quantity), &of) else {
            eprintln!("note: {} {} {}: no error above rounding now", row.engine, row.quantity, row.method);
            continue;
        };
        let name = format!("{}-{}-{}", row.engine, quantity.name(), row.method);
        write(&folder.join(&name), row, quantity, &reduced)?;
        let bodies = |description: &featherbench_model::Description| description.bodies.len();
        say!(
            "{name}: {value:.1e} on {} bodies of {}, {:.1e} on {}",
            bodies(&robot.description),
            row.robot,
            reduced.after,
            bodies(&reduced.case.description)
        );
        lines.push(format!(
            "| [{name}]({name}/README.md) | {} | {} | {:.1e} | {} | {:.1e} |",
            row.robot,
            bodies(&robot.description),
            reduced.before,
            bodies(&reduced.case.description),
            reduced.after
        ));
    }
    let head = format!(
        "# Catalogue of the run {}\n\nThe largest error of each engine's method, on the smallest robot and state that still show it (at least {} of it).\n\
         Errors of `fd` are multiples of the conditioning bound; those of `id` and `mass_matrix` are unit-free (METHODOLOGY.md).\n\n\
         | case | robot | bodies | error | bodies, reduced | error, reduced |\n|---|---|---|---|---|---|\n",
        info.run,
        reduce::KEEP
    );
    save(&folder.join("README.md"), &(head + &lines.join("\n") + "\n"))?;
    say!("{} cases: {}", lines.len(), folder.join("README.md").display());
    Ok(())
}

/// Errors up to this are no finding.
fn least(quantity: Quantity) -> f64 {
    if quantity == Quantity::ForwardDynamics { OVER_FLOOR } else { ROUNDING }
}

/// The cells to be reduced: those that are named, or the worst of each engine, quantity and method above rounding.
fn worst<'a>(rows: &'a [Row], named: &[String]) -> Vec<Worst<'a>> {
    let mut found: BTreeMap<(&str, &str, &str), Worst> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.precision == "f64") {
        let quantity = if row.quantity == Quantity::MassMatrixProbe.name() { Quantity::MassMatrix.name() } else { &row.quantity };
        let Some((quantity, value)) = Quantity::parse(quantity).zip(row.value) else { continue };
        let least = least(quantity);
        let asked = if named.is_empty() { value > least } else { named.iter().any(|cell| row.cell.starts_with(cell.as_str())) };
        if row.metric != reduce::metric(quantity) || !asked {
            continue;
        }
        let key = (&*row.engine, quantity.name(), &*row.method);
        if found.get(&key).is_none_or(|known| known.value < value) {
            found.insert(key, Worst { row, quantity, value });
        }
    }
    found.into_values().collect()
}

/// The robots of a run, made again from its command.
fn robots_of(root: &Root, info: &RunInfo) -> Result<Vec<Robot>, Fail> {
    let all = words(&info.command).map_err(Fail::input)?;
    // `cargo run --release -- run …`; a run without arguments is that of the default suite.
    let given: Vec<String> = all.iter().skip_while(|word| *word != "--").skip(1).skip_while(|word| *word == "run").cloned().collect();
    let run = RunArgs::of(&given).map_err(|error| Fail::input(format!("the command of the run is none of `run`: {error}")))?;
    let loaded = robots::load(root, &run.suite, info.live, Some(info.seed), run.size)?;
    if loaded.hash != info.suite_hash {
        eprintln!("note: the suite {} is another one now", run.suite);
    }
    Ok(loaded.robots)
}

/// An engine that answers itself: recorded answers know no other robot.
fn open(root: &Root, name: &str) -> Result<Box<dyn Engine>, Fail> {
    if name == OWN {
        return Ok(Box::new(Featherbench::new()));
    }
    let engines = oracles::described(root)?;
    Ok(Box::new(oracles::start(root, engines.get(name).map_err(Fail::input)?, Limits::default())?))
}

/// Writes a case into a folder: the robot in every format that holds it, its state and the truth, a program, and what it is.
fn write(folder: &Path, row: &Row, quantity: Quantity, reduced: &Reduced) -> Result<(), Fail> {
    let lost = || Fail::input(format!("{}: the reduced robot is none", folder.display()));
    let mut case = reduced.case.clone();
    case.description.name = format!("{}-{}-{}", row.engine, quantity.name(), row.method);
    let robot = case.robot().ok_or_else(lost)?;
    let truth = TruthModel::new(&robot).and_then(|model| model.answer(&robot, quantity, 0)).ok_or_else(lost)?;
    let (q, v, a, tau) = (robot.states.q(0), robot.states.v(0), robot.states.a(0), robot.states.tau(0));
    let mut files = vec!["`robot.json`: the robot in the neutral format"];
    save(&folder.join("robot.json"), &neutral::to_string(&robot.description).map_err(|error| Fail::input(error.to_string()))?)?;
    // A format that lacks a joint, or gravity of another direction, is left out.
    if let Ok((text, _)) = urdf::to_string(&robot.description, OnLoss::Refuse) {
        save(&folder.join("robot.urdf"), &text)?;
        files.push("`robot.urdf`: the same as URDF");
    }
    if let Ok((text, _)) = mjcf::to_string(&robot.description, OnLoss::Refuse) {
        save(&folder.join("robot.xml"), &text)?;
        files.push("`robot.xml`: the same as MJCF");
    }
    let state = json!({"q": q, "v": v, "a": a, "tau": tau, "quantity": quantity.name(), "truth": truth});
    save(&folder.join("state.json"), &format!("{state:#}\n"))?;
    files.push("`state.json`: the state, and the true answer in double-double arithmetic, to the nearest double");
    if let Some(text) = program::of(row, quantity, &robot, &truth) {
        save(&folder.join("reproduce.py"), &text)?;
        files.push("`reproduce.py`: the error by the engine's own interface alone; run it with the engine's Python");
    }
    let body = |index: usize| robot.description.bodies.get(index).map(|body| format!("{} ({})", body.name, body.joint.kind.name()));
    let bodies: Vec<String> = (0..robot.description.bodies.len()).filter_map(body).collect();
    let text = format!(
        "# {} {}: {} by {}\n\n- error: {:.3e} on {} ({} bodies), {:.3e} on this robot ({}: {})\n- measure: {}\n- cell: {}\n- steps tried: {}\n\n{}\n",
        row.engine,
        row.engine_version,
        row.quantity,
        row.method,
        reduced.before,
        row.robot,
        row.bodies.unwrap_or_default(),
        reduced.after,
        bodies.len(),
        bodies.join(", "),
        reduce::metric(quantity),
        row.cell,
        reduced.tried,
        files.into_iter().map(|line| format!("- {line}")).collect::<Vec<_>>().join("\n")
    );
    save(&folder.join("README.md"), &text)
}

fn save(path: &Path, text: &str) -> Result<(), Fail> {
    let parent = path.parent().unwrap_or(path);
    std::fs::create_dir_all(parent).map_err(|source| HarnessError::io(parent, source))?;
    Ok(atomic_write(path, text.as_bytes())?)
}
