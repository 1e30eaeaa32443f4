//! The files of a reduced case: the robot in every format that holds it, its state with the true answer, a program, and what it is.

use crate::programs;
use crate::{Failure, Kind, Line, Reduced, true_answer};
use featherbench_bench::HarnessError;
use featherbench_formats::{OnLoss, mjcf, neutral, urdf};
use featherbench_results::{Row, atomic_write};
use serde_json::json;
use std::path::Path;

/// Writes a case into its folder, and returns the names of its files.
pub fn write(folder: &Path, line: &Line, row: &Row, finding: &Failure, reduced: &Reduced, kind: Kind) -> Result<Vec<String>, HarnessError> {
    let mut case = reduced.case.clone();
    case.description.name = line.name.clone();
    let robot = case.robot().ok_or_else(|| bad(folder, "the reduced robot is none"))?;
    let (q, v, a, tau) = (robot.states.q(0), robot.states.v(0), robot.states.a(0), robot.states.tau(0));
    let truth = true_answer(&robot, finding.quantity);
    let mut files = vec![("robot.json", "the robot in the neutral format")];
    save(&folder.join("robot.json"), &neutral::to_string(&robot.description).map_err(|error| bad(folder, error))?)?;
    // A format that lacks a joint, or gravity of another direction, is left out.
    if let Ok((text, _)) = urdf::to_string(&robot.description, OnLoss::Refuse) {
        save(&folder.join("robot.urdf"), &text)?;
        files.push(("robot.urdf", "the same as URDF"));
    }
    if let Ok((text, _)) = mjcf::to_string(&robot.description, OnLoss::Refuse) {
        save(&folder.join("robot.xml"), &text)?;
        files.push(("robot.xml", "the same as MJCF"));
    }
    let state = json!({"q": q, "v": v, "a": a, "tau": tau, "quantity": finding.quantity.name(), "truth": truth});
    save(&folder.join("state.json"), &format!("{state:#}\n"))?;
    files.push((
        "state.json",
        "the state, and the true answer in double-double arithmetic, to the nearest double; null where there is none",
    ));
    if let Some(text) = programs::of(&row.engine, &row.engine_version, finding, &robot) {
        save(&folder.join("reproduce.py"), &text)?;
        files.push(("reproduce.py", "the error by the engine's own interface alone; run it with the engine's Python"));
    }
    let bodies: Vec<String> = robot.description.bodies.iter().map(|body| format!("{} ({})", body.name, body.joint.kind.name())).collect();
    let error = |severity: f64| if kind == Kind::Number { format!("error {severity:.3e}") } else { "no number".into() };
    let text = format!(
        "# {} {}: {} by {}\n\n{}\n\n- {} on {} ({} bodies), {} on this robot ({}: {})\n- measure: {}\n- cell: {}\n- steps tried: {}\n\n{}\n",
        row.engine,
        row.engine_version,
        row.quantity,
        row.method,
        line.reason,
        error(reduced.before),
        row.robot,
        row.bodies.unwrap_or_default(),
        error(reduced.after),
        bodies.len(),
        bodies.join(", "),
        if finding.metric.is_empty() { "none: there is no answer" } else { &finding.metric },
        row.cell,
        reduced.tried,
        files.iter().map(|(name, meaning)| format!("- `{name}`: {meaning}")).collect::<Vec<_>>().join("\n")
    );
    save(&folder.join("README.md"), &text)?;
    Ok(files.into_iter().map(|(name, _)| name.to_owned()).chain(["README.md".to_owned()]).collect())
}

fn bad(folder: &Path, message: impl ToString) -> HarnessError {
    HarnessError::Config { path: folder.to_owned(), message: message.to_string() }
}

/// Writes a file whole or not at all, and its folder if there is none.
///
/// # Errors
/// [`HarnessError`] when the file cannot be written.
pub fn save(path: &Path, text: &str) -> Result<(), HarnessError> {
    let parent = path.parent().unwrap_or(path);
    std::fs::create_dir_all(parent).map_err(|source| HarnessError::io(parent, source))?;
    Ok(atomic_write(path, text.as_bytes())?)
}
