//! Rows of the outcomes of a robot's cells.

use super::machine::{LANES, Machine};
use super::samples::{Entrant, Samples, outcome_samples};
use super::statistics::{CONTROL_LEVEL, Estimate, Finding, LEVEL};
use super::{CHECK, EXPERIMENT, MACHINE, OVERHEAD, REFERENCE, check};
use crate::{quantile, row};
use featherbench_bench::measure::worst;
use featherbench_bench::{Cell, Finished, Gates, Outcome, Problem, Refusal};
use featherbench_model::Random;
use featherbench_results::{ESTIMATE, Kind, Record, Relation, Verdict};

/// An experiment whose A/A control fails is void by itself; when more than one in this many controls of a robot do, all its times are.
const BAD_CONTROLS: usize = 4;

/// What the rows of estimated times say, behind [`ESTIMATE`].
const ESTIMATED: &str = "through a language whose call overhead is measured and subtracted";

/// All rows of a robot.
pub(super) fn rows(gates: &Gates, problem: &Problem, finished: &[Finished]) -> Vec<Record> {
    let of_kind = |what: &'static str| finished.iter().filter(move |(cell, _)| cell.params["what"] == what);
    let checks: Vec<Check> = of_kind(CHECK).map(|finished| Check::of(gates, problem, finished)).collect();
    let experiments: Vec<Experiment> = of_kind(EXPERIMENT).map(|finished| Experiment::of(problem, finished)).collect();
    let noise = noise(&experiments);
    let machine = of_kind(MACHINE).flat_map(|(cell, outcome)| machine(cell, problem, outcome));
    let checked = checks.iter().filter_map(|check| check.row.clone());
    let overheads = of_kind(OVERHEAD).filter_map(|finished| overhead(problem, finished));
    let timed = experiments.iter().flat_map(|experiment| experiment.rows(&checks, noise.as_deref()));
    machine.chain(checked).chain(overheads).chain(timed).collect()
}

/// Why no time of this robot counts: too many of its controls say that the machine was not quiet, or say nothing.
fn noise(experiments: &[Experiment]) -> Option<String> {
    let timed = || experiments.iter().filter(|experiment| experiment.samples.is_ok());
    let (controls, bad) = (timed().count(), timed().filter(|experiment| experiment.noise().is_some()).count());
    (bad * BAD_CONTROLS > controls).then(|| format!("{bad} of {controls} A/A controls of this robot are not 1: the machine was not quiet"))
}

/// What the machine can do. The rows belong to no robot.
fn machine(cell: &Cell, problem: &Problem, outcome: &Outcome) -> Vec<Record> {
    let blank = Record { kind: Kind::Measured, quantity: MACHINE.into(), ..row(cell, problem) };
    let blank = Record { problem: String::new(), model: String::new(), nq: None, nv: None, bodies: None, depth: None, ..blank };
    let measured = match outcome.answer() {
        Ok(values) => Machine::from_values(values).ok_or_else(|| "the outcome is no machine".to_owned()),
        Err(refusal) => Err(refusal.to_string()),
    };
    let measured = match measured {
        Ok(machine) => machine,
        Err(reason) => return vec![blank.without_value(Verdict::Error, reason)],
    };
    let void = measured.complaint();
    let Machine { peak, scalar, resolution, empty } = measured;
    // The peak is a limit, and is void where it is none.
    let values = [
        ("fma_per_ns", "1/ns", peak, void.as_ref()),
        ("fma_per_ns_per_lane", "1/ns", peak / LANES as f64, void.as_ref()),
        ("fma_per_ns_scalar", "1/ns", scalar, None),
        ("clock_ns", "ns", resolution, None),
        ("empty_call_ns", "ns", empty, None),
    ];
    let row = |(metric, unit, value, void): (&str, &str, f64, Option<&String>)| {
        let mut row = Record { metric: metric.into(), unit: unit.into(), ..blank.clone() }.informed(value);
        if let Some(reason) = void.filter(|_| row.value.is_some()) {
            row.reason = format!("void: {reason}");
        }
        row
    };
    values.map(row).into()
}

