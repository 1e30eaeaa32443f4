//! Section: every row that did not pass, grouped by its reason.

use std::collections::BTreeMap;

use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

use crate::blocks::{self, opener};
use crate::chunks::{UNPASSED, is_unpassed};
use crate::labels;
use crate::numbers::{count, decades};
use crate::overview::Overview;
use crate::section::Section;
use crate::tally::{gravity, worst_first};

/// Number of groups that the page itself lists; the button that opens all rows shows the others.
const LISTED: usize = 600;
/// Number of robots, and of quantities, that a group names.
const NAMED: usize = 6;

/// Rows that did not pass for one reason.
struct Group<'a> {
    rows: usize,
    quantities: Vec<String>,
    robots: Vec<String>,
    worst: &'a Row,
}

/// Writes the section.
pub fn section(overview: &Overview, rows: &[Row]) -> Section {
    Section::new("unpassed", "Not passed", body(overview, rows))
}

fn body(overview: &Overview, rows: &[Row]) -> Markup {
    let groups = groups(rows);
    let total: usize = groups.iter().map(|group| group.rows).sum();
    html! {
        section #unpassed {
            h2 { "Everything that did not pass" }
            @if groups.is_empty() {
                p.empty { "Every judged row passed, and everything was offered." }
            } @else {
                p.lead {
                    (count(total, "row")) " for " (count(groups.len(), "reason")) ": "
                    (opener(UNPASSED, &[], "open them all")) "."
                    @if groups.len() > LISTED { " The first " (LISTED) " reasons are listed here." }
                }
                div.scroll.tall {
                    table.compact.sortable {
                        thead {
                            tr {
                                th scope="col" { "verdict" } th.number scope="col" { "rows" } th scope="col" { "engine" } th scope="col" { "quantity" }
                                th scope="col" { "robots" } th.number scope="col" { "worst margin" } th scope="col" { "reason" }
                            }
                        }
                        tbody { @for group in groups.iter().take(LISTED) { (row(overview, group)) } }
                    }
                }
            }
        }
    }
}

fn row(overview: &Overview, group: &Group) -> Markup {
    let worst = group.worst;
    let mut filters = vec![("verdict", worst.verdict.as_str()), ("study", &worst.study), ("engine", &worst.engine)];
    // As for the groups: rows with a number by their quantity and measure, others by their reason.
    match worst.value {
        Some(_) => filters.extend([("quantity", worst.quantity.as_str()), ("metric", &worst.metric)]),
        None => filters.push(("reason", &worst.reason)),
    }
    html! {
        tr {
            td { span class={ "badge " (worst.verdict) } { (labels::glyph(worst.verdict)) " " (worst.verdict) } }
            td.number { (opener(UNPASSED, &filters, &group.rows.to_string())) }
            td { (blocks::engine(overview, &worst.engine)) }
            td { (some(&group.quantities)) }
            td { (some(&group.robots)) }
            td.number { @if let Some(margin) = worst.margin { (decades(margin)) } }
            td.reason { (worst.reason) }
        }
    }
}

/// The first names of a list, and their number if not all are shown.
fn some(names: &[String]) -> Markup {
    html! {
        (names.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", "))
        @if names.len() > NAMED { ", … " small { "(" (names.len()) ")" } }
    }
}

/// Failures of one engine, quantity and metric are one group: only the numbers in their reasons differ, and the worst is shown.
/// Deviations are grouped by the cause before the parenthesis, rows without a value by their reason.
fn groups(rows: &[Row]) -> Vec<Group<'_>> {
    let mut groups: BTreeMap<_, Group> = BTreeMap::new();
    for row in rows.iter().filter(|row| is_unpassed(row)) {
        let reason = match row.verdict {
            Verdict::Fail if row.value.is_some() => "",
            Verdict::Deviation => row.reason.split_once(" (").map_or(row.reason.as_str(), |(cause, _)| cause),
            _ => row.reason.as_str(),
        };
        let measured = row.value.map(|_| (labels::quantity_rank(&row.quantity), &row.metric));
        let group = groups.entry((gravity(row.verdict), &row.study, &row.engine, measured, reason)).or_insert_with(|| Group {
            rows: 0,
            quantities: Vec::new(),
            robots: Vec::new(),
            worst: row,
        });
        group.rows += 1;
        let quantity = labels::error(&row.quantity, &row.metric);
        if !group.quantities.contains(&quantity) {
            group.quantities.push(quantity);
        }
        if !row.robot.is_empty() && !group.robots.contains(&row.robot) {
            group.robots.push(row.robot.clone());
        }
        if worst_first(row) < worst_first(group.worst) {
            group.worst = row;
        }
    }
    groups.into_values().collect()
}
