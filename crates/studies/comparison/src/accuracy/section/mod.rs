//! The section of this study: errors against the truth per engine and method, as a plot along one axis and as a table of medians.

mod axes;
mod data;
mod drawings;
mod figures;
mod truth;

use std::collections::{BTreeMap, BTreeSet};

use featherbench_report::numbers::scientific;
use featherbench_report::{Finding, Overview, Section, engine, labels, robot, swatch};
use featherbench_results::{Row, RunInfo, Verdict};
use maud::{Markup, html};

use data::{Accuracy, Cell, lost};
use truth::Truth;

/// The study's name in rows.
const STUDY: &str = "accuracy";
/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[
    (
        "Truth",
        "The reference of accuracy is the answer in double-double arithmetic, 32 digits, from the description's own numbers. Errors of forward dynamics are in the 2-norm, for the comparison with published tables. A gate on forward dynamics there is on ‖Δq̈‖_M / ‖q̈‖_M, against what a backward error of its size amounts to at that state.",
    ),
    ("Digits lost", "log₁₀(error/2⁻⁵²), none below. Medians and quartiles are over the states."),
    (
        "Conditioning bound",
        "How far the true q̈ moves, in the 2-norm and relative to itself, when q, q̇, τ and every mass, length and inertia moves by half a unit in its last place and all of it adds up: a worst case. Roundings of random sign leave about a tenth of it, so an error may lie below the bound.",
    ),
];

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let accuracy = Accuracy::of(overview, rows);
    if accuracy.answers.is_empty() {
        return Vec::new();
    }
    let truth = Truth::of(overview, &accuracy, rows);
    let (drawn, parts) = drawings::drawings(overview, &accuracy);
    vec![Section {
        script: include_str!("accuracy.js"),
        parts,
        style: include_str!("accuracy.css"),
        finding: Some(Finding { rank: 0, body: truth::markup(overview, &accuracy, &truth) }),
        quantities: accuracy.quantities().into_iter().map(str::to_owned).collect(),
        terms: TERMS,
        figures: figures::figures(overview, rows),
        shows: drawings::shown(&accuracy),
        ..Section::new("accuracy", "Accuracy", body(overview, &accuracy, &drawn)).with_data(&accuracy)
    }]
}

/// The errors of a method on a robot, over the states.
pub struct Errors {
    /// Median.
    pub median: f64,
    /// First quartile.
    pub q1: Option<f64>,
    /// Third quartile.
    pub q3: Option<f64>,
}

/// Names a method on a robot: robot and engine (as indices of the overview), method and precision.
pub type MethodOn<'a> = (usize, usize, &'a str, &'a str);

/// The errors of all methods of a quantity against the truth.
pub fn errors<'a>(overview: &Overview<'a>, rows: &'a [Row], quantity: &str) -> BTreeMap<MethodOn<'a>, Errors> {
    let Accuracy { answers, cells, .. } = Accuracy::of(overview, rows);
    let of = |cell: &Cell| {
        let answer = &answers[cell.answer];
        let median = cell.median.filter(|_| answer.quantity == quantity)?;
        Some(((cell.robot, answer.engine, answer.method, answer.scalar), Errors { median, q1: cell.q1, q3: cell.q3 }))
    };
    cells.iter().filter_map(of).collect()
}

fn body(overview: &Overview, accuracy: &Accuracy, drawn: &Markup) -> Markup {
    html! {
        section #accuracy {
            h2 { "Accuracy: who is right" }
            p.lead {
                "Relative error of each engine and method against the truth, the answer in double-double arithmetic. "
                "Forward dynamics in the 2-norm, as published tables have it; inverse dynamics and M entry by entry in their unit-free measures."
            }
            (truth::warning(overview, accuracy))
            (drawn)
            @if !accuracy.curves.is_empty() {
                p.note {
                    "Marks: the median over the states, with bars from the first to the third quartile. Dashed: the conditioning bound, what half a unit in the last "
                    "place of every input can do to the answer when all of it adds up; chance leaves about a tenth of it. Dotted: 2⁻⁵², where no digit is lost. "
                    "p: the fitted exponent, over errors of at least 2⁻⁵³, and of a tip's mass over ratios of at least one. Hollow marks on the plot's lower edge are errors below 10⁻¹⁸, "
                    "others are of M seen through products, where all its entries would be too many."
                }
            }
            h3 { "Median errors" }
            div.controls {
                label { "Robot " input #accuracy-filter type="search" placeholder="part of a name" autocomplete="off"; }
                p #accuracy-count role="status" {}
            }
            (legend())
            div.heat-frame tabindex="-1" { (table(overview, accuracy)) }
            p.note { "Point at a number for quartiles and the largest error; click it, or walk with the arrow keys and press Enter, for its rows." }
        }
    }
}