/// What it takes to call an engine whose times are estimates, by the clock that subtracts it. One that does not offer the robot has its row
/// in the check.
fn overhead(problem: &Problem, (cell, outcome): &Finished) -> Option<Record> {
    let blank =
        Record { kind: Kind::Measured, case: "stream".into(), metric: "overhead_ns".into(), unit: "ns".into(), ..row(cell, problem) };
    match outcome.answer() {
        Ok(overheads) => {
            let mut sorted = overheads.to_vec();
            sorted.sort_unstable_by(f64::total_cmp);
            Some(labelled(blank.informed(quantile(&sorted, 0.5))))
        }
        Err(Refusal::Unsupported(_)) => None,
        Err(refusal) => Some(blank.without_value(Verdict::Error, refusal.to_string())),
    }
}

/// A row of an estimated time: its reason says so, behind what else it says.
fn labelled(mut row: Record) -> Record {
    let separator = if row.reason.is_empty() { "" } else { "; " };
    row.reason += &format!("{separator}{ESTIMATE}{ESTIMATED}");
    row
}

/// Whether the times of one subject's method count.
struct Check {
    subject: String,
    method: String,
    quantity: String,
    /// Why they do not.
    complaint: Option<String>,
    row: Option<Record>,
}

impl Check {
    fn of(gates: &Gates, problem: &Problem, (cell, outcome): &Finished) -> Self {
        let blank = Record {
            case: "stream".into(),
            metric: "worst_error".into(),
            unit: "1".into(),
            reference: REFERENCE.into(),
            ..row(cell, problem)
        };
        let limit = check::limit(problem.depth);
        let row = match outcome.answer() {
            Err(refusal) => {
                let verdict = if matches!(refusal, Refusal::Unsupported(_)) { Verdict::Skip } else { Verdict::Error };
                blank.without_value(verdict, refusal.to_string())
            }
            Ok(errors) => blank.gated(errors.iter().copied().fold(0.0, worst), Relation::Le, limit),
        };
        let complaint = match row.verdict {
            Verdict::Pass => None,
            Verdict::Fail => Some(format!("a wrong answer has no time: {}", row.reason)),
            _ => Some(row.reason.clone()),
        };
        // Our own good answers are the agreement study's subject; here only what others, or failures, say is news.
        let news = cell.subject != REFERENCE || complaint.is_some();
        let (subject, method, quantity) = (cell.subject.clone(), cell.method.clone(), cell.quantity.clone());
        Self { subject, method, quantity, complaint, row: news.then(|| gates.explain(row)) }
    }
}

/// One experiment with its statistics.
struct Experiment<'a> {
    cell: &'a Cell,
    blank: Record,
    entrants: Vec<Entrant>,
    samples: Result<Samples, String>,
    /// The second copy of the reference over the first, or why it is not known.
    control: Result<Estimate, &'static str>,
}

impl<'a> Experiment<'a> {
    fn of(problem: &Problem, (cell, outcome): &'a Finished) -> Self {
        let entrants = Entrant::of(cell);
        let samples = match outcome.answer() {
            Err(refusal) => Err(refusal.to_string()),
            Ok(_) => outcome_samples(cell, outcome).ok_or_else(|| "the outcome holds no samples".to_owned()),
        };
        let case = cell.params["cache"].as_str().unwrap_or_default().to_owned();
        // The entrants stand in rows of their own: a parameter that lists them would stand in each.
        let params = serde_json::json!({"algorithm": cell.quantity, "cache": case, "states": cell.params["states"], "seconds": cell.params["seconds"]});
        let blank = Record { kind: Kind::Measured, case, params: featherbench_results::canonical_json(&params), ..row(cell, problem) };
        let mut experiment = Self { cell, blank, entrants, samples, control: Err("the experiment has no A/A control") };
        if let (Some(which), Ok(samples)) = (experiment.entrants.iter().position(|entrant| entrant.control), &experiment.samples) {
            let ratio = Estimate::ratio(samples.of(which), samples.of(0), CONTROL_LEVEL, &mut experiment.random("control"));
            let known = ratio.value.is_finite() && ratio.low.is_finite() && ratio.high.is_finite();
            experiment.control =
                if known { Ok(ratio) } else { Err("the A/A control or the reference stopped answering while it was timed") };
        }
        experiment
    }

    /// Why no time of this experiment counts, when its control says so, or says nothing.
    fn noise(&self) -> Option<String> {
        match &self.control {
            Ok(control) => control.complaint(),
            Err(reason) => Some((*reason).to_owned()),
        }
    }

