//! Section: ranks, base parameters and estimates.

mod drawings;

use super::STUDY;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use featherbench_study::known::{passed, table};
use featherbench_study::rows_of;
use maud::{Markup, html};
use std::collections::BTreeMap;

/// What the rows of a quantity are about, in the order of the table.
const QUANTITIES: [(&str, &str); 9] = [
    ("rank", "ranks of the torque regressor"),
    ("without_noise", "base parameters without noise"),
    ("scatter", "scatter of estimates with noise"),
    ("interval", "95 % intervals of one draw of noise"),
    ("with_noise", "another trajectory predicted, bodies that can exist"),
    ("pseudo_inertia", "which parameters a body can have"),
    ("log_cholesky", "log-Cholesky numbers"),
    ("excitation", "exciting trajectories"),
    ("witness", "other engines' regressors on the same samples"),
];

/// A name and three numbers.
type Named<'a> = (&'a str, f64, f64, f64);

/// What the section draws.
struct Figures<'a> {
    /// Of each way to a rank: its name, and of each robot its name, unknowns, last kept and first dropped singular value over the largest.
    gaps: Vec<(&'a str, Vec<Named<'a>>)>,
    /// Of each base parameter: its name, estimate, truth, and half its interval.
    intervals: Vec<Named<'a>>,
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    vec![Section::new("identification", "Identification", body(&rows, &chunk))]
}

/// The values of a cell, by metric.
type Cell<'a> = BTreeMap<&'a str, f64>;

/// The cells of a quantity in the order of their rows, each with one of its rows.
fn cells<'a>(rows: &[&'a Row], quantity: &str) -> Vec<(&'a Row, Cell<'a>)> {
    let mut cells: Vec<(&Row, Cell)> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == quantity) {
        if cells.last().is_none_or(|(last, _)| last.cell != row.cell) {
            cells.push((row, Cell::new()));
        }
        if let (Some((_, cell)), Some(value)) = (cells.last_mut(), row.value) {
            cell.insert(&row.metric, value);
        }
    }
    cells
}

fn figures<'a>(rows: &[&'a Row]) -> Figures<'a> {
    let ranks = cells(rows, "rank");
    let ways = ["torque", "energy", "base rows", "at rest"].into_iter().map(|way| {
        let of = |(row, cell): &(&'a Row, Cell<'a>)| {
            (row.method == way).then_some(())?;
            Some((row.family.as_str(), *cell.get("unknowns")?, *cell.get("last_kept")?, *cell.get("first_dropped")?))
        };
        (way, ranks.iter().filter_map(of).collect())
    });
    let interval = |(row, cell): (&'a Row, Cell<'a>)| {
        Some((row.family.as_str(), *cell.get("estimate")?, *cell.get("truth")?, *cell.get("half_width")?))
    };
    Figures { gaps: ways.collect(), intervals: cells(rows, "interval").into_iter().filter_map(interval).collect() }
}

/// The worst value of a metric.
fn worst(rows: &[&Row], quantity: &str, metric: &str) -> Option<f64> {
    let values = rows.iter().filter(|row| row.quantity == quantity && row.metric == metric).filter_map(|row| row.value);
    values.reduce(|a, b| if a.is_nan() || a > b { a } else { b })
}

/// Ranks by robot: of each the law's number and what each way found.
fn ranks(rows: &[&Row]) -> Markup {
    /// Of each way: its name, the rank and the law's.
    type Ways<'a> = Vec<(&'a str, f64, f64)>;
    let mut robots: Vec<(&str, Ways)> = Vec::new();
    for (row, cell) in cells(rows, "rank") {
        if robots.last().is_none_or(|(name, _)| *name != row.family) && !robots.iter().any(|(name, _)| *name == row.family) {
            robots.push((&row.family, Vec::new()));
        }
        if let (Some((_, ways)), Some(&rank), Some(&unknowns)) =
            (robots.iter_mut().find(|(name, _)| *name == row.family), cell.get("rank"), cell.get("unknowns"))
        {
            ways.push((&row.method, rank, unknowns));
        }
    }
    html! {
        details {
            summary { "Ranks, robot by robot" }
            div.scroll {
                table.compact.sortable {
                    thead { tr { th scope="col" { "robot" } th.number scope="col" { "unknowns" } th scope="col" { "base parameters, by each way" } } }
                    tbody {
                        @for (name, ways) in &robots {
                            tr {
                                th scope="row" { (name) }
                                td.number { @if let Some((_, _, unknowns)) = ways.first() { (unknowns) } }
                                td { @for (k, (way, rank, _)) in ways.iter().enumerate() { @if k > 0 { " · " } (rank) " (" (way) ")" } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn body(rows: &[&Row], chunk: &str) -> Markup {
    let (right, judged) = passed(rows);
    let figures = figures(rows);
    let own: Vec<&Row> = rows.iter().filter(|row| row.quantity == "rank" && row.metric == "rank").copied().collect();
    let (ranked, ranks_judged) = passed(&own);
    let witnesses: Vec<&Row> = rows.iter().filter(|row| row.quantity == "witness" && row.value.is_some()).copied().collect();
    html! {
        section #identification {
            h2 { "Identification" }
            p.lead { b { (right) " of " (judged) " known numbers are reproduced." } }
            ul {
                li { (ranked) " of " (ranks_judged) " ranks of the torque regressor are those of the laws: 7n − 6 along the first axis, 7n − 4 oblique, 3n in the plane, 7n + 10 floating." }
                @if let Some(error) = worst(rows, "without_noise", "error") {
                    li { "Without noise every estimator finds the base parameters to " (short(error)) " of the largest." }
                }
                @if let Some(error) = worst(rows, "scatter", "variance_error") {
                    li { "With noise thousands of estimates scatter as σ²(YᵀY)⁻¹ says, to " (short(100.0 * error)) " %." }
                }
                @if let Some(ratio) = worst(rows, "with_noise", "held_out_over_noise") {
                    li { "Another trajectory is predicted to " (short(ratio)) " of the noise. Estimates by log-Cholesky numbers are bodies that can exist; those of least squares need not be." }
                }
                @if witnesses.is_empty() {
                    li { "A live run asks other engines for the regressors of the same samples." }
                } @else {
                    li {
                        "Other engines' regressors of the same samples give the same base parameters, to "
                        @if let Some(difference) = worst(rows, "witness", "parameter_difference") { (short(difference)) } "."
                    }
                }
            }
            div.pair {
                (drawings::gaps(&figures))
                (drawings::intervals(&figures))
            }
            (ranks(rows))
            (table(STUDY, rows, &QUANTITIES, chunk))
        }
    }
}
