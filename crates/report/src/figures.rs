//! The data of the plots: errors against depth, times against size, and those of the other sections.

use std::collections::BTreeMap;

use featherbench_results::{Relation, Row};
use serde::{Deserialize, Serialize};

use crate::accuracy::Accuracy;
use crate::conditioning::{self, Family};
use crate::fit::{Fit, power_law};
use crate::joint_matrix::JointMatrix;
use crate::labels;
use crate::overview::{AGREEMENT, Overview, PAIRWISE, TIMING};
use crate::speed::Speed;
use crate::steps::{self, StepLine};
use crate::tradeoff::{Tradeoff, tradeoffs};

/// The metrics that are errors even without a gate.
pub const ERROR_METRICS: [&str; 3] = ["scaled", "forward", "backward"];

/// The data of all plots.
#[derive(Debug, Serialize)]
pub struct Figures<'a> {
    /// One plot per quantity and measure.
    pub errors: Vec<ErrorPlot<'a>>,
    /// One line per algorithm, family and cache regime.
    pub times: Vec<TimeLine<'a>>,
    /// Errors against the truth.
    pub accuracy: Accuracy<'a>,
    /// Ratios of times.
    pub speed: Speed<'a>,
    /// Methods with both a time and a true error.
    pub tradeoffs: Vec<Tradeoff<'a>>,
    /// Condition numbers.
    pub conditions: Vec<Family<'a>>,
    /// Joint types by engine and quantity.
    pub joints: JointMatrix<'a>,
    /// Errors of steps.
    pub steps: Vec<StepLine<'a>>,
}

/// Errors of one quantity under one measure.
#[derive(Debug, Serialize)]
pub struct ErrorPlot<'a> {
    /// The quantity's name.
    pub quantity: &'a str,
    /// The measure's name.
    pub metric: &'a str,
    /// Both in words.
    pub title: String,
    /// One per engine, method and scalar.
    pub traces: Vec<ErrorTrace<'a>>,
}

/// Errors of one engine's method.
#[derive(Debug, Serialize)]
pub struct ErrorTrace<'a> {
    engine: usize,
    method: &'a str,
    scalar: &'a str,
    points: Vec<ErrorPoint<'a>>,
}

/// One row's error: its model's index, its case, value, bound and floor.
#[derive(Debug, Serialize)]
struct ErrorPoint<'a>(usize, &'a str, f64, Option<f64>, Option<f64>);

/// Times of one algorithm on one family.
#[derive(Debug, Serialize)]
pub struct TimeLine<'a> {
    /// Index of the engine.
    pub engine: usize,
    /// The algorithm's name.
    pub algorithm: &'a str,
    /// The engine's method.
    pub method: &'a str,
    /// Its arithmetic.
    pub scalar: &'a str,
    /// The family of models.
    pub family: &'a str,
    /// `stream` or `hot`.
    pub cache: &'a str,
    /// One per model, by size.
    pub points: Vec<TimePoint>,
    /// Growth of the time of a call with the number of degrees of freedom.
    pub per_call: Option<Fit>,
    /// The same of the time per joint.
    pub per_joint: Option<Fit>,
}

/// The time of one model.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TimePoint {
    /// Index of the model.
    pub model: usize,
    /// Degrees of freedom.
    pub size: u64,
    /// Joints: as many as bodies.
    pub joints: u64,
    /// Nanoseconds per call.
    pub ns: f64,
    /// Its first decile, if the run has it.
    pub p10: Option<f64>,
    /// Its last decile.
    pub p90: Option<f64>,
    /// Lower end of the interval of the median, if the run has it.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// Whether the time counts.
    pub valid: bool,
    /// Whether it is an estimate.
    pub estimated: bool,
}

impl<'a> Figures<'a> {
    /// Collects the plots' data.
    pub fn of(overview: &Overview<'a>, records: &'a [Row]) -> Self {
        let (times, accuracy) = (times(overview, records), Accuracy::of(overview, records));
        Self {
            errors: errors(overview, records),
            speed: Speed::of(overview, records),
            tradeoffs: tradeoffs(&accuracy, &times),
            conditions: conditioning::families(overview, records),
            joints: JointMatrix::of(overview, records),
            steps: steps::lines(overview, records),
            times,
            accuracy,
        }
    }
}

