//! Section: digits lost per engine and method, as a plot along one axis and as a table of medians.

use std::collections::BTreeSet;

use featherbench_results::Verdict;
use maud::{Markup, html};

use crate::accuracy::{Accuracy, Cell, lost};
use crate::axes::Axis;
use crate::labels;
use crate::numbers::short;
use crate::overview::Overview;
use crate::truth;

/// Writes the section; nothing if the run has no accuracy rows.
pub fn section(overview: &Overview, digits: &Accuracy) -> Markup {
    html! {
        @if !digits.answers.is_empty() {
            section #accuracy {
                h2 { "Accuracy: who is right" }
                p.lead {
                    "Relative error of each engine and method against the truth, the answer in double-double arithmetic. "
                    "Forward dynamics in the 2-norm, as published tables have it; inverse dynamics and M entry by entry in their unit-free measures."
                }
                (truth::warning(overview, digits))
                div.controls {
                    label { "Quantity " select #accuracy-quantity {
                        @for quantity in digits.quantities() { option value=(quantity) { (labels::quantity(quantity)) } }
                    } }
                    @if !digits.curves.is_empty() {
                        label { "Against " select #accuracy-axis {
                            @for axis in axes(digits) { option value=(axis.name()) { (axis.title()) } }
                        } }
                        label { "Family " select #accuracy-family {} }
                    }
                }
                @if !digits.curves.is_empty() {
                    div #accuracy-plot.plot role="group" aria-label="Plot of the median error against the truth" {}
                    p.note {
                        "Marks: the median over the states, with bars from the first to the third quartile. Dashed: the conditioning bound, what half a unit in the last "
                        "place of every input can do to the answer when all of it adds up; chance leaves about a tenth of it. Dotted: 2⁻⁵², where no digit is lost. "
                        "p: the fitted exponent, over errors of at least 2⁻⁵³, and of a tip's mass over ratios of at least one. Hollow marks on the plot's lower edge are errors below 10⁻¹⁸, "
                        "others are of M seen through products, where all its entries would be too many."
                    }
                    details open {
                        summary { "Growth: fitted exponents" }
                        p.note { "Error ∝ xᵖ by least squares on logarithms, with the standard error of p; beside it the exponent between the last two robots, where what grows has left the rest behind." }
                        div.scroll.tall { (growth(overview, digits)) }
                    }
                }
                h3 { "Median errors" }
                div.controls {
                    label { "Model " input #accuracy-filter type="search" placeholder="part of a name" autocomplete="off"; }
                    p #accuracy-count role="status" {}
                }
                (legend())
                div.heat-frame tabindex="-1" { (table(overview, digits)) }
                p.note { "Point at a number for quartiles and the largest error; click it, or walk with the arrow keys and press Enter, for its rows." }
            }
        }
    }
}

fn axes(digits: &Accuracy) -> Vec<Axis> {
    let used: BTreeSet<Axis> = digits.curves.iter().map(|curve| curve.axis).collect();
    Axis::ALL.into_iter().filter(|axis| used.contains(axis)).collect()
}

fn growth(overview: &Overview, digits: &Accuracy) -> Markup {
    html! {
        table #accuracy-growth.compact.sortable {
            thead {
                tr {
                    th scope="col" { "engine and method" } th scope="col" { "quantity" } th scope="col" { "against" } th scope="col" { "family" }
                    th.number scope="col" { "robots" } th.number scope="col" { "p" } th.number scope="col" { "p at the end" } th.number scope="col" { "error at the end" }
                }
            }
            tbody {
                @for (index, curve) in digits.curves.iter().enumerate() {
                    @let end = curve.points.last().and_then(|&(_, cell)| digits.cells[cell].median);
                    tr data-k=(index) {
                        th scope="row" { (digits.name(overview, curve.answer)) }
                        td { (labels::quantity(digits.answers[curve.answer].quantity)) }
                        td { (curve.axis.title()) }
                        td { (curve.family) }
                        td.number { (curve.points.len()) }
                        td.number { @if let Some(fit) = curve.fit { (format!("{:.2} ± {:.2}", fit.slope, fit.error)) } @else { "too few" } }
                        td.number { @if let Some(last) = curve.last { (format!("{last:.2}")) } }
                        td.number { @if let Some(end) = end { (short(end)) } }
                    }
                }
            }
        }
    }
}

