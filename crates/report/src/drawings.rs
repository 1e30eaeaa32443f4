//! The drawings of a run's robots on their pages. Bodies are marked that a row names which does not pass, or a section.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Drawing, RobotInfo, Row, RunInfo, Severity};
use maud::{Markup, html};

use crate::numbers::grouped;
use crate::overview::Overview;
use crate::robot::drawn;
use crate::section::Section;

/// The drawings of a run.
pub struct Drawings<'a> {
    run: &'a RunInfo,
    /// The words of the run.
    pub overview: &'a Overview<'a>,
    /// The bodies that are marked, by robot and engine.
    marks: BTreeMap<(&'a str, &'a str), BTreeSet<String>>,
}

impl<'a> Drawings<'a> {
    /// Collects what is marked.
    pub fn of(run: &'a RunInfo, rows: &'a [Row], overview: &'a Overview, sections: &'a [Section]) -> Self {
        let mut marks: BTreeMap<(&str, &str), BTreeSet<String>> = BTreeMap::new();
        for row in rows.iter().filter(|row| !row.body.is_empty() && Severity::of(row).is_some()) {
            marks.entry((&row.robot, &row.engine)).or_default().insert(row.body.clone());
        }
        for mark in sections.iter().flat_map(|section| &section.marks) {
            marks.entry((&mark.robot, &mark.engine)).or_default().insert(mark.body.clone());
        }
        Self { run, overview, marks }
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
}
