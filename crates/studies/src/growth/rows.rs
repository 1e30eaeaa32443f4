//! The rows of the study, from the text of each line.

use super::line::{Grown, Point, Stop};
use super::slope::{self, Interval};
use crate::scaling::crossing;
use featherbench_bench::measure::ratio;
use featherbench_bench::{Cell, Context, Finished, OWN, Outcome, Quantity};
use featherbench_results::{Kind, Row, Verdict, canonical_json};
use featherbench_robots::Random;
use serde_json::json;

/// Why a time does not count.
const NO_CLOCK: &str = "the engine has no clock beside its loop: the time includes the exchange of messages";

/// Every row.
pub(super) fn rows(context: &Context, finished: &[Finished]) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut lines = Vec::new();
    for (cell, outcome) in finished {
        let grown = match outcome {
            Outcome::Text(text) => Grown::of_text(text),
            Outcome::NoAnswer(no_answer) => Err(no_answer.to_string()),
            Outcome::Values(_) => Err("the outcome is numbers, and a text is due".into()),
        };
        match grown {
            Ok(grown) => {
                rows.extend(of_line(context, cell, &grown));
                lines.push((cell, grown));
            }
            Err(reason) => rows.push(context.gates.explain(blank(cell).without_value(Verdict::Error, reason))),
        }
    }
    rows.extend(against_each_other(&lines));
    rows
}

/// A row about a whole line.
fn blank(cell: &Cell) -> Row {
    Row {
        cell: cell.id(),
        study: cell.study.clone(),
        family: cell.robot.clone(),
        engine: cell.engine.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        precision: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        kind: Kind::Measured,
        params: canonical_json(&json!({"line": cell.robot})),
        ..Row::default()
    }
}

/// A row about one size.
fn sized(cell: &Cell, point: &Point) -> Row {
    Row { robot: point.tree.clone(), nv: Some(point.dofs as u64), states: "random".into(), ..blank(cell) }
}

fn of_line(context: &Context, cell: &Cell, grown: &Grown) -> Vec<Row> {
    let mut random = Random::named(context.seed, &cell.id());
    let engine = context.engine(&cell.engine);
    let (clock, estimated) = engine.map_or((true, false), |engine| (engine.has_clock(), engine.estimates()));
    let of_time = |row: Row, Interval { value, low, high }: Interval| {
        let row = Row { estimated, ..row }.measured(value, low, high);
        if clock { row } else { row.invalid(NO_CLOCK) }
    };
    let mut rows = Vec::new();
    for point in &grown.points {
        let row = |metric: &str, unit: &str| Row { metric: metric.into(), unit: unit.into(), ..sized(cell, point) };
        rows.push(of_time(row("seconds", "s"), slope::of_median(&point.calls, &mut random)));
        rows.push(row("build_seconds", "s").informed(point.build));
        rows.extend(point.peak.map(|bytes| row("peak", "B").informed(bytes as f64)));
        rows.extend(point.resident.map(|bytes| row("resident", "B").informed(bytes as f64)));
        rows.extend(point.error.map(|error| Row { reference: "truth".into(), ..row("error", "1") }.informed(error)));
    }
    let sizes: Vec<(f64, &[f64])> = grown.points.iter().map(|point| (point.dofs as f64, point.calls.as_slice())).collect();
    let row = |metric: &str, unit: &str| Row { metric: metric.into(), unit: unit.into(), ..blank(cell) };
    rows.extend(slope::of_exponent(&sizes, &mut random).map(|exponent| of_time(row("time_exponent", "1"), exponent)));
    rows.extend(memory_per_dof(&grown.points).map(|bytes| row("memory_per_dof", "B").informed(bytes)));
    rows.push(largest(context, cell, row("largest", "1"), grown));
    rows
}

/// Growth of the resident memory per dof, between the last two sizes.
fn memory_per_dof(points: &[Point]) -> Option<f64> {
    let [.., before, last] = points else { return None };
    let grown = last.resident? as f64 - before.resident? as f64;
    (last.dofs > before.dofs).then(|| grown / (last.dofs - before.dofs) as f64)
}

/// The largest size that was answered, and why no larger one was. It is an error if a size that every engine must answer was not.
fn largest(context: &Context, cell: &Cell, row: Row, grown: &Grown) -> Row {
    let dofs = grown.points.last().map_or(0, |point| point.dofs) as f64;
    let Some(Stop { size, tree, reason, offered }) = &grown.stop else { return row.informed(dofs) };
    let reason = format!("{tree}: {reason}");
    let must = cell.params["must"].as_u64().unwrap_or(u64::MAX);
    if *offered && *size <= must {
        return context.gates.explain(row.without_value(Verdict::Error, reason));
    }
    Row { reason, ..row.informed(dofs) }
}

/// Our way by the mass matrix against our articulated-body algorithm, along each line: the ratios, and where they cross one.
fn against_each_other(lines: &[(&Cell, Grown)]) -> Vec<Row> {
    let own = |method: &'static str| {
        let forward = Quantity::ForwardDynamics.name();
        lines.iter().filter(move |(cell, _)| cell.engine == OWN && cell.quantity == forward && cell.method == method)
    };
    let mut rows = Vec::new();
    for (cell, factorizing) in own("ltdl") {
        let Some((_, articulated)) = own("aba").find(|(other, _)| other.robot == cell.robot) else { continue };
        let mut ratios = Vec::new();
        for (a, b) in factorizing.points.iter().zip(&articulated.points) {
            let median = |point: &Point| slope::of_median(&point.calls, &mut Random::new(0, 0)).value;
            let ratio = ratio(median(a), median(b));
            ratios.push((a.dofs as f64, ratio));
            rows.push(Row { metric: "time_ratio".into(), unit: "1".into(), reference: "aba".into(), ..sized(cell, a) }.informed(ratio));
        }
        let row = Row { metric: "crossover_measured".into(), unit: "1".into(), reference: "aba".into(), ..blank(cell) };
        rows.extend(crossing(&ratios).map(|at| row.informed(at)));
    }
    rows
}
