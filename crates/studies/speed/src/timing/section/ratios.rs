//! The results of the paired experiments: ratios with their intervals, A/A ratios, the machine's limit, and times that do not count.

use std::collections::BTreeMap;

use featherbench_bench::BATCH;
use featherbench_report::{Overview, labels};
use featherbench_results::Row;

use super::STUDY;

/// The quantity of the rows about the machine.
const MACHINE: &str = "machine";
/// Quantities whose best algorithm has an exact count of operations per revolute joint. They are multiply-adds, or single multiplications
/// and additions, each of which takes the place of one.
pub const OPERATIONS: [(&str, &str, f64); 2] = [("id", "RNEA", 142.0), ("fd", "ABA", 396.0)];

/// The arithmetic whose operations take half the time of those in double precision.
const SINGLE: &str = "f32";

/// The data of the section on speed.
#[derive(Debug)]
pub struct Speed<'a> {
    /// All candidates but the reference, on every robot.
    pub ratios: Vec<Ratio<'a>>,
    /// The A/A replicates of the reference.
    pub controls: Vec<Ratio<'a>>,
    /// Quantities with ratios, as name and words.
    pub quantities: Vec<[&'a str; 2]>,
    /// Times, and the least time that the machine could need.
    pub limits: Vec<Limit<'a>>,
    /// Why no time is compared with the limit: the peak was measured too low. [`Speed::limits`] is empty then.
    pub no_limits: Option<String>,
    /// The peak performance of the machine.
    pub machine: Option<Machine>,
    /// Why times do not count, and how many rows for each reason.
    pub invalid: BTreeMap<&'a str, usize>,
}

/// A ratio of times with its interval.
#[derive(Clone, Debug)]
pub struct Ratio<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// Its arithmetic.
    pub precision: &'a str,
    /// What is computed.
    pub quantity: &'a str,
    /// `stream` or `hot`.
    pub cache: &'a str,
    /// The reference.
    pub reference: &'a str,
    /// The time over that of the reference.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it counts.
    pub valid: bool,
    /// Whether it is an estimate.
    pub estimated: bool,
}

/// A time per joint, and the machine's limit.
#[derive(Clone, Debug)]
pub struct Limit<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// What is computed.
    pub quantity: &'a str,
    /// `stream` or `hot`.
    pub cache: &'a str,
    /// Whether the time is an estimate.
    pub estimated: bool,
    /// Nanoseconds per joint.
    pub per_joint: f64,
    /// The least time for the operations of a revolute joint, one state at a time.
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

/// The ratios of one method on one quantity over the robots.
#[derive(Clone, Debug)]
pub struct Summary<'a> {
    /// One of its ratios, for names.
    pub of: &'a Ratio<'a>,
    /// Robots.
    pub count: usize,
    /// Geometric mean.
    pub mean: f64,
    /// The smallest, and its robot.
    pub least: (f64, usize),
    /// The largest.
    pub largest: (f64, usize),
}

impl<'a> Speed<'a> {
    /// Collects the rows of paired experiments.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let timing: Vec<&Row> = rows.iter().filter(|row| row.study == STUDY).collect();
        let machine = Machine::of(&timing);
        let mut invalid: BTreeMap<&str, usize> = BTreeMap::new();
        for row in timing.iter().filter(|row| row.quantity != MACHINE && !row.valid) {
            *invalid.entry(&*row.reason).or_default() += 1;
        }
        let ratios = ratios(overview, &timing, "ratio");
        let mut quantities: Vec<&str> = ratios.iter().map(|ratio| ratio.quantity).collect();
        quantities.sort_by_key(|name| labels::quantity_rank(name));
        quantities.dedup();
        let limits = machine.map_or_else(Vec::new, |machine| limits(overview, &timing, machine));
        let no_limits = invalid_peak(&timing).or_else(|| below(overview, &limits));
        Self {
            controls: self::ratios(overview, &timing, "control"),
            limits: if no_limits.is_some() { Vec::new() } else { limits },
            no_limits,
            quantities: quantities.into_iter().map(|name| [name, labels::quantity(name)]).collect(),
            ratios,
            machine,
            invalid,
        }
    }

    /// Whether there is nothing to show.
    pub fn is_empty(&self) -> bool {
        self.ratios.is_empty() && self.controls.is_empty() && self.machine.is_none()
    }

    /// Geometric mean, smallest and largest of each method on each quantity, over the valid ratios.
    pub fn summaries(&self) -> Vec<Summary<'_>> {
        let mut groups: BTreeMap<_, Vec<&Ratio>> = BTreeMap::new();
        for ratio in self.ratios.iter().filter(|ratio| ratio.valid && ratio.value > 0.0) {
            let rank = labels::quantity_rank(ratio.quantity);
            groups.entry((rank, std::cmp::Reverse(ratio.cache), ratio.engine, ratio.method, ratio.precision)).or_default().push(ratio);
        }
        groups.into_values().filter_map(Summary::of).collect()
    }
}

