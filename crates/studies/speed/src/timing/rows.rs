//! Rows of the outcomes of a robot's cells.

use super::machine::Machine;
use super::samples::{Candidate, Processes, Samples, quietest_of};
use super::{CellKind, MACHINE, Paired, REFERENCE, check};
use featherbench_bench::measure::worst;
use featherbench_bench::statistics::{Estimate, Pace, drift, quantile_of};
use featherbench_bench::{Cell, Finished, Gates, NoAnswer, Outcome, Robot, params};
use featherbench_results::{Kind, Relation, Row, Verdict};
use featherbench_spatial::peak::LANES;
use featherbench_study::{row, unanswered};
use serde::{Deserialize, Serialize};

/// An experiment whose A/A ratio is bad is not valid. If more than one in this number of a robot's A/A ratios is bad, none of its times is.
const BAD_CONTROLS: usize = 4;

/// All rows of a robot.
pub(super) fn rows(gates: &Gates, robot: &Robot, best_of: &[String], finished: &[Finished]) -> Vec<Row> {
    let (mut checks, mut processes, mut machines, mut overheads) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for item in finished {
        match item.0.params() {
            Ok(CellKind::Machine) => machines.extend(machine(&item.0, robot, &item.1)),
            Ok(CellKind::Check { .. }) => checks.push(Check::of(gates, robot, item)),
            Ok(CellKind::Overhead { .. }) => overheads.extend(overhead(robot, item)),
            Ok(CellKind::Experiment(paired)) => {
                let samples = match item.1.answer() {
                    Err(no_answer) => Err(no_answer.to_string()),
                    Ok(_) => Samples::of_outcome(&item.1, paired.candidates.len()).ok_or_else(|| "the outcome holds no samples".to_owned()),
                };
                processes.push(Process { cell: &item.0, paired, samples });
            }
            Err(_) => {}
        }
    }
    // The cells of an experiment stand together, process after process.
    let same = |a: &Process, b: &Process| a.cell.path() == b.cell.path() && a.paired.cache == b.paired.cache;
    let quietest = quietest_of(processes.iter().filter_map(|process| process.samples.as_ref().ok()));
    let experiments: Vec<Experiment> = processes.chunk_by(same).map(|processes| Experiment::of(robot, processes, quietest)).collect();
    let (noise, drift) = (noise(&experiments), drift(experiments.iter().filter_map(Experiment::copies)));
    let checked = checks.iter().filter_map(|check| check.row.clone());
    let timed = experiments.iter().flat_map(|experiment| {
        let mut rows = experiment.rows(&checks, noise.as_deref(), drift);
        rows.extend(experiment.beside(best_of, &checks, noise.as_deref()));
        rows
    });
    machines.into_iter().chain(checked).chain(overheads).chain(timed).collect()
}

/// Why no time of this robot counts: too many of its A/A ratios show that the machine was not quiet, or are missing.
fn noise(experiments: &[Experiment]) -> Option<String> {
    let timed = || experiments.iter().filter(|experiment| experiment.samples.is_ok());
    let (controls, bad) = (timed().count(), timed().filter(|experiment| experiment.missed().is_some()).count());
    (bad * BAD_CONTROLS > controls)
        .then(|| format!("{bad} of {controls} A/A controls of this robot are far from 1: the machine was not quiet"))
}

/// The machine's performance. The rows belong to no robot.
fn machine(cell: &Cell, robot: &Robot, outcome: &Outcome) -> Vec<Row> {
    let blank = Row { kind: Kind::Measured, quantity: MACHINE.into(), ..row(cell, robot) };
    let blank = Row { family: String::new(), robot: String::new(), nq: None, nv: None, bodies: None, depth: None, ..blank };
    let measured = match outcome.answer() {
        Ok(values) => Machine::from_values(values).ok_or_else(|| "the outcome is no machine".to_owned()),
        Err(no_answer) => Err(no_answer.to_string()),
    };
    let measured = match measured {
        Ok(machine) => machine,
        Err(reason) => return vec![blank.without_value(Verdict::Error, reason)],
    };
    let complaint = measured.complaint();
    let Machine { peak, scalar, resolution, empty } = measured;
    // A peak that is not valid does not count.
    let values = [
        ("fma_per_ns", "1/ns", peak, complaint.as_ref()),
        ("fma_per_ns_per_lane", "1/ns", peak / LANES as f64, complaint.as_ref()),
        ("fma_per_ns_scalar", "1/ns", scalar, None),
        ("clock_ns", "ns", resolution, None),
        ("empty_call_ns", "ns", empty, None),
    ];
    let row = |(metric, unit, value, complaint): (&str, &str, f64, Option<&String>)| {
        let row = Row { metric: metric.into(), unit: unit.into(), ..blank.clone() }.informed(value);
        judged(row, complaint.map(String::as_str))
    };
    values.map(row).into()
}

