//! What the paired experiments say: ratios with their intervals, controls, the machine's limit, and what is void.

use std::collections::BTreeMap;

use featherbench_results::{ESTIMATE, Record};
use serde::Serialize;

use crate::labels;
use crate::overview::{Overview, TIMING};

/// How the reasons of rows begin whose values do not count.
pub const VOID: &str = "void: ";
/// The quantity of the rows on the machine.
const MACHINE: &str = "machine";
/// Quantities whose best algorithm has an exact count of operations per revolute joint: multiply-adds, or single multiplications and
/// additions, each of which fills the place of one.
pub const OPERATIONS: [(&str, &str, f64); 2] = [("id", "RNEA", 142.0), ("fd", "ABA", 396.0)];

/// Everything that the section on speed shows.
#[derive(Debug, Serialize)]
pub struct Speed<'a> {
    /// Everyone but the reference, on every robot.
    pub ratios: Vec<Ratio<'a>>,
    /// The second copies of the reference.
    pub controls: Vec<Ratio<'a>>,
    /// Quantities with ratios, as name and words.
    pub quantities: Vec<[&'a str; 2]>,
    /// Times against the least that the machine could need.
    #[serde(skip)]
    pub limits: Vec<Limit<'a>>,
    /// Why no time is set beside the limit: the peak was measured too low. [`Speed::limits`] is empty then.
    #[serde(skip)]
    pub limits_void: Option<String>,
    /// What the machine does at best.
    #[serde(skip)]
    pub machine: Option<Machine>,
    /// Why times are void, and how many rows for each reason.
    #[serde(skip)]
    pub void: BTreeMap<&'a str, usize>,
}

/// A ratio of times with its interval.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio<'a> {
    /// Index of the robot.
    pub model: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// What is computed.
    pub quantity: &'a str,
    /// `stream` or `hot`.
    pub case: &'a str,
    /// With whom it is compared.
    pub reference: &'a str,
    /// Times that of the reference.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it does not count.
    pub void: bool,
    /// Whether it is an estimate.
    pub estimate: bool,
}

/// A time per joint beside the machine's limit.
#[derive(Clone, Debug)]
pub struct Limit<'a> {
    /// Index of the robot.
    pub model: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// What is computed.
    pub quantity: &'a str,
    /// `stream` or `hot`.
    pub case: &'a str,
    /// Whether the time is an estimate.
    pub estimate: bool,
    /// Nanoseconds per joint.
    pub per_joint: f64,
    /// The least that the operations of a revolute joint take, one state at a time.
    pub least: f64,
}

/// The machine.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    /// Multiply-adds per nanosecond in full vectors.
    pub vector: f64,
    /// The same in one lane.
    pub lane: f64,
    /// Shortest step of the clock, ns.
    pub clock: Option<f64>,
    /// A call that computes nothing, ns.
    pub empty: Option<f64>,
}

/// What the ratios of one method on one quantity come to over the robots.
#[derive(Clone, Debug)]
pub struct Summary<'a> {
    /// One of its ratios, for names.
    pub of: &'a Ratio<'a>,
    /// Robots.
    pub count: usize,
    /// Geometric mean.
    pub mean: f64,
    /// The least, and the robot where it is.
    pub least: (f64, usize),
    /// The largest.
    pub largest: (f64, usize),
}

impl<'a> Speed<'a> {
    /// Collects the rows of paired experiments.
    pub fn of(overview: &Overview<'a>, records: &'a [Record]) -> Self {
        let timing: Vec<&Record> = records.iter().filter(|row| row.study == TIMING).collect();
        let machine = Machine::of(&timing);
        let mut void: BTreeMap<&str, usize> = BTreeMap::new();
        for reason in timing.iter().filter(|row| row.quantity != MACHINE).filter_map(|row| row.reason.strip_prefix(VOID)) {
            let reason = reason.split_once(&format!("; {ESTIMATE}")).map_or(reason, |(reason, _)| reason);
            *void.entry(reason).or_default() += 1;
        }
        let ratios = ratios(overview, &timing, ["ratio", "ratio_low", "ratio_high"]);
        let mut quantities: Vec<&str> = ratios.iter().map(|ratio| ratio.quantity).collect();
        quantities.sort_by_key(|name| labels::quantity_rank(name));
        quantities.dedup();
        let limits = machine.map_or_else(Vec::new, |machine| limits(overview, &timing, machine));
        let limits_void = void_peak(&timing).or_else(|| below(overview, &limits));
        Self {
            controls: self::ratios(overview, &timing, ["control", "control_low", "control_high"]),
            limits: if limits_void.is_some() { Vec::new() } else { limits },
            limits_void,
            quantities: quantities.into_iter().map(|name| [name, labels::quantity(name)]).collect(),
            ratios,
            machine,
            void,
        }
    }

