//! Rows of a robot's experiment.

use super::candidates::Candidate;
use super::{Measured, STUDY, TARGET};
use crate::timing::rows::{estimated, judged};
use crate::timing::statistics::{CONTROL_LEVEL, Estimate, LEVEL};
use featherbench_bench::{Cell, Gates, Outcome};
use featherbench_results::{Kind, Relation, Row, Verdict, canonical_json};
use featherbench_robots::Random;
use serde_json::json;

/// All rows of a cell.
pub(super) fn rows(gates: &Gates, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let candidates = Candidate::of(cell);
    let blank = Row {
        cell: cell.id(),
        study: STUDY.into(),
        family: cell.robot.clone(),
        params: canonical_json(
            &json!({"contacts": cell.params["contacts"], "rank": cell.params["rank"], "seconds": cell.params["seconds"]}),
        ),
        engine: cell.engine.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        precision: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        ..Row::default()
    };
    let measured = match outcome.answer() {
        Ok(values) => Measured::from_values(values, candidates.len()).ok_or_else(|| "the outcome holds no samples".to_owned()),
        Err(no_answer) => Err(no_answer.to_string()),
    };
    let measured = match measured {
        Ok(measured) => measured,
        Err(reason) => return vec![blank.without_value(Verdict::Error, reason)],
    };
    let random = |what: &str| Random::named(0, &format!("{} {what}", cell.id()));
    let samples = &measured.samples;
    let control = candidates.iter().position(|candidate| candidate.control).map(|which| {
        let ratio = Estimate::ratio(samples.of(which), samples.of(0), CONTROL_LEVEL, &mut random("control"));
        (ratio, ratio.complaint())
    });
    let noise = match &control {
        Some((_, complaint)) => complaint.clone(),
        None => Some("the experiment has no A/A control".to_owned()),
    };
    let noise = noise.as_deref();
    let usual = format!("{} {}", cell.engine, cell.method);
    let mut rows = vec![Row { metric: "problems".into(), unit: "1".into(), ..blank.clone() }.informed(measured.problems)];
    for (which, candidate) in candidates.iter().enumerate() {
        let Candidate { engine, version, method, .. } = candidate.clone();
        let blank = Row { engine, engine_version: version, method, ..blank.clone() };
        let of = |metric: &str, unit: &str, kind| Row { metric: metric.into(), unit: unit.into(), kind, ..blank.clone() };
        if candidate.control {
            let row = Row { reference: format!("{usual}, its first copy"), ..of("control", "1", Kind::Measured) };
            rows.extend(control.as_ref().map(|(ratio, _)| judged(estimated(row, ratio), noise)));
            continue;
        }
        let [tolerance, residual] = measured.told[which];
        if tolerance.is_nan() {
            // An engine's own measure may end before its answers are as good as asked. That is a result, and its time is not comparable.
            let reason = format!("at no tolerance are all its answers within a natural-map residual of {TARGET:.0e}");
            let verdict = if candidate.engine == cell.engine { Verdict::Error } else { Verdict::Info };
            rows.push(of("residual", "1", Kind::Exact).without_value(verdict, reason));
            continue;
        }
        rows.push(of("tolerance", "1", Kind::Exact).informed(tolerance));
        let row = Row { reference: "laws".into(), ..of("residual", "1", Kind::Exact) };
        rows.push(gates.explain(row.gated(residual, Relation::Le, TARGET)));
        let ns = samples.of(which);
        let timed = of("ns_per_call", "ns", Kind::Measured);
        if ns.iter().any(|ns| ns.is_nan()) {
            rows.push(timed.without_value(Verdict::Error, "it stopped answering while it was timed"));
            continue;
        }
        let name = format!("{} {}", candidate.engine, candidate.method);
        rows.push(judged(estimated(timed, &Estimate::median(ns, LEVEL, &mut random(&name))), noise));
        if which > 0 {
            let ratio = Estimate::ratio(ns, samples.of(0), LEVEL, &mut random(&format!("{name} ratio")));
            let row = Row { reference: usual.clone(), ..of("ratio", "1", Kind::Measured) };
            rows.push(judged(estimated(row, &ratio), noise));
        }
    }
    rows
}
