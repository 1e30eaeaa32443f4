//! Section: what engines make of scenes whose motion is known.

mod drawings;

use super::drawing::drawing;
use super::rows::Told;
use super::{BOUNCE, STUDY};
use featherbench_bench::{OWN, params};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, opener};
use featherbench_results::{Row, RunInfo, Verdict};
use featherbench_scenes::systems::{BoxOnBalls, BoxStack, Incline, Rod, Standing, Table};
use featherbench_scenes::{OwnSolver, Question, simulate};
use featherbench_study::rows_of;
use maud::{Markup, html};

/// A variant with its points.
#[derive(Clone)]
struct Line<'a> {
    engine: &'a str,
    method: String,
    points: Vec<(f64, f64)>,
}

/// Errors of a number of a scene over the steps.
struct Errors<'a> {
    question: String,
    lines: Vec<Line<'a>>,
}

/// What the section draws.
struct Figures<'a> {
    /// Heading, °, and the felt friction over μ; variants of an engine that feel alike are one line.
    rose: Vec<Line<'a>>,
    errors: Vec<Errors<'a>>,
    /// Of each way and stiffness: step, error of the derivative.
    bounce: Vec<Line<'a>>,
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    let figures = Figures { rose: rose(&rows), errors: errors(&rows), bounce: bounce(&rows) };
    let (questions, parts) = drawings::questions(&figures.errors);
    vec![Section { parts, ..Section::new("scenes", "Scenes", body(&rows, &figures, &questions, &chunk)) }]
}

/// The rows of a number at the finest step of its scene: the last of several.
fn finest<'a, 'b>(rows: &'b [&'a Row], quantity: &'b str, metric: &'b str) -> impl Iterator<Item = &'a Row> + 'b {
    let of: Vec<&'a Row> = rows.iter().filter(|row| row.quantity == quantity && row.metric == metric).copied().collect();
    let next: Vec<Option<String>> = of.iter().skip(1).map(|row| Some(row.cell.clone())).chain([None]).collect();
    of.into_iter().zip(next).filter(|(row, next)| next.as_ref() != Some(&row.cell)).map(|(row, _)| row)
}

fn rose<'a>(rows: &[&'a Row]) -> Vec<Line<'a>> {
    let mut lines: Vec<Line> = Vec::new();
    for row in finest(rows, "felt_friction", "value") {
        let heading = params::of_row(row).and_then(|told: Told| told.scene?["heading"].as_f64());
        let (Some(heading), Some(value)) = (heading, row.value) else { continue };
        let point = (heading.to_degrees(), value);
        match lines.iter_mut().find(|line| line.engine == row.engine && line.method == row.method) {
            Some(line) => line.points.push(point),
            None => lines.push(Line { engine: &row.engine, method: row.method.clone(), points: vec![point] }),
        }
    }
    // Variants of one engine that differ by less than the width of a line are drawn once.
    let mut groups: Vec<(Line, usize)> = Vec::new();
    for line in lines {
        let alike = |other: &Line| {
            other.engine == line.engine
                && other.points.len() == line.points.len()
                && other.points.iter().zip(&line.points).all(|(a, b)| (a.1 - b.1).abs() < 0.03)
        };
        match groups.iter_mut().find(|(other, _)| alike(other)) {
            Some((_, count)) => *count += 1,
            None => groups.push((line, 0)),
        }
    }
    let named = |(line, more): (Line<'a>, usize)| match more {
        0 => line,
        more => Line { method: format!("{} and {more} more", line.method), ..line },
    };
    groups.into_iter().map(named).collect()
}

/// Which numbers are plotted: a scene's own name where it has variants of it, and the number.
fn question_of(row: &Row) -> String {
    format!("{} · {}", row.family, row.quantity)
}

fn errors<'a>(rows: &[&'a Row]) -> Vec<Errors<'a>> {
    let mut found: Vec<Errors> = Vec::new();
    for row in rows.iter().filter(|row| row.metric == "error") {
        let (Some(Told { dt: Some(dt), .. }), Some(value)) = (params::of_row(row), row.value) else { continue };
        let question = question_of(row);
        let at = found.iter().position(|errors| errors.question == question).unwrap_or_else(|| {
            found.push(Errors { question, lines: Vec::new() });
            found.len() - 1
        });
        let lines = &mut found[at].lines;
        match lines.iter_mut().find(|line| line.engine == row.engine && line.method == row.method) {
            Some(line) => line.points.push((dt, value)),
            None => lines.push(Line { engine: &row.engine, method: row.method.clone(), points: vec![(dt, value)] }),
        }
    }
    found
}

fn bounce<'a>(rows: &[&'a Row]) -> Vec<Line<'a>> {
    let mut lines: Vec<Line> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == BOUNCE && row.metric == "derivative_error") {
        let Some(Told { dt: Some(dt), stiffness: Some(stiffness), .. }) = params::of_row(row) else { continue };
        let Some(value) = row.value else { continue };
        let method = format!("{}, k = {}", row.method, short(stiffness));
        match lines.iter_mut().find(|line| line.engine == row.engine && line.method == method) {
            Some(line) => line.points.push((dt, value)),
            None => lines.push(Line { engine: &row.engine, method, points: vec![(dt, value)] }),
        }
    }
    lines
}

