//! The section of this study: quantile maps of errors, and the robots with the largest ones.

mod maps;

use featherbench_report::numbers::count;
use featherbench_report::{Overview, Section, labels, opener, robot_chunk, swatch};
use featherbench_results::{Row, RunInfo};
use maud::{Markup, html};

use maps::{Answer, Maps, QUANTILES, STUDY, Spot};

/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[(
    "Quantile map",
    "The errors of one engine's method at one level of an axis, over all robots that were drawn at that level; their other axes are at any of their levels. A quantile of few robots is uncertain: the 99 % of fewer than a hundred is near their largest.",
)];
/// The quantile that is shown first.
const FIRST: usize = 2;

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections(_: &RunInfo, rows: &[Row], overview: &Overview) -> Vec<Section> {
    let maps = Maps::of(overview, rows);
    if maps.answers.is_empty() {
        return Vec::new();
    }
    vec![Section {
        script: include_str!("sweep.js"),
        style: include_str!("sweep.css"),
        terms: TERMS,
        ..Section::new("sweep", "Sweep", body(overview, &maps))
    }]
}

fn body(overview: &Overview, maps: &Maps) -> Markup {
    html! {
        section #sweep {
            h2 { "Sweep: errors over drawn robots" }
            p.lead {
                "Relative errors against the truth of " (count(maps.robots, "robot")) ", each drawn at one level of every axis, at one state each. "
                "A column is a level: it has the errors of the robots at that level, whatever their other levels."
            }
            div.controls {
                label { "Quantity " select #sweep-quantity {
                    @for quantity in maps.quantities() { option value=(quantity) { (labels::quantity(quantity)) } }
                } }
                label { "Quantile " select #sweep-quantile {
                    @for (at, (name, _)) in QUANTILES.iter().enumerate() { option value=(at) selected[at == FIRST] { (name) } }
                } }
            }
            ul.legend aria-label="Legend: digits lost, decades above 2⁻⁵²" {
                li { "digits lost:" }
                @for (class, meaning) in [("d0", "less than 1"), ("d1", "1–2"), ("d2", "2–4"), ("d3", "4–6"), ("d4", "6–9"), ("d5", "9 or more")] {
                    (swatch(class, "", meaning))
                }
            }
            @for quantity in maps.quantities() {
                div data-quantity=(quantity) {
                    h3 { (labels::quantity(quantity)) }
                    div.scroll.tall { (map(overview, maps, quantity)) }
                }
            }
            p.note {
                "A number opens the rows of the robot with the largest error at that level; its name in "
                code { "featherbench explain" } " and its line in the suite make it again. +2!: two cells without an answer, or whose error is no number."
            }
        }
    }
}

fn map(overview: &Overview, maps: &Maps, quantity: &str) -> Markup {
    html! {
        table.grid {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "engine and method" }
                    @for (axis, width) in maps.axes() { th.engine colspan=(width) scope="colgroup" { @if axis.is_empty() { "robots" } @else { (title(axis)) } } }
                }
                tr { @for level in &maps.levels { th.method scope="col" { (level.name) } } }
            }
            tbody {
                @for (answer, spots) in maps.answers.iter().zip(&maps.spots).filter(|(answer, _)| answer.quantity == quantity) {
                    tr {
                        th scope="row" { (overview.engines[answer.engine]) " " (answer.method) @if answer.precision != "f64" { small { " " (answer.precision) } } }
                        @for spot in spots { (cell(answer, spot)) }
                    }
                }
            }
        }
    }
}

fn cell(answer: &Answer, spot: &Spot) -> Markup {
    let failed = html! { @if spot.failed > 0 { small { " +" (spot.failed) "!" } } };
    let Some((quantiles, worst)) = spot.quantiles().zip(spot.worst()) else { return html! { td { (failed) } } };
    let filters = [("study", STUDY), ("method", answer.method)];
    html! {
        td.(step(quantiles[FIRST])) data-errors=(quantiles.map(|error| format!("{error:e}")).join(" ")) {
            (opener(&robot_chunk(worst), &filters, &told(quantiles[FIRST]))) (failed)
        }
    }
}

/// An error in two digits, as the script has it too.
fn told(error: f64) -> String {
    if error == 0.0 { "0".into() } else { format!("{error:.1e}") }
}

/// The name of an axis on the page.
fn title(axis: &str) -> &str {
    match axis {
        "n" => "bodies",
        "tip_scale" => "mass of the tip, ×",
        "base_offset" => "base offset, m",
        "speed" => "speed, ×",
        "spread" => "branching",
        other => other,
    }
}

/// Colour steps by digits lost, as the script has them too.
fn step(error: f64) -> String {
    let lost = (error / f64::EPSILON).log10();
    format!("d{}", [1.0, 2.0, 4.0, 6.0, 9.0].iter().filter(|digits| lost >= **digits).count())
}
