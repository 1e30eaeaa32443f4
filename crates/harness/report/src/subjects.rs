//! The pages of an engine, a robot and a study: what was found about it, from the gravest, then the map of its rows.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Culprit, EngineInfo, RobotInfo, Row, RunInfo};
use maud::{Markup, html};

use crate::blocks::opener;
use crate::cards::{self, card, card_of_robot};
use crate::drawings::Drawings;
use crate::findings::{Findings, Status};
use crate::labels;
use crate::map::{Head, Map, engine_heads, legend, quantity_head, robot_heads};
use crate::overview::{Overview, robot_chunk};
use crate::section::Section;

/// Findings on a page; the first page has all.
const LISTED: usize = 30;

/// The kind of a robot's page.
const ROBOT: &str = "Robot";

/// A page.
pub struct Subject {
    /// Its address in the report's folder.
    pub path: String,
    /// Its title.
    pub title: String,
    /// Its sections.
    pub body: Markup,
}

/// What a page says besides its findings.
struct About {
    /// Before them.
    before: Markup,
    /// Behind them.
    after: Markup,
}

/// What the pages are made from.
pub struct Subjects<'a> {
    run: &'a RunInfo,
    overview: &'a Overview<'a>,
    drawings: &'a Drawings<'a>,
    sections: &'a [Section],
    engines: Vec<Vec<&'a Row>>,
    robots: Vec<Vec<&'a Row>>,
    studies: Vec<Vec<&'a Row>>,
}

impl<'a> Subjects<'a> {
    /// Sorts the rows by engine, robot and study.
    pub fn of(run: &'a RunInfo, rows: &'a [Row], drawings: &'a Drawings, sections: &'a [Section]) -> Self {
        let overview = drawings.overview;
        let (mut engines, mut robots) = (vec![Vec::new(); overview.engines.len()], vec![Vec::new(); overview.robots.len()]);
        let mut studies = vec![Vec::new(); overview.studies.len()];
        for row in rows {
            let places = [
                overview.engine(&row.engine).map(|at| &mut engines[at]),
                overview.robot(&row.robot).map(|at| &mut robots[at]),
                overview.study(&row.study).map(|at| &mut studies[at]),
            ];
            places.into_iter().flatten().for_each(|list| list.push(row));
        }
        Self { run, overview, drawings, sections, engines, robots, studies }
    }

    /// Every page, one after the other.
    pub fn pages(&self) -> impl Iterator<Item = Subject> {
        let engines = (0..self.engines.len()).map(|index| self.engine(index));
        let robots = (0..self.robots.len()).map(|index| self.robot(index));
        let studies = (0..self.studies.len()).map(|index| self.study(index));
        engines.chain(robots).chain(studies)
    }

    fn engine(&self, index: usize) -> Subject {
        let (name, rows) = (self.overview.engines[index], &self.engines[index]);
        let info = self.run.engines.iter().find(|engine| engine.name == name);
        let filters = vec![("engine", name.to_owned())];
        let map = self.map(["robot", "quantity"], name, filters, None, rows);
        let about = About { before: html! { @if let Some(info) = info { (version(info)) } }, after: html! {} };
        let findings = Findings::about(self.run, rows.iter().copied(), |culprit: &Culprit| culprit.engine == name);
        self.page(&self.overview.pages.engines[index], "Engine", name, &findings, &about, &map)
    }

    fn robot(&self, index: usize) -> Subject {
        let (about, rows) = (&self.overview.robots[index], &self.robots[index]);
        let info = self.run.robots.iter().find(|robot| robot.name == about.name);
        let chunk = robot_chunk(index);
        let map = self.map(["quantity", "engine"], about.name, Vec::new(), Some(&chunk), rows);
        let number = |value: Option<u64>| value.map_or_else(|| "?".to_owned(), |value| value.to_string());
        let words = html! {
            p.lead {
                @if !about.family.is_empty() { "Family " b { (about.family) } ", " }
                (number(about.nv)) " degrees of freedom, " (number(about.bodies)) " bodies, depth " (number(about.depth)) ". "
                (opener(&chunk, &[], "All its rows")) "."
            }
            (self.drawings.on_page(about.name))
            @if let Some(info) = info { (source(info)) }
        };
        let findings = Findings::about(self.run, rows.iter().copied(), |culprit: &Culprit| culprit.robot == about.name);
        self.page(&self.overview.pages.robots[index], ROBOT, about.name, &findings, &About { before: words, after: html! {} }, &map)
    }