impl<'a> Ratio<'a> {
    /// The ratio of a row, if it has a value.
    pub fn of(overview: &Overview<'a>, row: &'a Row) -> Option<Self> {
        let value = row.value?;
        Some(Self {
            robot: overview.robot(&row.robot)?,
            engine: overview.engine(&row.engine)?,
            method: &row.method,
            precision: &row.precision,
            quantity: &row.quantity,
            cache: &row.cache,
            reference: &row.reference,
            value,
            low: row.ci_low.unwrap_or(value),
            high: row.ci_high.unwrap_or(value),
            valid: row.valid,
            estimated: row.estimated,
        })
    }

    /// Whether many states are computed at once.
    pub fn is_batch(&self) -> bool {
        self.method == BATCH
    }

    /// The method, and its arithmetic unless it is f64.
    pub fn way(&self) -> String {
        if self.precision == SINGLE { format!("{} {SINGLE}", self.method) } else { self.method.to_owned() }
    }
}

impl<'a> Summary<'a> {
    /// `None` without ratios.
    fn of(mut ratios: Vec<&'a Ratio<'a>>) -> Option<Self> {
        ratios.sort_by(|a, b| a.value.total_cmp(&b.value));
        let (least, largest) = (*ratios.first()?, *ratios.last()?);
        let mean = mean(ratios.iter().map(|ratio| ratio.value));
        Some(Self { of: least, count: ratios.len(), mean, least: (least.value, least.robot), largest: (largest.value, largest.robot) })
    }
}

fn ratios<'a>(overview: &Overview<'a>, timing: &[&'a Row], metric: &str) -> Vec<Ratio<'a>> {
    timing.iter().filter(|row| row.metric == metric).filter_map(|row| Ratio::of(overview, row)).collect()
}

/// The geometric mean of ratios.
pub fn mean(ratios: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = ratios.len() as f64;
    (ratios.map(f64::ln).sum::<f64>() / count).exp()
}

fn limits<'a>(overview: &Overview<'a>, timing: &[&'a Row], machine: Machine) -> Vec<Limit<'a>> {
    let limit = |row: &&'a Row| {
        let &(_, _, operations) = OPERATIONS.iter().find(|(quantity, ..)| *quantity == row.quantity)?;
        let (ns, joints) = (row.value?, row.bodies.filter(|&bodies| bodies > 0)?);
        Some(Limit {
            robot: overview.robot(&row.robot)?,
            engine: overview.engine(&row.engine)?,
            method: &row.method,
            quantity: &row.quantity,
            cache: &row.cache,
            estimated: row.estimated,
            per_joint: ns / joints as f64,
            least: operations / machine.vector,
        })
    };
    // The peak is that of double precision.
    let counted = timing.iter().filter(|row| row.metric == "ns_per_call" && row.valid && row.precision != SINGLE);
    counted.filter_map(limit).collect()
}

/// Why the peak is not valid by its own row.
fn invalid_peak(timing: &[&Row]) -> Option<String> {
    let peak = timing.iter().find(|row| row.quantity == MACHINE && row.metric == "fma_per_ns")?;
    (!peak.valid).then(|| peak.reason.clone())
}

/// A time below its limit shows that the limit is wrong. (An estimate may be below it.)
fn below(overview: &Overview, limits: &[Limit]) -> Option<String> {
    let below: Vec<&Limit> = limits.iter().filter(|limit| !limit.estimated && limit.per_joint < limit.least).collect();
    let least = below.iter().min_by(|a, b| (a.per_joint / a.least).total_cmp(&(b.per_joint / b.least)))?;
    let (engine, robot, share) = (overview.engines[least.engine], &overview.robots[least.robot].name, least.per_joint / least.least);
    let first = format!("{engine} {} on {robot} takes {share:.2} times its limit", least.method);
    Some(format!("{} of {} times are below their limits ({first}): the peak was measured too low", below.len(), limits.len()))
}

impl Machine {
    fn of(timing: &[&Row]) -> Option<Self> {
        let value = |metric: &str| timing.iter().find(|row| row.quantity == MACHINE && row.metric == metric).and_then(|row| row.value);
        let (vector, lane) = (value("fma_per_ns")?, value("fma_per_ns_per_lane")?);
        Some(Self { vector, lane, clock: value("clock_ns"), empty: value("empty_call_ns") })
    }
}
