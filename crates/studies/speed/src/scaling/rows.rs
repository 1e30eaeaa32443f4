//! The rows of the study, from the outcomes of its cells.

use super::others;
use super::tree::{self, SIZES};
use super::{Line, What, crossing};
use crate::operations::COUNTS;
use featherbench_bench::measure::ratio;
use featherbench_bench::{Cell, Context, Finished, params};
use featherbench_results::{Relation, Row, Verdict};
use featherbench_study::unanswered;
use serde_json::json;

/// What the values are compared with.
const THEORY: &str = "theory";
pub(super) const TRUTH: &str = "truth";
/// Numbers of f64 in a register: one, with AVX2, and with AVX-512.
const LANES: [f64; 3] = [1.0, 4.0, 8.0];

/// Every row.
pub(super) fn rows(context: &Context, lines: &[Line], finished: &[Finished]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (cell, outcome) in finished {
        let values = match outcome.answer() {
            Ok(values) if values.len() > SIZES => values,
            Ok(_) => {
                rows.push(tree::row(context, cell, None).without_value(Verdict::Error, "the outcome has too few numbers"));
                continue;
            }
            Err(no_answer) => {
                rows.push(context.gates.explain(unanswered(others::blank(context, cell), &no_answer, Verdict::Skip)));
                continue;
            }
        };
        let (sizes, values) = values.split_at(SIZES);
        let blank = tree::row(context, cell, Some(sizes));
        rows.extend(match cell.params() {
            Ok(What::Counts { .. }) => counts(context, blank, values),
            Ok(What::FillIn) => fill_in(context, blank, values),
            Ok(What::Factors) => factors(context, blank, sizes[1], values),
            Ok(What::Others) => vec![others::row(context, blank, sizes[1], values[0])],
            Ok(What::Floor) => vec![Row { metric: "floor".into(), estimated: true, ..blank }.informed(values[0])],
            Ok(What::Dynamics) => dynamics(context, blank, values[0], floor(cell, finished)),
            Ok(What::Parallel) => parallel(context, blank, values),
            Ok(What::Work { line }) => work(blank, line, values),
            Ok(What::Crossover { .. }) | Err(_) => Vec::new(),
        });
    }
    rows.extend(lines.iter().flat_map(|line| predicted(context, line, finished)));
    rows
}

/// The integers of the factorization.
fn counts(context: &Context, blank: Row, values: &[f64]) -> Vec<Row> {
    let (Some((&counted, values)), count) = (values.split_first(), COUNTS.len()) else { return Vec::new() };
    let route = if counted == 1.0 { "counted" } else { "pattern" };
    let params = params::text(&What::Counts { route: Some(route.into()) });
    let (due, found) = values.split_at(count.min(values.len()));
    let metrics = COUNTS.iter().zip(due.iter().zip(found));
    metrics
        .map(|((metric, _), (&due, &found))| {
            let row = Row { metric: (*metric).into(), reference: THEORY.into(), params: params.clone(), ..blank.clone() };
            context.gates.explain(row.gated(found, Relation::Eq, due))
        })
        .collect()
}

/// What an order of elimination adds to the stored numbers of M.
fn fill_in(context: &Context, blank: Row, values: &[f64]) -> Vec<Row> {
    let &[stored, due, found, multiply_subtracts] = values else {
        return vec![blank.without_value(Verdict::Error, "the outcome has not four numbers")];
    };
    let fill = Row { metric: "fill_in".into(), reference: THEORY.into(), ..blank.clone() };
    let work = Row { metric: "multiply_subtracts".into(), ..blank };
    vec![context.gates.explain(fill.gated(found - stored, Relation::Eq, due - stored)), work.informed(multiply_subtracts)]
}

/// The errors of factors and solution, per dof: a stable factorization keeps them below a constant.
fn factors(context: &Context, blank: Row, dofs: f64, values: &[f64]) -> Vec<Row> {
    let metrics = [("factorization", "factor_error_per_dof"), ("solve", "solution_error_per_dof")];
    let row = |((quantity, metric), &error): ((&str, &str), &f64)| {
        let row = Row { quantity: quantity.into(), metric: metric.into(), reference: TRUTH.into(), ..blank.clone() };
        context.gates.judge(row, error / dofs, 1.0)
    };
    metrics.into_iter().zip(values).map(row).collect()
}

