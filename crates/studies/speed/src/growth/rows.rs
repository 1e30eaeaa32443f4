//! The rows of the study, from the text of each line.

use super::line::{Grown, Point, Stop};
use super::slope::{self, Interval};
use super::{OfLine, Params, own};
use crate::scaling::crossing;
use featherbench_bench::measure::ratio;
use featherbench_bench::{Cell, Context, Finished, Outcome, params};
use featherbench_report::fit::power_law;
use featherbench_results::{Kind, Relation, Row, Verdict};
use featherbench_robots::Random;
use featherbench_study::case_row;
use std::collections::BTreeSet;

/// From so many dofs on, the whole resident memory over the dofs is a row: program and libraries take some bytes per dof of it.
const MANY_DOFS: usize = 1_000_000;

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
    rows.extend(answers(context, &lines));
    rows
}

/// A row about a whole line.
fn blank(cell: &Cell) -> Row {
    let params = cell.params::<OfLine>().unwrap_or_default();
    Row { kind: Kind::Measured, params: params::text(&params), ..case_row(cell) }
}

/// A row about one size.
fn sized(cell: &Cell, point: &Point) -> Row {
    Row { robot: point.tree.clone(), nv: Some(point.dofs as u64), states: "random".into(), ..blank(cell) }
}

fn of_line(context: &Context, cell: &Cell, grown: &Grown) -> Vec<Row> {
    let mut random = Random::named(context.seed, &cell.id());
    let engine = context.engine(&cell.engine);
    let (clock, estimated) = engine.map_or((true, false), |engine| (engine.has_clock(), engine.estimates()));
    let counts = |row: Row| if clock { Row { estimated, ..row } } else { Row { estimated, ..row }.invalid(NO_CLOCK) };
    let of_time = |row: Row, Interval { value, low, high }: Interval| counts(row.measured(value, low, high));
    let mut rows = Vec::new();
    for point in &grown.points {
        let row = |metric: &str, unit: &str| Row { metric: metric.into(), unit: unit.into(), ..sized(cell, point) };
        rows.push(match point.calls[..] {
            // One block has no interval.
            [only] => counts(row("seconds", "s").informed(only)),
            _ => of_time(row("seconds", "s"), slope::of_median(&point.calls, &mut random)),
        });
        rows.push(row("build_seconds", "s").informed(point.build));
        rows.extend(point.peak.map(|bytes| row("peak", "B").informed(bytes as f64)));
        rows.extend(point.resident.map(|bytes| row("resident", "B").informed(bytes as f64)));
        if let Some(bytes) = point.resident.filter(|_| point.dofs >= MANY_DOFS) {
            rows.push(context.gates.judge(row("resident_per_dof", "B"), bytes as f64 / point.dofs as f64, 1.0));
        }
        rows.extend(point.error.map(|error| Row { reference: "truth".into(), ..row("error", "1") }.informed(error)));
    }
    let sizes: Vec<(f64, &[f64])> = grown.points.iter().map(|point| (point.dofs as f64, point.calls.as_slice())).collect();
    let row = |metric: &str, unit: &str| Row { metric: metric.into(), unit: unit.into(), ..blank(cell) };
    rows.extend(slope::of_exponent(&sizes, &mut random).map(|exponent| of_time(row("time_exponent", "1"), exponent)));
    rows.extend(memory_per_dof(&grown.points).map(|bytes| row("memory_per_dof", "B").informed(bytes)));
    rows.extend(memory_exponent(&grown.points).map(|exponent| row("memory_exponent", "1").informed(exponent)));
    rows.push(largest(context, cell, row("largest", "1"), grown));
    rows
}

/// Bytes from which a growth of the resident memory says something: the heap takes and returns hundreds of kilobytes at a time, and where a
/// process has what it was given changes that from run to run.
const COARSE: f64 = 1e7;

/// Growth of the resident memory per dof, between the last two sizes; `None` if so little grew that chance makes it.
fn memory_per_dof(points: &[Point]) -> Option<f64> {
    let [.., before, last] = points else { return None };
    let grown = last.resident? as f64 - before.resident? as f64;
    (last.dofs > before.dofs && grown >= COARSE).then(|| grown / (last.dofs - before.dofs) as f64)
}

