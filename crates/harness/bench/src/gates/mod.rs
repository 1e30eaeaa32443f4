//! Gates: every threshold, and every known deviation, as data.

pub(crate) mod counts;
pub(crate) mod deviation;
pub(crate) mod known;
pub(crate) mod means;
pub(crate) mod meter;
pub(crate) mod ranges;

use crate::gates::known::Known;
use crate::gates::ranges::files;
use crate::robot::class::named;
use crate::{Deviation, DeviationFile, Engines, HarnessError, Lack, Mean, Ranges, Reproduction, Suite};
use featherbench_results::{Culprit, Expectation, GateKind, Properties, Quantity, Relation, Row, Verdict};
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The thresholds of `ci/gates.toml`, the known deviations and their sizes in `ci/deviations/`, and what engines do not offer.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Gates {
    gates: Vec<Gate>,
    sharp: Option<Sharpness>,
    means: Vec<Mean>,
    known: Known,
    externals: Vec<String>,
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

impl Gates {
    /// Reads `gates.toml` and the files of `deviations/` from a folder. What the engines do not offer is said in their descriptions.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key, or the entry.
    pub fn read(folder: &Path, engines: &Engines) -> Result<Self, HarnessError> {
        Self::read_without_ranges(folder, engines)?.with_ranges(Ranges::read(&folder.join("deviations"))?, folder)
    }

    /// Reads the same without the sizes of deviations: what is needed to measure them.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key, or the entry.
    pub fn read_without_ranges(folder: &Path, engines: &Engines) -> Result<Self, HarnessError> {
        let path = folder.join("gates.toml");
        let text = std::fs::read_to_string(&path).map_err(|source| HarnessError::io(&path, source))?;
        let mut gates = Self::parse(&text, &path)?.with_lacks(engines.lacks());
        for path in files(&folder.join("deviations"), "toml")? {
            gates = gates.with_deviations(DeviationFile::read(&path)?);
        }
        Ok(gates)
    }

    /// The same gates in a run with external engines. Something that such an engine does not offer is not a fault, as in the conformance
    /// test. Its answers, and its failures to answer, are judged like any engine's.
    pub fn with_external(mut self, names: &[&str]) -> Self {
        self.externals = names.iter().map(|&name| name.to_owned()).collect();
        self
    }

    /// The gates of a text, without known deviations; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let GateFile { gate: gates, sharp, mean: means } =
            toml::from_str(text).map_err(|error| HarnessError::Config { path: path.to_owned(), message: error.to_string() })?;
        Ok(Self { gates, sharp, means, ..Self::default() })
    }

    /// The same gates, with the known deviations of one more engine.
    pub fn with_deviations(mut self, file: DeviationFile) -> Self {
        self.known.add(file);
        self
    }

    /// The same gates, with what engines do not offer.
    pub fn with_lacks(mut self, lacks: Vec<Lack>) -> Self {
        self.known.lacks = lacks;
        self
    }

    /// The same gates, with the deviations' sizes; errors name `folder` as their place.
    ///
    /// # Errors
    /// [`HarnessError`], when a size belongs to no known deviation.
    pub fn with_ranges(mut self, ranges: Ranges, folder: &Path) -> Result<Self, HarnessError> {
        self.known.set_ranges(ranges, folder)?;
        Ok(self)
    }

    /// The same gates, with the properties of the robots that will be judged.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and entry, when a robot with a size of a deviation is not of its class, or when two entries are about
    /// the same errors of a robot.
    pub fn with_robots(mut self, robots: impl IntoIterator<Item = (String, Properties)>) -> Result<Self, HarnessError> {
        self.known.set_robots(robots.into_iter().collect())?;
        Ok(self)
    }

    /// The same gates for a robot that was altered and keeps its name: its sizes are those of the name, its class is that of the new properties.
    ///
    /// It is what a reduced case is judged by. Where [`Gates::with_robots`] refuses a robot that has left the class of a size, this one lets its
    /// rows fail.
    pub fn with_altered(mut self, robot: &str, properties: Properties) -> Self {
        self.known.set_altered(robot, properties);
        self
    }

    /// The known deviations.
    pub fn deviations(&self) -> &[Deviation] {
        &self.known.deviations
    }

    /// The known deviations with a measured size that may be the cause of a row.
    pub fn measured<'a>(&'a self, row: &Row) -> impl Iterator<Item = &'a Deviation> {
        self.known.measured(row)
    }

    /// What engines do not offer.
    pub fn lacks(&self) -> &[Lack] {
        &self.known.lacks
    }

    /// The sizes of the known deviations.
    pub fn ranges(&self) -> &Ranges {
        &self.known.ranges
    }

    /// The reproductions of known deviations.
    pub fn reproductions(&self) -> &[Reproduction] {
        &self.known.reproductions
    }

    /// Plants a fault of ten times its bound (or one, where the bound is zero) under each gate: which of them fire. One that does not is hidden by a gate before it.
    pub fn planted(&self) -> Vec<Planted<'_>> {
        let first = |row: &Row| self.gates.iter().find(|gate| gate.matches(row));
        let fires = |gate: &Gate, row: Row| {
            let depth = row.depth.unwrap_or(0) as f64;
            let bound = gate.bound * if gate.times == Factor::One { 1.0 } else { depth };
            // Nothing may be counted where the bound is zero: one is the smallest fault.
            let fault = if bound == 0.0 { 1.0 } else { 10.0 * bound };
            first(&row).is_some_and(|found| std::ptr::eq(found, gate)) && self.judge(row, fault, 1.0).verdict == Verdict::Fail
        };
        self.gates.iter().map(|gate| Planted { gate, fired: gate.examples().any(|row| fires(gate, row)) }).collect()
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
                let bound = gate.bound * factor * rounding(&row);
                row.gated(value, Relation::Le, bound)
            }
        };
        self.explain(row)
    }

    /// Gives a row that does not pass its known cause.
    /// - A failure within the range that was measured for its robot becomes a known deviation, and so does an error.
    /// - A question that an engine does not offer stays a skip.
    /// - A failure without a range, or beyond it, stays a failure and says so.
    pub fn explain(&self, row: Row) -> Row {
        self.known.explain(row)
    }

    /// The conditions that a set of rows must meet: one expectation each, passing or not.
    ///
    /// - No row fails, and every skip and error is explained.
    /// - If the run is `complete`, it has rows. A thorough suite then also shows every known deviation in its known size, everything that is not offered, and sharp bounds.
    pub fn conditions(&self, suite: &Suite, records: &[Row], complete: bool) -> Vec<Expectation> {
        // The culprit is the first row of those with the least margin.
        let none = |kind: GateKind, what: &str, of_these: &dyn Fn(&Row) -> bool| {
            let rows = || records.iter().filter(|row| of_these(row));
            let margin = |row: &Row| row.margin.unwrap_or(f64::NEG_INFINITY);
            let worst = rows().min_by(|a, b| margin(a).total_cmp(&margin(b)));
            Expectation::new(kind, what.into(), 0, rows().count() as u64).about(worst.map(Culprit::of).unwrap_or_default())
        };
        let unknown = |row: &Row| {
            let excused = self.externals.contains(&row.engine) || self.known.is_lacking(row);
            // A row without a quantity says that an engine offers nothing of a study. `ci/counts.csv` knows what each engine answers.
            row.verdict == Verdict::Skip && !excused && !row.quantity.is_empty()
        };
        let mut conditions = vec![
            none(GateKind::Bound, "rows outside their bound", &|row| row.verdict == Verdict::Fail),
            none(GateKind::Answer, "rows without a value that was due", &|row| row.verdict == Verdict::Error),
            none(GateKind::Unlisted, "rows that an engine does not offer and oracles/engines.toml does not name", &unknown),
        ];
        if !complete {
            return conditions;
        }
        conditions.push(Expectation::new(GateKind::Rows, "rows at all".into(), 1, u64::from(!records.is_empty())));
        if suite.thorough {
            conditions.extend(self.known.still_seen(suite, records));
            conditions.extend(self.sharp.iter().flat_map(|sharp| sharp.conditions(suite, records)));
            conditions.extend(self.means.iter().flat_map(|mean| mean.conditions(records)));
        }
        conditions
    }
}