/// "engine variant", and "engine variant 0.71" beside it.
fn named(row: &Row) -> String {
    format!("{} {}", row.engine, row.method)
}

fn valued(row: &Row) -> String {
    format!("{} {}", named(row), row.value.map_or_else(|| "–".into(), short))
}

/// The columns of the table: a scene, a number, and words.
const COLUMNS: [(&str, &str, &str); 16] = [
    ("incline_0", "felt_friction", "friction along x"),
    ("incline_45", "felt_friction", "friction at 45°"),
    ("incline_0", "lift", "lift of what slides, m"),
    ("incline_sticking", "creep", "creep of what sticks, m/s"),
    ("sliding_sphere", "rolling_speed", "speed of a rolling sphere"),
    ("sliding_sphere", "way", "its way"),
    ("box_on_balls", "box_acceleration", "box on balls"),
    ("stack_10", "load_error", "stack 10 : 1"),
    ("stack_1000", "load_error", "stack 1000 : 1"),
    ("boxes_10_1", "drift", "drift of ten boxes"),
    ("boxes_5_100", "load_error", "boxes 100 : 1"),
    ("rocking_block", "energy_ratio", "rocking block"),
    ("table", "wrench_error", "table"),
    ("standing_quadruped", "drift", "drift of a quadruped"),
    ("standing_humanoid", "wrench_error", "humanoid"),
    ("bouncing_ball", "felt_restitution", "restitution"),
];

fn body(rows: &[&Row], figures: &Figures, questions: &Markup, chunk: &str) -> Markup {
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let laws: Vec<&&Row> = rows.iter().filter(|row| row.metric == "law_error" && row.verdict == Verdict::Pass).collect();
    let diagonal: Vec<String> = figures.rose.iter().filter_map(|line| felt_at(line, 45.0)).collect();
    let lifted = largest(finest(rows, "lift", "value").filter(|row| row.family == "incline_0"), 3, 1e-4);
    let creeping = largest(finest(rows, "creep", "value"), 3, 1e-6);
    let tips: Vec<&Row> = finest(rows, "tip_slip", "value").collect();
    // A hundredth of the speed is what the tip has again after 20 ms at most.
    let stops = |row: &&&Row| row.value.is_some_and(|slip| slip.abs() < 0.01);
    let stopped = tips.iter().filter(stops).count();
    let slipping: Vec<String> = tips.iter().filter(|row| !stops(row)).map(|row| valued(row)).collect();
    let heavy = largest(finest(rows, "load_error", "error").filter(|row| row.family == "stack_1000"), 3, 1e-2);
    let created = largest(finest(rows, "energy_created", "error"), 3, 1e-6);
    let drifting = largest(finest(rows, "drift", "error").filter(|row| row.family.starts_with("standing")), 3, 1e-4);
    let derivative = rows.iter().filter(|row| row.quantity == BOUNCE && row.metric == "derivative_error" && row.engine != OWN);
    let (nearest, farthest) = ends(derivative.copied());
    html! {
        section #scenes {
            h2 { "Scenes" }
            p.lead {
                b { (count(Verdict::Pass)) " of " (count(Verdict::Pass) + count(Verdict::Fail)) " judged numbers are as known" }
                @if !laws.is_empty() { "; " (laws.len()) " of them are laws of other engines' contact models" } "."
            }
            ul {
                @if !diagonal.is_empty() { li { "Friction that a sled feels at 45° to the axes, over μ: " (diagonal.join("; ")) ". Coulomb's law says 1." } }
                @if !lifted.is_empty() { li { "What slides is lifted off level ground, mean height in m: " (lifted.join("; ")) ". A convex model asks for v" sub { "n" } " = μ|v" sub { "t" } "|." } }
                @if !creeping.is_empty() { li { "What should stick creeps, m/s: " (creeping.join("; ")) "." } }
                @if !heavy.is_empty() { li { "Below a ball of a thousand times the mass, error of the loads 0.4 s after the start: " (heavy.join("; ")) "." } }
                @if !created.is_empty() { li { "Stacks of boxes at rest gain energy, over that of the stack: " (created.join("; ")) "." } }
                @if !drifting.is_empty() { li { "A robot that stands and is pushed by a thirtieth of its weight drifts in 0.4 s, over its height: " (drifting.join("; ")) "." } }
                @if !tips.is_empty() {
                    li {
                        "Where no force obeys the laws, the tip of Painlevé's rod stops at once in " (stopped) " of " (tips.len()) " variants."
                        @if !slipping.is_empty() { " In the others it keeps, of its speed after 20 ms: " (slipping.join("; ")) "." }
                    }
                }
                @if let (Some(nearest), Some(farthest)) = (nearest, farthest) {
                    li { "Derivative through an elastic bounce, relative error: " (valued(nearest)) " at best, " (valued(farthest)) " at worst. Ours is exact to rounding." }
                }
            }
            (heat(rows, chunk))
            div.pair {
                (drawings::rose(&figures.rose))
                div { (questions) }
            }
            (drawings::bounce(&figures.bounce))
            (views())
        }
    }
}

