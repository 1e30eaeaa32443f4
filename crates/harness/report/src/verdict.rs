//! Section: what the run found, from the gravest, and whether it passed.

use featherbench_results::{Row, RunInfo, Severity, Verdict};
use maud::{Markup, html};

use crate::blocks::{self, opener};
use crate::cards::{card, class};
use crate::chunks::UNPASSED;
use crate::drawings::Drawings;
use crate::findings::{Findings, Status};
use crate::labels;
use crate::numbers::{capitalised, count, decades, grouped};
use crate::overview::Overview;
use crate::section::{Part, Section};
use crate::tally::{BY_GRAVITY, Tally, worst_first};

/// Number of findings in the head of the page; a click opens the others.
const TOLD: usize = 6;

/// Writes the section, with what the sections of studies add to it.
pub fn section(run: &RunInfo, drawings: &Drawings, rows: &[Row], sections: &[Section]) -> Section {
    let findings = Findings::of(run, rows);
    let (rest, conditions) = (rest(drawings, &findings), conditions(run));
    let body = body(run, drawings, rows, sections, &findings, [rest.as_ref(), conditions.as_ref()]);
    Section { parts: rest.into_iter().chain(conditions).collect(), ..Section::new("verdict", "Verdict", body) }
}

fn body(
    run: &RunInfo,
    drawings: &Drawings,
    rows: &[Row],
    sections: &[Section],
    findings: &Findings,
    [rest, conditions]: [Option<&Part>; 2],
) -> Markup {
    let overview = drawings.overview;
    let mut added: Vec<_> = sections.iter().filter_map(|section| section.finding.as_ref()).collect();
    added.sort_by_key(|finding| finding.rank);
    let (class, word) = match findings.status {
        Status::Passed => ("good", "Passed"),
        Status::Failed => ("bad", "Failed"),
        Status::Empty => ("void", "Nothing judged"),
    };
    html! {
        section #verdict class={ "verdict " (class) } {
            p.stamp { span.glyph aria-hidden="true" { (match findings.status { Status::Passed => "✓", Status::Failed => "✕", Status::Empty => "·" }) } (word) }
            // What failed begins with an engine's name, which stays as it is.
            h1 { @if findings.status == Status::Failed { (findings.meaning()) } @else { (capitalised(&findings.meaning())) } }
            // Who is right, by how much and how fast; of a run that failed, what failed comes first.
            @let lead = || html! { @for lead in sections.iter().filter_map(|section| section.lead.as_ref()) { (lead.body) } };
            @if findings.status != Status::Failed { (lead()) }
            (tiles(findings))
            (list(drawings, findings))
            @if let Some(part) = rest {
                details { summary { (count(findings.found.len() - TOLD, "more finding")) } (part.place()) }
            }
            (extent(findings))
            @if findings.status == Status::Failed { (lead()) }
            @for answer in sections.iter().filter_map(|section| section.answer.as_ref()) { (answer) }
            div.columns.broad {
                div {
                    @for finding in added { (finding.body) }
                    (closest(overview, rows))
                }
                div {
                    (by_engine(overview, rows, findings))
                    @if overview.studies.len() > 1 { (by_study(overview, rows)) }
                }
            }
            @if let Some(part) = conditions { details { summary { (expectations(run)) } (part.place()) } }
        }
    }
}

/// How many findings each level has.
fn tiles(findings: &Findings) -> Markup {
    html! {
        ul.tiles {
            @for &level in Severity::ALL {
                @let of_level = || findings.found.iter().filter(|found| found.severity == Some(level));
                @let (all, new) = (of_level().count(), of_level().filter(|found| found.new).count());
                li class={ "tile " (class(level)) @if all == 0 { " none" } } title=(level.meaning()) {
                    div { b { (grouped(all)) } span { (level) @if new > 0 { ", " (grouped(new)) " new" } } }
                }
            }
        }
    }
}

/// The findings from the gravest, each with its rows and the command that repeats it.
fn list(drawings: &Drawings, findings: &Findings) -> Markup {
    html! {
        h2 { "What was found" }
        @if findings.found.is_empty() { p { "Nothing." } } @else {
            ol.findings { @for found in findings.found.iter().take(TOLD) { (card(drawings, found)) } }
        }
    }
}

/// The other findings.
fn rest(drawings: &Drawings, findings: &Findings) -> Option<Part> {
    let rest = findings.found.get(TOLD..).filter(|rest| !rest.is_empty())?;
    let body = html! { ol.findings start=(TOLD + 1) { @for found in rest { (card(drawings, found)) } } };
    Some(Part { name: "findings".into(), title: "More findings".into(), body })
}