    fn study(&self, index: usize) -> Subject {
        let (name, rows) = (self.overview.studies[index], &self.studies[index]);
        // A study without robots has a line for each of its quantities.
        let of_robots = rows.iter().any(|row| !row.robot.is_empty());
        let filters = vec![("study", name.to_owned())];
        let map = self.map([if of_robots { "robot" } else { "quantity" }, "engine"], name, filters, Some(&format!("study-{index}")), rows);
        let map = Map { named: of_robots, ..map };
        let shown: Vec<&Section> = self.sections.iter().filter(|section| section.study == name).collect();
        let words = html! {
            @if !shown.is_empty() {
                p.lead {
                    "On the first page: "
                    @for (place, section) in shown.iter().enumerate() { @if place > 0 { ", " } a href={ "#" (section.anchor) } { (section.name) } }
                    "."
                }
            }
            @for section in shown {
                @if let Some(finding) = &section.finding { (finding.body) }
                @if let Some(answer) = &section.answer { (answer) }
            }
        };
        let findings = Findings::about(self.run, rows.iter().copied(), |culprit: &Culprit| culprit.study == name);
        self.page(&self.overview.pages.studies[index], "Study", name, &findings, &About { before: html! {}, after: words }, &map)
    }

    /// The map of a page's rows. Lines of quantities have their rows in `chunk`.
    fn map(
        &self,
        axes: [&'static str; 2],
        name: &str,
        filters: Vec<(&'static str, String)>,
        chunk: Option<&str>,
        rows: &[&'a Row],
    ) -> Map<'a> {
        let quantities = quantities(rows);
        let of_quantity = |&quantity: &&str| Head { chunk: chunk.map(str::to_owned), ..quantity_head(quantity) };
        let [lines, columns] = axes.map(|axis| match axis {
            "robot" => robot_heads(self.overview),
            "engine" => engine_heads(self.overview),
            _ => quantities.iter().map(of_quantity).collect(),
        });
        let label = format!("Margin to the gate by {} and {}: {name}", axes[0], axes[1]);
        let mut map = Map { id: "map".into(), label, axes, filters, lines, columns, cells: BTreeMap::new(), named: false };
        for &row in rows {
            let places = axes.map(|axis| match axis {
                "robot" => self.overview.robot(&row.robot),
                "engine" => self.overview.engine(&row.engine),
                _ => quantities.iter().position(|&quantity| quantity == row.quantity),
            });
            if let [Some(line), Some(column)] = places {
                map.add((line, column), row);
            }
        }
        map
    }

    /// The one template.
    fn page(&self, path: &str, kind: &str, name: &str, findings: &Findings, about: &About, map: &Map) -> Subject {
        let (class, sign) = match findings.status {
            Status::Passed => ("good", "✓"),
            Status::Failed => ("bad", "✕"),
            Status::Empty => ("void", "·"),
        };
        let told = findings.headline();
        // The headline of an engine's page begins with the engine already.
        let headline = match told.strip_prefix(name) {
            Some(rest) => html! { (rest.trim_start_matches([',', ':', ' '])) },
            None if findings.is_quiet() => html! { "no engine misses a gate" },
            None if findings.status == Status::Empty => html! { "nothing is judged here" },
            None => cards::headline(self.drawings, findings),
        };
        let body = html! {
            section #about class={ "verdict " (class) } {
                p.stamp { span.glyph aria-hidden="true" { (sign) } (kind) }
                h1 { (name) ": " (headline) }
                (about.before)
                h2 { "What was found" }
                @if findings.found.is_empty() { p { "Nothing." } } @else {
                    ol.findings { @for found in findings.found.iter().take(LISTED) { (if kind == ROBOT { card_of_robot(self.drawings, found) } else { card(self.drawings, found) }) } }
                }
                @if findings.found.len() > LISTED { p.note { "The first " (LISTED) " of " (findings.found.len()) "." } }
                (about.after)
                p.note { (findings.levels()) " among " (findings.extent()) "." }
            }
            section #rows-map {
                h2 { "By " (map.axes[0]) " and " (map.axes[1]) }
                @if map.cells.is_empty() {
                    p.empty { "No rows." }
                } @else {
                    p.lead { "Each cell is the worst row of its kind: the decades left between its error and its gate. A click opens its rows." }
                    (legend())
                    (map.markup(&html! {}))
                }
            }
        };
        Subject { path: path.to_owned(), title: name.to_owned(), body }
    }
}

/// The quantities of rows, in the order of the page.
fn quantities<'a>(rows: &[&'a Row]) -> Vec<&'a str> {
    let names: BTreeSet<&str> = rows.iter().map(|row| row.quantity.as_str()).collect();
    let mut names: Vec<&str> = names.into_iter().collect();
    names.sort_by_key(|name| labels::quantity_rank(name));
    names
}

fn version(info: &EngineInfo) -> Markup {
    html! {
        p.lead {
            "Version " code { (info.version) } ", " (info.source) ": "
            (info.status) @if !info.reason.is_empty() { ", " (info.reason) } "."
        }
    }
}

fn source(info: &RobotInfo) -> Markup {
    html! {
        p.note { "Origin: " (info.origin) @if !info.source.is_empty() { ", " (info.source) } @if !info.licence.is_empty() { "; licence " (info.licence) } "." }
        @if !info.notes.is_empty() { ul { @for note in &info.notes { li { (note) } } } }
    }
}
