//! Section: the engines' imports of the robots' own files, as a matrix of robots and engines, and the number of differences by cause.

use super::opening::opening;
use std::collections::BTreeMap;

use featherbench_report::numbers::{count, larger, short};
use featherbench_report::{Mark, Overview, Section, robot, robot_chunk};
use featherbench_results::{Drawing, Row, RunInfo, Verdict};
use maud::{Markup, html};
use serde_json::Value;

/// The study's name in rows, and the quantity of an import.
const STUDY: &str = "import";

/// Robots that the section draws itself, as a comparison has them.
const DRAWN: usize = 8;

/// The result of one robot in one engine.
#[derive(Default)]
struct Cell<'a> {
    /// The row that counts the differences, or says why there is no import.
    read: Option<&'a Row>,
    /// The row that counts the parts that the differences do not explain.
    unexplained: Option<&'a Row>,
    /// The largest error of inverse dynamics and mass matrix of the imported robot, against the reference import.
    error: Option<f64>,
}

/// The effect of rounding, if a run's rows do not give it.
const SHALLOW: f64 = 1e-12;

impl Cell<'_> {
    /// The effect of rounding on M and inverse dynamics of this robot. The study gives it beside its replay, as it grows with the depth.
    fn bound(&self) -> f64 {
        let said = self.unexplained.and_then(|row| serde_json::from_str::<Value>(&row.params).ok()?["gate"].as_f64());
        said.unwrap_or(SHALLOW)
    }

    /// Whether the answers about the imported robot are those of the reference, and nothing that was taken out of both changes the physics. A
    /// NaN is not.
    fn agrees(&self) -> Option<bool> {
        self.error.map(|error| error <= self.bound() && self.params()["physics"].as_u64().unwrap_or(0) == 0)
    }

    /// The parameters of its import.
    fn params(&self) -> Value {
        self.read.and_then(|row| serde_json::from_str(&row.params).ok()).unwrap_or_default()
    }
}

/// The data of the section.
struct Imports<'a> {
    engines: Vec<usize>,
    robots: Vec<usize>,
    cells: BTreeMap<(usize, usize), Cell<'a>>,
    /// Cause and field → engine → how many.
    causes: BTreeMap<(String, String), BTreeMap<usize, usize>>,
}

impl<'a> Imports<'a> {
    /// Collects the rows of imports.
    fn of(overview: &Overview, rows: &'a [Row]) -> Self {
        let mut imports = Self { engines: Vec::new(), robots: Vec::new(), cells: BTreeMap::new(), causes: BTreeMap::new() };
        for row in rows.iter().filter(|row| row.study == STUDY) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            if !imports.robots.contains(&robot) {
                imports.robots.push(robot);
            }
            if !imports.engines.contains(&engine) {
                imports.engines.push(engine);
            }
            let cell = imports.cells.entry((robot, engine)).or_default();
            match row.metric.as_str() {
                "differences" if row.quantity == STUDY => cell.read = Some(row),
                "unexplained" => cell.unexplained = Some(row),
                "as_read" => cell.error = row.value.map(|value| larger(cell.error.unwrap_or(0.0), value)).or(cell.error),
                "difference" => {
                    let params: Value = serde_json::from_str(&row.params).unwrap_or_default();
                    let cause = params["cause"].as_str().unwrap_or_default().to_owned();
                    *imports.causes.entry((cause, row.quantity.clone())).or_default().entry(engine).or_default() += 1;
                }
                _ => {}
            }
        }
        imports.engines.sort_unstable();
        imports
    }
}

/// Makes the section, if the run has imports.
pub(crate) fn sections<'a>(run: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let imports = Imports::of(overview, rows);
    if imports.robots.is_empty() {
        return Vec::new();
    }
    let (script, style) = (include_str!("section.js"), include_str!("section.css"));
    let (answer, part) = opening(overview, rows);
    let (parts, marks) = (part.into_iter().collect(), marks(rows));
    let body = body(run, overview, &imports, &marks);
    vec![Section { script, style, answer: Some(answer), parts, marks, ..Section::new("import", "Imports", body) }]
}

fn body(run: &RunInfo, overview: &Overview, imports: &Imports, marks: &[Mark]) -> Markup {
    html! {
        section #import {
            h2 { "How engines read it" }
            p.lead {
                "Every engine's own parser reads the robot's file, and what it then holds is compared body by body with the reference: "
                "our import of URDF, that of MuJoCo's compiler of MJCF. That is another question than whether engines compute alike from "
                "one model. A number counts the differences that a simulation feels; click it to see them with their causes."
            }
            div.scroll { (summary(overview, imports)) }
            div.scroll.tall { (matrix(overview, imports)) }
            p.note {
                span.key.d0 { "✓" } " alike, "
                span.key.d2 { "n" } " differences, of which nothing enters M or inverse dynamics beyond rounding (1e-12, and 1e-14 per joint of a chain beyond a hundred), "
                span.key.d5 { "n" } " differences that do, "
                "– not read, "
                span.key.unexplained { "?" } " answers that the differences do not explain. "
                "The answers are replayed: the engine computes with what it read, our kernels with what it says to have read."
            }
            (robots(run, overview, imports, marks))
            div #import-details role="region" aria-live="polite" tabindex="-1" {}
            h3 { "Causes" }
            (causes(overview, imports))
            (told(overview, imports))
        }
    }
}

