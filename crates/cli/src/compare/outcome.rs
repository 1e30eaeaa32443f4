//! How a comparison ends for an engine and a robot: four questions, each with its row, and which of them make the exit code.

use ::featherbench_results::{Culprit, Expectation, GateKind, Row, Verdict};
use featherbench_bench::{Engine, OWN, Robot, measure::worst};
use featherbench_comparison::import::{Precision, bound};
use serde_json::Value;

/// The questions of all engines about a robot; `strict` counts what is only not read, and rounding, as well.
pub fn conditions(robot: &Robot, engines: &[&dyn Engine], records: &[Row], strict: bool) -> Vec<Expectation> {
    let engines = engines.iter().map(|engine| engine.identity().name.as_str()).filter(|name| *name != OWN);
    engines.flat_map(|engine| of_engine(robot, engine, records, strict)).collect()
}

fn of_engine(robot: &Robot, engine: &str, records: &[Row], strict: bool) -> Vec<Expectation> {
    let name = &robot.name;
    let rows: Vec<&Row> = records.iter().filter(|row| row.robot == *name && row.engine == engine).collect();
    let of = |metric: &str| rows.iter().find(|row| row.study == "import" && row.metric == metric);
    let read = of("differences");
    let bound = bound(robot.depth, rows.first().map_or(Precision::Double, |row| Precision::of(&row.precision)));
    let condition = |what: String, found: u64, reason: String| {
        let culprit = Culprit { study: "import".into(), robot: name.clone(), ..Culprit::engine(engine) };
        Expectation::new(GateKind::Import, what, 0, found).because(reason).about(culprit)
    };
    let told = |found: u64| format!("found {found}");
    // A file that is refused is no answer to "do they read it alike"; one that is beyond a limit was not asked.
    let refused = read.is_none_or(|row| row.value.is_none() && (strict || row.verdict != Verdict::Skip));
    let reason = read.map_or_else(|| "there is no answer".to_owned(), |row| row.reason.clone());
    let mut list = vec![condition(format!("{engine} reads {name}"), u64::from(refused), reason)];

    let count = |class: &str| read.map_or(0, |row| params(row)[class].as_u64().unwrap_or(0));
    let error = worst_of(rows.iter().filter(|row| row.study == "import" && row.metric == "as_read"));
    let far = error.is_some_and(|error| error.is_nan() || error > bound);
    // Many small differences may add up to one that counts.
    let physics = count("physics").max(u64::from(far));
    list.push(condition(format!("differences of {name} in {engine} that change the physics"), physics, told(physics)));
    let displaced = count("pose");
    list.push(condition(format!("differences of {name} in {engine} that displace it in the world"), displaced, told(displaced)));
    if strict {
        let others = count("unfelt") + count("rounding") + count("not_read");
        list.push(condition(format!("other differences in what {engine} reads of {name}"), others, told(others)));
    }
    if let Some(row) = of("unexplained") {
        let found = row.value.map_or(1, |value| value as u64);
        let reason = if row.reason.is_empty() { told(found) } else { row.reason.clone() };
        list.push(condition(format!("sub-trees of {name} that this does not explain in {engine}'s answers"), found, reason));
    }
    let failed = rows.iter().find(|row| row.study == "agreement" && row.verdict == Verdict::Error && usual(row));
    let off = neutral(&rows).filter(|error| error.is_nan() || *error > bound);
    let reason = off.map(|error| format!("off by {error:e}")).or(failed.map(|row| row.reason.clone())).unwrap_or_default();
    let found = u64::from(off.is_some() || failed.is_some());
    list.push(condition(format!("{engine} computes otherwise from the neutral model of {name}"), found, reason));
    list
}

/// The quantities by which engines are compared on the neutral model.
fn usual(row: &Row) -> bool {
    row.study == "agreement" && ["id", "bias", "mass_matrix", "mass_matrix_probe"].contains(&row.quantity.as_str())
}

/// The worst error of inverse dynamics, bias and mass matrix on the neutral route, by an engine's usual method.
pub fn neutral(rows: &[&Row]) -> Option<f64> {
    worst_of(rows.iter().filter(|row| row.metric == "scaled" && usual(row)))
}

fn worst_of<'a>(rows: impl Iterator<Item = &'a &'a Row>) -> Option<f64> {
    rows.filter_map(|row| row.value).reduce(worst)
}

/// The parameters of a row.
pub fn params(row: &Row) -> Value {
    serde_json::from_str(&row.params).unwrap_or_default()
}
