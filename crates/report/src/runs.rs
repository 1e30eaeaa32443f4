//! A page over several runs: what each found, and what changed from one to the next.
//!
//! Runs of one suite are compared in the order in which they started: findings that are new or gone, engines with another version, and rows
//! that changed beyond noise by the rules of [`featherbench_results::diff`]. Runs of different suites are not compared.

use std::collections::BTreeMap;

use featherbench_results::{Change, Diff, Row, RunInfo, Severity, diff};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::findings::{Findings, Found, Status};
use crate::labels;
use crate::numbers::{count, grouped, short};

/// The report's style sheet: the page has it inside, as it is one file.
const STYLE: &str = include_str!("../assets/style.css");
/// Changes of rows that a comparison lists, from the largest factor.
const LISTED: usize = 12;

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

/// A finding, known again in another run: engine, quantities, and its cause if that is known.
type Key = (String, Vec<String>, String);

fn key(found: &Found) -> Key {
    let cause = if found.new { String::new() } else { found.cause.clone() };
    (found.culprit.engine.clone(), found.quantities.clone(), cause)
}

/// The findings of a run by key.
fn by_key<'a, 'b>(findings: &'b Findings<'a>) -> BTreeMap<Key, &'b Found<'a>> {
    findings.found.iter().map(|found| (key(found), found)).collect()
}

/// The page as text. The runs are sorted by their start.
pub fn render(mut runs: Vec<Past>) -> String {
    runs.sort_by(|a, b| (&a.info.started, &a.folder).cmp(&(&b.info.started, &b.folder)));
    let findings: Vec<Findings> = runs.iter().map(|past| Findings::of(&past.info, &past.rows)).collect();
    // Each run with the last one before it of the same suite.
    let pairs: Vec<(usize, Option<usize>)> =
        (0..runs.len()).map(|index| (index, (0..index).rev().find(|&before| runs[before].info.suite == runs[index].info.suite))).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "featherbench: " (count(runs.len(), "run")) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    section #runs {
                        h1 { (count(runs.len(), "run")) @if let Some(last) = findings.last() { ", the last: " (last.headline()) } }
                        (table(&runs, &findings))
                    }
                    @for &(index, before) in pairs.iter().rev() { (comparison(&runs, &findings, index, before)) }
                }
            }
        }
    };
    page.into_string()
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

/// What changed in a run.
fn comparison(runs: &[Past], findings: &[Findings], index: usize, before: Option<usize>) -> Markup {
    let past = &runs[index];
    let title = html! { h2 { (past.info.started) ", suite " (past.info.suite) } };
    let Some(before) = before else {
        return html! { section { (title) p.note { "The first run of this suite here: nothing to compare with." } } };
    };
    let (old, new) = (by_key(&findings[before]), by_key(&findings[index]));
    let appeared: Vec<&Found> = new.iter().filter(|(key, _)| !old.contains_key(*key)).map(|(_, found)| *found).collect();
    let vanished: Vec<&Found> = old.iter().filter(|(key, _)| !new.contains_key(*key)).map(|(_, found)| *found).collect();
    let changed = diff(&runs[before].rows, &past.rows);
    html! {
        section {
            (title)
            p.lead { "Against the run of " (runs[before].info.started) ": " (summary(&appeared, &vanished, &changed)) "." }
            @if runs[before].info.suite_hash != past.info.suite_hash { p.warning { "The suite's file changed between the two runs." } }
            @if runs[before].info.host.cpu != past.info.host.cpu { p.warning { "The runs are of two machines: their times compare the machines." } }
            @for words in versions(&runs[before].info, &past.info) { p { (words) } }
            (list("Findings that appeared", "fail", &appeared))
            (list("Findings that vanished", "pass", &vanished))
            (rows(&changed))
        }
    }
}

/// Counts of everything that changed.
fn summary(appeared: &[&Found], vanished: &[&Found], changed: &Diff) -> String {
    let kinds = Change::ALL.into_iter().filter_map(|kind| {
        let number = changed.changes.iter().filter(|changed| changed.change == kind).count();
        (number > 0).then(|| format!("{} {}", grouped(number), kind.as_str()))
    });
    let mut parts = vec![format!("{} appeared, {} vanished", count(appeared.len(), "finding"), grouped(vanished.len()))];
    parts.extend(kinds);
    format!("{}, of {} compared", parts.join(", "), count(changed.compared, "row"))
}

/// Engines that came, left, or have another version.
fn versions(before: &RunInfo, after: &RunInfo) -> Vec<String> {
    let of = |run: &RunInfo| -> BTreeMap<String, String> {
        run.engines.iter().map(|engine| (engine.name.clone(), engine.version.clone())).collect()
    };
    let (old, new) = (of(before), of(after));
    let names: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let words = |name: &&String| match (old.get(*name), new.get(*name)) {
        (Some(a), Some(b)) if a != b => Some(format!("{name}: version {a} became {b}.")),
        (None, Some(b)) => Some(format!("{name} {b} takes part now.")),
        (Some(a), None) => Some(format!("{name} {a} takes no part any more.")),
        _ => None,
    };
    names.iter().filter_map(words).collect()
}

fn list(title: &str, class: &str, found: &[&Found]) -> Markup {
    html! {
        @if !found.is_empty() {
            h3 { (title) }
            ul.findings { @for found in found { li class=(class) { span.level { (found.level()) } " " (found.sentence()) } } }
        }
    }
}

/// The rows that changed beyond noise, from the largest factor of each kind.
fn rows(changed: &Diff) -> Markup {
    let value = |row: Option<&Row>| row.and_then(|row| row.value).map_or_else(|| "–".to_owned(), short);
    html! {
        @if !changed.changes.is_empty() {
            details {
                summary { (count(changed.changes.len(), "row")) " changed beyond noise" }
                div.scroll { table.compact {
                    thead { tr {
                        th scope="col" { "change" } th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "quantity" }
                        th.number scope="col" { "before" } th.number scope="col" { "after" } th.number scope="col" { "factor" }
                    } }
                    tbody {
                        @for kind in Change::ALL {
                            @for changed in changed.changes.iter().filter(|changed| changed.change == kind).take(LISTED) {
                                @if let Some(row) = changed.after.or(changed.before) {
                                    tr {
                                        td { (kind.as_str()) } td { (row.robot) } td { (row.engine) " " (row.method) }
                                        td { (labels::error(&row.quantity, &row.metric)) }
                                        td.number { (value(changed.before)) } td.number { (value(changed.after)) }
                                        td.number { @if let Some(factor) = changed.factor().filter(|factor| factor.is_finite()) { (short(factor)) } }
                                    }
                                }
                            }
                        }
                    }
                } }
                p.note { "At most " (LISTED) " of each kind; " code { "featherbench diff" } " lists more." }
            }
        }
    }
}
