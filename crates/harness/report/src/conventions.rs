//! Section: the engines' conventions that differ from ours, and the test of each.

use featherbench_results::{Convention, EngineSource, RunInfo};
use maud::{Markup, html};

use crate::numbers::listed;
use crate::section::Section;

/// Writes the section.
pub fn section(run: &RunInfo) -> Section {
    Section::new("conventions", "Conventions", body(run))
}

fn body(run: &RunInfo) -> Markup {
    let mut engines: Vec<(&str, Vec<&Convention>)> = Vec::new();
    for row in &run.conventions {
        match engines.iter_mut().find(|(engine, _)| *engine == row.engine) {
            Some((_, rows)) => rows.push(row),
            None => engines.push((&row.engine, vec![row])),
        }
    }
    // Our own engine's conventions are those of everyone.
    let others = run.engines.iter().filter(|engine| engine.source != EngineSource::Own && engine.status == "ok").map(|engine| &engine.name);
    let unlisted: Vec<String> = others.filter(|&name| run.conventions.iter().all(|row| row.engine != *name)).cloned().collect();
    html! {
        section #conventions {
            h2 { "Conventions" }
            p.lead {
                "Each engine is asked in its own coordinates, and its answers are brought into ours by the functions named here. "
                "Behind each row stands a test that asks the engine itself, and fails if the convention were otherwise."
            }
            @if engines.is_empty() && unlisted.is_empty() { p.empty { "The run names no conventions." } }
            @if !unlisted.is_empty() {
                p.note #conventions-unlisted {
                    b { (listed(&unlisted)) } ": no row here. How such an engine's answers are converted is tested by the answers alone, not by a test of each convention."
                }
            }
            @for (engine, rows) in engines {
                h3 { (engine) }
                div.scroll {
                    table.compact.conventions {
                        thead {
                            tr {
                                th scope="col" { "topic" } th scope="col" { "the engine" } th scope="col" { "ours" }
                                th scope="col" { "converted by" } th scope="col" { "held by" }
                            }
                        }
                        tbody {
                            @for row in rows {
                                tr {
                                    th scope="row" { (row.topic) }
                                    td { (prose(&row.theirs)) }
                                    td.soft { (prose(&row.ours)) }
                                    td { (prose(&row.conversion)) }
                                    td { code.nowrap { (row.test) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Text in which backticks mark code.
fn prose(text: &str) -> Markup {
    html! {
        @for (k, part) in text.split('`').enumerate() {
            @if k % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}
