//! Section: problems with loops, contacts and events whose answers are known.

mod drawings;

use super::STUDY;
use crate::scenes::section::views;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use featherbench_study::known::{beside, defined_by, passed, table};
use featherbench_study::rows_of;
use maud::{Markup, html};
use serde::Deserialize;

/// Of each method: its name, and of each problem its name, iterations and a value.
type Lines<'a> = Vec<(&'a str, Vec<(&'a str, f64, f64)>)>;

/// What the section draws.
struct Figures<'a> {
    /// Of each shape of the cone: its name, and heading (°) with the friction felt over that of the round cone.
    felt: Vec<(&'a str, Vec<(f64, f64)>)>,
    /// Of each angle of Painlevé's rod, °: the rate where the number of forces changes, rad/s, and that number below and above.
    existence: Vec<[f64; 4]>,
    /// First-order solvers: fitted over predicted rate less one.
    rates: Lines<'a>,
    /// All solvers: the residual of the natural map.
    accuracy: Lines<'a>,
}

/// What the rows of a quantity are about, in the order of the table.
const QUANTITIES: [(&str, &str); 17] = [
    ("contact_solution", "contact problems: existence and the laws"),
    ("contact_quantity", "contact problems: closed forms"),
    ("existence", "Painlevé's rod: how many forces there are"),
    ("contact_draws", "drawn contact problems"),
    ("felt_friction", "friction that a sliding body feels"),
    ("convergence", "rates of first-order solvers"),
    ("standing", "contact problems of robots that land and stand"),
    ("delassus", "Delassus matrices by three routes"),
    ("impact", "impact laws"),
    ("mobility", "mobility of robots with loops"),
    ("loop_dynamics", "accelerations with loops"),
    ("loop_motion", "motions with loops"),
    ("event_time", "times of events"),
    ("saltation", "saltation matrices"),
    ("run_derivative", "derivatives of runs through events"),
    ("end_of_run", "how runs end"),
    ("penalty_law", "penalty limit law"),
];

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    vec![Section::new("contact", "Contact", body(&rows, &figures(&rows), &chunk))]
}

fn figures<'a>(rows: &[&'a Row]) -> Figures<'a> {
    Figures { felt: felt(rows), existence: existence(rows), rates: rates(rows), accuracy: accuracy(rows) }
}

/// The values of different methods, each with what `of` makes of its rows.
fn by_method<'a, X>(rows: &[&'a Row], quantity: &str, of: impl Fn(&'a Row) -> Option<X>) -> Vec<(&'a str, Vec<X>)> {
    let rows: Vec<&&Row> = rows.iter().filter(|row| row.quantity == quantity).collect();
    let mut methods: Vec<&str> = Vec::new();
    for row in &rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let lines =
        methods.into_iter().map(|method| (method, rows.iter().filter(|row| row.method == method).filter_map(|row| of(row)).collect()));
    lines.filter(|(_, points): &(&str, Vec<X>)| !points.is_empty()).collect()
}

/// Of friction that is felt: the shape of the cone, and the heading, rad.
#[derive(Deserialize)]
struct Felt {
    heading: f64,
    section: String,
}

/// Of Painlevé's rod: its angle, rad.
#[derive(Deserialize)]
struct Rod {
    angle: f64,
}

fn felt<'a>(rows: &[&'a Row]) -> Vec<(&'a str, Vec<(f64, f64)>)> {
    ["round", "inscribed", "box"]
        .into_iter()
        .map(|section| {
            let of = |row: &&&Row| row.quantity == "felt_friction" && row.metric == "over_cone";
            let point = |row: &&Row| {
                let felt: Felt = defined_by(row)?;
                (felt.section == section).then_some((felt.heading.to_degrees(), row.value?))
            };
            (section, rows.iter().filter(of).filter_map(point).collect())
        })
        .collect()
}

/// The map of Painlevé's rod by rising angle.
fn existence(rows: &[&Row]) -> Vec<[f64; 4]> {
    let of = |row: &&Row| {
        (row.quantity == "existence" && row.metric == "critical_rate").then_some(())?;
        let rod: Rod = defined_by(row)?;
        Some([rod.angle.to_degrees(), row.value?, beside(rows, row, "forces_below")?, beside(rows, row, "forces_above")?])
    };
    let mut angles: Vec<[f64; 4]> = rows.iter().filter_map(of).collect();
    angles.sort_by(|a, b| a[0].total_cmp(&b[0]));
    angles
}

fn rates<'a>(rows: &[&'a Row]) -> Lines<'a> {
    by_method(rows, "convergence", |row| {
        (row.metric == "fitted_rate_error").then_some(())?;
        Some((row.family.as_str(), beside(rows, row, "iterations")?, row.value?))
    })
}

fn accuracy<'a>(rows: &[&'a Row]) -> Lines<'a> {
    by_method(rows, "contact_solution", |row| {
        (row.metric == "natural_map").then_some(())?;
        Some((row.family.as_str(), beside(rows, row, "iterations")?, row.value?))
    })
}

/// The solvers that answer with impulses where no solution exists, and those that say that there is none.
fn of_none<'a>(rows: &[&'a Row]) -> (Vec<&'a str>, Vec<&'a str>) {
    let none = rows.iter().filter(|row| row.family == "painleve_none" && row.metric == "answers");
    let (silent, answering): (Vec<&&Row>, Vec<&&Row>) = none.partition(|row| row.value == Some(0.0));
    let names = |rows: Vec<&&'a Row>| rows.into_iter().map(|row| row.method.as_str()).collect();
    (names(answering), names(silent))
}

fn body(rows: &[&Row], figures: &Figures, chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let (answering, silent) = of_none(rows);
    html! {
        section #contact {
            h2 { "Loops, contact and events" }
            p.lead { b { (passed) " of " (judged) " known numbers are reproduced." } }
            ul {
                @if !silent.is_empty() || !answering.is_empty() {
                    li {
                        "Where Painlevé's rod has no solution, "
                        @if answering.is_empty() { "no solver gives a number" } @else { (answering.join(", ")) " give a number" }
                        "; " (silent.join(", ")) " give none."
                    }
                }
                li { "Residuals are those of Signorini's and Coulomb's laws, whatever model a solver has. Errors are against closed forms or a second route." }
            }
            div.pair {
                (drawings::accuracy(figures))
                (drawings::rates(figures))
            }
            div.pair {
                (drawings::existence(figures))
                (drawings::felt(figures))
            }
            (views())
            (table(STUDY, rows, &QUANTITIES, chunk))
        }
    }
}
