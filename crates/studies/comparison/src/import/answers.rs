//! The answer of a comparison for each robot and engine, in one line: a pure function of the rows.
//!
//! Four questions:
//!
//! - Does the engine load the file as it is written?
//! - Has what it loaded the reference's M and τ?
//! - Which body changed M or τ most?
//! - What can be done about it?

use super::{Precision, bound};
use featherbench_bench::measure::worst;
use featherbench_results::{Row, Verdict};
use serde::Serialize;
use serde_json::Value;

/// The causes of notes that say that the file was repaired before the engine loaded it.
const REPAIRS: [&str; 3] = ["balanceinertia", "bounds", "geometry_dropped"];

/// Whether an engine loads a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Loads {
    /// As it is written.
    Yes,
    /// After a repair, as it refuses the file as it is written; or without the ties of joints that mimic others.
    Altered,
    /// Not at all.
    No,
}

impl Loads {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Altered => "altered",
            Self::No => "no",
        }
    }
}

/// The difference that changes M or τ most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Largest {
    /// The body; empty for the robot as a whole.
    pub body: String,
    /// The field: mass, inertia, ….
    pub field: String,
    /// The cause, as far as it is known.
    pub cause: String,
    /// The reference's value.
    pub ours: String,
    /// The engine's value.
    pub theirs: String,
    /// The scaled change of inverse dynamics by this difference alone; none where it cannot be computed, as for a body that is missing.
    pub id: Option<f64>,
    /// The same of the mass matrix.
    pub mass_matrix: Option<f64>,
}

impl Largest {
    /// The larger of both changes.
    pub fn effect(&self) -> Option<f64> {
        [self.id, self.mass_matrix].into_iter().flatten().reduce(worst)
    }

    /// Its place, in words.
    pub fn place(&self) -> String {
        let body = if self.body.is_empty() { "the robot" } else { &self.body };
        format!("{body}: {}", self.field.replace('_', " "))
    }
}

/// What became of one robot in one engine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The robot.
    pub robot: String,
    /// The engine.
    pub engine: String,
    /// The engine's version.
    pub version: String,
    /// Whether the engine loads the file.
    pub loads: Loads,
    /// Whether what it loaded has the reference's mass matrix and inverse dynamics; none if there is no answer about that.
    pub same: Option<bool>,
    /// The largest scaled error of both.
    pub error: Option<f64>,
    /// The bound of that error: rounding.
    pub bound: f64,
    /// The difference that changes them most.
    pub largest: Option<Largest>,
    /// What to do.
    pub advice: String,
}

impl Answer {
    /// Whether M and τ are the same, in one word.
    pub fn same_word(&self) -> &'static str {
        match self.same {
            Some(true) => "yes",
            Some(false) => "no",
            None => "–",
        }
    }
}

/// The answers of all robots and engines, in the order of the rows.
pub fn answers(rows: &[Row]) -> Vec<Answer> {
    let read = |row: &&Row| row.study == "import" && row.metric == "differences" && row.quantity == "import";
    rows.iter().filter(read).map(|read| answer(read, rows)).collect()
}

/// The repairs by which an engine loaded a file that it refuses as written.
pub fn repairs(read: &Row) -> Vec<String> {
    let params = params(read);
    let notes = params["notes"].as_array().into_iter().flatten();
    let repairs = notes.filter(|note| REPAIRS.iter().any(|word| note["cause"] == *word));
    repairs.map(|note| note["text"].as_str().unwrap_or_default().to_owned()).collect()
}

fn answer(read: &Row, rows: &[Row]) -> Answer {
    let of_engine = |row: &&Row| row.study == "import" && row.robot == read.robot && row.engine == read.engine;
    let rows: Vec<&Row> = rows.iter().filter(of_engine).collect();
    let repaired = repairs(read);
    let untied = rows.iter().any(|row| row.metric == "difference" && row.quantity == "mimic");
    let loads = match read.value {
        None => Loads::No,
        Some(_) if repaired.is_empty() && !untied => Loads::Yes,
        Some(_) => Loads::Altered,
    };
    let unexplained = rows.iter().find(|row| row.metric == "unexplained");
    let gate = unexplained.and_then(|row| params(row)["gate"].as_f64());
    let bound = gate.unwrap_or_else(|| bound(usize::try_from(read.depth.unwrap_or(0)).unwrap_or(0), Precision::of(&read.precision)));
    let error = rows.iter().filter(|row| row.metric == "as_read").filter_map(|row| row.value).reduce(worst);
    let largest = rows.iter().filter(|row| row.metric == "difference").filter_map(|row| largest(row)).reduce(graver);
    let physics = params(read)["physics"].as_u64().unwrap_or(0);
    // Without answers a difference of physics is an answer too: a body that is missing, for example.
    let same = match (read.value, error) {
        (None, _) => None,
        (Some(_), Some(error)) => Some(error <= bound && physics == 0),
        (Some(_), None) => (physics > 0).then_some(false),
    };
    let open = unexplained.is_some_and(|row| row.value.is_some_and(|value| value > 0.0));
    let advice = advice(read, &rows, &repaired, same, open, largest.as_ref());
    Answer {
        robot: read.robot.clone(),
        engine: read.engine.clone(),
        version: read.engine_version.clone(),
        loads,
        same,
        error,
        bound,
        largest,
        advice,
    }
}

