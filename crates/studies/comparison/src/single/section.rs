//! Section: what single precision costs each robot, in units.

use std::collections::BTreeMap;

use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Quantity, Row, RunInfo};
use maud::{Markup, html};

/// The study's name in rows.
const STUDY: &str = "single";

/// What is told of an engine on a robot.
#[derive(Default)]
struct Told<'a> {
    torque: Measured<'a>,
    acceleration: Measured<'a>,
    drift: Option<&'a Row>,
}

/// A difference in units, over the largest answer, and over the conditioning bound.
#[derive(Default)]
struct Measured<'a> {
    off: Option<&'a Row>,
    share: Option<&'a Row>,
    bound: Option<&'a Row>,
}

impl<'a> Measured<'a> {
    /// Keeps a row, if it is of the engine's usual method: the first that comes.
    fn take(&mut self, row: &'a Row) {
        let place = match row.metric.as_str() {
            "off_share" => &mut self.share,
            "off_bound" => &mut self.bound,
            _ => &mut self.off,
        };
        place.get_or_insert(row);
    }
}

/// Makes the section, if the run has the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let mut told: BTreeMap<(usize, usize), Told> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY) {
        let robot = overview.robots.iter().position(|robot| robot.name == row.robot);
        let engine = overview.engines.iter().position(|engine| *engine == row.engine);
        let (Some(robot), Some(engine)) = (robot, engine) else { continue };
        let told = told.entry((robot, engine)).or_default();
        match Quantity::parse(&row.quantity) {
            Some(Quantity::InverseDynamics) => told.torque.take(row),
            Some(_) => told.acceleration.take(row),
            None => {
                told.drift.get_or_insert(row);
            }
        }
    }
    if told.is_empty() { Vec::new() } else { vec![Section::new("single", "Single precision", body(overview, &told))] }
}

fn body(overview: &Overview, told: &BTreeMap<(usize, usize), Told>) -> Markup {
    html! {
        section #single {
            h2 { "Is single precision good enough for this robot?" }
            p.lead {
                "The largest difference from our kernels in double precision, in units, over all states, joints and directions. In parentheses the share of the largest answer. "
                "Drift is the difference of two simulations of a second from rest, with the same 500 steps: only the accelerations are the engine's."
            }
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "robot" } th scope="col" { "engine" } th.number scope="col" { "torque, N m" }
                            th.number scope="col" { "acceleration, rad/s²" } th.number scope="col" { "of the conditioning bound" } th.number scope="col" { "drift after 1 s, rad" }
                        }
                    }
                    tbody {
                        @for ((robot, engine), told) in told {
                            tr {
                                th scope="row" { (overview.robots[*robot].name) }
                                td { (overview.engines[*engine]) }
                                (measured(&told.torque))
                                (measured(&told.acceleration))
                                (cell(told.acceleration.bound))
                                (cell(told.drift))
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A difference with its share of the largest answer.
fn measured(of: &Measured) -> Markup {
    html! {
        td.number title=[of.off.filter(|row| row.value.is_none()).map(|row| row.reason.as_str())] {
            (number(of.off)) @if let Some(share) = of.share.and_then(|row| row.value) { " " small { "(" (short(share)) ")" } }
        }
    }
}

fn cell(row: Option<&Row>) -> Markup {
    html! { td.number title=[row.filter(|row| row.value.is_none()).map(|row| row.reason.as_str())] { (number(row)) } }
}

fn number(row: Option<&Row>) -> String {
    row.and_then(|row| row.value).map_or_else(|| "–".to_owned(), short)
}
