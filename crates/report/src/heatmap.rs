//! Section: model × quantity × engine, coloured by the margin to the gate.

use featherbench_results::Verdict;
use maud::{Markup, html};

use crate::findings::Findings;
use crate::labels;
use crate::numbers::decades;
use crate::overview::{Cell, Overview};

/// Writes the section.
pub fn section(overview: &Overview, findings: &Findings) -> Markup {
    html! {
        section #agreement {
            h2 { "Who agrees, and by how much" }
            p.lead {
                "Each cell is the worst row of one model, quantity and engine: the decades left between its error and its gate. "
                "Click one, or walk with the arrow keys and press Enter, to see its rows."
                @if findings.references.len() == 1 { " Reference: " @for reference in &findings.references { b { (reference) } } "." }
            }
            @if overview.cells.is_empty() {
                p.empty { "This run holds no rows of agreement." }
            } @else {
                div.controls {
                    label { "Engine " select #heat-engine {
                        option value="" { "all, side by side" }
                        @for (index, engine) in shown_engines(overview) { option value=(index) { (engine) } }
                    } }
                    label { "Model " input #heat-filter type="search" placeholder="part of a name" autocomplete="off"; }
                    label.check { input #heat-trouble type="checkbox"; " only models with trouble" }
                    p #heat-count role="status" {}
                }
                (legend())
                div.heat-frame tabindex="-1" { (grid(overview)) }
            }
        }
    }
}

/// Engines that have a column, with their indices.
fn shown_engines<'a>(overview: &'a Overview) -> impl Iterator<Item = (usize, &'a str)> {
    overview.engines.iter().copied().enumerate().filter(|&(index, _)| overview.columns.iter().any(|&(engine, _)| engine == index))
}

fn grid(overview: &Overview) -> Markup {
    html! {
        table #heat.grid role="grid" aria-label="Margin to the gate by model, engine and quantity" {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "model" }
                    @for (index, engine) in shown_engines(overview) {
                        @let width = overview.columns.iter().filter(|&&(other, _)| other == index).count();
                        th.engine colspan=(width) scope="colgroup" data-e=(index) { (engine) }
                    }
                }
                tr {
                    @for (position, &(engine, quantity)) in overview.columns.iter().enumerate() {
                        th.quantity.first[starts_engine(overview, position)] scope="col" data-e=(engine) title=(overview.quantities[quantity]) {
                            span { (labels::quantity(overview.quantities[quantity])) }
                        }
                    }
                }
            }
            @for family in families(overview) {
                tbody {
                    tr.family { th colspan=(overview.columns.len() + 1) scope="rowgroup" { span { (overview.models[family[0]].family) } } }
                    @for &model in &family { (row(overview, model)) }
                }
            }
        }
    }
}

/// The models of each family that have a cell.
fn families(overview: &Overview) -> Vec<Vec<usize>> {
    let mut families: Vec<Vec<usize>> = Vec::new();
    for model in 0..overview.models.len() {
        if overview.cells.range((model, 0, 0)..(model + 1, 0, 0)).next().is_none() {
            continue;
        }
        match families.last_mut().filter(|family| overview.models[family[0]].family == overview.models[model].family) {
            Some(family) => family.push(model),
            None => families.push(vec![model]),
        }
    }
    families
}

fn starts_engine(overview: &Overview, position: usize) -> bool {
    position == 0 || overview.columns[position - 1].0 != overview.columns[position].0
}

fn row(overview: &Overview, model: usize) -> Markup {
    let about = &overview.models[model];
    html! {
        tr data-m=(model) {
            th scope="row" {
                button type="button" tabindex="-1" { (about.name) }
                @if let Some(nv) = about.nv { small { (nv) } }
            }
            @for (position, &(engine, quantity)) in overview.columns.iter().enumerate() {
                td.first[starts_engine(overview, position)] {
                    @if let Some(cell) = overview.cells.get(&(model, engine, quantity)) { (button(cell)) }
                }
            }
        }
    }
}

fn button(cell: &Cell) -> Markup {
    let verdict = cell.tally.verdict();
    let (class, text) = match (verdict, cell.worst.margin) {
        (Verdict::Pass, Some(margin)) => (inside(margin), format!("{:.0}", margin.floor().max(0.0))),
        (Verdict::Fail, Some(margin)) => (outside(margin), labels::glyph(verdict).to_owned()),
        (Verdict::Pass, None) => ("p5", labels::glyph(verdict).to_owned()),
        (Verdict::Fail, None) => ("f2", labels::glyph(verdict).to_owned()),
        _ => (verdict.as_str(), labels::glyph(verdict).to_owned()),
    };
    let partial = matches!(verdict, Verdict::Pass) && cell.tally.get(Verdict::Skip) > 0;
    html! {
        button.(class).part[partial] type="button" tabindex="-1" data-d=[cell.worst.margin.map(decades)] { (text) }
    }
}

/// Colour steps inside the gate, by decades.
pub fn inside(margin: f64) -> &'static str {
    match margin {
        m if m < 0.5 => "p0",
        m if m < 1.0 => "p1",
        m if m < 2.0 => "p2",
        m if m < 3.0 => "p3",
        m if m < 4.0 => "p4",
        _ => "p5",
    }
}

/// Colour steps outside the gate, by decades.
pub fn outside(margin: f64) -> &'static str {
    match margin {
        m if m > -1.0 => "f0",
        m if m > -2.0 => "f1",
        _ => "f2",
    }
}

fn legend() -> Markup {
    let swatch = |class: &str, text: &str, meaning: &str| html! { li { span.swatch.(class) aria-hidden="true" { (text) } (meaning) } };
    html! {
        ul.legend aria-label="Legend" {
            (swatch("f2", "✕", "2 decades or more outside"))
            (swatch("f1", "✕", "1–2"))
            (swatch("f0", "✕", "up to 1"))
            (swatch("p0", "0", "inside by less than ½"))
            (swatch("p1", "0", "½–1"))
            (swatch("p2", "1", "1–2"))
            (swatch("p3", "2", "2–3"))
            (swatch("p4", "3", "3–4"))
            (swatch("p5", "4", "4 or more"))
            (swatch("error", "!", "no answer"))
            (swatch("skip", "–", "not offered"))
            (swatch("p3 part", "2", "passes where it is offered"))
            (swatch("deviation", "≈", "known deviation"))
            (swatch("info", "·", "not judged"))
        }
    }
}
