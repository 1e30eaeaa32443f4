//! Section: what must not change an answer, and does.

use std::collections::BTreeMap;

use featherbench_bench::measure::worst;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use maud::{Markup, html};

use super::changes::CHANGES;

/// The study's name in rows.
const STUDY: &str = "invariance";

/// The worst row of an engine's quantity by each change.
type Worst<'a> = [Option<&'a Row>; CHANGES.len()];

/// Makes the section, if the run has the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let mut told: BTreeMap<(usize, &str), Worst> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY && row.value.is_some()) {
        let params: serde_json::Value = serde_json::from_str(&row.params).unwrap_or_default();
        let change = CHANGES.iter().position(|change| params["change"] == *change);
        let engine = overview.engines.iter().position(|engine| *engine == row.engine);
        let (Some(change), Some(engine)) = (change, engine) else { continue };
        let place = &mut told.entry((engine, &row.quantity)).or_default()[change];
        let size = |row: &Row| row.value.unwrap_or(0.0);
        if place.is_none_or(|other| worst(size(other), size(row)) > size(other) || size(row).is_nan()) {
            *place = Some(row);
        }
    }
    if told.is_empty() { Vec::new() } else { vec![Section::new("invariance", "Invariance", body(overview, &told))] }
}

fn body(overview: &Overview, told: &BTreeMap<(usize, &str), Worst>) -> Markup {
    html! {
        section #invariance {
            h2 { "What must not change an answer, and does?" }
            p.lead { "The largest change of an answer over all robots, in units of 2⁻⁵², when the robot is described otherwise, with the robot where it is largest. All columns but the last round nothing: 0 is the same bits." }
            div.scroll {
                table.compact {
                    thead { tr {
                        th scope="col" { "engine" } th scope="col" { "compute" }
                        @for change in CHANGES { th.number scope="col" { (change) } }
                    } }
                    tbody { @for ((engine, quantity), worst) in told {
                        tr {
                            th scope="row" { (overview.engines[*engine]) }
                            td { (featherbench_report::labels::quantity(quantity)) }
                            @for row in worst { (cell(*row)) }
                        }
                    } }
                }
            }
        }
    }
}

fn cell(row: Option<&Row>) -> Markup {
    html! {
        td.number {
            @match row.and_then(|row| Some((row, row.value?))) {
                Some((row, value)) => { (short(value / f64::EPSILON)) @if value > 0.0 { " " small { (row.robot) } } },
                None => "–",
            }
        }
    }
}