/// The conditioning bound of a cell's tree, from its own cell.
fn floor(cell: &Cell, finished: &[Finished]) -> Option<f64> {
    let of_tree = |(other, _): &&Finished| other.robot == cell.robot && matches!(other.params(), Ok(What::Floor));
    finished.iter().find(of_tree)?.1.values()?.get(SIZES).copied().filter(|floor| floor.is_finite())
}

/// The error of an acceleration, and its ratio to the conditioning bound.
fn dynamics(context: &Context, blank: Row, error: f64, floor: Option<f64>) -> Vec<Row> {
    let blank = Row { reference: TRUTH.into(), states: "random".into(), floor, ..blank };
    let mut rows = vec![context.gates.judge(Row { metric: "error".into(), ..blank.clone() }, error, 1.0)];
    let over = Row { metric: "error_over_floor".into(), estimated: true, ..blank };
    rows.push(match floor {
        Some(floor) => context.gates.judge(over, ratio(error, floor), 1.0),
        None => over.without_value(Verdict::Error, "there is no conditioning bound"),
    });
    rows
}

/// The operations of forward dynamics by the mass matrix over those of the articulated-body algorithm.
fn work(blank: Row, family: String, values: &[f64]) -> Vec<Row> {
    let &[articulated, factorizing] = values else {
        return vec![blank.without_value(Verdict::Error, "the outcome has not two numbers")];
    };
    let params = params::text(&json!({"what": "work", "aba": articulated, "ltdl": factorizing}));
    let row = Row { family, metric: "work_ratio".into(), reference: "aba".into(), params, ..blank };
    vec![row.informed(ratio(factorizing, articulated))]
}

/// Work and span of a method on several cores, over the work of the serial one.
fn parallel(context: &Context, blank: Row, values: &[f64]) -> Vec<Row> {
    let &[serial, work, span] = values else {
        return vec![blank.without_value(Verdict::Error, "the outcome has not three numbers")];
    };
    let params = params::text(&json!({"what": "parallel", "serial": serial, "work": work, "span": span}));
    let row = |metric: &str, value: f64| {
        let row = Row { metric: metric.into(), reference: "serial".into(), params: params.clone(), ..blank.clone() };
        context.gates.judge(row, ratio(value, serial), 1.0)
    };
    vec![row("parallel_work", work), row("parallel_span", span)]
}

/// Where the two ways are predicted to take the same time along a line, if they cross.
///
/// Our way by the mass matrix has several numbers to a register in all its parts, and our articulated-body algorithm one link at a time. So
/// there is one prediction for each number of lanes: the operations of the mass matrix are divided by it.
fn predicted(context: &Context, line: &Line, finished: &[Finished]) -> Vec<Row> {
    let along = |(cell, outcome): &Finished| {
        let of_line = matches!(cell.params(), Ok(What::Work { line: name }) if name == line.name);
        let values = outcome.values().filter(|_| of_line)?;
        Some((*values.get(1)?, ratio(*values.get(SIZES + 1)?, *values.get(SIZES)?)))
    };
    let points: Vec<(f64, f64)> = finished.iter().filter_map(along).collect();
    let Some((first, _)) = finished.iter().find(|item| along(item).is_some()) else { return Vec::new() };
    let blank = tree::row(context, first, None);
    let row = |lanes: f64| {
        let at = crossing(&points.iter().map(|(n, ratio)| (*n, ratio / lanes)).collect::<Vec<_>>())?;
        let params = params::text(&What::Crossover { lanes });
        let (robot, family, metric) = (String::new(), line.name.clone(), "crossover_predicted".into());
        Some(Row { robot, family, metric, reference: "aba".into(), params, ..blank.clone() }.informed(at))
    };
    LANES.into_iter().filter_map(row).collect()
}
