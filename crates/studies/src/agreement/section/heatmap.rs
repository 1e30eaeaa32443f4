//! Section: robot × quantity × engine, coloured by the margin to the gate.

use featherbench_results::Verdict;
use maud::{Markup, html};

use featherbench_report::numbers::decades;
use featherbench_report::{Overview, labels, swatch};

use super::cells::{Cell, Cells};
use super::findings::WhoAgrees;

/// Writes the section.
pub fn markup(overview: &Overview, cells: &Cells, who: &WhoAgrees) -> Markup {
    html! {
        section #agreement {
            h2 { "Who agrees, and by how much" }
            p.lead {
                "Each cell is the worst row of one robot, quantity and engine: the decades left between its error and its gate. "
                "Click one, or walk with the arrow keys and press Enter, to see its rows."
                @if who.references.len() == 1 { " Reference: " @for reference in &who.references { b { (reference) } } "." }
            }
            @if cells.cells.is_empty() {
                p.empty { "This run holds no rows of agreement." }
            } @else {
                div.controls {
                    label { "Engine " select #heat-engine {
                        option value="" { "all, side by side" }
                        @for (index, engine) in shown_engines(overview, cells) { option value=(index) { (engine) } }
                    } }
                    label { "Robot " input #heat-filter type="search" placeholder="part of a name" autocomplete="off"; }
                    label.check { input #heat-trouble type="checkbox"; " only robots with trouble" }
                    p #heat-count role="status" {}
                }
                (legend())
                div.heat-frame tabindex="-1" { (grid(overview, cells)) }
            }
        }
    }
}

/// Engines that have a column, with their indices.
fn shown_engines<'a>(overview: &'a Overview, cells: &Cells) -> impl Iterator<Item = (usize, &'a str)> {
    overview.engines.iter().copied().enumerate().filter(|&(index, _)| cells.columns.iter().any(|&(engine, _)| engine == index))
}

fn grid(overview: &Overview, cells: &Cells) -> Markup {
    html! {
        table #heat.grid role="grid" aria-label="Margin to the gate by robot, engine and quantity" {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "robot" }
                    @for (index, engine) in shown_engines(overview, cells) {
                        @let width = cells.columns.iter().filter(|&&(other, _)| other == index).count();
                        th.engine colspan=(width) scope="colgroup" data-e=(index) { (engine) }
                    }
                }
                tr {
                    @for (position, &(engine, quantity)) in cells.columns.iter().enumerate() {
                        th.quantity.first[starts_engine(cells, position)] scope="col" data-e=(engine) title=(cells.quantities[quantity]) {
                            span { (labels::quantity(cells.quantities[quantity])) }
                        }
                    }
                }
            }
            @for family in overview.families(with_cell(overview, cells)) {
                tbody {
                    tr.family { th colspan=(cells.columns.len() + 1) scope="rowgroup" { span { (overview.robots[family[0]].family) } } }
                    @for &robot in &family { (row(overview, cells, robot)) }
                }
            }
        }
    }
}

/// The robots that have a cell.
fn with_cell(overview: &Overview, cells: &Cells) -> impl Iterator<Item = usize> {
    (0..overview.robots.len()).filter(|&robot| cells.cells.range((robot, 0, 0)..(robot + 1, 0, 0)).next().is_some())
}

fn starts_engine(cells: &Cells, position: usize) -> bool {
    position == 0 || cells.columns[position - 1].0 != cells.columns[position].0
}

fn row(overview: &Overview, cells: &Cells, robot: usize) -> Markup {
    let about = &overview.robots[robot];
    html! {
        tr data-m=(robot) {
            th scope="row" {
                button type="button" tabindex="-1" { (about.name) }
                @if let Some(nv) = about.nv { small { (nv) } }
            }
            @for (position, &(engine, quantity)) in cells.columns.iter().enumerate() {
                td.first[starts_engine(cells, position)] {
                    @if let Some(cell) = cells.cells.get(&(robot, engine, quantity)) { (button(cell)) }
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
