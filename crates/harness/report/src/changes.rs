//! What changed between two runs: findings that appeared or vanished, versions, and rows beyond noise. As a part of the page over several runs,
//! and as a page of its own.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Apart, Change, Diff, Row, RunInfo, diff};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::findings::{Findings, Found};
use crate::labels;
use crate::numbers::{capitalised, count, grouped, short};
use crate::sheet::sheet;

/// The style of such a page, beside the sheet of every page.
const STYLE: &str =
    ".scroll + .lead { margin-top: 1rem; } .drawn svg { display: block; max-width: 100%; height: auto; border-radius: 8px; }";
/// Changes of rows that a comparison lists, from the largest factor.
const LISTED: usize = 12;

/// A run as a side of a comparison.
#[derive(Clone, Copy)]
pub(crate) struct Side<'a> {
    pub(crate) info: &'a RunInfo,
    pub(crate) rows: &'a [Row],
    pub(crate) findings: &'a Findings<'a>,
}

/// A finding, known again in another run: engine, quantities, and its cause if that is known.
type Key = (String, Vec<String>, String);

/// The findings of a run by key.
fn by_key<'a, 'b>(findings: &'b Findings<'a>) -> BTreeMap<Key, &'b Found<'a>> {
    let key = |found: &Found| {
        let cause = if found.new { String::new() } else { found.cause.clone() };
        (found.culprit.engine.clone(), found.quantities.clone(), cause)
    };
    findings.found.iter().map(|found| (key(found), found)).collect()
}

/// A page of one file, with the report's style.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "featherbench: " (title) }
                // Inside, as the page is one file.
                style { (PreEscaped(sheet())) (PreEscaped(STYLE)) }
            }
            body { main { (body) } }
        }
    };
    page.into_string()
}

/// The page of `featherbench diff`: one file that opens without a network.
pub fn between(before: (&RunInfo, &[Row]), after: (&RunInfo, &[Row])) -> String {
    let findings = [before, after].map(|(info, rows)| Findings::of(info, rows));
    let [old, new] = [(before, &findings[0]), (after, &findings[1])].map(|((info, rows), findings)| Side { info, rows, findings });
    let revision = |info: &RunInfo| info.git.revision.chars().take(10).collect::<String>();
    let headline = |side: &Side| side.findings.headline();
    let body = html! {
        section #changes {
            h1 { (headings(old, new)) }
            div.scroll { table.compact {
                thead { tr { td {} th scope="col" { "before" } th scope="col" { "after" } } }
                tbody {
                    @for (name, [old, new]) in facts(old.info, new.info) { tr { th scope="row" { (name) } td { (old) } td { (new) } } }
                    tr { th scope="row" { "revision" } td { code { (revision(old.info)) } } td { code { (revision(new.info)) } } }
                    tr { th scope="row" { "gravest finding" } td { (headline(&old)) } td { (headline(&new)) } }
                }
            } }
            h2 { "Findings and rows" }
            (comparison(old, new))
        }
    };
    page("what changed", &body)
}

/// What the runs are: the name of a fact, and the fact of both.
fn facts(old: &RunInfo, new: &RunInfo) -> [(&'static str, [String; 2]); 4] {
    let both = |of: fn(&RunInfo) -> String| [of(old), of(new)];
    [
        ("run", both(|info| info.run.clone())),
        ("suite", both(|info| info.suite.clone())),
        ("started", both(|info| info.started.clone())),
        ("machine", both(|info| format!("{}, {} cores", info.host.cpu, info.host.cores))),
    ]
}

/// The first line of the page.
fn headings(old: Side, new: Side) -> String {
    let mut changed = diff(old.rows, new.rows);
    let apart = Apart::of(old.info, new.info, &mut changed);
    match (changed.changes.len(), apart) {
        (0, None) => format!("Nothing changed beyond noise, of {}", count(changed.compared, "row")),
        (0, Some(_)) => format!("Two suites; nothing changed beyond noise in the {} that both have", count(changed.compared, "row")),
        (number, None) => format!("{} changed beyond noise", count(number, "row")),
        (number, Some(_)) => format!("Two suites; {} that both have changed beyond noise", count(number, "row")),
    }
}

/// What changed, in the order of its weight.
pub(crate) fn comparison(before: Side, after: Side) -> Markup {
    let (old, new) = (by_key(before.findings), by_key(after.findings));
    let appeared: Vec<&Found> = new.iter().filter(|(key, _)| !old.contains_key(*key)).map(|(_, found)| *found).collect();
    let vanished: Vec<&Found> = old.iter().filter(|(key, _)| !new.contains_key(*key)).map(|(_, found)| *found).collect();
    let mut changed = diff(before.rows, after.rows);
    let apart = Apart::of(before.info, after.info, &mut changed);
    html! {
        p.lead { "Against the run of " (before.info.started) ": " (summary(&appeared, &vanished, &changed)) "." }
        @if let Some(apart) = apart { p.warning { (capitalised(&apart.sentence())) "." } }
        @if before.info.host.cpu != after.info.host.cpu { p.warning { "The runs are of two machines: their times compare the machines." } }
        @for words in versions(before.info, after.info) { p { (words) } }
        (list("Findings that appeared", "fail", &appeared))
        (list("Findings that vanished", "pass", &vanished))
        (rows(&changed))
    }
}

/// Counts of everything that changed.
fn summary(appeared: &[&Found], vanished: &[&Found], changed: &Diff) -> String {
    let kinds = Change::ALL.iter().filter_map(|&kind| {
        let number = changed.changes.iter().filter(|changed| changed.change == kind).count();
        (number > 0).then(|| format!("{} {}", grouped(number), kind.as_str()))
    });
    let mut parts = vec![format!("{} appeared, {} vanished", count(appeared.len(), "finding"), grouped(vanished.len()))];
    parts.extend(kinds);
    format!("{}, of {} compared", parts.join(", "), count(changed.compared, "row"))
}

/// Engines that came, left, or have another version.
pub(crate) fn versions(before: &RunInfo, after: &RunInfo) -> Vec<String> {
    let of = |run: &RunInfo| -> BTreeMap<String, String> {
        run.engines.iter().map(|engine| (engine.name.clone(), engine.version.clone())).collect()
    };
    let (old, new) = (of(before), of(after));
    let names: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
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
                        @for &kind in Change::ALL {
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
