//! Gates: every threshold, and every known deviation, as data.

use crate::deviation::named;
use crate::measure::worst;
use crate::{Deviation, HarnessError, Mean, NotOffered, RangeKey, Ranges, Reproduction, Suite};
use featherbench_results::{Expectation, Relation, Row, Verdict};
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The thresholds of `ci/gates.toml`, the known deviations of `ci/deviations.toml` and their sizes in `ci/deviations/`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Gates {
    gates: Vec<Gate>,
    sharp: Option<Sharpness>,
    means: Vec<Mean>,
    deviations: Vec<Deviation>,
    not_offered: Vec<NotOffered>,
    reproductions: Vec<Reproduction>,
    externals: Vec<String>,
    ranges: Ranges,
}

/// A computed bound may be too wide to find errors. So each engine's method must meet one below this, for each kind of joint and base.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sharpness {
    /// The study.
    pub study: String,
    /// The quantity.
    pub quantity: String,
    /// The error measure with computed bounds.
    pub metric: String,
    /// At least one bound must be below this.
    pub bound: f64,
    /// The reason for the value.
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
    /// The robots, or all of them: names; a trailing `*` stands for any rest.
    pub robots: Option<Vec<String>>,
    /// Only robots up to this depth have the gate; deeper ones are measured without it.
    pub max_depth: Option<usize>,
    /// The threshold.
    pub bound: f64,
    /// The factor of the threshold.
    #[serde(default)]
    pub times: Factor,
    /// The reason for the value.
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
    not_offered: Vec<NotOffered>,
    #[serde(default)]
    reproduction: Vec<Reproduction>,
}

