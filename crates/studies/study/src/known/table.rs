//! The table of a section of known answers.

use featherbench_report::numbers::short;
use featherbench_report::{labels, opener};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};
use std::collections::BTreeSet;

/// Passed and judged rows of a quantity, and the one nearest to its bound or beyond it.
struct Line<'a> {
    quantity: &'a str,
    about: &'a str,
    methods: usize,
    passed: usize,
    judged: usize,
    nearest: Option<&'a Row>,
}

fn lines<'a>(rows: &[&'a Row], quantities: &[(&'a str, &'a str)]) -> Vec<Line<'a>> {
    let of = |&(quantity, about): &(&'a str, &'a str)| {
        let own: Vec<&'a Row> = rows.iter().filter(|row| row.quantity == quantity).copied().collect();
        let judged: Vec<&'a Row> = own.iter().filter(|row| matches!(row.verdict, Verdict::Pass | Verdict::Fail)).copied().collect();
        let margin = |row: &Row| row.margin.unwrap_or(f64::INFINITY);
        Line {
            quantity,
            about,
            methods: own.iter().map(|row| row.method.as_str()).collect::<BTreeSet<_>>().len(),
            passed: judged.iter().filter(|row| row.verdict == Verdict::Pass).count(),
            judged: judged.len(),
            nearest: judged.into_iter().min_by(|a, b| margin(a).total_cmp(&margin(b))),
        }
    };
    quantities.iter().map(of).filter(|line| line.methods > 0).collect()
}

/// How many rows passed, of how many that are judged.
pub fn passed(rows: &[&Row]) -> (usize, usize) {
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    (count(Verdict::Pass), count(Verdict::Pass) + count(Verdict::Fail))
}

/// What was asked, a line for each quantity with its words: how many numbers are as known, and which is nearest to its bound.
pub fn table(study: &str, rows: &[&Row], quantities: &[(&str, &str)], chunk: &str) -> Markup {
    html! {
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "question" } th.number scope="col" { "methods" } th.number scope="col" { "passed" } th.number scope="col" { "judged" }
                        th scope="col" { "nearest to its bound" } th.number scope="col" { "value" } th.number scope="col" { "bound" }
                    }
                }
                tbody { @for line in &lines(rows, quantities) { (row(study, line, chunk)) } }
            }
        }
    }
}

fn row(study: &str, line: &Line, chunk: &str) -> Markup {
    let verdict = if line.passed == line.judged { Verdict::Pass } else { Verdict::Fail };
    html! {
        tr {
            th scope="row" { (opener(chunk, &[("study", study), ("quantity", line.quantity)], line.about)) }
            td.number { (line.methods) }
            td.number { @if line.judged > 0 { span class={ "badge " (verdict) } { (labels::glyph(verdict)) } " " (line.passed) } }
            td.number { (line.judged) }
            @if let Some(nearest) = line.nearest {
                td { (nearest.family) ", " (nearest.method) ", " (nearest.metric) }
                td.number { @if let Some(value) = nearest.value { (short(value)) } }
                td.number { @if let Some(bound) = nearest.bound { (short(bound)) } }
            } @else { td {} td {} td {} }
        }
    }
}

/// The value of a metric of a case by a method.
pub fn value(rows: &[&Row], quantity: &str, family: &str, method: &str, metric: &str) -> Option<f64> {
    let is_it = |row: &&&Row| row.quantity == quantity && row.family == family && row.method == method && row.metric == metric;
    rows.iter().find(is_it)?.value
}

/// The value of another metric of a row's cell.
pub fn beside(rows: &[&Row], row: &Row, metric: &str) -> Option<f64> {
    rows.iter().find(|other| other.cell == row.cell && other.metric == metric)?.value
}
