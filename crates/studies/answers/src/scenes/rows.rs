//! Rows of a scene by a variant.

use super::MOTION;
use featherbench_bench::{Cell, Gates, NoAnswer, OWN, Outcome, params};
use featherbench_results::{Row, Verdict};
use featherbench_scenes::{Fit, Measure, Question, SoftContact, block_step_felt};
use featherbench_study::case_row;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::f64::consts::SQRT_2;

/// The parameters of a row: those of the scene, the engine's settings, the step in s, and the stiffness of a bounce in N/m.
#[derive(Serialize, Deserialize)]
pub(super) struct Told {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
    pub settings: Value,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
}

/// The fields of all rows of a cell. Its `params` tell the scene's parameters and the engine's settings.
pub(super) fn blank(cell: &Cell, params: &impl Serialize) -> Row {
    Row { params: params::text(params), ..case_row(cell) }
}

/// The row of a cell without an answer. What an engine does not offer is a skip; our own lack of an answer is an error, and another engine's
/// is told.
pub(super) fn without_answer(blank: Row, no_answer: NoAnswer) -> Row {
    let verdict = match no_answer {
        NoAnswer::NotOffered(_) => Verdict::Skip,
        _ if is_reference(&blank) => Verdict::Error,
        _ => Verdict::Info,
    };
    blank.without_value(verdict, no_answer.to_string())
}

/// The row of an engine that is not there.
pub(super) fn of_absent(cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    outcome.answer().err().map(|no_answer| without_answer(blank(cell, &json!({})), no_answer)).into_iter().collect()
}

/// Whether a row is of a method of ours whose errors are judged: all but sweeps, which may end at their cap.
fn is_reference(row: &Row) -> bool {
    row.engine == OWN && row.method != "block_gauss_seidel"
}

/// Of each measure its value and error at each step, the bias at dt → 0, and a law's error where one is known.
pub(super) fn of_motion(gates: &Gates, question: &Question, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let params = |dt: Option<f64>| Told {
        scene: Some(question.params.clone()),
        duration: Some(question.duration),
        settings: cell.params["settings"].clone(),
        dt,
        stiffness: None,
    };
    let values = match outcome.answer() {
        Ok(values) => values,
        Err(no_answer) => return vec![without_answer(blank(cell, &params(None)), no_answer)],
    };
    let measures = &question.measures;
    if values.len() != question.dts.len() * measures.len() {
        let due = format!("{} numbers came, {} are due", values.len(), question.dts.len() * measures.len());
        return vec![blank(cell, &params(None)).without_value(Verdict::Error, due)];
    }
    let mut rows = Vec::new();
    for (k, measure) in measures.iter().enumerate() {
        let points: Vec<(f64, f64)> = question.dts.into_iter().zip(values.iter().skip(k).step_by(measures.len()).copied()).collect();
        let of = |metric: &str, dt: Option<f64>, unit: &str| Row {
            quantity: measure.quantity.into(),
            metric: metric.into(),
            unit: unit.into(),
            reference: "rigid mechanics".into(),
            ..blank(cell, &params(dt))
        };
        // What no law determines is told, and has no error.
        let determined = measure.quantity != "null_share";
        for &(dt, value) in &points {
            rows.push(of("value", Some(dt), measure.unit).informed(value));
            let (row, error) = (of("error", Some(dt), "1"), measure.error(value));
            if determined {
                let judged = is_reference(&row) && dt == question.finest();
                rows.push(if judged { gates.judge(row, error, 1.0) } else { row.informed(error) });
            }
        }
        if let Some(fit) = Fit::of(&points).filter(|_| determined) {
            rows.push(bias(gates, of("bias", None, "1"), measure, &fit));
            rows.push(of("bias_uncertainty", None, "1").informed(fit.off / measure.scale));
        }
        let finest = points.last().map_or(f64::NAN, |point| point.1);
        if let Some((law, due)) = law(cell, question, measure) {
            let row = Row { reference: law.into(), ..of("law_error", Some(question.finest()), "1") };
            rows.push(gates.judge(row, (finest / due - 1.0).abs(), 1.0));
        }
    }
    rows
}

fn bias(gates: &Gates, row: Row, measure: &Measure, fit: &Fit) -> Row {
    let bias = measure.error(fit.limit);
    if is_reference(&row) { gates.judge(row, bias, 1.0) } else { row.informed(bias) }
}

/// What an engine's own contact model should do here, if that is known: its name and the value.
pub(super) fn law(cell: &Cell, question: &Question, measure: &Measure) -> Option<(&'static str, f64)> {
    debug_assert_eq!(cell.quantity, MOTION);
    let number = |key: &str| question.params[key].as_f64();
    let straight = ["incline_0", "incline_90"].contains(&question.scene.name.as_str()) && measure.quantity == "felt_friction";
    let diagonal = question.scene.name == "incline_45" && measure.quantity == "felt_friction";
    match (cell.engine.as_str(), cell.method.as_str()) {
        ("mujoco", method) if diagonal && method.starts_with("pyramidal") => Some(("inscribed pyramid: 1/√2", 1.0 / SQRT_2)),
        ("mujoco", method) if diagonal && method.starts_with("elliptic") => Some(("round cone", 1.0)),
        // At other headings the sled turns and leaves its way.
        ("rapier", _) if diagonal || straight => {
            let (heading, half, height, mass) = (number("heading")?, number("half")?, number("height")?, number("mass")?);
            let arms = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| [x * half, y * half, -height]);
            let felt = block_step_felt(heading, &arms, mass, question.scene.bodies.first()?.inertia[0]);
            Some(("friction along K⁻¹v", felt))
        }
        ("dart", "dantzig" | "pgs") if diagonal => Some(("box pyramid: √2", SQRT_2)),
        ("mujoco", method) if measure.quantity == "creep" && method.starts_with("elliptic") => {
            let setting = |key: &str, k: usize| cell.params["settings"][key][k].as_f64();
            let soft = SoftContact {
                time: setting("solref", 0)?,
                damping: setting("solref", 1)?,
                impedance: [setting("solimp", 0)?, setting("solimp", 1)?, setting("solimp", 2)?],
                ratio: cell.params["settings"]["impratio"].as_f64()?,
            };
            // A quarter of the weight on each foot; the contact sees the inverse of the sled's mass.
            let (slope, mass, gravity) = (number("slope")?, number("mass")?, number("gravity")?);
            let load = mass * gravity / 4.0;
            Some(("creep of a soft contact", soft.creep(load * slope.sin(), load * slope.cos(), 1.0 / mass)))
        }
        _ => None,
    }
}