/// The overhead of calling an engine whose times are estimates, by the clock that subtracts it. An engine that does not offer the robot has
/// its row in the check.
fn overhead(robot: &Robot, (cell, outcome): &Finished) -> Option<Row> {
    let blank = Row {
        kind: Kind::Measured,
        cache: "stream".into(),
        metric: "overhead_ns".into(),
        unit: "ns".into(),
        estimated: true,
        ..row(cell, robot)
    };
    match outcome.answer() {
        Ok(overheads) => Some(blank.informed(quantile_of(overheads, 0.5))),
        Err(NoAnswer::NotOffered(_)) => None,
        Err(no_answer) => Some(blank.without_value(Verdict::Error, no_answer.to_string())),
    }
}

/// A measured row, not valid if there is a complaint. A row without a value has its reason already.
pub(crate) fn judged(row: Row, complaint: Option<&str>) -> Row {
    match complaint.filter(|_| row.value.is_some()) {
        Some(reason) => row.invalid(reason),
        None => row,
    }
}

/// Whether the times of one engine's method count.
pub(super) struct Check {
    engine: String,
    method: String,
    quantity: String,
    /// The reason, if they do not.
    complaint: Option<String>,
    row: Option<Row>,
}

impl Check {
    fn of(gates: &Gates, robot: &Robot, (cell, outcome): &Finished) -> Self {
        let blank =
            Row { cache: "stream".into(), metric: "worst_error".into(), unit: "1".into(), reference: REFERENCE.into(), ..row(cell, robot) };
        let limit = check::limit(robot.depth, &cell.quantity);
        let row = match outcome.answer() {
            Err(no_answer) => unanswered(blank, &no_answer, Verdict::Skip),
            Ok(errors) => blank.gated(errors.iter().copied().fold(0.0, worst), Relation::Le, limit),
        };
        let complaint = match row.verdict {
            Verdict::Pass => None,
            Verdict::Fail => Some(format!("a wrong answer has no time: {}", row.reason)),
            _ => Some(row.reason.clone()),
        };
        // Our own good answers belong to the agreement study; here only other engines and failures have rows.
        let news = cell.engine != REFERENCE || complaint.is_some();
        let (engine, method, quantity) = (cell.engine.clone(), cell.method.clone(), cell.quantity.clone());
        Self { engine, method, quantity, complaint, row: news.then(|| gates.explain(row)) }
    }
}

impl Check {
    pub(super) fn find<'c>(checks: &'c [Self], candidate: &Candidate) -> Option<&'c Self> {
        let of =
            |check: &&Self| check.engine == candidate.engine && check.method == candidate.method && check.quantity == candidate.quantity;
        checks.iter().find(of)
    }

    /// Why a candidate's times do not count, as far as its answers go.
    pub(super) fn complaint(check: Option<&Self>) -> Option<&str> {
        match check {
            None => Some("its answers were not checked in this run"),
            Some(check) => check.complaint.as_deref(),
        }
    }
}

/// The part of an experiment that one process made.
struct Process<'a> {
    cell: &'a Cell,
    paired: Paired,
    /// Or why there are none.
    samples: Result<Samples, String>,
}

/// One experiment with its statistics.
pub(super) struct Experiment<'a> {
    cell: &'a Cell,
    pub(super) params: RowParams,
    pub(super) blank: Row,
    pub(super) candidates: Vec<Candidate>,
    pub(super) samples: Result<Processes, String>,
    /// The ratio of the A/A replicate to the reference, or why it is not known.
    control: Result<Estimate, &'static str>,
}

