//! A map: a table of two lists, whose cells are the worst of their rows, coloured by the margin to the gate.
//!
//! A cell opens its rows. Which rows these are is written once for the map, once for a line and once for a column; the script puts them
//! together.

use std::collections::BTreeMap;

use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

use crate::blocks::{self, swatch};
use crate::findings::clipped;
use crate::labels;
use crate::numbers::{decades, short};
use crate::overview::{Overview, Robot, robot_chunk};
use crate::tally::{Tally, worst_first};

/// All rows of a cell.
#[derive(Clone, Debug)]
pub struct Cell<'a> {
    /// Their verdicts.
    pub tally: Tally,
    /// The row that decides: of the worst verdict, the one with the smallest margin.
    pub worst: &'a Row,
}

impl<'a> Cell<'a> {
    /// A cell with its first row.
    pub fn of(row: &'a Row) -> Self {
        Self { tally: Tally::of([row.verdict]), worst: row }
    }

    /// Adds a row.
    pub fn add(&mut self, row: &'a Row) {
        self.tally.add(row.verdict);
        if worst_first(row) < worst_first(self.worst) {
            self.worst = row;
        }
    }

    /// How it looks: its class and its text.
    fn look(&self) -> (&'static str, String) {
        let verdict = self.tally.verdict();
        match (verdict, self.worst.margin) {
            (Verdict::Pass, Some(margin)) => (inside(margin), format!("{:.0}", margin.floor().max(0.0))),
            (Verdict::Fail, Some(margin)) => (outside(margin), labels::glyph(verdict).to_owned()),
            (Verdict::Pass, None) => ("p5", labels::glyph(verdict).to_owned()),
            (Verdict::Fail, None) => ("f2", labels::glyph(verdict).to_owned()),
            _ => (verdict.as_str(), labels::glyph(verdict).to_owned()),
        }
    }

    /// What a tip says of it.
    fn told(&self) -> String {
        let row = self.worst;
        let mut lines = vec![self.tally.words()];
        if let Some(value) = row.value {
            let gate = row.bound.map(|bound| format!(", gate {}", short(bound))).unwrap_or_default();
            let margin = row.margin.map(|margin| format!(", {} decades", decades(margin))).unwrap_or_default();
            lines.push(format!("worst: {} {}{gate}{margin}", labels::error(&row.quantity, &row.metric), short(value)));
        }
        let place = [&*row.states, &row.method].into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ");
        lines.extend([place, clipped(&row.reason)].into_iter().filter(|line| !line.is_empty()));
        lines.join("\n")
    }

    fn button(&self, named: bool) -> Markup {
        let (class, text) = self.look();
        let partial = self.tally.verdict() == Verdict::Pass && self.tally.get(Verdict::Skip) > 0;
        let quantity = (named && !self.worst.quantity.is_empty()).then(|| labels::quantity(&self.worst.quantity));
        html! {
            button.(class).part[partial] type="button" tabindex="-1" data-d=[self.worst.margin.map(decades)] data-q=[quantity] data-t=(self.told()) {
                (text)
            }
        }
    }

    /// A number that orders cells from the worst.
    fn rank(&self) -> (usize, i64) {
        worst_first(self.worst)
    }
}