    fn random(&self, what: &str) -> Random {
        Random::named(0, &format!("{} {what}", self.cell.id()))
    }

    fn rows(&self, checks: &[Check], noise: Option<&str>) -> Vec<Record> {
        let samples = match &self.samples {
            Ok(samples) => samples,
            Err(reason) => return vec![self.blank.clone().without_value(Verdict::Error, reason.clone())],
        };
        let own_noise = self.noise();
        let mut rows = Vec::new();
        for (which, entrant) in self.entrants.iter().enumerate() {
            let blank = Record {
                engine: entrant.engine.clone(),
                engine_version: entrant.version.clone(),
                method: entrant.method.clone(),
                ..self.blank.clone()
            };
            let check = checks
                .iter()
                .find(|check| check.subject == entrant.engine && check.method == entrant.method && check.quantity == self.cell.quantity);
            let usual = format!("{REFERENCE} {}", self.cell.method);
            if entrant.control {
                // A reference that refused from the start has its row in the check, and nothing to compare.
                if self.control.is_err() && check.is_some_and(|check| check.complaint.is_some()) {
                    continue;
                }
                let blank = Record { unit: "1".into(), reference: format!("{usual}, its first copy"), ..blank };
                let mut own: Vec<Record> = match &self.control {
                    Ok(control) => estimate(&blank, ["control", "control_low", "control_high"], control),
                    Err(reason) => vec![Record { metric: "control".into(), ..blank }.without_value(Verdict::Error, *reason)],
                };
                if let Some(reason) = own_noise.as_ref().filter(|_| self.control.is_ok()) {
                    own.iter_mut().for_each(|row| row.reason = format!("void: {reason}"));
                }
                rows.extend(own);
                continue;
            }
            let void = match check {
                None => Some("its answers were not checked in this run"),
                Some(check) => check.complaint.as_deref(),
            };
            let ns = samples.of(which);
            if ns.iter().any(|ns| ns.is_nan()) {
                // One that refused from the start has its row in the check.
                if void.is_none() {
                    let row = Record { metric: "ns_per_call".into(), unit: "ns".into(), ..blank };
                    rows.push(row.without_value(Verdict::Error, "it stopped answering while it was timed"));
                }
                continue;
            }
            let name = format!("{} {}", entrant.engine, entrant.method);
            let time = Estimate::median(ns, LEVEL, &mut self.random(&name));
            let mut own = estimate(&Record { unit: "ns".into(), ..blank.clone() }, ["ns_per_call", "ns_low", "ns_high"], &time);
            own.extend(deciles(&Record { unit: "ns".into(), ..blank.clone() }, ns));
            if which > 0 {
                let ratio = Estimate::ratio(ns, samples.of(0), LEVEL, &mut self.random(&format!("{name} ratio")));
                let blank = Record { unit: "1".into(), reference: usual, ..blank };
                own.extend(estimate(&blank, ["ratio", "ratio_low", "ratio_high"], &ratio));
                own.push(Record { metric: "finding".into(), ..blank }.informed(match ratio.finding() {
                    Finding::Slower => 1.0,
                    Finding::Alike => 0.0,
                    Finding::Faster => -1.0,
                }));
            }
            if let Some(reason) = void.or(noise).or(own_noise.as_deref()) {
                own.iter_mut().for_each(|row| row.reason = format!("void: {reason}"));
            }
            rows.extend(own.into_iter().map(|row| if entrant.estimate { labelled(row) } else { row }));
        }
        rows
    }
}

/// Value and interval as three rows.
fn estimate(blank: &Record, metrics: [&str; 3], estimate: &Estimate) -> Vec<Record> {
    let values = [estimate.value, estimate.low, estimate.high];
    metrics.into_iter().zip(values).map(|(metric, value)| Record { metric: metric.into(), ..blank.clone() }.informed(value)).collect()
}

/// The first and the last decile of the blocks.
fn deciles(blank: &Record, ns: &[f64]) -> [Record; 2] {
    let mut sorted = ns.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    [("ns_p10", 0.1), ("ns_p90", 0.9)].map(|(metric, at)| Record { metric: metric.into(), ..blank.clone() }.informed(quantile(&sorted, at)))
}
