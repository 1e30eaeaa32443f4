//! Gates: every threshold, and every known deviation from one, as data.

use crate::deviation::{SLACK, named};
use crate::{Deviation, HarnessError, Mean, Reproduction, Suite};
use record::{Expectation, Record, Relation, Verdict};
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The thresholds of `ci/gates.toml` and the known deviations of `ci/deviations.toml`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Gates {
    gates: Vec<Gate>,
    sharp: Option<Sharpness>,
    means: Vec<Mean>,
    deviations: Vec<Deviation>,
    reproductions: Vec<Reproduction>,
    guests: Vec<String>,
}

/// A computed bound may be so wide that it sees nothing: each engine's method must meet one below this, for each kind of joint and base.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sharpness {
    /// The study.
    pub study: String,
    /// The quantity.
    pub quantity: String,
    /// The error measure with computed bounds.
    pub metric: String,
    /// What at least one bound must be below.
    pub bound: f64,
    /// Why it is what it is.
    pub reason: String,
}

/// One threshold. The first gate that matches a row judges it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gate {
    /// The study.
    pub study: String,
    /// The quantities, by name.
    pub quantities: Vec<String>,
    /// The error measure.
    pub metric: String,
    /// The engines, or all of them.
    pub engines: Option<Vec<String>>,
    /// The methods, or all of them.
    pub methods: Option<Vec<String>>,
    /// The models, or all of them: names, a trailing `*` standing for any rest.
    pub models: Option<Vec<String>>,
    /// Only robots up to this depth are gated; deeper ones are measured.
    pub max_depth: Option<usize>,
    /// The threshold.
    pub bound: f64,
    /// What the threshold is multiplied with.
    #[serde(default)]
    pub times: Factor,
    /// Why it is what it is.
    pub reason: String,
}

