//! Section: rods, beams and strings whose answers are known.

mod drawings;

use super::STUDY;
use super::beams::Refinement;
use featherbench_bench::{OWN, params};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo, Verdict};
use featherbench_study::known::{beside, passed, table};
use featherbench_study::rows_of;
use maud::{Markup, html};
use std::collections::BTreeMap;

/// A line of a drawing.
struct Line<'a> {
    name: String,
    /// The engine, unless the line is that of a case.
    engine: Option<&'a str>,
    points: Vec<[f64; 2]>,
}

/// What the section draws.
struct Figures<'a> {
    /// Of each element and engine: the number of elements, and the magnitude of the tip's error at α = 1.
    tip: Vec<Line<'a>>,
    /// The same of the first frequency.
    frequency: Vec<Line<'a>>,
    /// Of each: nanoseconds of a forward dynamics, and the magnitude of the first frequency's error.
    cost: Vec<Line<'a>>,
    /// Points of the elastica under forces.
    elastica: Vec<Line<'a>>,
    /// Points of modes.
    modes: Vec<Line<'a>>,
    /// Points of the fingers of the gripper.
    gripper: Vec<Line<'a>>,
    /// Points of the arm with a cable.
    arm: Vec<Line<'a>>,
}

/// What the rows of a quantity are about, in the order of the table.
const QUANTITIES: [(&str, &str); 20] = [
    ("printed", "numbers that are in print, to their last digit"),
    ("beam_law", "one beam by every element: order and prefactor"),
    ("beam_agreement", "engines with the same element"),
    ("small_deflection", "small deflections: the closed law at every n"),
    ("deflection_law", "small deflections: order and prefactor"),
    ("elastica", "the elastica's table"),
    ("closed_circle", "an end moment closes a circle"),
    ("equilibria", "equilibria that are not on the branch from rest"),
    ("roots", "roots of the cantilever and of J₀"),
    ("ritz_frequencies", "frequencies of shape functions: closed forms"),
    ("ritz_error", "errors of more monomials"),
    ("string_frequencies", "strings of masses: Laguerre zeros"),
    ("string_law", "hanging strings: order and prefactor"),
    ("passivity", "M, K and D are those of a passive rod"),
    ("energy", "energy of damped runs"),
    ("momentum", "momentum of a free hub and of a flying rod"),
    ("clamped_limit", "a heavy hub is a wall"),
    ("stiff_limit", "a stiff rod is rigid"),
    ("shape", "shapes"),
    ("beam", "one beam by every element: errors and times"),
];

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    vec![Section::new("continuum", "Continua", body(&rows, &figures(&rows), &chunk))]
}

fn figures<'a>(rows: &[&'a Row]) -> Figures<'a> {
    Figures {
        tip: errors(rows, "tip_error_1", elements),
        frequency: errors(rows, "frequency_error_1", elements),
        cost: errors(rows, "frequency_error_1", |row| beside(rows, row, "forward_dynamics")),
        elastica: shapes(rows, "elastica"),
        modes: shapes(rows, "mode"),
        gripper: shapes(rows, "gripper"),
        arm: shapes(rows, "arm"),
    }
}

/// The number of elements of a row's rod.
fn elements(row: &Row) -> Option<f64> {
    params::of_row(row).map(|params: Refinement| params.elements as f64)
}

/// The name of an element, with the engine if it is not ours.
fn name(row: &Row) -> String {
    if row.engine == OWN { row.method.clone() } else { format!("{}, {}", row.engine, row.method) }
}

/// Of each element a line: what `of` says of a row, and the magnitude of its value.
fn errors<'a>(rows: &[&'a Row], metric: &str, of: impl Fn(&Row) -> Option<f64>) -> Vec<Line<'a>> {
    let mut lines: Vec<Line> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == "beam" && row.metric == metric) {
        let (Some(x), Some(value)) = (of(row), row.value) else { continue };
        let name = name(row);
        match lines.iter_mut().find(|known| known.name == name) {
            Some(known) => known.points.push([x, value.abs()]),
            None => lines.push(Line { name, engine: Some(&row.engine), points: vec![[x, value.abs()]] }),
        }
    }
    lines
}