impl Gates {
    /// Reads `gates.toml`, `deviations.toml` and the files of `deviations/` from a folder.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read(folder: &Path) -> Result<Self, HarnessError> {
        Self::read_without_ranges(folder)?.with_ranges(Ranges::read(&folder.join("deviations"))?, folder)
    }

    /// Reads `gates.toml` and `deviations.toml` alone: what is needed to measure the sizes of deviations.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read_without_ranges(folder: &Path) -> Result<Self, HarnessError> {
        let read = |path: &Path| std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source));
        Self::parse(&read(&folder.join("gates.toml"))?, &read(&folder.join("deviations.toml"))?, folder)
    }

    /// The same gates in a run with external engines. Something that such an engine does not offer is not a fault, as in the conformance
    /// test. Its answers, and its failures to answer, are judged like any engine's.
    pub fn with_external(mut self, names: &[&str]) -> Self {
        self.externals = names.iter().map(|&name| name.to_owned()).collect();
        self
    }

    /// The gates and deviations of two texts, without the deviations' sizes. In errors they are named `gates.toml` and `deviations.toml` in
    /// `folder`.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn parse(gates: &str, deviations: &str, folder: &Path) -> Result<Self, HarnessError> {
        let GateFile { gate: gates, sharp, mean: means } = parse_toml(gates, &folder.join("gates.toml"))?;
        let path = folder.join("deviations.toml");
        let DeviationFile { deviation: deviations, not_offered, reproduction: reproductions } = parse_toml(deviations, &path)?;
        for deviation in &deviations {
            if !["fail", "error"].contains(&deviation.verdict.as_str()) {
                let message = format!(
                    "deviation of {}: verdict '{}' is none of fail, error (what an engine does not offer is a [[not_offered]])",
                    deviation.engine, deviation.verdict
                );
                return Err(HarnessError::Config { path, message });
            }
            if let Some(name) = &deviation.reproduction
                && reproductions.iter().all(|reproduction| reproduction.name != *name)
            {
                let message = format!("deviation of {}: there is no [[reproduction]] named '{name}'", deviation.engine);
                return Err(HarnessError::Config { path, message });
            }
        }
        for Reproduction { name, range: [low, high], .. } in &reproductions {
            if !(0.0 < *low && low <= high && high.is_finite()) {
                let message = format!("{name}: range [{low}, {high}] is not that of a deviation");
                return Err(HarnessError::Config { path, message });
            }
        }
        Ok(Self { gates, sharp, means, deviations, not_offered, reproductions, externals: Vec::new(), ranges: Ranges::default() })
    }

    /// The same gates, with the deviations' sizes; errors name `folder` as their place.
    ///
    /// # Errors
    /// [`HarnessError`], when a size belongs to no known deviation.
    pub fn with_ranges(self, ranges: Ranges, folder: &Path) -> Result<Self, HarnessError> {
        for (key, _) in ranges.iter() {
            if !self.deviations.iter().any(|deviation| deviation.has(key)) {
                let RangeKey { engine, version, method, quantity, robot, .. } = key;
                let message = format!(
                    "a range is known of {engine} {version} {method}, {quantity}, {robot}, and deviations.toml names no such deviation; \
                     remove the row, or write the file again with `featherbench gate --ranges … --write`"
                );
                return Err(HarnessError::Config { path: folder.join("deviations"), message });
            }
        }
        Ok(Self { ranges, ..self })
    }

    /// The known deviations.
    pub fn deviations(&self) -> &[Deviation] {
        &self.deviations
    }

    /// The sizes of the known deviations.
    pub fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// The reproductions of known deviations.
    pub fn reproductions(&self) -> &[Reproduction] {
        &self.reproductions
    }

    /// Closes a row with its value: judged if a gate matches, otherwise informed. Then known deviations are searched.
    ///
    /// `amplification` turns a backward error into a forward one at the row's state (1 where it does not apply).
    pub fn judge(&self, row: Row, value: f64, amplification: f64) -> Row {
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

    /// Gives a row that does not pass its known cause.
    /// - A failure within the range that was measured for its robot becomes a known deviation, and so does an error.
    /// - A question that an engine does not offer stays a skip.
    /// - A failure without a range, or beyond it, stays a failure and says so.
    pub fn explain(&self, row: Row) -> Row {
        match row.verdict {
            Verdict::Skip => match self.not_offered.iter().find(|known| known.explains(&row)) {
                Some(known) => Row { reason: format!("{} ({})", known.reason, row.reason), ..row },
                None => row,
            },
            Verdict::Error => match self.deviations.iter().find(|known| known.explains_error(&row)) {
                Some(known) => row.deviating(&known.reason),
                None => row,
            },
            Verdict::Fail => match (self.measured(&row), self.ranges.get(&row)) {
                (None, _) => row,
                (Some(known), Some(range)) if row.value.is_some_and(|value| range.admits(value)) => row.deviating(&known.reason),
                (Some(known), Some(range)) => {
                    let reason = format!(
                        "{}; larger than the known deviation, which is at most {:e} in {} seeds on this robot: {}",
                        row.reason, range.high, range.seeds, known.reason
                    );
                    Row { reason, ..row }
                }
                (Some(known), None) => {
                    let reason = format!(
                        "{}; the cause may be known, but no range was measured on this robot (`featherbench gate --ranges … --write`): {}",
                        row.reason, known.reason
                    );
                    Row { reason, ..row }
                }
            },
            Verdict::Pass | Verdict::Info | Verdict::Deviation => row,
        }
    }

    /// The known deviation with a measured size that is about a row.
    fn measured(&self, row: &Row) -> Option<&Deviation> {
        self.deviations.iter().find(|known| known.is_measured() && known.is_about(row))
    }

    /// The conditions that a set of rows must meet: one expectation each, passing or not.
    ///
    /// - No row fails, and every skip and error is explained.
    /// - If the run is `complete`, it has rows. A thorough suite then also shows every known deviation in its known size, everything that is not offered, and sharp bounds.
    pub fn conditions(&self, suite: &Suite, records: &[Row], complete: bool) -> Vec<Expectation> {
        let count = |of_these: &dyn Fn(&Row) -> bool| records.iter().filter(|row| of_these(row)).count() as u64;
        let unknown = |row: &Row| {
            let excused = self.externals.contains(&row.engine) || self.not_offered.iter().any(|known| known.explains(row));
            row.verdict == Verdict::Skip && !excused
        };
        let mut conditions = vec![
            condition("rows outside their bound".into(), 0, count(&|row| row.verdict == Verdict::Fail)),
            condition("rows without a value that was due".into(), 0, count(&|row| row.verdict == Verdict::Error)),
            condition("rows that an engine does not offer and ci/deviations.toml does not name".into(), 0, count(&unknown)),
        ];
        if !complete {
            return conditions;
        }
        conditions.push(condition("rows at all".into(), 1, u64::from(!records.is_empty())));
        if suite.thorough {
            conditions.extend(self.still_seen(suite, records));
            conditions.extend(self.sharp.iter().flat_map(|sharp| sharp.conditions(suite, records)));
            conditions.extend(self.means.iter().flat_map(|mean| mean.conditions(records)));
        }
        conditions
    }

    /// One condition per known deviation of the suite's engines and robots: it still occurs. If its size is measured, there is one more: it
    /// has the known size on every robot. And there is one condition per thing that is not offered.
    fn still_seen(&self, suite: &Suite, records: &[Row]) -> Vec<Expectation> {
        let asked = |engine: &String| suite.engines().contains(engine);
        let mut conditions = Vec::new();
        for known in self.deviations.iter().filter(|known| asked(&known.engine)) {
            if records.iter().any(|row| known.concerns(row)) {
                let seen = records.iter().any(|row| known.excused(row));
                conditions.push(condition(format!("known deviation of {} still seen: {}", known.engine, known.reason), 1, u64::from(seen)));
                conditions.extend(self.still_large(known, records));
            }
        }
        for known in self.not_offered.iter().filter(|known| asked(&known.engine)) {
            if records.iter().any(|row| known.concerns(row)) {
                let seen = records.iter().any(|row| known.explains(row));
                conditions.push(condition(format!("{} still does not offer: {}", known.engine, known.reason), 1, u64::from(seen)));
            }
        }
        conditions
    }

    /// The condition that a deviation has its known size on each of its robots; `None` if no robot of the run showed it at every seed.
    fn still_large(&self, known: &Deviation, records: &[Row]) -> Option<Expectation> {
        let mut found: BTreeMap<RangeKey, f64> = BTreeMap::new();
        let judged = records.iter().filter(|row| row.bound.is_some() && known.is_measured() && known.is_about(row));
        for (row, value) in judged.filter_map(|row| Some((row, row.value?))) {
            if self.ranges.get(row).is_some_and(|range| range.outside == range.seeds) {
                let largest = found.entry(RangeKey::of(row)).or_insert(value);
                *largest = worst(*largest, value);
            }
        }
        if found.is_empty() {
            return None;
        }
        let shrunk = found.iter().filter_map(|(key, &value)| {
            let range = self.ranges.of(key).filter(|range| range.has_shrunk(value))?;
            Some(format!("{} {} {} ({value:e}, known from {:e})", key.robot, key.method, key.quantity, range.low))
        });
        let shrunk: Vec<String> = shrunk.collect();
        let what = format!("robots on which a known deviation of {} is smaller than known: {}", known.engine, known.reason);
        let mut condition = condition(what, 0, shrunk.len() as u64);
        if !shrunk.is_empty() {
            condition.reason = format!("{}: {}", condition.reason, shrunk.join(", "));
        }
        Some(condition)
    }
}