    /// Whether there is nothing to show.
    pub fn is_empty(&self) -> bool {
        self.ratios.is_empty() && self.controls.is_empty() && self.machine.is_none()
    }

    /// Geometric mean, least and largest of each method on each quantity; only what counts.
    pub fn summaries(&self) -> Vec<Summary<'_>> {
        let mut groups: BTreeMap<_, Vec<&Ratio>> = BTreeMap::new();
        for ratio in self.ratios.iter().filter(|ratio| !ratio.void && ratio.value > 0.0) {
            let rank = labels::quantity_rank(ratio.quantity);
            groups.entry((rank, std::cmp::Reverse(ratio.case), ratio.engine, ratio.method)).or_default().push(ratio);
        }
        groups.into_values().filter_map(Summary::of).collect()
    }
}

impl<'a> Summary<'a> {
    /// `None` of no ratios.
    fn of(mut ratios: Vec<&'a Ratio<'a>>) -> Option<Self> {
        ratios.sort_by(|a, b| a.value.total_cmp(&b.value));
        let (least, largest) = (*ratios.first()?, *ratios.last()?);
        let mean = (ratios.iter().map(|ratio| ratio.value.ln()).sum::<f64>() / ratios.len() as f64).exp();
        Some(Self { of: least, count: ratios.len(), mean, least: (least.value, least.model), largest: (largest.value, largest.model) })
    }
}

/// What a row of an experiment is about.
fn about(row: &Record) -> [&str; 5] {
    [&row.model, &row.engine, &row.method, &row.quantity, &row.case]
}

fn ratios<'a>(overview: &Overview<'a>, timing: &[&'a Record], metrics: [&str; 3]) -> Vec<Ratio<'a>> {
    let ends: BTreeMap<([&str; 5], &str), f64> = timing
        .iter()
        .filter(|row| metrics[1..].contains(&row.metric.as_str()))
        .filter_map(|row| Some(((about(row), row.metric.as_str()), row.value?)))
        .collect();
    let ratio = |row: &&'a Record| {
        let value = row.value?;
        let end = |metric| ends.get(&(about(row), metric)).copied().unwrap_or(value);
        Some(Ratio {
            model: overview.model(&row.model)?,
            engine: overview.engine(&row.engine)?,
            method: &row.method,
            quantity: &row.quantity,
            case: &row.case,
            reference: &row.reference,
            value,
            low: end(metrics[1]),
            high: end(metrics[2]),
            void: row.reason.starts_with(VOID),
            estimate: row.is_estimate(),
        })
    };
    timing.iter().filter(|row| row.metric == metrics[0]).filter_map(ratio).collect()
}

fn limits<'a>(overview: &Overview<'a>, timing: &[&'a Record], machine: Machine) -> Vec<Limit<'a>> {
    let limit = |row: &&'a Record| {
        let &(_, _, operations) = OPERATIONS.iter().find(|(quantity, ..)| *quantity == row.quantity)?;
        let (ns, joints) = (row.value?, row.bodies.filter(|&bodies| bodies > 0)?);
        Some(Limit {
            model: overview.model(&row.model)?,
            engine: overview.engine(&row.engine)?,
            method: &row.method,
            quantity: &row.quantity,
            case: &row.case,
            estimate: row.is_estimate(),
            per_joint: ns / joints as f64,
            least: operations / machine.lane,
        })
    };
    let counted = timing.iter().filter(|row| row.metric == "ns_per_call" && !row.reason.starts_with(VOID));
    counted.filter_map(limit).collect()
}

/// Why the peak is void by its own row.
fn void_peak(timing: &[&Record]) -> Option<String> {
    let peak = timing.iter().find(|row| row.quantity == MACHINE && row.metric == "fma_per_ns")?;
    peak.reason.strip_prefix(VOID).map(str::to_owned)
}

/// What is faster than its limit shows that the limit is none. (An estimate may be.)
fn below(overview: &Overview, limits: &[Limit]) -> Option<String> {
    let below: Vec<&Limit> = limits.iter().filter(|limit| !limit.estimate && limit.per_joint < limit.least).collect();
    let least = below.iter().min_by(|a, b| (a.per_joint / a.least).total_cmp(&(b.per_joint / b.least)))?;
    let (engine, model, share) = (overview.engines[least.engine], &overview.models[least.model].name, least.per_joint / least.least);
    let first = format!("{engine} {} on {model} takes {share:.2} times its limit", least.method);
    Some(format!("{} of {} times are below their limits ({first}): the peak was measured too low", below.len(), limits.len()))
}

impl Machine {
    fn of(timing: &[&Record]) -> Option<Self> {
        let value = |metric: &str| timing.iter().find(|row| row.quantity == MACHINE && row.metric == metric).and_then(|row| row.value);
        let (vector, lane) = (value("fma_per_ns")?, value("fma_per_ns_per_lane")?);
        Some(Self { vector, lane, clock: value("clock_ns"), empty: value("empty_call_ns") })
    }
}