/// A factor of a threshold that depends on the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Factor {
    /// The threshold is a constant.
    #[default]
    One,
    /// Times the depth of the robot.
    Depth,
    /// Times the depth and the amplification of a backward error into a forward error at this state.
    DepthAndAmplification,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GateFile {
    gate: Vec<Gate>,
    sharp: Option<Sharpness>,
    #[serde(default)]
    mean: Vec<Mean>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DeviationFile {
    #[serde(default)]
    deviation: Vec<Deviation>,
    #[serde(default)]
    reproduction: Vec<Reproduction>,
}

impl Gates {
    /// Reads `gates.toml` and `deviations.toml` from a folder.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read(folder: &Path) -> Result<Self, HarnessError> {
        let read = |path: &Path| std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source));
        Self::parse(&read(&folder.join("gates.toml"))?, &read(&folder.join("deviations.toml"))?, folder)
    }

    /// The same gates in a run with engines that a user brought along: what such an engine does not offer is no fault, as in the conformance
    /// test. Its answers are judged like any engine's, and its failures to answer.
    pub fn with_guests(mut self, names: &[&str]) -> Self {
        self.guests = names.iter().map(|&name| name.to_owned()).collect();
        self
    }

    /// The gates and deviations of two texts; errors call them `gates.toml` and `deviations.toml` in `folder`.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn parse(gates: &str, deviations: &str, folder: &Path) -> Result<Self, HarnessError> {
        let GateFile { gate: gates, sharp, mean: means } = parse_toml(gates, &folder.join("gates.toml"))?;
        let path = folder.join("deviations.toml");
        let DeviationFile { deviation: deviations, reproduction: reproductions } = parse_toml(deviations, &path)?;
        for deviation in &deviations {
            if !["fail", "skip", "error"].contains(&deviation.verdict.as_str()) {
                let message = format!("deviation of {}: verdict '{}' is none of fail, skip, error", deviation.engine, deviation.verdict);
                return Err(HarnessError::Config { path, message });
            }
            if let Some(name) = &deviation.reproduction
                && reproductions.iter().all(|reproduction| reproduction.name != *name)
            {
                let message = format!("deviation of {}: there is no [[reproduction]] named '{name}'", deviation.engine);
                return Err(HarnessError::Config { path, message });
            }
        }
        let of_deviations = deviations.iter().filter_map(|deviation| Some((&deviation.engine, deviation.range?)));
        let of_reproductions = reproductions.iter().map(|reproduction| (&reproduction.name, reproduction.range));
        for (name, [low, high]) in of_deviations.chain(of_reproductions) {
            if !(0.0 < low && low <= high && high.is_finite()) {
                let message = format!("{name}: range [{low}, {high}] is not that of a deviation");
                return Err(HarnessError::Config { path, message });
            }
        }
        Ok(Self { gates, sharp, means, deviations, reproductions, guests: Vec::new() })
    }

    /// The known deviations.
    pub fn deviations(&self) -> &[Deviation] {
        &self.deviations
    }

    /// The reproductions of known deviations.
    pub fn reproductions(&self) -> &[Reproduction] {
        &self.reproductions
    }

    /// Closes a row with its value: judged where a gate matches, informed elsewhere, and then looked up among the known deviations.
    ///
    /// `amplification` turns a backward error into a forward one at the row's state (1 where that has no meaning).
    pub fn judge(&self, row: Record, value: f64, amplification: f64) -> Record {
        let depth = row.depth.unwrap_or(0);
        let gate = self.gates.iter().find(|gate| gate.matches(&row));
        let row = match gate {
            None => row.informed(value),
            Some(gate) => {
                let factor = match gate.times {
                    Factor::One => 1.0,
                    Factor::Depth => depth as f64,
                    Factor::DepthAndAmplification => depth as f64 * amplification,
                };
                row.gated(value, Relation::Le, gate.bound * factor)
            }
        };
        self.explain(row)
    }

    /// Turns a row that is no pass into a deviation where one is known.
    pub fn explain(&self, row: Record) -> Record {
        match self.deviations.iter().find(|deviation| deviation.explains(&row)) {
            Some(deviation) => row.deviating(&deviation.reason),
            None => row,
        }
    }

    /// What keeps a set of records from being green: one expectation per condition, passing or not.
    ///
    /// Conditions: no row fails; none is skipped or an error unexplained; and, when the run is `complete`, the suite's
    /// counts of rows are met exactly, and a thorough suite shows every known deviation and sharp bounds.
    pub fn conditions(&self, suite: &Suite, records: &[Record], complete: bool) -> Vec<Expectation> {
        let excused = |row: &Record| row.verdict == Verdict::Skip && self.guests.contains(&row.engine);
        let count = |verdict: Verdict| records.iter().filter(|row| row.verdict == verdict && !excused(row)).count() as u64;
        let mut conditions: Vec<Expectation> = [
            (Verdict::Fail, "rows outside their bound"),
            (Verdict::Error, "rows without a value that was due"),
            (Verdict::Skip, "rows that a subject does not offer and ci/deviations.toml does not name"),
        ]
        .map(|(verdict, what)| condition(what.to_owned(), 0, count(verdict)))
        .into();
        if !complete {
            return conditions;
        }
        conditions.push(condition("rows at all".into(), 1, u64::from(!records.is_empty())));
        for deviation in self.deviations.iter().filter(|_| suite.thorough) {
            let known = suite.agreement.as_ref().is_some_and(|agreement| agreement.engines.contains(&deviation.engine));
            if known && records.iter().any(|row| deviation.concerns(row)) {
                let seen = records.iter().any(|row| deviation.excused(row));
                let what = format!("known deviation of {} still seen: {}", deviation.engine, deviation.reason);
                conditions.push(condition(what, 1, u64::from(seen)));
                if let (Some([low, _]), Some(worst)) = (deviation.range, deviation.worst(records)) {
                    let what = format!(
                        "known deviation of {} as large as known ({low:e}, here {worst:e}): {}",
                        deviation.engine, deviation.reason
                    );
                    conditions.push(condition(what, 1, u64::from(worst >= low / SLACK)));
                }
            }
        }
        conditions.extend(self.sharp.iter().filter(|_| suite.thorough).flat_map(|sharp| sharp.conditions(suite, records)));
        conditions.extend(self.means.iter().filter(|_| suite.thorough).flat_map(|mean| mean.conditions(records)));
        for (engine, quantities) in &suite.expect {
            for (quantity, &expected) in quantities {
                let of_these = |row: &&Record| row.engine == *engine && row.quantity == *quantity && accounted(row);
                let found = records.iter().filter(of_these).count() as u64;
                conditions.push(condition(format!("rows of {engine} on {quantity} that pass or deviate as known"), expected, found));
            }
        }
        conditions
    }
}