pub(crate) fn condition(what: String, expected: u64, found: u64) -> Expectation {
    let met = expected == found;
    let reason = if met { String::new() } else { format!("expected {expected}, found {found}") };
    Expectation { what, expected, found, verdict: if met { Verdict::Pass } else { Verdict::Fail }, reason }
}

/// The sharpest bound for each kind of joint and base.
type Bounds = HashMap<(String, String), f64>;

impl Sharpness {
    /// One condition per method of the suite's engines: the number of kinds of joints and bases without a robot with a sharp bound is zero.
    /// An external engine need not have every kind.
    fn conditions(&self, suite: &Suite, records: &[Row]) -> Vec<Expectation> {
        let mut sharpest: BTreeMap<(&str, &str), Bounds> = BTreeMap::new();
        let own = records.iter().filter(|row| row.engine == crate::OWN || suite.engines().contains(&row.engine));
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
    fn matches(&self, row: &Row) -> bool {
        let among = |names: &Option<Vec<String>>, name: &String| names.as_ref().is_none_or(|names| names.contains(name));
        self.study == row.study
            && self.metric == row.metric
            && self.quantities.contains(&row.quantity)
            && among(&self.engines, &row.engine)
            && among(&self.methods, &row.method)
            && self.robots.as_ref().is_none_or(|robots| named(robots, &row.robot))
            && self.max_depth.is_none_or(|limit| row.depth.unwrap_or(0) <= limit as u64)
    }
}

fn parse_toml<T: for<'a> Deserialize<'a>>(text: &str, path: &Path) -> Result<T, HarnessError> {
    toml::from_str(text).map_err(|error| HarnessError::Config { path: path.to_owned(), message: error.to_string() })
}
