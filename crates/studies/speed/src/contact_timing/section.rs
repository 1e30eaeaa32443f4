//! Section: how long solvers take for the contacts of standing robots.

use super::{OfRobot, STUDY, TARGET};
use featherbench_bench::{OWN, params};
use featherbench_report::figure::{Axis, Point};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, labels, opener};
use featherbench_results::{Row, RunInfo, Verdict};
use featherbench_spatial::{larger, smaller};
use featherbench_study::figures::{drawing, nth, point, told};
use featherbench_study::rows_of;
use maud::{Markup, html};

/// A time of a method on a robot.
struct Time<'a> {
    robot: &'a str,
    contacts: f64,
    engine: &'a str,
    method: &'a str,
    ns: f64,
    valid: bool,
    /// Over the reference's; none for the reference itself, and for an engine's own model.
    ratio: Option<f64>,
    /// Of an engine's own model: over the time of ours from M and J.
    own_ratio: Option<f64>,
    residual: Option<f64>,
    tolerance: Option<f64>,
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    let times = times(&rows);
    vec![Section::new("contact_timing", "Contact timing", body(&rows, &times, &chunk))]
}

fn times<'a>(rows: &[&'a Row]) -> Vec<Time<'a>> {
    let beside = |row: &Row, metric: &str| {
        let same =
            |other: &&&Row| other.cell == row.cell && other.engine == row.engine && other.method == row.method && other.metric == metric;
        rows.iter().find(same)?.value
    };
    let of = |row: &&'a Row| {
        (row.metric == "ns_per_call").then_some(())?;
        let params: OfRobot = params::of_row(row)?;
        Some(Time {
            robot: &row.family,
            contacts: params.contacts as f64,
            engine: &row.engine,
            method: &row.method,
            ns: row.value?,
            valid: row.valid,
            ratio: beside(row, "ratio"),
            own_ratio: beside(row, "own_model_ratio"),
            residual: beside(row, "residual"),
            tolerance: beside(row, "tolerance"),
        })
    };
    rows.iter().filter_map(of).collect()
}

/// Of each robot the best other engine's time over that of our sweeps.
fn best_others<'a>(times: &'a [Time]) -> Vec<(&'a str, &'a Time<'a>)> {
    let mut best: Vec<(&str, &Time)> = Vec::new();
    for time in times.iter().filter(|time| time.engine != OWN && time.valid && time.ratio.is_some()) {
        match best.iter_mut().find(|(robot, _)| *robot == time.robot) {
            Some((_, known)) if known.ns <= time.ns => {}
            Some((_, known)) => *known = time,
            None => best.push((time.robot, time)),
        }
    }
    best
}

/// Of each engine with a model of its own: its name, the least and the most of its fastest method's times over ours, and the least residual.
fn own_models<'a>(times: &'a [Time]) -> Vec<(&'a str, [f64; 2], f64)> {
    let mut fastest: Vec<(&str, &str, f64, f64)> = Vec::new();
    for time in times.iter().filter(|time| time.valid) {
        let (Some(ratio), Some(residual)) = (time.own_ratio, time.residual) else { continue };
        match fastest.iter_mut().find(|(engine, robot, ..)| *engine == time.engine && *robot == time.robot) {
            Some((.., least, known)) => (*least, *known) = (smaller(*least, ratio), smaller(*known, residual)),
            None => fastest.push((time.engine, time.robot, ratio, residual)),
        }
    }
    let mut models: Vec<(&str, [f64; 2], f64)> = Vec::new();
    for (engine, _, ratio, residual) in fastest {
        match models.iter_mut().find(|(known, ..)| *known == engine) {
            Some((_, ends, least)) => {
                *ends = [smaller(ends[0], ratio), larger(ends[1], ratio)];
                *least = smaller(*least, residual);
            }
            None => models.push((engine, [ratio; 2], residual)),
        }
    }
    models
}