fn largest(row: &Row) -> Option<Largest> {
    let params = params(row);
    let text = |key: &str| params[key].as_str().unwrap_or_default().to_owned();
    (params["weight"] == "dynamics").then(|| Largest {
        body: row.body.clone(),
        field: row.quantity.clone(),
        cause: text("cause"),
        ours: text("ours"),
        theirs: text("theirs"),
        id: params["id"].as_f64(),
        mass_matrix: params["mass_matrix"].as_f64(),
    })
}

/// The graver of two differences. One whose effect has no number is a body or a joint that is another: it comes first.
fn graver(a: Largest, b: Largest) -> Largest {
    let rank = |largest: &Largest| largest.effect().unwrap_or(f64::INFINITY);
    if rank(&b).total_cmp(&rank(&a)).is_gt() { b } else { a }
}

fn advice(read: &Row, rows: &[&Row], repaired: &[String], same: Option<bool>, open: bool, largest: Option<&Largest>) -> String {
    if read.value.is_none() {
        return if read.verdict == Verdict::Skip {
            format!("leave it out with --engines: {}", first(&read.reason))
        } else {
            format!("correct what its parser names: {}", first(&read.reason))
        };
    }
    if open {
        return "do not trust its answers on this file: they are not those of the robot that it says to have read".into();
    }
    if let Some(repair) = repaired.first() {
        return format!("correct the file: {}", first(repair));
    }
    match (same, largest) {
        (Some(false), largest) => remedy(read, largest),
        (None, _) => "compare the listed fields: M and τ were not asked".into(),
        // The same M and τ, and the robot stands elsewhere.
        (Some(true), _) if params(read)["pose"].as_u64().is_some_and(|count| count > 0) => remedy(read, largest),
        (Some(true), _) => carried(rows),
    }
}

/// What to do about differences: what was tried on the robot and helps, or that nothing does.
fn remedy(read: &Row, largest: Option<&Largest>) -> String {
    let params = params(read);
    let body = largest.map_or("", |largest| largest.body.as_str());
    match (params["remedy"].as_str(), largest.map_or("", |largest| largest.cause.as_str())) {
        (_, "mimic") => {
            format!("take the joint of '{body}' as free, or couple it by yourself: engines treat mimic joints in different ways")
        }
        (_, "added_armature") => format!("add the armature of '{body}' to this engine's M by yourself, or take it out of the file"),
        (Some(tried), _) => tried.to_owned(),
        _ => "do not use this engine for this file as it is: what it loses cannot be set after loading".into(),
    }
}

/// What to do where M and τ are the same: fields that only the engine's own simulation takes may differ.
fn carried(rows: &[&Row]) -> String {
    let mut fields: Vec<String> = rows
        .iter()
        .filter(|row| row.metric == "difference" && params(row)["weight"] == "carried")
        .map(|row| row.quantity.replace('_', " "))
        .collect();
    fields.sort();
    fields.dedup();
    if fields.is_empty() {
        "nothing".into()
    } else {
        format!("nothing for M and τ; set {} by yourself before you simulate", fields.join(", "))
    }
}

/// The first line of a message, as far as a table holds it.
fn first(text: &str) -> String {
    const LONGEST: usize = 120;
    let line = text.lines().next().unwrap_or_default();
    if line.chars().count() <= LONGEST { line.to_owned() } else { line.chars().take(LONGEST).chain(" …".chars()).collect() }
}

fn params(row: &Row) -> Value {
    serde_json::from_str(&row.params).unwrap_or_default()
}
