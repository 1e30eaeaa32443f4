//! Section: robot × engine, coloured by the margin to the gate; each engine opens its quantities.

use std::path::Path;

use featherbench_report::map::{Map, legend};
use featherbench_report::{Overview, Part};
use maud::{Markup, html};

use super::cells::Cells;
use super::findings::WhoAgrees;

/// Writes the section and the map of each engine by quantity.
pub fn markup(overview: &Overview, cells: &Cells, who: &WhoAgrees) -> (Markup, Vec<Part>) {
    let parts: Vec<(usize, Part)> = cells.engines.iter().map(|(&engine, map)| (engine, part(overview, engine, map))).collect();
    let body = html! {
        section #agreement {
            h2 { "Who agrees, and by how much" }
            p.lead {
                "Each cell is the worst row of one robot and engine, over all quantities: the decades left between its error and its gate. "
                "Click one, or walk with the arrow keys and press Enter, to see its rows. Choose an engine to see its quantities."
                @if who.references.len() == 1 { " Reference: " @for reference in &who.references { b { (reference) } } "." }
            }
            @if cells.whole.cells.is_empty() {
                p.empty { "This run holds no rows of agreement." }
            } @else {
                div.controls {
                    label { "Quantities of " select #heat-engine {
                        option value="" { "no engine: the worst of each" }
                        @for (engine, part) in &parts { option value=(part.name) { (overview.engines[*engine]) } }
                    } }
                }
                (legend())
                div #heat-whole { (cells.whole.markup(&html! {})) }
                @for (_, part) in &parts { div.heat-of id={ "of-" (part.name) } hidden { (part.place()) } }
                noscript {
                    p { "The quantities of: " @for (engine, part) in &parts { a href={ "sections/" (part.name) ".html" } { (overview.engines[*engine]) } " " } }
                }
            }
        }
    };
    (body, parts.into_iter().map(|(_, part)| part).collect())
}

/// The map of an engine by quantity.
fn part(overview: &Overview, engine: usize, map: &Map) -> Part {
    let page = Path::new(&overview.pages.engines[engine]).file_stem().unwrap_or_default().to_string_lossy();
    Part {
        name: format!("agreement-{page}"),
        title: format!("Agreement of {} by quantity", overview.engines[engine]),
        body: html! { div { (map.markup(&html! {})) } },
    }
}