/// The causes of notes on what a file says and no compared quantity has.
const BESIDE: [&str; 7] =
    ["not_compared", "tendon_armature", "actuator_armature", "free_armature", "bad_value", "mimic", "mimic_otherwise"];

/// What the files say beside what is compared, by name.
fn told(overview: &Overview, imports: &Imports) -> Markup {
    let mut lines: BTreeMap<(usize, String), Vec<&str>> = BTreeMap::new();
    for (&(robot, engine), cell) in &imports.cells {
        for note in cell.params()["notes"].as_array().into_iter().flatten().filter(|note| BESIDE.iter().any(|word| note["cause"] == *word))
        {
            let about = note["about"].as_str().map_or_else(String::new, |about| format!("{about}: "));
            let text = format!("{about}{}", note["text"].as_str().unwrap_or_default());
            lines.entry((robot, text)).or_default().push(overview.engines[engine]);
        }
    }
    html! {
        @if !lines.is_empty() {
            details #import-told {
                summary { "What the files say that is not compared, or is taken out of both sides" }
                div.scroll.tall { table.compact { tbody { @for ((robot, text), engines) in &lines {
                    tr { th scope="row" { (overview.robots[*robot].name) } td { (text) } td { (engines.join(", ")) } }
                } } } }
            }
        }
    }
}

/// The bodies in which a difference changes the physics.
fn marks(rows: &[Row]) -> Vec<Mark> {
    let differs = |row: &&Row| {
        let class = || serde_json::from_str::<Value>(&row.params).ok()?["class"].as_str().map(str::to_owned);
        row.study == STUDY && row.metric == "difference" && class().as_deref() == Some("physics")
    };
    let mark = |row: &Row| Mark { robot: row.robot.clone(), engine: row.engine.clone(), body: row.body.clone() };
    rows.iter().filter(differs).map(mark).collect()
}

/// The robots of a comparison. Of many robots, as a suite has them, each is drawn on its own page alone.
fn robots(run: &RunInfo, overview: &Overview, imports: &Imports, marks: &[Mark]) -> Markup {
    let names = imports.robots.iter().map(|&robot| overview.robots[robot].name);
    let drawn: Vec<(&str, &Drawing)> = names.filter_map(|name| Some((name, run.drawings.get(name)?))).collect();
    let marked = |robot: &str| marks.iter().filter(|mark| mark.robot == robot).map(|mark| mark.body.clone()).collect();
    html! {
        @if drawn.len() > DRAWN {
            p.note { "Each robot is drawn on its page, to which its name leads." }
        } @else if !drawn.is_empty() {
            div.robots { @for (name, drawing) in drawn { (robot::drawn(name, drawing, &marked(name), "the physics differs")) } }
        }
    }
}

fn summary(overview: &Overview, imports: &Imports) -> Markup {
    let of = |engine: usize| imports.cells.iter().filter(move |((_, e), _)| *e == engine).map(|(_, cell)| cell);
    let value = |cell: &Cell| cell.read.and_then(|row| row.value);
    html! {
        table.compact {
            thead {
                tr {
                    th scope="col" { "engine" } th.number scope="col" { "files read" } th.number scope="col" { "alike" }
                    th.number scope="col" { "M and inverse dynamics within rounding" } th.number scope="col" { "not read" } th.number scope="col" { "unexplained" }
                }
            }
            tbody {
                @for &engine in &imports.engines {
                    tr {
                        th scope="row" { (overview.engines[engine]) }
                        td.number { (of(engine).filter(|cell| value(cell).is_some()).count()) }
                        td.number { (of(engine).filter(|cell| value(cell) == Some(0.0)).count()) }
                        td.number { (of(engine).filter(|cell| cell.agrees() == Some(true)).count()) }
                        td.number { (of(engine).filter(|cell| value(cell).is_none()).count()) }
                        td.number { (of(engine).filter(|cell| unexplained(cell)).count()) }
                    }
                }
            }
        }
    }
}

fn matrix(overview: &Overview, imports: &Imports) -> Markup {
    html! {
        table.compact.imports {
            thead { tr { th scope="col" { "robot" } @for &engine in &imports.engines { th.number scope="col" { (overview.engines[engine]) } } } }
            tbody {
                @for &robot in &imports.robots {
                    tr {
                        th scope="row" { (featherbench_report::robot(overview, overview.robots[robot].name)) }
                        @for &engine in &imports.engines {
                            @match imports.cells.get(&(robot, engine)) {
                                Some(cell) => (entry(overview, robot, engine, cell)),
                                None => td.number {},
                            }
                        }
                    }
                }
            }
        }
    }
}