/// The head of a line or of a column.
#[derive(Clone, Debug)]
pub struct Head {
    /// Its name, perhaps as a link.
    pub name: Markup,
    /// The name as text: what a filter looks at.
    pub text: String,
    /// Lines of one group stand together under its name.
    pub group: String,
    /// A number behind the name of a line, by which lines can be sorted.
    pub size: Option<u64>,
    /// The values that the columns of its rows have.
    pub filters: Vec<(&'static str, String)>,
    /// The chunk of its rows.
    pub chunk: Option<String>,
}

impl Head {
    /// A head whose rows have a value in a column.
    pub fn new(name: Markup, text: &str, column: &'static str, value: &str) -> Self {
        Self { name, text: text.to_owned(), group: String::new(), size: None, filters: vec![(column, value.to_owned())], chunk: None }
    }
}

/// A map.
#[derive(Debug)]
pub struct Map<'a> {
    /// Its `id`.
    pub id: String,
    /// What it shows.
    pub label: String,
    /// What its lines and columns are, each in a word.
    pub axes: [&'static str; 2],
    /// The values that the columns of all rows have.
    pub filters: Vec<(&'static str, String)>,
    /// Its lines.
    pub lines: Vec<Head>,
    /// Its columns.
    pub columns: Vec<Head>,
    /// Its cells by line and column.
    pub cells: BTreeMap<(usize, usize), Cell<'a>>,
    /// Whether a cell names the quantity of its worst row.
    pub named: bool,
}

impl<'a> Map<'a> {
    /// Adds a row to a cell.
    pub fn add(&mut self, at: (usize, usize), row: &'a Row) {
        self.cells.entry(at).and_modify(|cell| cell.add(row)).or_insert_with(|| Cell::of(row));
    }

    /// The lines with a cell, those of one group beside each other.
    fn groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for line in (0..self.lines.len()).filter(|&line| self.cells.range((line, 0)..(line + 1, 0)).next().is_some()) {
            match groups.iter_mut().find(|group| self.lines[group[0]].group == self.lines[line].group) {
                Some(group) => group.push(line),
                None => groups.push(vec![line]),
            }
        }
        groups
    }

    /// The columns with a cell.
    fn shown(&self) -> Vec<usize> {
        (0..self.columns.len()).filter(|&column| self.cells.keys().any(|&(_, other)| other == column)).collect()
    }

    /// Places of the lines from the worst, for the script that sorts them.
    fn ranks(&self) -> BTreeMap<usize, usize> {
        let worst = |line: usize| self.cells.range((line, 0)..(line + 1, 0)).map(|(_, cell)| cell.rank()).min();
        let mut lines: Vec<usize> = (0..self.lines.len()).collect();
        lines.sort_by_key(|&line| worst(line).unwrap_or((usize::MAX, i64::MAX)));
        lines.into_iter().enumerate().map(|(place, line)| (line, place)).collect()
    }

    /// Writes the map with its controls; further controls stand before its own.
    pub fn markup(&self, controls: &Markup) -> Markup {
        let [line, _] = self.axes;
        let sized = self.lines.iter().any(|head| head.size.is_some());
        html! {
            div.map-box {
                div.controls {
                    (controls)
                    label { "Part of a name " input id={ (self.id) "-filter" } type="search" placeholder=(line) autocomplete="off"; }
                    label { "Order " select id={ (self.id) "-sort" } {
                        option value="" { "as given" }
                        option value="worst" { "worst first" }
                        option value="name" { "name" }
                        @if sized { option value="size" { "degrees of freedom" } }
                    } }
                    label.check { input id={ (self.id) "-trouble" } type="checkbox"; " only with trouble" }
                    p id={ (self.id) "-count" } role="status" {}
                }
                div.heat-frame tabindex="-1" { (self.table()) }
            }
        }
    }

    fn table(&self) -> Markup {
        let (columns, ranks) = (self.shown(), self.ranks());
        html! {
            table.grid.map.named[self.named].upright[self.axes[1] == "quantity"] id=(self.id) role="grid" aria-label=(self.label) data-with=(with(&self.filters)) data-of=(self.axes[0]) {
                thead {
                    tr {
                        th.corner scope="col" { (self.axes[0]) }
                        @for &column in &columns {
                            @let head = &self.columns[column];
                            th.engine scope="col" data-with=(with(&head.filters)) data-rows=[&head.chunk] title=(head.text) { span { (head.name) } }
                        }
                    }
                }
                @for group in self.groups() {
                    tbody {
                        @let title = &self.lines[group[0]].group;
                        @if !title.is_empty() { tr.family { th colspan=(columns.len() + 1) scope="rowgroup" { span { (title) } } } }
                        @for line in group { (self.line(line, &columns, ranks.get(&line).copied().unwrap_or_default())) }
                    }
                }
            }
        }
    }

    fn line(&self, line: usize, columns: &[usize], rank: usize) -> Markup {
        let head = &self.lines[line];
        html! {
            tr data-m=(line) data-with=(with(&head.filters)) data-rows=[&head.chunk] data-worst=(rank) {
                th scope="row" { (head.name) @if let Some(size) = head.size { small { (size) } } }
                @for &column in columns { td { @if let Some(cell) = self.cells.get(&(line, column)) { (cell.button(self.named)) } } }
            }
        }
    }
}

/// A line for each robot, families together.
pub fn robot_heads(overview: &Overview) -> Vec<Head> {
    let head = |(index, robot): (usize, &Robot)| Head {
        group: robot.family.to_owned(),
        size: robot.nv,
        filters: Vec::new(),
        chunk: Some(robot_chunk(index)),
        ..Head::new(blocks::robot(overview, robot.name), robot.name, "robot", robot.name)
    };
    overview.robots.iter().enumerate().map(head).collect()
}

/// A column for each engine.
pub fn engine_heads(overview: &Overview) -> Vec<Head> {
    overview.engines.iter().map(|&engine| Head::new(blocks::engine(overview, engine), engine, "engine", engine)).collect()
}

/// A line or column for a quantity.
pub fn quantity_head(quantity: &str) -> Head {
    let title = labels::quantity(quantity);
    Head::new(html! { (title) }, title, "quantity", quantity)
}

/// Filters as the script reads them.
fn with(filters: &[(&'static str, String)]) -> String {
    let filters: serde_json::Map<String, serde_json::Value> =
        filters.iter().map(|(column, value)| ((*column).to_owned(), value.as_str().into())).collect();
    serde_json::Value::from(filters).to_string()
}

/// Shades inside the gate, by decades.
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

/// Shades outside the gate, by decades.
pub fn outside(margin: f64) -> &'static str {
    match margin {
        m if m > -1.0 => "f0",
        m if m > -2.0 => "f1",
        _ => "f2",
    }
}

/// What the colours and signs of a map mean.
pub fn legend() -> Markup {
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
