//! Rows of a cell.

use super::ask::{Judged, OfCell, Params};
use super::systems::NEAR;
use featherbench_bench::{Cell, Gates, NoAnswer, OWN, Outcome, params};
use featherbench_results::{Kind, Row, Verdict};
use featherbench_study::{case_row, unanswered};

/// All rows of a cell. Gates judge ours: what another engine gives is a finding.
pub(super) fn rows(gates: &Gates, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let asked = match cell.params::<OfCell>() {
        Ok(params) => params.asked,
        Err(no_answer) => return vec![unanswered(case_row(cell), &no_answer, Verdict::Error)],
    };
    let blank = Row { family: asked.name.clone(), params: params::text(&asked), ..case_row(cell) };
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
    let told = Params { settings: Some(judged.settings), ..asked };
    let blank = Row { params: params::text(&told), ..blank };
    let of = |blank: &Row, metric: &str, unit: &str, reference: &str, value: Option<f64>| {
        let row = Row { metric: metric.into(), unit: unit.into(), reference: reference.into(), ..blank.clone() };
        match value {
            None if cell.engine == OWN => row.without_value(Verdict::Error, "the answer is not finite"),
            None => row.without_value(Verdict::Info, "the answer is not finite"),
            Some(value) if cell.engine == OWN => gates.judge(row, value, 1.0),
            Some(value) => row.informed(value),
        }
    };
    let row = |metric: &str, unit: &str, reference: &str, value: Option<f64>| of(&blank, metric, unit, reference, value);
    let moves = cell.quantity == "loop_motion";
    let mut rows = Vec::new();
    let unit = if moves { "rad" } else { "1" };
    if cell.quantity == "loop_singular" {
        for (power, value) in NEAR.zip(&judged.errors) {
            let params = Params { beside: Some(10.0_f64.powi(-power)), ..told.clone() };
            rows.push(of(&Row { params: params::text(&params), ..blank.clone() }, "error", unit, "truth", *value));
        }
    } else {
        rows.extend(judged.errors.iter().map(|value| row("error", unit, "truth", *value)));
    }
    // Where a motion has left all bounds, its only row says so.
    if moves && judged.energy_drift.is_some() {
        rows.push(row("energy_drift", "J", "begin", judged.energy_drift));
        rows.push(row("open", "m", "loops", judged.open));
        if cell.engine == OWN && judged.of_steps.is_some() {
            rows.push(row("of_steps", "rad", "closed form", judged.of_steps));
            rows.push(row("energy_of_steps", "J", "closed form", judged.energy_of_steps));
        }
    }
    let metric = if moves { "ns_per_step" } else { "ns_per_state" };
    let time = Row { kind: Kind::Measured, metric: metric.into(), unit: "ns".into(), ..blank.clone() };
    rows.push(time.informed(judged.nanoseconds));
    rows
}
