//! Drawings of finite differences, robot by robot: the error of derivatives against their step, ID on the left, FD on the right.

use super::super::STUDY;
use super::lines::Line;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Point, Rows, Series, Style};
use featherbench_report::numbers::{larger, smaller};
use featherbench_report::{Overview, Part, labels, robot_chunk};
use featherbench_study::figures::{drawing, errors, joined, point, told};
use maud::{Markup, html};

/// The drawings of all robots; the opening one is shown first.
pub(super) fn drawings(overview: &Overview, lines: &[Line], robots: &[usize], opening: usize) -> (Markup, Vec<Part>) {
    let of = |&robot: &usize| {
        let pair = html! {
            div.pair {
                (drawn(overview, lines, robot, "id_", "derivatives-id", "median error of ∂ID"))
                (drawn(overview, lines, robot, "fd_", "derivatives-fd", "median error of ∂FD"))
            }
        };
        (vec![robot.to_string()], pair)
    };
    let options = robots.iter().map(|&robot| (robot.to_string(), overview.robots[robot].name.to_owned())).collect();
    let lists = vec![List { id: "derivatives-robot", label: "Robot", options }];
    let drawings = robots.iter().map(of).collect();
    Choices { name: "derivatives-choices", title: "Finite differences of robots", lists, opening: vec![opening.to_string()], drawings }
        .made()
}

/// The lines of a robot: a colour for each method, a dash and a mark for each of two quantities.
fn drawn(overview: &Overview, lines: &[Line], robot: usize, prefix: &str, name: &str, upwards: &str) -> Markup {
    let (mut methods, mut quantities): (Vec<(usize, &str)>, Vec<&str>) = (Vec::new(), Vec::new());
    for line in lines {
        if !methods.contains(&(line.engine, line.method)) {
            methods.push((line.engine, line.method));
        }
        if !quantities.contains(&line.quantity) {
            quantities.push(line.quantity);
        }
    }
    let steps = || lines.iter().flat_map(|line| &line.points).filter_map(|(eps, _)| *eps);
    let ends = [steps().fold(0.0, larger), steps().fold(f64::INFINITY, smaller)];
    let of = |line: &Line| {
        let filters = [("study", STUDY), ("engine", overview.engines[line.engine]), ("quantity", line.quantity)];
        let rows = Some(Rows::of(robot_chunk(robot), overview.robots[robot].name, &filters));
        let at = |eps: f64, words: String, error: f64| Point {
            rows: rows.clone(),
            ..point(&words, eps, error, [format!("error {}", told(error))])
        };
        // What has no step is a level line.
        let points = line.points.iter().flat_map(|&(eps, error)| match eps {
            Some(eps) => vec![at(eps, format!("step {}", told(eps)), error)],
            None => ends.map(|eps| at(eps, "no differences".into(), error)).into(),
        });
        let method = methods.iter().position(|known| *known == (line.engine, line.method)).unwrap_or(0);
        let quantity = quantities.iter().position(|known| *known == line.quantity).unwrap_or(0) % 2;
        let label = joined(&[overview.engines[line.engine], labels::method(line.method), line.title]);
        Series { dash: quantity, ..Series::new(label, Style::nth(quantity).coloured(method), points.collect()) }
    };
    let series: Vec<Series> = lines.iter().filter(|line| line.robot == robot && line.quantity.starts_with(prefix)).map(of).collect();
    if series.is_empty() {
        return html! { p.empty { "No finite differences of this robot." } };
    }
    let title = format!("Error of derivatives against the step of differences, {}", overview.robots[robot].name);
    drawing(name, &title, Axis::log("step of the differences"), errors(upwards), series)
}