fn entry(overview: &Overview, robot: usize, engine: usize, cell: &Cell) -> Markup {
    let read = cell.read.and_then(|row| row.value);
    let text = match read {
        Some(0.0) => "✓".to_owned(),
        Some(many) => format!("{many}"),
        None => "–".to_owned(),
    };
    let class = match (read, cell.agrees()) {
        (None, _) => "none",
        (Some(0.0), Some(true)) => "d0",
        (_, Some(true)) => "d2",
        _ => "d5",
    };
    let about = match (read, cell.error, cell.read) {
        (None, _, Some(row)) => row.reason.clone(),
        (_, Some(error), _) => format!("M or inverse dynamics off by {}", short(error)),
        _ => String::new(),
    };
    html! {
        td class={ "number " (class) } title=(about) {
            button.open type="button" data-import=(robot_chunk(robot)) data-engine=(overview.engines[engine]) {
                (text) @if unexplained(cell) { span.unexplained { "?" } }
            }
        }
    }
}

/// Whether the differences do not explain the engine's answers, or that is not known.
fn unexplained(cell: &Cell) -> bool {
    cell.unexplained.is_some_and(|row| row.verdict == Verdict::Error || row.value.is_some_and(|value| value > 0.0))
}

fn causes(overview: &Overview, imports: &Imports) -> Markup {
    if imports.causes.is_empty() {
        return html! { p.empty { "There is no difference." } };
    }
    html! {
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "cause" } th scope="col" { "field" }
                        @for &engine in &imports.engines { th.number scope="col" { (overview.engines[engine]) } }
                    }
                }
                tbody {
                    @for ((cause, field), engines) in &imports.causes {
                        tr {
                            td { (phrase(cause)) }
                            td { (field.replace('_', " ")) }
                            @for engine in &imports.engines { td.number { @if let Some(many) = engines.get(engine) { (many) } } }
                        }
                    }
                }
            }
        }
        p.note { (count(imports.causes.values().flat_map(BTreeMap::values).sum(), "difference")) " in all, those included that are information only." }
    }
}

/// The cause of a difference between two import results, as a phrase; an unknown cause is its own phrase.
fn phrase(name: &str) -> &str {
    match name {
        "number" => "another number",
        "inertial_rotation_lost" => "the rotation of the inertial frame was lost",
        "inertial_rotation_applied" => "a rotation of the inertial frame was applied",
        "inertia_turned" => "the same principal moments about other axes",
        "flipped" => "the axis points the other way",
        "unit" => "another unit: a factor of a thousand or its square",
        "degrees" => "degrees for radians",
        "order" => "another order of the joints",
        "merged" => "fixed to its parent, mass included",
        "dropped" => "dropped, mass included",
        "added" => "a body that the reference does not have",
        "default_inertia" => "the engine's own inertia of a link that has none in the file: 1 kg and 1 kg·m²",
        "com_sign" => "the sign of the centre of mass",
        "off_diagonals" => "products of inertia left out",
        "about_origin" => "inertia about the link's origin, or about the centre of mass, taken for the other",
        "transposed" => "the transpose of the rotation",
        "planar_axis" => "the axis of a planar joint ignored",
        "euler_sequence" => "Euler angles in another sequence than the file's",
        "gravity_ignored" => "the file's gravity is not read",
        "first_tree" => "only the first body of the world is read",
        "frame_skipped" => "a <frame> is skipped with all that is in it",
        "world_pose" => "the pose of a body that is fixed to the world is not read",
        "free_pose" => "the pose of a free body is undone by what is not its inverse",
        "inertia_groups" => "inertiagrouprange is not read",
        "joint_ref" => "the ref of joints is not read",
        "shell" => "shellinertia is not read",
        "classes" => "default classes are not read, or not in full",
        "inertial_ignored" => "inertials are not read",
        "first_compiler" => "only the first <compiler> is read",
        "axis_length" => "the axis of an axisangle is not made a unit vector",
        "not_a_rotation" => "it holds a matrix that is no rotation",
        "not_a_mass" => "it holds mass properties that no body has",
        "bounds" => "raised to the least mass or inertia that the engine takes",
        "balanced" => "impossible principal moments were made equal",
        "unphysical" => "an inertia that no body can have was replaced",
        "massless_link" => "the inertia of a fixed link without mass was left out",
        "total_mass" => "all masses have one factor: the total mass was set, or not",
        "between_joints" => "the pose of a link with several joints stands at another of them",
        "other_root" => "the floating base has the frame of another link of the root",
        "geometry" => "computed from the shape of the body at 1000 kg/m³",
        "edited" => "replaced by the parser, as it says itself",
        "mimic" => "the joint follows another one",
        "added_armature" => "the armature of a tendon or an actuator",
        "rotor_inertia" => "the inertia of an actuator's rotor times the gear ratio squared",
        "unsupported" => "not read",
        other => other,
    }
}