/// "engine variant felt" at a heading.
fn felt_at(line: &Line, heading: f64) -> Option<String> {
    // Headings are multiples of 15°, up to rounding.
    let (_, felt) = line.points.iter().find(|point| (point.0 - heading).abs() < 1.0)?;
    Some(format!("{} {} {}", line.engine, line.method, short(*felt)))
}

/// The `count` largest values above a level, in words.
fn largest<'a>(rows: impl Iterator<Item = &'a Row>, count: usize, level: f64) -> Vec<String> {
    let mut rows: Vec<(&Row, f64)> = rows.filter_map(|row| Some((row, row.value?))).filter(|(_, value)| *value > level).collect();
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    rows.into_iter().take(count).map(|(row, _)| valued(row)).collect()
}

/// The rows with the smallest and the largest value.
fn ends<'a>(rows: impl Iterator<Item = &'a Row>) -> (Option<&'a Row>, Option<&'a Row>) {
    let mut rows: Vec<(&Row, f64)> = rows.filter_map(|row| Some((row, row.value?))).collect();
    rows.sort_by(|a, b| a.1.total_cmp(&b.1));
    (rows.first().map(|row| row.0), rows.last().map(|row| row.0))
}

/// Errors at the finest step: a line for each variant, a column for each question. Below an error stands the bias, where the step does not
/// remove it.
fn heat(rows: &[&Row], chunk: &str) -> Markup {
    let mut variants: Vec<(&str, &str)> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity != BOUNCE) {
        if !variants.contains(&(&row.engine, &row.method)) {
            variants.push((&row.engine, &row.method));
        }
    }
    let value = |engine: &str, method: &str, scene: &str, quantity: &str, metric: &str| {
        let same = |row: &&&Row| {
            row.engine == engine && row.method == method && row.family == scene && row.quantity == quantity && row.metric == metric
        };
        // By falling steps: the last is the finest.
        rows.iter().rfind(same)?.value
    };
    html! {
        div.scroll {
            table.compact {
                caption { "Errors at the finest step (1 ms; the block's: 0.2 ms) against rigid mechanics. A dot marks a bias: at least half of the error stays at dt → 0." }
                thead { tr { th scope="col" { "engine" } th scope="col" { "variant" } @for (_, _, words) in COLUMNS { th.number scope="col" { (words) } } } }
                tbody {
                    @for (engine, method) in variants {
                        tr {
                            th scope="row" { (opener(chunk, &[("study", STUDY), ("engine", engine), ("method", method)], engine)) }
                            td { (method) }
                            @for (scene, quantity, _) in COLUMNS {
                                @match value(engine, method, scene, quantity, "error") {
                                    None => td.number { "–" }
                                    Some(error) => {
                                        @let stays = value(engine, method, scene, quantity, "bias").is_some_and(|bias| error > 1e-9 && bias >= error / 2.0);
                                        td.number style=(shade(error)) { (short(error)) @if stays { " •" } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A darker ground for a larger error, by decades from 1e-6 to 1e-1.
fn shade(error: f64) -> String {
    let level = (error.max(1e-12).log10() + 6.0).clamp(0.0, 5.0).round();
    let ink = if level > 3.0 { "d-ink-far" } else { "d-ink" };
    format!("background: var(--d{level}); color: var(--{ink})")
}

/// Drawings of scenes, by our own step: also for the section of contact problems.
pub(crate) fn views() -> Markup {
    let shown: [(Question, &str); 6] = [
        (Table::default().question(), "A table whose load is not in the middle"),
        (Incline { heading: 0.0, ..Incline::sliding() }.question(), "A sled that slides: each force is on the side of its cone"),
        (BoxOnBalls::default().question(), "A box that is pulled over balls"),
        (Rod::default().question(), "Painlevé's rod after the impact without collision"),
        (BoxStack::default().question(), "A stack of boxes: each plane carries the weight above it"),
        (Standing::humanoid().question(), "A humanoid with locked joints on two feet, pushed; the point is its centre of mass"),
    ];
    html! {
        @for pair in shown.chunks(2) {
            div.pair {
                @for (question, caption) in pair {
                    // A scene that cannot be moved is not drawn; its rows say why.
                    @if let Ok(motion) = simulate(&question.scene, 2e-3, 5, 5, &mut OwnSolver::newton()) { (drawing(question, &motion, caption)) }
                }
            }
        }
        p.quiet { "Cones: friction. Arrows: forces of one step of ours, the longest to scale." }
    }
}
