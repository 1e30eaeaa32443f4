//! The drawings of a run's robots: on their pages, and in the cards of findings, which bring them when they are opened. Bodies are marked that
//! a row names which does not pass, or a section.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Culprit, Drawing, RobotInfo, Row, RunInfo, Severity};
use maud::{Markup, html};

use crate::numbers::grouped;
use crate::overview::Overview;
use crate::robot::drawn;
use crate::section::{Section, Shown};

/// The drawings of a run.
pub struct Drawings<'a> {
    run: &'a RunInfo,
    /// The words of the run.
    pub overview: &'a Overview<'a>,
    /// The bodies that are marked, by robot and engine.
    marks: BTreeMap<(&'a str, &'a str), BTreeSet<String>>,
    /// The robots that a finding may be about.
    found: BTreeSet<&'a str>,
    /// The sections, whose drawings show rows.
    sections: &'a [Section],
}

/// A drawing that a card brings. Its page is the robot's.
pub struct Brought {
    /// The name of its piece.
    pub name: String,
    /// The robot.
    pub robot: String,
    /// The drawing.
    pub body: Markup,
}

impl<'a> Drawings<'a> {
    /// Collects what is marked.
    pub fn of(run: &'a RunInfo, rows: &'a [Row], overview: &'a Overview, sections: &'a [Section]) -> Self {
        let mut marks: BTreeMap<(&str, &str), BTreeSet<String>> = BTreeMap::new();
        let unpassed = || rows.iter().filter(|row| Severity::of(row).is_some());
        for row in unpassed().filter(|row| !row.body.is_empty()) {
            marks.entry((&row.robot, &row.engine)).or_default().insert(row.body.clone());
        }
        for mark in sections.iter().flat_map(|section| &section.marks) {
            marks.entry((&mark.robot, &mark.engine)).or_default().insert(mark.body.clone());
        }
        let unmet = run.expected.iter().filter(|condition| !condition.is_met()).map(|condition| condition.culprit.robot.as_str());
        let found = unpassed().map(|row| row.robot.as_str()).chain(unmet).collect();
        Self { run, overview, marks, found, sections }
    }

    /// The drawing on a robot's own page, or why there is none.
    pub fn on_page(&self, robot: &str) -> Markup {
        let of = |&((named, _), _): &(&(&str, &str), &BTreeSet<String>)| *named == robot;
        let marked = self.marks.iter().filter(of).flat_map(|(_, bodies)| bodies.iter().cloned()).collect();
        // An older run has no drawings, and a robot that a study made is not among the announced ones.
        let missing = |info: &&RobotInfo| info.name == robot && !self.run.drawings.is_empty();
        html! {
            @if let Some(drawing) = self.run.drawings.get(robot) {
                (drawn(robot, drawing, &marked, "engines differ"))
            } @else if self.run.robots.iter().any(|info| missing(&info)) {
                p.note #not-drawn {
                    "It is not drawn. A run draws robots of at most " (Drawing::MOST_BODIES) " bodies, those of its findings first, until the drawings have "
                    (grouped(Drawing::MOST_BYTES)) " bytes."
                }
            }
        }
    }

    /// The way from a row to the drawing that shows its kind, with its choice, or else to the section of its study.
    pub fn figure(&self, row: &Row) -> Markup {
        let of_study = || self.sections.iter().filter(|section| section.study == row.study && !section.appendix);
        let shows = |shown: &&Shown| shown.quantity == row.quantity && shown.metric.as_ref().is_none_or(|metric| *metric == row.metric);
        let shown = of_study().find_map(|section| Some((section.anchor, &section.shows.iter().find(shows)?.choice)));
        html! {
            @if let Some((anchor, (list, value))) = shown {
                " " a.figure href={ "#" (anchor) } data-list=(list) data-value=(value) { "Its figure" } "."
            } @else if let Some(section) = of_study().next() {
                " " a.figure href={ "#" (section.anchor) } { "Its section" } "."
            }
        }
    }

    /// What stands in the card of a finding: the drawing of its robot, which is brought when it is opened.
    pub fn place(&self, culprit: &Culprit) -> Markup {
        let place = self.found.get(culprit.robot.as_str()).and_then(|robot| self.drawable(robot));
        html! {
            @if let Some((robot, _)) = place {
                details.look {
                    summary { "Show " (culprit.robot) }
                    div data-part=(self.name(robot, &culprit.engine)) {
                        a href=(self.overview.pages.robots[robot]) { (culprit.robot) " on a page of its own" }
                    }
                }
            }
        }
    }

    /// Every drawing that a card may bring: of each robot in a finding one for each engine that differs in a body, and one without a mark.
    pub fn brought(&self) -> impl Iterator<Item = Brought> {
        let of_engines = self.marks.keys().filter(|(robot, engine)| self.found.contains(robot) && self.overview.engine(engine).is_some());
        let plain = self.found.iter().map(|&robot| (robot, ""));
        plain.chain(of_engines.copied()).filter_map(|(robot, engine)| {
            let (index, drawing) = self.drawable(robot)?;
            let marked = self.marks.get(&(robot, engine)).cloned().unwrap_or_default();
            let body = drawn(robot, drawing, &marked, &format!("{engine} differs"));
            Some(Brought { name: self.name(index, engine), robot: robot.to_owned(), body })
        })
    }

    /// A robot that has a page and a drawing.
    fn drawable(&self, robot: &str) -> Option<(usize, &'a Drawing)> {
        Some((self.overview.robot(robot)?, self.run.drawings.get(robot)?))
    }

    /// The name of a robot's drawing with the marks of an engine, or without marks.
    fn name(&self, robot: usize, engine: &str) -> String {
        let marked = self.marks.contains_key(&(self.overview.robots[robot].name, engine));
        match self.overview.engine(engine).filter(|_| marked) {
            Some(engine) => format!("drawing-{robot}-{engine}"),
            None => format!("drawing-{robot}"),
        }
    }
}
