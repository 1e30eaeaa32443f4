//! Rows of a robot's experiment.

use super::candidates::{Candidate, Told, WHOLE};
use super::{Measured, OfRobot, Params, TARGET};
use crate::timing::rows::{estimated, judged};
use crate::timing::samples::{Processes, quietest_of};
use featherbench_bench::statistics::{Estimate, drift};
use featherbench_bench::{Finished, Gates, NoAnswer, params};
use featherbench_results::{Kind, Relation, Row, Verdict};
use featherbench_study::{case_row, unanswered};

/// All rows of an experiment, whose processes these are. What is no time is the same in each of them.
pub(super) fn rows(gates: &Gates, processes: &[Finished]) -> Vec<Row> {
    let Some((cell, _)) = processes.first() else { return Vec::new() };
    let parts = || -> Result<_, NoAnswer> {
        let Params { of_robot, candidates, .. } = cell.params()?;
        let of = |(_, outcome): &Finished| {
            let measured = Measured::from_values(outcome.answer()?, candidates.len());
            measured.ok_or_else(|| NoAnswer::Failed("the outcome holds no samples".into()))
        };
        let mut measured = processes.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let quietest = quietest_of(measured.iter().map(|measured| &measured.samples));
        let samples = Processes::new(measured.iter().map(|measured| measured.samples.clone()).collect(), quietest);
        Ok((of_robot, candidates, measured.swap_remove(0), samples))
    };
    let params = cell.params::<OfRobot>().map(|params| params::text(&params)).unwrap_or_default();
    let blank = Row { params, ..case_row(cell) };
    let (of_robot, candidates, measured, samples) = match parts() {
        Ok(parts) => parts,
        Err(no_answer) => return vec![unanswered(blank, &no_answer, Verdict::Error)],
    };
    let control = candidates.iter().position(|candidate| candidate.control).map(|which| {
        let ratio = samples.ratio(which, 0);
        (ratio, samples.steady.complaint().or_else(|| ratio.complaint()))
    });
    let drift = drift(candidates.iter().position(|candidate| candidate.control).map(|which| samples.beside_the_first(which)));
    let widened = |ratio: Estimate| control.as_ref().map_or(ratio, |(control, _)| ratio.widened(control));
    let noise = match &control {
        Some((_, complaint)) => complaint.clone(),
        None => Some("the experiment has no A/A control".to_owned()),
    };
    let noise = noise.as_deref();
    let usual = format!("{} {}", cell.engine, cell.method);
    let whole = candidates.iter().position(|candidate| candidate.engine == cell.engine && candidate.method == WHOLE);
    let mut rows = vec![Row { metric: "problems".into(), unit: "1".into(), ..blank.clone() }.informed(measured.problems)];
    for (which, candidate) in candidates.iter().enumerate() {
        let Candidate { engine, version, method, own_model, .. } = candidate.clone();
        let mut blank = Row { engine, engine_version: version, method, ..blank.clone() };
        let own = !own_model.is_null();
        let params = OfRobot { own_model: Some(own_model).filter(|_| own), ..of_robot.clone() };
        blank.params = params::text(&params);
        let of = |metric: &str, unit: &str, kind| Row { metric: metric.into(), unit: unit.into(), kind, ..blank.clone() };
        if candidate.control {
            let row = Row { reference: format!("{usual}, its first copy"), ..of("control", "1", Kind::Measured) };
            rows.extend(control.as_ref().map(|(ratio, _)| judged(estimated(row, ratio), noise)));
            continue;
        }
        let Told { tolerance, residual, from_limit } = measured.told[which];
        if tolerance.is_nan() {
            // An engine's own measure may end before its answers are as good as asked. That is a result, and its time is not comparable.
            let reason = if own {
                format!("at no tolerance are all its velocities within {TARGET:.0e} of the limit of its own model")
            } else {
                format!("at no tolerance are all its answers within a natural-map residual of {TARGET:.0e}")
            };
            let verdict = if candidate.engine == cell.engine { Verdict::Error } else { Verdict::Info };
            rows.push(of("residual", "1", Kind::Exact).without_value(verdict, reason));
            continue;
        }
        rows.push(of("tolerance", "1", Kind::Exact).informed(tolerance));
        let row = Row { reference: "laws".into(), ..of("residual", "1", Kind::Exact) };
        if own {
            let limit = Row { reference: "its own model".into(), ..of("from_limit", "1", Kind::Exact) };
            rows.extend([row.informed(residual), limit.informed(from_limit)]);
        } else {
            rows.push(gates.explain(row.gated(residual, Relation::Le, TARGET)));
        }
        let timed = Row { params: params::text(&OfRobot { drift: Some(drift), ..params }), ..of("ns_per_call", "ns", Kind::Measured) };
        if !samples.answered(which) {
            rows.push(timed.without_value(Verdict::Error, "it stopped answering while it was timed"));
            continue;
        }
        rows.push(judged(estimated(timed, &samples.time(which, drift)), noise));
        if let Some(whole) = whole.filter(|_| own) {
            // From M and J on, as the engine's: but another model at another residual, so by a name of its own.
            let ratio = widened(samples.ratio(which, whole));
            let row = Row { reference: format!("{} {WHOLE}", cell.engine), ..of("own_model_ratio", "1", Kind::Measured) };
            rows.push(judged(estimated(row, &ratio), noise));
        } else if which > 0 && !own {
            let ratio = widened(samples.ratio(which, 0));
            let row = Row { reference: usual.clone(), ..of("ratio", "1", Kind::Measured) };
            rows.push(judged(estimated(row, &ratio), noise));
        }
    }
    rows
}