/// Whether a row is the error of an answer that has a reference.
pub fn is_error_measure(row: &Row) -> bool {
    let gated = matches!(row.relation, Some(Relation::Le | Relation::Within));
    row.study == AGREEMENT && row.metric != PAIRWISE && (gated || ERROR_METRICS.contains(&row.metric.as_str()))
}

fn errors<'a>(overview: &Overview<'a>, records: &'a [Row]) -> Vec<ErrorPlot<'a>> {
    type Key<'a> = (usize, &'a str, &'a str);
    let mut plots: BTreeMap<(&str, &str), BTreeMap<Key, Vec<ErrorPoint>>> = BTreeMap::new();
    for row in records.iter().filter(|row| is_error_measure(row)) {
        let (Some(model), Some(engine), Some(value)) = (overview.model(&row.robot), overview.engine(&row.engine), row.value) else {
            continue;
        };
        if overview.models[model].depth.is_some_and(|depth| depth > 0) {
            let traces = plots.entry((&row.quantity, &row.metric)).or_default();
            let points = traces.entry((engine, &row.method, &row.precision)).or_default();
            points.push(ErrorPoint(model, &row.states, value.abs(), row.bound, row.floor));
        }
    }
    let mut plots: Vec<ErrorPlot> = plots
        .into_iter()
        .map(|((quantity, metric), traces)| ErrorPlot {
            quantity,
            metric,
            title: labels::error(quantity, metric),
            traces: traces.into_iter().map(|((engine, method, scalar), points)| ErrorTrace { engine, method, scalar, points }).collect(),
        })
        .collect();
    // Forward before backward error, and the rest by name.
    let metric_rank = |metric: &str| ERROR_METRICS.iter().position(|&known| known == metric).unwrap_or(ERROR_METRICS.len());
    plots.sort_by_key(|plot| (labels::quantity_rank(plot.quantity), metric_rank(plot.metric)));
    plots
}

/// The deciles of a time's blocks, from its parameters.
#[derive(Default, Deserialize)]
struct Deciles {
    p10: Option<f64>,
    p90: Option<f64>,
}

fn times<'a>(overview: &Overview<'a>, records: &'a [Row]) -> Vec<TimeLine<'a>> {
    let mut lines: BTreeMap<[&str; 6], Vec<TimePoint>> = BTreeMap::new();
    for row in records.iter().filter(|row| row.study == TIMING && row.metric == "ns_per_call") {
        let (Some(model), Some(ns)) = (overview.model(&row.robot), row.value) else { continue };
        let Some(size) = overview.models[model].nv.filter(|&size| size > 0) else { continue };
        let joints = overview.models[model].bodies.filter(|&bodies| bodies > 0).unwrap_or(size);
        let params: Deciles = serde_json::from_str(&row.params).unwrap_or_default();
        let (valid, estimated, low, high) = (row.valid, row.estimated, row.ci_low, row.ci_high);
        let point = TimePoint { model, size, joints, ns, p10: params.p10, p90: params.p90, low, high, valid, estimated };
        lines.entry([&row.engine, &row.quantity, &row.method, &row.precision, &row.family, &row.cache]).or_default().push(point);
    }
    lines
        .into_iter()
        .filter_map(|([engine, algorithm, method, scalar, family, cache], mut points)| {
            points.sort_by_key(|point| (point.size, point.model));
            // Invalid times too: they are wrong by some percent, and a fit spans decades.
            let per_call = power_law(points.iter().map(|point| (point.size as f64, point.ns)));
            let per_joint = power_law(points.iter().map(|point| (point.size as f64, point.ns / point.joints as f64)));
            let engine = overview.engine(engine)?;
            Some(TimeLine { engine, algorithm, method, scalar, family, cache, points, per_call, per_joint })
        })
        .collect()
}