/// How many rows the findings are among, each kind of verdict with its rows.
fn extent(findings: &Findings) -> Markup {
    html! {
        p.note {
            "Among " (count(findings.tally.total(), "row")) ": "
            @for (index, verdict) in BY_GRAVITY.into_iter().filter(|&verdict| findings.tally.get(verdict) > 0).enumerate() {
                @if index > 0 { ", " }
                @let words = format!("{} {}", grouped(findings.tally.get(verdict)), labels::verdict(verdict));
                @if matches!(verdict, Verdict::Pass | Verdict::Info) { (words) } @else { (opener(UNPASSED, &[("verdict", verdict.as_str())], &words)) }
            }
            "."
        }
    }
}

fn closest(overview: &Overview, rows: &[Row]) -> Markup {
    let passing = rows.iter().filter(|row| row.verdict == Verdict::Pass && row.margin.is_some());
    html! {
        @if let Some(row) = passing.min_by_key(|row| worst_first(row)) {
            p.note {
                "Closest call among what passed: "
                (opener(&overview.chunk_of(row), &[("engine", &row.engine), ("quantity", &row.quantity), ("states", &row.states), ("body", &row.body)],
                    &format!("{}, {} on {}", row.engine, labels::error(&row.quantity, &row.metric), row.robot)))
                @if let Some(margin) = row.margin { ", " span.number { (decades(margin)) } " decades inside its gate." }
            }
        }
    }
}

fn tally_cells(tally: &Tally) -> Markup {
    html! {
        @for verdict in [Verdict::Pass, Verdict::Fail, Verdict::Error, Verdict::Deviation, Verdict::Skip] {
            td class={ "number " (verdict) @if tally.get(verdict) == 0 { " none" } } { (grouped(tally.get(verdict))) }
        }
    }
}

fn tally_heads() -> Markup {
    html! {
        @for verdict in [Verdict::Pass, Verdict::Fail, Verdict::Error, Verdict::Deviation, Verdict::Skip] {
            th.number scope="col" title=(labels::verdict(verdict)) { (labels::glyph(verdict)) " " (verdict) }
        }
    }
}

fn by_engine(overview: &Overview, rows: &[Row], findings: &Findings) -> Markup {
    html! {
        h3 { "By engine" }
        div.scroll { table.compact {
            thead { tr { th scope="col" { "engine" } th scope="col" { "gravest finding" } (tally_heads()) th.number scope="col" { "worst margin" } } }
            tbody {
                @for &engine in &overview.engines {
                    @let own = || rows.iter().filter(|row| row.engine == engine);
                    @let worst = own().filter_map(|row| row.margin).min_by(f64::total_cmp);
                    tr {
                        th scope="row" { (blocks::engine(overview, engine)) }
                        td.gravest { @if let Some(found) = findings.of_engine(engine) { (found.level()) @if let Some(first) = found.quantities.first() { ": " (first) } } }
                        (tally_cells(&Tally::of(own().map(|row| row.verdict))))
                        td.number { @if let Some(margin) = worst { (decades(margin)) } }
                    }
                }
            }
        } }
        p.note { "Margin: decades between a value and its gate, log₁₀(bound/value); positive is inside." }
    }
}

fn by_study(overview: &Overview, rows: &[Row]) -> Markup {
    html! {
        h3 { "By study" }
        div.scroll { table.compact {
            thead { tr { th scope="col" { "study" } (tally_heads()) th.number scope="col" { "rows" } } }
            tbody {
                @for &study in &overview.studies {
                    @let tally = Tally::of(rows.iter().filter(|row| row.study == study).map(|row| row.verdict));
                    tr { th scope="row" { (blocks::study(overview, study)) } (tally_cells(&tally)) td.number { (grouped(tally.total())) } }
                }
            }
        } }
    }
}

/// How many conditions of the suite are met.
fn expectations(run: &RunInfo) -> Markup {
    let unmet = run.expected.iter().filter(|condition| condition.verdict != Verdict::Pass).count();
    let all = count(run.expected.len(), "condition");
    html! {
        "What the suite expects: "
        @if unmet == 0 { "all " (all) " met" } @else { (unmet) " of " (all) " not met" }
    }
}

/// Every condition of the suite, those that are not met first.
fn conditions(run: &RunInfo) -> Option<Part> {
    let mut conditions: Vec<_> = run.expected.iter().collect();
    if conditions.is_empty() {
        return None;
    }
    conditions.sort_by_key(|condition| BY_GRAVITY.iter().position(|&verdict| verdict == condition.verdict));
    let body = html! {
        div.scroll {
            table.compact {
                thead { tr { th scope="col" { "condition" } th.number scope="col" { "expected" } th.number scope="col" { "found" } th scope="col" { "verdict" } th scope="col" { "reason" } } }
                tbody {
                    @for condition in conditions {
                        tr {
                            th scope="row" { (condition.what) }
                            td.number { (condition.expected) }
                            td.number { (condition.found) }
                            td { span class={ "badge " (condition.verdict) } { (labels::glyph(condition.verdict)) " " (condition.verdict) } }
                            td { (condition.reason) }
                        }
                    }
                }
            }
        }
    };
    Some(Part { name: "conditions".into(), title: "What the suite expects".into(), body })
}
