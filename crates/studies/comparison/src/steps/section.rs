//! Section: the limit of small steps: how the acceleration of a step approaches the true one, and how steps change the energy.

mod drawings;

use std::collections::BTreeMap;

use super::Step;
use featherbench_bench::params;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, labels, opener, robot_chunk};
use featherbench_results::{Row, RunInfo, Verdict};
use maud::{Markup, html};

/// The study's name in rows.
const STUDY: &str = "steps";

/// Errors of one engine's method to step on one robot.
#[derive(Debug)]
pub struct StepLine<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method to step.
    pub method: &'a str,
    /// The kind of state.
    pub case: &'a str,
    /// Whether the error is that of the energy, not of the acceleration.
    pub energy: bool,
    /// Step in seconds and error, the longest step first.
    pub points: Vec<(f64, f64)>,
    /// The fitted order, if the run has it.
    pub order: Option<f64>,
    /// The verdict on the order.
    verdict: Option<Verdict>,
}

/// Collects a run's rows.
fn lines<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<StepLine<'a>> {
    let mut found: BTreeMap<(usize, usize, bool, &str, bool, &str), StepLine> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY) {
        let (Some(robot), Some(engine), Some(value)) = (overview.robot(&row.robot), overview.engine(&row.engine), row.value) else {
            continue;
        };
        let (energy, method, case) = (row.quantity == "kinetic_energy", row.method.as_str(), row.states.as_str());
        let line = found.entry((robot, engine, energy, method, case != "random", case)).or_insert_with(|| StepLine {
            robot,
            engine,
            method,
            case,
            energy,
            points: Vec::new(),
            order: None,
            verdict: None,
        });
        match row.metric.as_str() {
            "order" => line.order = Some(value),
            "order_off_one" => line.verdict = Some(row.verdict),
            _ => line.points.extend(params::of_row(row).map(|step: Step| (step.dt, value))),
        }
    }
    let mut lines: Vec<StepLine> = found.into_values().collect();
    for line in &mut lines {
        line.points.sort_by(|a, b| b.0.total_cmp(&a.0));
    }
    lines
}

/// Makes the section, if the run has steps.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let lines = lines(overview, rows);
    if lines.is_empty() {
        return Vec::new();
    }
    let mut robots: Vec<usize> = lines.iter().map(|line| line.robot).collect();
    robots.dedup();
    // The robot with the most lines, and of these the largest: it shows the most.
    let count = |robot: usize| lines.iter().filter(|line| line.robot == robot).count();
    let opening = robots.iter().copied().max_by_key(|&robot| (count(robot), overview.robots[robot].nv)).unwrap_or(0);
    let (drawn, parts) = drawings::drawings(overview, &lines, &robots, opening);
    vec![Section { parts, ..Section::new("steps", "Steps", body(overview, &lines, &drawn)) }]
}

fn body(overview: &Overview, lines: &[StepLine], drawn: &Markup) -> Markup {
    html! {
        section #steps {
            h2 { "Steps" }
            p.lead {
                "Engines that integrate answer with the acceleration of a step, the true one in the limit of small steps. Left: its error against the length of the step. "
                "Right: how far the energy drifts in a motion under gravity alone."
            }
            (drawn)
            div.scroll.tall {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "way to step" } th scope="col" { "states" } th scope="col" { "error of" }
                            th.number scope="col" { "longest step, s" } th.number scope="col" { "error there" } th.number scope="col" { "shortest step, s" } th.number scope="col" { "error there" }
                            th.number scope="col" { "order" }
                        }
                    }
                    tbody { @for line in lines { (row(overview, line)) } }
                }
            }
            p.note {
                "Errors of accelerations are relative, in the kinetic-energy norm, against our forward dynamics; drifts are over the sum of the magnitudes of the potential "
                "energy's terms. Orders are slopes by least squares over the straight part. With an engine's own damping the acceleration has another limit. "
                "Rapier's guard against added energy, from dt·|v| = 1e-3 on, may drop the implicit term: the acceleration is then the true one, and the error falls to rounding."
            }
        }
    }
}

fn row(overview: &Overview, line: &StepLine) -> Markup {
    let filters = [("study", STUDY), ("method", line.method)];
    html! {
        tr {
            th scope="row" { (opener(&robot_chunk(line.robot), &filters, overview.robots[line.robot].name)) }
            td { (overview.engines[line.engine]) }
            td { (line.method) }
            td { (line.case) }
            td { @if line.energy { "energy" } @else { "acceleration" } }
            @for end in [line.points.first(), line.points.last()] {
                td.number { @if let Some((dt, _)) = end { (format!("{dt:e}")) } }
                td.number { @if let Some((_, error)) = end { (short(*error)) } }
            }
            td.number {
                @if let Some(verdict) = line.verdict { span.badge.(verdict.as_str()) { (labels::glyph(verdict)) } " " }
                @if let Some(order) = line.order { (format!("{order:.4}")) }
            }
        }
    }
}
