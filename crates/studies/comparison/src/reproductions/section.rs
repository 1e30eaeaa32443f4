//! Section: known deviations of the engines, each reproduced by a program of its own.

use std::collections::BTreeMap;

use super::Params;
use featherbench_bench::params;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, UNPASSED, labels, opener};
use featherbench_results::{Row, RunInfo, Verdict};
use maud::{Markup, html};

/// The study's name in rows.
const STUDY: &str = "reproductions";

/// Both rows of one reproduction, or the one that says why there is no value.
struct Known<'a> {
    smallest: Option<&'a Row>,
    largest: Option<&'a Row>,
    gravest: &'a Row,
    params: Params,
}

/// Makes the section, if the run has reproductions.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], _: &Overview<'a>) -> Vec<Section> {
    let known = known(rows);
    if known.is_empty() {
        return Vec::new();
    }
    vec![Section { appendix: true, ..Section::new("known", "Known deviations", body(&known)) }]
}

fn body(known: &[Known]) -> Markup {
    html! {
        section #known {
            h2 { "Known deviations, reproduced" }
            p.lead {
                "Each by a program of a few lines in the engine's own interface, oracles/featherbench_oracles/ENGINE/reproductions, over seeded draws. A deviation that has gone, or left its "
                "range, fails the gate."
            }
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "engine" } th scope="col" { "when" } th scope="col" { "measure" } th.number scope="col" { "known range" }
                            th.number scope="col" { "here" } th scope="col" { "still there" } th scope="col" { "public thread" } th scope="col" { "program" }
                        }
                    }
                    tbody { @for known in known { (row(known)) } }
                }
            }
        }
    }
}

fn known(rows: &[Row]) -> Vec<Known<'_>> {
    let mut found: BTreeMap<(&str, &str), Known> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY) {
        let params = || params::of_row(row).unwrap_or_default();
        let known = found.entry((&row.engine, &row.method)).or_insert_with(|| Known {
            smallest: None,
            largest: None,
            gravest: row,
            params: params(),
        });
        match row.metric.as_str() {
            "smallest" => known.smallest = Some(row),
            "largest" => known.largest = Some(row),
            _ => {}
        }
        if row.verdict != Verdict::Pass {
            known.gravest = row;
        }
    }
    found.into_values().collect()
}

fn row(known: &Known) -> Markup {
    let row = known.gravest;
    let Params { condition, measure, range: [low, high], upstream, .. } = &known.params;
    let value = |row: Option<&Row>| row.and_then(|row| row.value);
    html! {
        tr {
            th scope="row" { (row.engine) " " (row.engine_version) }
            td { (condition) }
            td { (measure) }
            td.number { (range(Some(*low), Some(*high))) }
            td.number { (range(value(known.smallest), value(known.largest))) }
            td {
                span class={ "badge " (row.verdict) } { (labels::glyph(row.verdict)) " " (status(row)) }
                @if row.verdict != Verdict::Pass { " " (opener(UNPASSED, &[("study", STUDY), ("method", &row.method)], "why")) }
            }
            td { @if upstream.starts_with("https://") { a href=(upstream) { (thread(upstream)) } } @else { (upstream) } }
            td { code { (row.method) } }
        }
    }
}

fn status(row: &Row) -> &'static str {
    match (row.verdict, row.metric.as_str()) {
        (Verdict::Pass, _) => "yes",
        (Verdict::Fail, "smallest") => "smaller, or gone",
        (Verdict::Fail, _) => "larger",
        _ => "not answered",
    }
}

/// A thread's address in short: project and number.
fn thread(address: &str) -> String {
    let parts: Vec<&str> = address.rsplit('/').collect();
    match parts[..] {
        [number, _, project, ..] => format!("{project} #{number}"),
        _ => address.to_owned(),
    }
}

fn range(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) if high - low <= 1e-9 * high => short(low),
        (Some(low), Some(high)) => format!("{} … {}", short(low), short(high)),
        _ => String::new(),
    }
}