/// Of each case of shapes whose name begins so, its points.
fn shapes<'a>(rows: &[&Row], begin: &str) -> Vec<Line<'a>> {
    let mut lines: Vec<(String, BTreeMap<usize, [f64; 2]>)> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == "shape" && row.family.starts_with(begin)) {
        let place = |axis: &str| row.metric.strip_prefix(axis).and_then(|index| index.parse::<usize>().ok());
        let (Some(value), Some((index, axis))) = (row.value, place("x_").map(|k| (k, 0)).or(place("y_").map(|k| (k, 1)))) else { continue };
        if lines.last().is_none_or(|(known, _)| *known != row.family) {
            lines.push((row.family.clone(), BTreeMap::new()));
        }
        if let Some((_, points)) = lines.last_mut() {
            points.entry(index).or_insert([f64::NAN; 2])[axis] = value;
        }
    }
    lines.into_iter().map(|(name, points)| Line { name, engine: None, points: points.into_values().collect() }).collect()
}

/// The element with the smallest error of the first frequency at 16 elements or fewer, and the error.
fn best(rows: &[&Row]) -> Option<(String, f64)> {
    let of = |row: &&&Row| row.quantity == "beam" && row.metric == "frequency_error_1" && elements(row) == Some(16.0);
    let found = rows.iter().filter(of).filter_map(|row| Some((name(row), row.value?.abs())));
    found.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Of the stiff limit: in how many cases 1e-10 is within reach, and in how many it is not.
fn reach(rows: &[&Row]) -> [usize; 2] {
    [1.0, 0.0].map(|value| rows.iter().filter(|row| row.metric == "within_reach" && row.value == Some(value)).count())
}

/// The engines that are not there, as their rows say.
fn missing<'a>(rows: &[&'a Row]) -> Vec<&'a str> {
    rows.iter()
        .filter(|row| row.quantity == "beam" && row.verdict == Verdict::Info && row.value.is_none())
        .map(|row| row.reason.as_str())
        .collect()
}

fn body(rows: &[&Row], figures: &Figures, chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let [within, beyond] = reach(rows);
    let agreement = rows.iter().filter(|row| row.quantity == "beam_agreement").filter_map(|row| Some((name(row), row.value?)));
    html! {
        section #continuum {
            h2 { "Continua" }
            p.lead { b { (passed) " of " (judged) " known numbers of rods, beams and strings are reproduced." } }
            ul {
                @if let Some((element, missed)) = best(rows) {
                    li { "With 16 elements, the first frequency of a cantilever is nearest with " (element) ": " (short(missed)) " of it." }
                }
                @for (engine, apart) in agreement {
                    li { "Tips of " (engine) " are those of our element of the same kind, and frequencies of hinge chains are too: to " (short(apart)) "." }
                }
                @if within + beyond > 0 {
                    li {
                        "A stiff rod has the accelerations of the rigid tree to 1e-10 where it can: in " (within) " of " (within + beyond)
                        " cases. In the others its deflection or the rounding of K x is larger."
                    }
                }
                li { "A collocation basis is not passive: its mass matrix has a negative eigenvalue." }
                @for reason in missing(rows) { li { (reason) } }
            }
            div.pair {
                (drawings::refined("continuum-tip", &figures.tip, "error of the tip at F L²/EI = 1"))
                (drawings::refined("continuum-frequency", &figures.frequency, "error of the first frequency"))
            }
            div.pair {
                (drawings::cost(&figures.cost))
                (drawings::shapes("continuum-modes", "Shapes of the first three modes", &figures.modes, ["x / L", "deflection"]))
            }
            div.pair {
                (drawings::shapes("continuum-elastica", "Shapes of a cantilever under forces at its tip", &figures.elastica, ["x / L", "y / L"]))
                (drawings::shapes("continuum-gripper", "Shapes of the fingers of a gripper that closes", &figures.gripper, ["x, m", "z, m"]))
            }
            (drawings::shapes("continuum-arm", "Shapes of an arm that falls with a cable at its end", &figures.arm, ["x, m", "z, m"]))
            p.note {
                "The time is that of one forward dynamics of the rod. Times of engines that are called from Python include the call. "
                "Links with springs are served by the articulated-body algorithm; the other elements of ours factorize M."
            }
            (table(STUDY, rows, &QUANTITIES, chunk))
        }
    }
}
