//! A page over several runs: what each found, and what changed from one to the next.
//!
//! Runs of one suite are compared in the order in which they started. The page shows:
//!
//! - trends with their change points,
//! - findings that are new or gone,
//! - engines with another version,
//! - rows that changed beyond noise by the rules of [`featherbench_results::diff`].
//!
//! Runs of different suites are not compared.

use featherbench_results::{Row, RunInfo, Severity};
use maud::{Markup, html};

use crate::changes::{self, Side};
use crate::findings::{Findings, Status};
use crate::numbers::{count, grouped};
use crate::trends;

/// A run with its rows.
#[derive(Clone, Debug)]
pub struct Past {
    /// The run's folder, as the page links to it.
    pub folder: String,
    /// The run.
    pub info: RunInfo,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// The page as text. The runs are sorted by their start.
pub fn render(mut runs: Vec<Past>) -> String {
    runs.sort_by(|a, b| (&a.info.started, &a.folder).cmp(&(&b.info.started, &b.folder)));
    let findings: Vec<Findings> = runs.iter().map(|past| Findings::of(&past.info, &past.rows)).collect();
    // Each run with the last one before it of the same suite.
    let pairs: Vec<(usize, Option<usize>)> =
        (0..runs.len()).map(|index| (index, (0..index).rev().find(|&before| runs[before].info.suite == runs[index].info.suite))).collect();
    let mut suites: Vec<&str> = Vec::new();
    for past in runs.iter().rev().filter(|past| !past.info.suite.is_empty() || runs.len() > 1) {
        if !suites.contains(&past.info.suite.as_str()) {
            suites.push(&past.info.suite);
        }
    }
    let body = html! {
        section #runs {
            h1 { (count(runs.len(), "run")) @if let Some(last) = findings.last() { ", the last: " (last.meaning()) } }
            (table(&runs, &findings))
        }
        @for suite in suites {
            @let of_suite: Vec<(&Past, &Findings)> = runs.iter().zip(&findings).filter(|(past, _)| past.info.suite == suite).collect();
            (trends::section(suite, &of_suite.iter().map(|(past, findings)| side(past, findings)).collect::<Vec<_>>()))
        }
        @for &(index, before) in pairs.iter().rev() {
            section {
                h2 { (runs[index].info.started) ", suite " (runs[index].info.suite) }
                @match before {
                    Some(before) => (changes::comparison(side(&runs[before], &findings[before]), side(&runs[index], &findings[index]))),
                    None => p.note { "The first run of this suite here: nothing to compare with." },
                }
            }
        }
    };
    changes::page(&count(runs.len(), "run"), &body)
}

fn side<'a>(past: &'a Past, findings: &'a Findings<'a>) -> Side<'a> {
    Side { info: &past.info, rows: &past.rows, findings }
}

/// A line for each run, the last first.
fn table(runs: &[Past], findings: &[Findings]) -> Markup {
    html! {
        div.scroll { table.compact {
            thead { tr {
                th scope="col" { "started" } th scope="col" { "suite" } th scope="col" { "revision" } th scope="col" { "gate" }
                @for level in Severity::ALL { th.number scope="col" title=(level.meaning()) { (level) } }
                th.number scope="col" { "new" } th.number scope="col" { "rows" } th scope="col" { "engines" }
            } }
            tbody {
                @for (past, found) in runs.iter().zip(findings).rev() {
                    tr {
                        th scope="row" { a href={ (past.folder) "/index.html" } { (past.info.started) } }
                        td { (past.info.suite) }
                        td { code { (past.info.git.revision.chars().take(10).collect::<String>()) } }
                        td { (match found.status { Status::Passed => "✓ passed", Status::Failed => "✕ failed", Status::Empty => "· empty" }) }
                        @for &level in Severity::ALL {
                            td.number { (grouped(found.found.iter().filter(|found| found.severity == Some(level)).count())) }
                        }
                        td.number { (grouped(found.red().count())) }
                        td.number { (grouped(found.tally.total())) }
                        td { (past.info.engines.iter().map(|engine| format!("{} {}", engine.name, engine.version)).collect::<Vec<_>>().join(", ")) }
                    }
                }
            }
        } }
    }
}
