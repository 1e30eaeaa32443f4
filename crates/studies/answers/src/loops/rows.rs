//! Rows of a cell.

use super::ask::Judged;
use super::systems::NEAR;
use featherbench_bench::{Cell, Gates, NoAnswer, OWN, Outcome};
use featherbench_results::{Kind, Row, Verdict, canonical_json};
use featherbench_study::case_row;
use serde_json::{Value, json};

/// All rows of a cell. Gates judge ours: what another engine gives is a finding.
pub(super) fn rows(gates: &Gates, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let asked = &cell.params["asked"];
    let family = asked["name"].as_str().unwrap_or(&cell.robot).to_owned();
    let blank = Row { family, params: canonical_json(asked), ..case_row(cell) };
    let judged = match outcome {
        Outcome::Text(text) => serde_json::from_str::<Judged>(text).map_err(|error| error.to_string()),
        Outcome::NoAnswer(NoAnswer::NotOffered(reason)) => {
            return vec![Row { metric: "error".into(), ..blank }.without_value(Verdict::Skip, reason)];
        }
        // Another engine that gives up where a row is singular tells as much as one that answers.
        Outcome::NoAnswer(NoAnswer::Failed(reason)) if cell.engine != OWN => {
            return vec![Row { metric: "error".into(), ..blank }.without_value(Verdict::Info, reason)];
        }
        Outcome::NoAnswer(no_answer) => Err(no_answer.to_string()),
        Outcome::Values(_) => Err("the outcome is a list of numbers, and a text is due".into()),
    };
    let judged = match judged {
        Ok(judged) => judged,
        Err(reason) => return vec![blank.without_value(Verdict::Error, reason)],
    };
    let params = |more: Value| {
        let mut params = asked.clone();
        params["settings"] = judged.settings.clone();
        if let (Some(params), Value::Object(more)) = (params.as_object_mut(), more) {
            params.extend(more);
        }
        canonical_json(&params)
    };
    let row = |metric: &str, unit: &str, reference: &str, value: Option<f64>, more: Value| {
        let row = Row { metric: metric.into(), unit: unit.into(), reference: reference.into(), params: params(more), ..blank.clone() };
        match value {
            None if cell.engine == OWN => row.without_value(Verdict::Error, "the answer is not finite"),
            None => row.without_value(Verdict::Info, "the answer is not finite"),
            Some(value) if cell.engine == OWN => gates.judge(row, value, 1.0),
            Some(value) => row.informed(value),
        }
    };
    let moves = cell.quantity == "loop_motion";
    let mut rows = Vec::new();
    let unit = if moves { "rad" } else { "1" };
    if cell.quantity == "loop_singular" {
        for (power, value) in NEAR.zip(&judged.errors) {
            rows.push(row("error", unit, "truth", *value, json!({"beside": 10.0_f64.powi(-power)})));
        }
    } else {
        rows.extend(judged.errors.iter().map(|value| row("error", unit, "truth", *value, json!({}))));
    }
    // Where a motion has left all bounds, its only row says so.
    if moves && judged.energy_drift.is_some() {
        rows.push(row("energy_drift", "J", "begin", judged.energy_drift, json!({})));
        rows.push(row("open", "m", "loops", judged.open, json!({})));
        if cell.engine == OWN && judged.of_steps.is_some() {
            rows.push(row("of_steps", "rad", "closed form", judged.of_steps, json!({})));
            rows.push(row("energy_of_steps", "J", "closed form", judged.energy_of_steps, json!({})));
        }
    }
    let metric = if moves { "ns_per_step" } else { "ns_per_state" };
    let time = Row { kind: Kind::Measured, metric: metric.into(), unit: "ns".into(), params: params(json!({})), ..blank.clone() };
    rows.push(time.informed(judged.nanoseconds));
    rows
}