/// The rounding of a row's arithmetic over that of its gate, which is stated for `f64`. Quantities of single precision have gates of their own.
fn rounding(row: &Row) -> f64 {
    let own = Quantity::parse(&row.quantity).is_some_and(|quantity| quantity.precision() == "f32");
    if own { 1.0 } else { row.roundoff() / f64::EPSILON }
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
            let culprit = Culprit {
                study: self.study.clone(),
                quantity: self.quantity.clone(),
                method: (*method).to_owned(),
                ..Culprit::engine(engine)
            };
            Expectation::new(GateKind::Sharp, what, 0, blunt).about(culprit)
        };
        sharpest.iter().map(condition).collect()
    }
}

/// A gate in which a fault was planted.
#[derive(Clone, Copy, Debug)]
pub struct Planted<'a> {
    /// The gate.
    pub gate: &'a Gate,
    /// Whether the fault made it fail.
    pub fired: bool,
}

/// Depths of the rows that a gate is tried with: below, at and far beyond every `max_depth`.
const DEPTHS: [u64; 3] = [1, 20, 1000];

impl Gate {
    /// Rows that it judges, if no gate before it does: of each quantity, engine, method and robot that it names.
    fn examples(&self) -> impl Iterator<Item = Row> + '_ {
        fn named(names: Option<&Vec<String>>) -> Vec<String> {
            names.map_or_else(|| vec!["any".to_owned()], |names| names.iter().map(|name| name.trim_end_matches('*').to_owned()).collect())
        }
        let lists = [Some(&self.quantities), self.engines.as_ref(), self.methods.as_ref(), self.robots.as_ref()].map(named);
        let mut rows = vec![Row { study: self.study.clone(), metric: self.metric.clone(), ..Row::default() }];
        let set: [fn(Row, String) -> Row; 4] = [
            |row, quantity| Row { quantity, ..row },
            |row, engine| Row { engine, ..row },
            |row, method| Row { method, ..row },
            |row, robot| Row { robot, ..row },
        ];
        for (names, set) in lists.iter().zip(set) {
            rows = rows.iter().flat_map(|row| names.iter().map(move |name| set(row.clone(), name.clone()))).collect();
        }
        rows.into_iter().flat_map(|row| DEPTHS.map(|depth| Row { depth: Some(depth), ..row.clone() }))
    }

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
