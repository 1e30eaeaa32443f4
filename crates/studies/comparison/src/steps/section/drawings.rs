//! The section's drawings, robot by robot: errors of accelerations on the left, drift of the energy on the right.

use super::{STUDY, StepLine};
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Point, Rows, Series, Style};
use featherbench_report::{Overview, Part, labels, robot_chunk};
use featherbench_study::figures::{drawing, errors, joined, point, told, with_exponent};
use maud::{Markup, html};

/// The drawings of all robots; the opening one is shown first.
pub(super) fn drawings(overview: &Overview, lines: &[StepLine], robots: &[usize], opening: usize) -> (Markup, Vec<Part>) {
    let of = |&robot: &usize| {
        let pair = html! {
            div.pair {
                (drawn(overview, lines, robot, false, "steps-plot", "Error of the acceleration against the step", "relative error of the acceleration"))
                (drawn(overview, lines, robot, true, "drift-plot", "Drift of the energy against the step", "relative drift of the energy"))
            }
        };
        (vec![robot.to_string()], pair)
    };
    let options = robots.iter().map(|&robot| (robot.to_string(), overview.robots[robot].name.to_owned())).collect();
    let lists = vec![List { id: "steps-robot", label: "Robot", options }];
    let drawings = robots.iter().map(of).collect();
    Choices { name: "steps-choices", title: "Steps of robots", lists, opening: vec![opening.to_string()], drawings }.made()
}

/// The lines of a robot: a colour for each method, a dash and a mark for each kind of state.
fn drawn(overview: &Overview, lines: &[StepLine], robot: usize, energy: bool, name: &str, title: &str, upwards: &str) -> Markup {
    let place = |known: &[&str], word: &str| known.iter().position(|other| *other == word).unwrap_or(0);
    let (mut methods, mut cases): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for line in lines {
        if !methods.contains(&line.method) {
            methods.push(line.method);
        }
        if !cases.contains(&line.case) {
            cases.push(line.case);
        }
    }
    let of = |line: &StepLine| {
        let rows = Some(Rows::of(robot_chunk(robot), overview.robots[robot].name, &[("study", STUDY), ("method", line.method)]));
        let points = line.points.iter().map(|&(dt, error)| Point {
            rows: rows.clone(),
            ..point(&format!("dt = {} s", told(dt)), dt, error, [format!("error {}", told(error))])
        });
        let case = place(&cases, line.case);
        let label = with_exponent(joined(&[overview.engines[line.engine], labels::method(line.method), line.case]), line.order, 3);
        let style = Style::nth(case).coloured(place(&methods, line.method));
        Series { dash: case, ..Series::new(label, style, points.collect()) }
    };
    let series: Vec<Series> = lines.iter().filter(|line| line.robot == robot && line.energy == energy).map(of).collect();
    if series.is_empty() {
        return html! { p.empty { "This engine's energy is not comparable here." } };
    }
    let title = format!("{title}, {}", overview.robots[robot].name);
    drawing(name, &title, Axis::log("step dt, s"), errors(upwards), series)
}