fn body(rows: &[&Row], times: &[Time], chunk: &str) -> Markup {
    let best = best_others(times);
    let ratios: Vec<f64> = best.iter().filter_map(|(_, time)| time.ratio).collect();
    let ends = ratios.iter().copied().min_by(f64::total_cmp).zip(ratios.iter().copied().max_by(f64::total_cmp));
    let unreached: Vec<&&Row> = rows.iter().filter(|row| row.metric == "residual" && row.value.is_none()).collect();
    html! {
        section #contact_timing {
            h2 { "Contacts of standing robots in time" }
            p.lead {
                @match ends {
                    Some((least, most)) => b { "The fastest other solver takes " (short(least)) " to " (short(most)) " times as long as our block Gauss–Seidel." },
                    None => b { "No other engine was timed, or no time counts." },
                }
            }
            ul {
                li {
                    "Times are of answers with a natural-map residual of at most " (short(TARGET)) ", by the laws of Signorini and Coulomb; of an own "
                    "model, of velocities within " (short(TARGET)) " of its limit."
                }
                @for (engine, [least, most], residual) in own_models(times) {
                    li {
                        (engine) " answers by its own model of contact. Its fastest method takes " (short(least)) " to " (short(most))
                        " times as long as ours from M and J, and its residual by the laws is " (short(residual)) " at the least."
                    }
                }
                li { "Times of the sweeps and of other engines begin with G, b and memory prepared. Those of the other two methods of ours include preparation." }
            }
            @if !unreached.is_empty() {
                details {
                    summary { (unreached.len()) " solvers of a robot have no time, because their answers do not come as near as asked" }
                    ul { @for row in &unreached { li { (row.engine) " " (row.method) " on " (row.family) ": " (row.reason) "." } } }
                }
            }
            (drawn(times))
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "robot" } th scope="col" { "solver" } th.number scope="col" { "time, µs" }
                            th.number scope="col" { "over ours" } th.number scope="col" { "own model, over ours" }
                            th.number scope="col" { "tolerance" } th.number scope="col" { "residual" }
                        }
                    }
                    tbody { @for time in times { (line(time, chunk)) } }
                }
            }
        }
    }
}

/// The standing quadruped: times of solutions against its contacts.
fn drawn(times: &[Time]) -> Markup {
    let mut solvers: Vec<(String, Vec<Point>)> = Vec::new();
    for time in times.iter().filter(|time| time.robot.starts_with("quadruped")) {
        let (name, microseconds) = (format!("{} {}", time.engine, time.method), time.ns * 1e-3);
        let point = point(
            time.robot,
            time.contacts,
            microseconds,
            [format!("{} contacts", told(time.contacts)), format!("{} µs", told(microseconds))],
        );
        match solvers.iter_mut().find(|(known, _)| *known == name) {
            Some((_, points)) => points.push(point),
            None => solvers.push((name, vec![point])),
        }
    }
    let series = solvers.into_iter().enumerate().map(|(index, (name, points))| nth(index, name, points)).collect();
    let (x, y) = (Axis::log("contacts of the quadruped"), Axis::log("time of a solution, µs"));
    drawing("contact-times", "Solution times against contacts, per solver", x, y, series)
}

fn line(time: &Time, chunk: &str) -> Markup {
    let filter = [("study", STUDY), ("family", time.robot), ("engine", time.engine), ("method", time.method)];
    html! {
        tr {
            th scope="row" { (opener(chunk, &filter, time.robot)) }
            td { (time.engine) " " (time.method) }
            td.number { @if !time.valid { span class={ "badge " (Verdict::Skip) } { (labels::glyph(Verdict::Skip)) } " " } (short(time.ns * 1e-3)) }
            td.number { @if let Some(ratio) = time.ratio { (short(ratio)) } }
            td.number { @if let Some(ratio) = time.own_ratio { (short(ratio)) } }
            td.number { @if let Some(tolerance) = time.tolerance { (short(tolerance)) } }
            td.number { @if let Some(residual) = time.residual { (short(residual)) } }
        }
    }
}
