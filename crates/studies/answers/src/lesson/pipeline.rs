//! Problem 5: the error of each stage on a motion that none has seen.

use super::{Case, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_lesson::pipeline::{Outcome, STAGES, Setting, run};
use serde_json::json;
use std::sync::{Arc, OnceLock};

pub(super) const QUANTITY: &str = "pipeline";

/// The robots, by the names of their cases, with the first stage that must be exact.
pub(super) fn settings() -> [(&'static str, Setting, Option<usize>); 3] {
    let noisy = Setting::default();
    let clean = Setting { noise: 0.0, ..noisy };
    [
        ("with noise", noisy, None),
        ("without noise", clean, Some(4)),
        ("without noise and couplings", Setting { coupling: 0.0, ..clean }, Some(2)),
    ]
}

/// A run serves all its stages.
type Shared = Arc<OnceLock<Result<Outcome, String>>>;

pub(super) fn cases() -> Vec<Case> {
    settings().into_iter().flat_map(of_setting).collect()
}

fn of_setting((name, setting, exact): (&'static str, Setting, Option<usize>)) -> Vec<Case> {
    let shared = Shared::default();
    let params = json!({
        "joints": setting.joints, "arm": setting.seed, "wrong": setting.wrong, "coupling": setting.coupling, "noise": setting.noise, "samples": setting.samples,
    });
    let of_stage = |(stage, method): (usize, &&'static str)| {
        let is_exact = exact.is_some_and(|exact| stage >= exact);
        let judged = match stage {
            0 => told("held_out_over_before", "1"),
            _ if is_exact => error("held_out_exact", "truth"),
            _ => error("held_out_over_before", "stage before"),
        };
        let shared = shared.clone();
        Case {
            name: name.into(),
            quantity: QUANTITY,
            method: (*method).into(),
            params: params.clone(),
            numbers: vec![told("held_out", "1"), told("logged", "1"), judged],
            evaluate: Box::new(move |_| {
                let outcome = shared.get_or_init(|| run(&setting).map_err(|failure| failure.to_string()));
                let Outcome { logged, held_out, .. } = outcome.as_ref().map_err(failed)?;
                let before = if stage == 0 { 1.0 } else { held_out[stage - 1] };
                let judged = if is_exact { held_out[stage] } else { held_out[stage] / before };
                Ok::<_, NoAnswer>(vec![held_out[stage], logged[stage], judged])
            }),
        }
    };
    STAGES.iter().enumerate().map(of_stage).collect()
}
