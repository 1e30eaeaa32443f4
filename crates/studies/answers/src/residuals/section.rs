//! Section: residuals with known answers, corrected engines, and learned models.

mod drawings;

use super::STUDY;
use super::learning::DRIFTS;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo, Verdict};
use featherbench_study::known::{passed, table};
use featherbench_study::rows_of;
use maud::{Markup, html};
use std::collections::BTreeSet;

/// What the rows of a quantity are about, in the order of the table.
const QUANTITIES: [(&str, &str); 9] = [
    ("sign", "true = nominal + r on an arm"),
    ("payload", "a payload against the loaded model"),
    ("well_posed", "where the acceleration is determined"),
    ("drive", "drives with an inner state"),
    ("dry_friction", "dry friction at rest"),
    ("power", "the balance of power"),
    ("passive", "projections onto passive residuals"),
    ("learning", "learned models"),
    ("learning_draws", "learned models, further draws"),
];

/// A model: its name, and (time in s, change) of each time that it reached.
type Line<'a> = (&'a str, Vec<(f64, f64)>);

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    vec![Section::new(STUDY, "Residuals", body(&rows, &chunk))]
}

/// The different words of a column, in the order of the rows.
fn words<'a>(rows: &[&'a Row], of: impl Fn(&'a Row) -> &'a str) -> Vec<&'a str> {
    let mut words = Vec::new();
    for word in rows.iter().map(|row| of(row)) {
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words
}

/// Of each noise and model, times and the change of the true energy.
fn drift<'a>(rows: &[&'a Row]) -> Vec<(&'a str, Vec<Line<'a>>)> {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.quantity == "learning").copied().collect();
    let line = |case: &'a str, model: &'a str| {
        let own = rows.iter().filter(move |row| row.family == case && row.method == model);
        let point = |row: &&Row| {
            let place = DRIFTS.iter().position(|metric| *metric == row.metric)?;
            let seconds = DRIFTS[place].strip_prefix("drift_")?.strip_suffix('s')?.parse::<f64>().ok()?;
            Some((seconds, row.value?))
        };
        (model, own.filter_map(point).collect())
    };
    let models = words(&rows, |row| &row.method);
    words(&rows, |row| &row.family).into_iter().map(|case| (case, models.iter().map(|model| line(case, model)).collect())).collect()
}

/// The value of a metric of a learned model.
fn learned(rows: &[&Row], case: &str, model: &str, metric: &str) -> Option<f64> {
    rows.iter().find(|row| row.quantity == "learning" && row.family == case && row.method == model && row.metric == metric)?.value
}

/// The change of the true energy at the last time that a model reached.
fn last_drift(rows: &[&Row], case: &str, model: &str) -> Option<f64> {
    DRIFTS.iter().rev().find_map(|metric| learned(rows, case, model, metric))
}

/// A line per noise and model: held-out torque, energies, and how long it stayed.
fn models(rows: &[&Row]) -> Markup {
    let own: Vec<&Row> = rows.iter().filter(|row| row.quantity == "learning").copied().collect();
    let cell = |value: Option<f64>| html! { td.number { @if let Some(value) = value { (short(value)) } @else { "–" } } };
    html! {
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "learned from" } th scope="col" { "model" } th.number scope="col" { "unseen torque, error" }
                        th.number scope="col" { "own energy, change" } th.number scope="col" { "true energy, last change" } th.number scope="col" { "seconds" }
                    }
                }
                tbody {
                    @for case in words(&own, |row| &row.family) {
                        @for model in words(&own, |row| &row.method) {
                            tr {
                                td { (case) } th scope="row" { (model) }
                                (cell(learned(&own, case, model, "torque_error").or_else(|| learned(&own, case, model, "truth_torque_error"))))
                                (cell(learned(&own, case, model, "own_energy_drift")))
                                (cell(last_drift(&own, case, model)))
                                (cell(learned(&own, case, model, "seconds")))
                            }
                        }
                    }
                }
            }
        }
    }
}

/// What the corrected engines show, in a sentence.
fn corrected(rows: &[&Row]) -> Option<String> {
    let judged: Vec<&&Row> =
        rows.iter().filter(|row| ["changed_bits", "corrected_scaled", "corrected_backward"].contains(&row.metric.as_str())).collect();
    let names: BTreeSet<&str> = judged.iter().map(|row| row.engine.as_str()).collect();
    let right = judged.iter().filter(|row| row.verdict == Verdict::Pass).count();
    let zero = judged.iter().filter(|row| row.metric == "changed_bits");
    let same = zero.clone().filter(|row| row.value == Some(0.0)).count();
    (!judged.is_empty()).then(|| {
        let who = names.into_iter().collect::<Vec<_>>().join(", ");
        format!(
            "Corrected engines ({who}): {right} of {} answers as they must be; no residual leaves the bits in {same} of {}.",
            judged.len(),
            zero.count()
        )
    })
}

fn body(rows: &[&Row], chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let noisy = rows.iter().rev().find(|row| row.quantity == "learning").map(|row| row.family.as_str()).unwrap_or_default();
    let drifts = ["lagrangian net", "port-hamiltonian", "black box"]
        .map(|model| (model, last_drift(rows, noisy, model), learned(rows, noisy, model, "seconds")));
    html! {
        section #residuals {
            h2 { "Residuals" }
            p.lead { b { (passed) " of " (judged) " known numbers are reproduced." } }
            ul {
                @if drifts.iter().all(|(_, drift, _)| drift.is_some()) {
                    li {
                        "Change of the true energy without forces (" (noisy) "): "
                        @for (place, (model, drift, seconds)) in drifts.iter().enumerate() {
                            @if place > 0 { ", " }
                            (model) " " (short(drift.unwrap_or(f64::NAN)))
                            @if let Some(seconds) = seconds { @if *seconds < 1000.0 { " (it leaves the robot's range after " (short(*seconds)) " s)" } }
                        }
                        "."
                    }
                }
                @if let Some(sentence) = corrected(rows) { li { (sentence) } }
                li { "One sign holds: true = nominal + r, τ = ID(q, v, a) + r(q, v, a)." }
            }
            div.pair {
                @for (place, (case, lines)) in drift(rows).iter().enumerate() { (drawings::drift(place, case, lines)) }
            }
            (models(rows))
            (table(STUDY, rows, &QUANTITIES, chunk))
        }
    }
}