impl<'a> Experiment<'a> {
    /// Of its processes; the core was alone where it was about as crowded as `quietest`.
    fn of(robot: &Robot, processes: &[Process<'a>], quietest: f64) -> Self {
        let Process { cell, paired: Paired { cache, states, seconds, candidates, .. }, .. } = &processes[0];
        let samples = processes.iter().map(|process| process.samples.clone()).collect::<Result<Vec<_>, _>>();
        let samples = samples.map(|samples| Processes::new(samples, quietest));
        let fastest = samples.as_ref().ok().map(|samples| samples.steady.fastest).filter(|&fastest| fastest < processes.len());
        let params = RowParams { states: *states, seconds: *seconds, fastest, ..RowParams::default() };
        let blank = Row { kind: Kind::Measured, cache: cache.clone(), params: params::text(&params), ..row(cell, robot) };
        let control = match (candidates.iter().position(|candidate| candidate.control), &samples) {
            (Some(which), Ok(samples)) if samples.answered(which) && samples.answered(0) => Ok(samples.ratio(which, 0)),
            (Some(_), Ok(_)) => Err("the A/A control or the reference stopped answering while it was timed"),
            _ => Err("the experiment has no A/A control"),
        };
        Self { cell, params, blank, candidates: candidates.clone(), samples, control }
    }

    /// Why no time of this experiment counts: its A/A ratio, or too few processes in one state of the core.
    pub(super) fn noise(&self) -> Option<String> {
        let unsteady = self.samples.as_ref().ok().and_then(|samples| samples.steady.complaint());
        unsteady.or_else(|| self.missed())
    }

    /// What the A/A ratio shows against the experiment, if it does or is missing.
    fn missed(&self) -> Option<String> {
        match &self.control {
            Ok(control) => control.complaint(),
            Err(reason) => Some((*reason).to_owned()),
        }
    }

    /// The numbers of the two copies of our usual method, if they say how the machine drifts.
    fn copies(&self) -> Option<[Vec<f64>; 2]> {
        let which = self.candidates.iter().position(|candidate| candidate.control)?;
        let samples = self.samples.as_ref().ok()?;
        (self.control.is_ok() && samples.steady.complaint().is_none()).then(|| samples.beside_the_first(which))
    }

    /// The ratio of a candidate's time to another's; the A/A ratio widens its interval.
    pub(super) fn ratio(&self, samples: &Processes, which: usize, over: usize) -> Estimate {
        let ratio = samples.ratio(which, over);
        self.control.as_ref().map_or(ratio, |control| ratio.widened(control))
    }

    fn rows(&self, checks: &[Check], noise: Option<&str>, drift: f64) -> Vec<Row> {
        let samples = match &self.samples {
            Ok(samples) => samples,
            Err(reason) => return vec![self.blank.clone().without_value(Verdict::Error, reason.clone())],
        };
        let own_noise = self.noise();
        let mut rows = Vec::new();
        for (which, candidate) in self.candidates.iter().enumerate() {
            let blank = Row {
                engine: candidate.engine.clone(),
                engine_version: candidate.version.clone(),
                method: candidate.method.clone(),
                precision: candidate.precision().into(),
                ..self.blank.clone()
            };
            let check = Check::find(checks, candidate);
            let usual = format!("{REFERENCE} {}", self.cell.method);
            if candidate.control {
                // A reference that failed from the start has its row in the check, and there is nothing to compare.
                if self.control.is_err() && check.is_some_and(|check| check.complaint.is_some()) {
                    continue;
                }
                let blank = Row { metric: "control".into(), unit: "1".into(), reference: format!("{usual}, its first copy"), ..blank };
                rows.push(match &self.control {
                    Ok(control) => judged(estimated(blank, control), own_noise.as_deref()),
                    Err(reason) => blank.without_value(Verdict::Error, *reason),
                });
                continue;
            }
            let complaint = Check::complaint(check);
            if !samples.answered(which) {
                // A candidate that failed from the start has its row in the check.
                if complaint.is_none() {
                    let row = Row { metric: "ns_per_call".into(), unit: "ns".into(), ..blank };
                    rows.push(row.without_value(Verdict::Error, "it stopped answering while it was timed"));
                }
                continue;
            }
            let complaint = complaint.or(noise).or(own_noise.as_deref());
            let blank = Row { estimated: candidate.estimate, ..blank };
            let params = RowParams { drift: Some(drift), ..self.params.clone() }.with_deciles(&samples.all(which));
            let timed = Row { metric: "ns_per_call".into(), unit: "ns".into(), params, ..blank.clone() };
            rows.push(judged(estimated(timed, &samples.time(which, drift)), complaint));
            if which > 0 {
                let ratio = self.ratio(samples, which, 0);
                let blank = Row { unit: "1".into(), reference: usual, ..blank };
                rows.push(judged(estimated(Row { metric: "ratio".into(), ..blank.clone() }, &ratio), complaint));
                let finding = match ratio.pace() {
                    Pace::Slower => 1.0,
                    Pace::Alike => 0.0,
                    Pace::Faster => -1.0,
                };
                rows.push(judged(Row { metric: "finding".into(), ..blank }.informed(finding), complaint));
            }
        }
        rows
    }
}

/// A row closed with a value and its interval.
pub(crate) fn estimated(blank: Row, estimate: &Estimate) -> Row {
    blank.measured(estimate.value, estimate.low, estimate.high)
}

/// The parameters of an experiment's rows. The candidates are in rows of their own: a list of them here would be in each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct RowParams {
    pub(super) states: usize,
    pub(super) seconds: f64,
    /// The first and the last decile of a time's blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) p10: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) p90: Option<f64>,
    /// Of a time: the deviation by which the whole machine moves from run to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) drift: Option<f64>,
    /// How many of the processes count: those in which the core was at its fastest. Absent if all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fastest: Option<usize>,
    /// Of `best_other`: the methods of which the fastest is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) others: Option<Vec<String>>,
}

impl RowParams {
    fn with_deciles(&self, ns: &[f64]) -> String {
        let [p10, p90] = [0.1, 0.9].map(|fraction| Some(quantile_of(ns, fraction)));
        params::text(&Self { p10, p90, ..self.clone() })
    }
}