/// Columns: an answer, or (`None`) the conditioning bound of the quantity to the left.
pub fn columns(accuracy: &Accuracy) -> Vec<(Option<usize>, usize)> {
    let quantities = accuracy.quantities();
    let mut columns = Vec::new();
    for (group, quantity) in quantities.iter().enumerate() {
        let answers: Vec<usize> = (0..accuracy.answers.len()).filter(|&index| accuracy.answers[index].quantity == *quantity).collect();
        let floored = accuracy.cells.iter().any(|cell| answers.contains(&cell.answer) && cell.floor.is_some());
        columns.extend(answers.into_iter().map(|answer| (Some(answer), group)));
        if floored {
            columns.push((None, group));
        }
    }
    columns
}

fn table(overview: &Overview, accuracy: &Accuracy) -> Markup {
    let columns = columns(accuracy);
    let first = |position: usize| position == 0 || columns[position - 1].1 != columns[position].1;
    html! {
        table #accuracy-table.grid role="grid" aria-label="Median errors against the truth by robot, quantity, engine and method" {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "robot" }
                    @for (group, quantity) in accuracy.quantities().into_iter().enumerate() {
                        @let width = columns.iter().filter(|&&(_, other)| other == group).count();
                        th.engine colspan=(width) scope="colgroup" data-q=(group) { (labels::quantity(quantity)) }
                    }
                }
                tr {
                    @for (position, &(answer, group)) in columns.iter().enumerate() {
                        th.method.first[first(position)] scope="col" data-q=(group) {
                            @if let Some(answer) = answer.map(|answer| &accuracy.answers[answer]) {
                                (engine(overview, overview.engines[answer.engine])) small { (answer.method) @if answer.scalar != "f64" { " " (answer.scalar) } }
                            } @else { "bound" small { "conditioning" } }
                        }
                    }
                }
            }
            @for family in overview.families(with_cell(accuracy)) {
                tbody {
                    tr.family { th colspan=(columns.len() + 1) scope="rowgroup" { span { (overview.robots[family[0]].family) } } }
                    @for &index in &family {
                        tr data-m=(index) {
                            th scope="row" {
                                (robot(overview, overview.robots[index].name))
                                @if let Some(nv) = overview.robots[index].nv { small { (nv) } }
                            }
                            @for (position, &(answer, _)) in columns.iter().enumerate() {
                                td.first[first(position)] {
                                    @if let Some(answer) = answer {
                                        @if let Some(cell) = accuracy.cell(index, answer) { (button(cell)) }
                                    } @else if let Some(floor) = floor(accuracy, &columns, position, index) { span.floor { (scientific(floor)) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The conditioning bound of the quantity at a column, which is the same for all its answers.
fn floor(accuracy: &Accuracy, columns: &[(Option<usize>, usize)], position: usize, robot: usize) -> Option<f64> {
    let group = columns[position].1;
    columns.iter().filter(|&&(_, other)| other == group).find_map(|&(answer, _)| accuracy.cell(robot, answer?)?.floor)
}

/// The robots that have a cell.
fn with_cell(accuracy: &Accuracy) -> BTreeSet<usize> {
    accuracy.cells.iter().map(|cell| cell.robot).collect()
}

fn button(cell: &Cell) -> Markup {
    let sign = cell.verdict.filter(|verdict| *verdict != Verdict::Pass).map(labels::glyph);
    html! {
        @match cell.median {
            Some(median) => button.(step(median)) type="button" tabindex="-1" {
                @if let Some(sign) = sign { i { (sign) } }
                (scientific(median))
            },
            None => button.(cell.verdict.unwrap_or(Verdict::Info).as_str()) type="button" tabindex="-1" { (sign.unwrap_or("·")) },
        }
    }
}

/// Colour steps by digits lost.
fn step(error: f64) -> &'static str {
    match lost(error) {
        digits if digits < 1.0 => "d0",
        digits if digits < 2.0 => "d1",
        digits if digits < 4.0 => "d2",
        digits if digits < 6.0 => "d3",
        digits if digits < 9.0 => "d4",
        _ => "d5",
    }
}

fn legend() -> Markup {
    html! {
        ul.legend aria-label="Legend: digits lost, decades above 2⁻⁵²" {
            li { "digits lost:" }
            (swatch("d0", "", "less than 1"))
            (swatch("d1", "", "1–2"))
            (swatch("d2", "", "2–4"))
            (swatch("d3", "", "4–6"))
            (swatch("d4", "", "6–9"))
            (swatch("d5", "", "9 or more"))
            (swatch("", "✕", "a gate is missed"))
            (swatch("", "≈", "missed by known cause"))
            (swatch("error", "!", "no answer"))
            (swatch("skip", "–", "not offered"))
        }
    }
}