/// The exponent p of `resident − resident at the smallest size ~ nᵖ` over the last two decades: program and libraries are in both.
fn memory_exponent(points: &[Point]) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let grown = |point: &Point| Some((point.dofs as f64, point.resident?.checked_sub(first.resident?)? as f64));
    let grown: Option<Vec<(f64, f64)>> = points[1..].iter().filter(|point| point.dofs * 100 >= last.dofs).map(grown).collect();
    power_law(grown?.into_iter().filter(|(_, bytes)| *bytes >= COARSE)).map(|fit| fit.slope)
}

/// The largest size that was answered, and why no larger one was. It is an error if a size that every engine must answer was not.
fn largest(context: &Context, cell: &Cell, row: Row, grown: &Grown) -> Row {
    let dofs = grown.points.last().map_or(0, |point| point.dofs) as f64;
    let Some(Stop { size, tree, reason, offered }) = &grown.stop else { return row.informed(dofs) };
    let reason = format!("{tree}: {reason}");
    let must = cell.params::<Params>().map_or(u64::MAX, |params| params.must);
    if *offered && *size <= must {
        return context.gates.explain(row.without_value(Verdict::Error, reason));
    }
    Row { reason, ..row.informed(dofs) }
}

/// A cell with its sizes.
type Lines<'a> = [(&'a Cell, Grown)];

/// Our method of this name on the line of a cell, for the same quantity.
fn beside<'a>(lines: &'a Lines, cell: &Cell, method: &str) -> Option<&'a Grown> {
    let key = |cell: &Cell| (cell.robot.clone(), cell.engine.clone(), cell.quantity.clone());
    lines.iter().find(|(other, _)| other.method == method && key(other) == key(cell)).map(|(_, grown)| grown)
}

/// Our methods against each other, along each line: the ratios of their times, and where these cross one.
fn against_each_other(lines: &Lines) -> Vec<Row> {
    let mut rows = Vec::new();
    for (cell, grown) in lines {
        let Some(over) = own::of(cell).and_then(|own| own.over) else { continue };
        let Some(serial) = beside(lines, cell, over) else { continue };
        let row = |metric: &str, of: Row| Row { metric: metric.into(), unit: "1".into(), reference: over.into(), ..of };
        let mut ratios = Vec::new();
        for (a, b) in grown.points.iter().zip(&serial.points) {
            let median = |point: &Point| slope::median(&point.calls);
            let ratio = ratio(median(a), median(b));
            ratios.push((a.dofs as f64, ratio));
            rows.push(row("time_ratio", sized(cell, a)).informed(ratio));
        }
        rows.extend(crossing(&ratios).map(|at| row("crossover_measured", blank(cell)).informed(at)));
    }
    rows
}

/// How many different answers a parallel method of ours gives at each size, over all numbers of threads: one, to the bit. The serial method's
/// answer is among them, where it has the same operations.
fn answers(context: &Context, lines: &Lines) -> Vec<Row> {
    let mut rows = Vec::new();
    for (cell, grown) in lines {
        let Some(own) = own::of(cell).filter(|own| own.parallel) else { continue };
        let on = |other: &Cell| other.robot == cell.robot && own::of(other) == Some(own);
        let all: Vec<&(&Cell, Grown)> = lines.iter().filter(|(other, _)| on(other)).collect();
        // One row for all of them, at the cell with the most threads.
        if all.iter().any(|(other, _)| own::threads(other) > own::threads(cell)) {
            continue;
        }
        let serial = own.over.filter(|_| own.same).and_then(|over| beside(lines, cell, over));
        for point in &grown.points {
            let others = all.iter().map(|(_, grown)| grown).chain(serial);
            let of_size = others.flat_map(|grown| &grown.points).filter(|other| other.tree == point.tree);
            let different: BTreeSet<&str> = of_size.map(|point| point.answer.as_str()).collect();
            let row = Row { metric: "different_answers".into(), unit: "1".into(), kind: Kind::Exact, ..sized(cell, point) };
            rows.push(context.gates.explain(row.gated(different.len() as f64, Relation::Eq, 1.0)));
        }
    }
    rows
}