/// Columns: an answer, or (`None`) the conditioning bound of the quantity to the left.
pub fn columns(digits: &Accuracy) -> Vec<(Option<usize>, usize)> {
    let quantities = digits.quantities();
    let mut columns = Vec::new();
    for (group, quantity) in quantities.iter().enumerate() {
        let answers: Vec<usize> = (0..digits.answers.len()).filter(|&index| digits.answers[index].quantity == *quantity).collect();
        let floored = digits.cells.iter().any(|cell| answers.contains(&cell.answer) && cell.floor.is_some());
        columns.extend(answers.into_iter().map(|answer| (Some(answer), group)));
        if floored {
            columns.push((None, group));
        }
    }
    columns
}

fn table(overview: &Overview, digits: &Accuracy) -> Markup {
    let columns = columns(digits);
    let first = |position: usize| position == 0 || columns[position - 1].1 != columns[position].1;
    html! {
        table #accuracy-table.grid role="grid" aria-label="Median errors against the truth by model, quantity, engine and method" {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "model" }
                    @for (group, quantity) in digits.quantities().into_iter().enumerate() {
                        @let width = columns.iter().filter(|&&(_, other)| other == group).count();
                        th.engine colspan=(width) scope="colgroup" data-q=(group) { (labels::quantity(quantity)) }
                    }
                }
                tr {
                    @for (position, &(answer, group)) in columns.iter().enumerate() {
                        th.method.first[first(position)] scope="col" data-q=(group) {
                            @if let Some(answer) = answer.map(|answer| &digits.answers[answer]) {
                                (overview.engines[answer.engine]) small { (answer.method) @if answer.scalar != "f64" { " " (answer.scalar) } }
                            } @else { "floor" small { "structured" } }
                        }
                    }
                }
            }
            @for family in families(overview, digits) {
                tbody {
                    tr.family { th colspan=(columns.len() + 1) scope="rowgroup" { span { (overview.models[family[0]].family) } } }
                    @for &model in &family {
                        tr data-m=(model) {
                            th scope="row" {
                                button type="button" tabindex="-1" { (overview.models[model].name) }
                                @if let Some(nv) = overview.models[model].nv { small { (nv) } }
                            }
                            @for (position, &(answer, _)) in columns.iter().enumerate() {
                                td.first[first(position)] {
                                    @if let Some(answer) = answer {
                                        @if let Some(cell) = digits.cell(model, answer) { (button(cell)) }
                                    } @else if let Some(floor) = floor(digits, &columns, position, model) { span.floor { (exact(floor)) } }
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
fn floor(digits: &Accuracy, columns: &[(Option<usize>, usize)], position: usize, model: usize) -> Option<f64> {
    let group = columns[position].1;
    columns.iter().filter(|&&(_, other)| other == group).find_map(|&(answer, _)| digits.cell(model, answer?)?.floor)
}

/// The models of each family that have a cell.
fn families(overview: &Overview, digits: &Accuracy) -> Vec<Vec<usize>> {
    let models: BTreeSet<usize> = digits.cells.iter().map(|cell| cell.model).collect();
    let mut families: Vec<Vec<usize>> = Vec::new();
    for model in models {
        match families.last_mut().filter(|family| overview.models[family[0]].family == overview.models[model].family) {
            Some(family) => family.push(model),
            None => families.push(vec![model]),
        }
    }
    families
}

/// Three digits, always in scientific form, so that columns of them are easy to compare.
pub fn exact(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.2e}") }
}

fn button(cell: &Cell) -> Markup {
    let sign = cell.verdict.filter(|verdict| *verdict != Verdict::Pass).map(labels::glyph);
    html! {
        @match cell.median {
            Some(median) => button.(step(median)) type="button" tabindex="-1" {
                @if let Some(sign) = sign { i { (sign) } }
                (exact(median))
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
    let swatch = |class: &str, text: &str, meaning: &str| html! { li { span.swatch.(class) aria-hidden="true" { (text) } (meaning) } };
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
