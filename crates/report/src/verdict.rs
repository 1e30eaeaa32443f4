//! Section: whether the run passed, and if not, where it failed.

use featherbench_results::{Row, RunInfo, Verdict};
use maud::{Markup, html};

use crate::blocks::opener;
use crate::chunks::UNPASSED;
use crate::findings::{Findings, Status};
use crate::labels;
use crate::numbers::{count, decades, grouped};
use crate::overview::Overview;
use crate::section::Section;
use crate::tally::{BY_GRAVITY, Tally};

/// Number of failures in the head of the page; the others are in the list of rows that did not pass.
const TOLD: usize = 8;

/// Writes the section, with what the sections of studies add to it.
pub fn section(run: &RunInfo, overview: &Overview, rows: &[Row], sections: &[Section]) -> Section {
    Section::new("verdict", "Verdict", body(run, overview, rows, sections))
}

fn body(run: &RunInfo, overview: &Overview, rows: &[Row], sections: &[Section]) -> Markup {
    let findings = &Findings::of(run, rows, sections);
    let mut added: Vec<_> = sections.iter().filter_map(|section| section.finding.as_ref()).collect();
    added.sort_by_key(|finding| finding.rank);
    let (class, word) = match findings.status {
        Status::Passed => ("good", "Passed"),
        Status::Failed => ("bad", "Failed"),
        Status::Empty => ("void", "Empty"),
    };
    html! {
        section #verdict class={ "verdict " (class) } {
            p.stamp { span.glyph aria-hidden="true" { (match findings.status { Status::Passed => "✓", Status::Failed => "✕", Status::Empty => "·" }) } (word) }
            h1 { (findings.headline()) }
            (tiles(findings))
            div.columns {
                div {
                    @for finding in added { (finding.body) }
                    (failures(overview, findings))
                    (closest(overview, findings))
                }
                div {
                    (by_engine(overview, rows))
                    @if overview.studies.len() > 1 { (by_study(overview, rows)) }
                }
            }
            (expectations(run))
        }
    }
}

fn tiles(findings: &Findings) -> Markup {
    let order = [Verdict::Pass, Verdict::Fail, Verdict::Error, Verdict::Deviation, Verdict::Skip, Verdict::Info];
    html! {
        ul.tiles {
            @for verdict in order {
                @let number = findings.tally.get(verdict);
                li class={ "tile " (verdict) @if number == 0 { " none" } } {
                    @let figure = html! { b { (grouped(number)) } span { i aria-hidden="true" { (labels::glyph(verdict)) } " " (labels::verdict(verdict)) } };
                    @if number > 0 && !matches!(verdict, Verdict::Pass | Verdict::Info) {
                        button type="button" data-chunk=(UNPASSED) data-filter={ "{\"verdict\":\"" (verdict) "\"}" } { (figure) }
                    } @else {
                        div { (figure) }
                    }
                }
            }
        }
    }
}

fn failures(overview: &Overview, findings: &Findings) -> Markup {
    html! {
        @if !findings.failures.is_empty() {
            h3 { "Who does not" }
            ul.findings {
                @for found in findings.failures.iter().take(TOLD) {
                    li.fail {
                        b { (found.engine) } ", " (found.sentence()) ". Worst: "
                        (opener(
                            &overview.chunk_of(found.worst),
                            &[("engine", found.engine), ("quantity", found.quantity), ("verdict", found.worst.verdict.as_str())],
                            &found.worst_words(),
                        ))
                        @if let Some(margin) = found.worst.margin { " " span.number { "(" (decades(margin)) " decades)" } }
                    }
                }
            }
            @if findings.failures.len() > TOLD {
                p.note { (count(findings.failures.len() - TOLD, "more disagreement")) " in " a href="#unpassed" { "the list of what did not pass" } "." }
            }
        }
    }
}

fn closest(overview: &Overview, findings: &Findings) -> Markup {
    html! {
        @if let Some(row) = findings.closest {
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
            td.number class={ (verdict) @if tally.get(verdict) == 0 { " none" } } { (grouped(tally.get(verdict))) }
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

fn by_engine(overview: &Overview, rows: &[Row]) -> Markup {
    html! {
        h3 { "By engine" }
        div.scroll { table.compact {
            thead { tr { th scope="col" { "engine" } (tally_heads()) th.number scope="col" { "worst margin" } } }
            tbody {
                @for &engine in &overview.engines {
                    @let own = || rows.iter().filter(|row| row.engine == engine);
                    @let worst = own().filter_map(|row| row.margin).min_by(f64::total_cmp);
                    tr {
                        th scope="row" { (engine) }
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
                    tr { th scope="row" { (study) } (tally_cells(&tally)) td.number { (grouped(tally.total())) } }
                }
            }
        } }
    }
}

fn expectations(run: &RunInfo) -> Markup {
    let mut conditions: Vec<_> = run.expected.iter().collect();
    conditions.sort_by_key(|condition| BY_GRAVITY.iter().position(|&verdict| verdict == condition.verdict));
    let unmet = conditions.iter().filter(|condition| condition.verdict != Verdict::Pass).count();
    html! {
        @if !conditions.is_empty() {
            details open[unmet > 0] {
                summary {
                    "What the suite expects: "
                    @if unmet == 0 { "all " (count(conditions.len(), "condition")) " met" } @else { (unmet) " of " (count(conditions.len(), "condition")) " not met" }
                }
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
            }
        }
    }
}