/// Whether a row counts for a suite's `[expect]`: it passes, or has a value that deviates as known. (Near a gate, rounding on another
/// processor may turn one into the other; what counts is that the row is there.)
pub fn accounted(row: &Record) -> bool {
    row.verdict == Verdict::Pass || row.verdict == Verdict::Deviation && row.value.is_some()
}

pub(crate) fn condition(what: String, expected: u64, found: u64) -> Expectation {
    let met = expected == found;
    let reason = if met { String::new() } else { format!("expected {expected}, found {found}") };
    Expectation { what, expected, found, verdict: if met { Verdict::Pass } else { Verdict::Fail }, reason }
}

/// The sharpest bound for each kind of joint and base.
type Bounds = HashMap<(String, String), f64>;

impl Sharpness {
    /// One condition per method of the suite's engines: for how many kinds of joints and bases there is no robot with a sharp bound. An engine
    /// that a user brought along need not have every kind.
    fn conditions(&self, suite: &Suite, records: &[Record]) -> Vec<Expectation> {
        let mut sharpest: BTreeMap<(&str, &str), Bounds> = BTreeMap::new();
        let named = |engine: &String| suite.agreement.as_ref().is_some_and(|agreement| agreement.engines.contains(engine));
        let own = records.iter().filter(|row| row.engine == "native" || named(&row.engine));
        for row in own.filter(|row| row.study == self.study && row.quantity == self.quantity && row.metric == self.metric) {
            let (Some(bound), Ok(params)) = (row.bound, serde_json::from_str::<Value>(&row.params)) else { continue };
            let of_method = sharpest.entry((&row.engine, &row.method)).or_default();
            let base = params["base"].as_str().unwrap_or_default();
            for kind in params["joints"].as_array().into_iter().flatten().filter_map(Value::as_str) {
                let known = of_method.entry((kind.to_owned(), base.to_owned())).or_insert(bound);
                *known = known.min(bound);
            }
        }
        let condition = |((engine, method), bounds): (&(&str, &str), &Bounds)| {
            let blunt = bounds.values().filter(|&&bound| bound > self.bound).count() as u64;
            let what = format!("kinds of joint and base for which {engine} {method} has no {} bound below {:e}", self.metric, self.bound);
            condition(what, 0, blunt)
        };
        sharpest.iter().map(condition).collect()
    }
}

impl Gate {
    fn matches(&self, row: &Record) -> bool {
        let among = |names: &Option<Vec<String>>, name: &String| names.as_ref().is_none_or(|names| names.contains(name));
        self.study == row.study
            && self.metric == row.metric
            && self.quantities.contains(&row.quantity)
            && among(&self.engines, &row.engine)
            && among(&self.methods, &row.method)
            && self.models.as_ref().is_none_or(|models| named(models, &row.model))
            && self.max_depth.is_none_or(|limit| row.depth.unwrap_or(0) <= limit as u64)
    }
}

fn parse_toml<T: for<'a> Deserialize<'a>>(text: &str, path: &Path) -> Result<T, HarnessError> {
    toml::from_str(text).map_err(|error| HarnessError::Config { path: path.to_owned(), message: error.to_string() })
}
