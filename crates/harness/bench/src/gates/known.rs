//! What is known of the engines: their deviations, with their sizes, and what they do not offer. It explains rows that do not pass.

use crate::measure::worst;
use crate::{Deviation, DeviationFile, HarnessError, Lack, RangeKey, Ranges, Reproduction, Suite};
use featherbench_results::{Culprit, Expectation, GateKind, Properties, Row, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The probability with which a run may be without a deviation that it is to show, as of a limit on chance (`ci/gates.toml`).
const HIDDEN: f64 = 1e-6;

/// The key, in the parameters of a row, of the id of the deviation that explains the row.
const PARAMETER: &str = "deviation";

/// Known deviations and lacks, and the properties of the robots of a run.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Known {
    pub(crate) deviations: Vec<Deviation>,
    pub(crate) reproductions: Vec<Reproduction>,
    pub(crate) lacks: Vec<Lack>,
    pub(crate) ranges: Ranges,
    robots: BTreeMap<String, Properties>,
}

impl Known {
    pub(crate) fn add(&mut self, DeviationFile { deviation, reproduction, .. }: DeviationFile) {
        self.deviations.extend(deviation);
        self.reproductions.extend(reproduction);
    }

    /// Takes the sizes of the deviations, each of which must be that of a known one.
    pub(crate) fn set_ranges(&mut self, ranges: Ranges, folder: &Path) -> Result<(), HarnessError> {
        for (key, range) in ranges.iter() {
            if !self.deviations.iter().any(|known| known.id == range.deviation && known.has(key)) {
                let message = format!(
                    "a range is known of {key}, and {}.toml names no such deviation '{}'; remove the row, or write the file again with \
                     `featherbench gate --ranges … --write`",
                    key.engine, range.deviation
                );
                return Err(HarnessError::Config { path: folder.join("deviations"), message });
            }
        }
        self.ranges = ranges;
        Ok(())
    }

    /// Takes the properties of the robots. A robot with a range must be in the class of its deviation, and no two errors may be known of the
    /// same answers of a robot.
    pub(crate) fn set_robots(&mut self, robots: BTreeMap<String, Properties>) -> Result<(), HarnessError> {
        for (key, range) in self.ranges.iter() {
            let known = self.deviations.iter().find(|known| known.id == range.deviation && known.has(key));
            let (Some(known), Some(properties)) = (known, robots.get(&key.robot)) else { continue };
            if !known.class.holds(&key.robot, Some(properties)) {
                return Err(known.error(&format!("a size of it is known on {}, which is not one of its robots", key.robot)));
            }
        }
        let errors: Vec<&Deviation> = self.deviations.iter().filter(|known| !known.is_measured()).collect();
        for (index, known) in errors.iter().enumerate() {
            for other in errors[..index].iter().filter(|other| other.overlaps(known)) {
                let both = |(robot, properties): &(&String, &Properties)| {
                    known.class.holds(robot, Some(properties)) && other.class.holds(robot, Some(properties))
                };
                if let Some((robot, _)) = robots.iter().find(both) {
                    return Err(known.error(&format!("{robot} belongs to it and to '{}': nothing tells their rows apart", other.id)));
                }
            }
        }
        self.robots = robots;
        Ok(())
    }

    /// Takes the properties of one robot alone, which may be in the class of none of its sizes.
    pub(crate) fn set_altered(&mut self, robot: &str, properties: Properties) {
        self.robots = BTreeMap::from([(robot.to_owned(), properties)]);
    }

    /// What is known of a row that does not pass: see [`Gates::explain`](crate::Gates::explain).
    pub(crate) fn explain(&self, row: Row) -> Row {
        match row.verdict {
            Verdict::Skip => match self.lacks.iter().find(|lack| lack.explains(&row, self.properties(&row))) {
                Some(lack) => Row { reason: format!("{} ({})", lack.reason, row.reason), ..row },
                None => row,
            },
            Verdict::Error => {
                let known = self.about(&row).find(|known| !known.is_measured());
                match known {
                    Some(known) => deviating(row, known),
                    None => row,
                }
            }
            Verdict::Fail => self.explain_failure(row),
            Verdict::Pass | Verdict::Info | Verdict::Deviation => row,
        }
    }

    fn explain_failure(&self, row: Row) -> Row {
        let Some(range) = self.ranges.get(&row) else {
            let causes: Vec<&str> = self.measured(&row).map(|known| known.id.as_str()).collect();
            if causes.is_empty() {
                return row;
            }
            let reason = format!(
                "{}; the cause may be known ({} in ci/deviations/{}.toml), but no range was measured on this robot (`featherbench gate --ranges … \
                 --write`)",
                row.reason,
                causes.join(", "),
                row.engine
            );
            return Row { reason, ..row };
        };
        let known = self.measured(&row).find(|known| known.id == range.deviation);
        let Some(known) = known else { return row };
        if row.value.is_some_and(|value| range.admits(value)) {
            return deviating(row, known);
        }
        let reason = format!(
            "{}; larger than the known deviation '{}', which is at most {:e} in {} seeds on this robot: {}",
            row.reason, known.id, range.high, range.seeds, known.reason
        );
        Row { reason, ..row }
    }

    /// The known deviations with a measured size that may be the cause of a row.
    pub(crate) fn measured<'a>(&'a self, row: &Row) -> impl Iterator<Item = &'a Deviation> {
        self.about(row).filter(|known| known.is_measured())
    }

    fn about<'a>(&'a self, row: &Row) -> impl Iterator<Item = &'a Deviation> {
        self.deviations.iter().filter(|known| known.is_about(row, self.properties(row)))
    }

    /// Whether it is known that an engine does not offer what a row is about.
    pub(crate) fn is_lacking(&self, row: &Row) -> bool {
        self.lacks.iter().any(|lack| lack.explains(row, self.properties(row)))
    }

    fn properties(&self, row: &Row) -> Option<&Properties> {
        self.robots.get(&row.robot)
    }

    /// One condition per known deviation of the suite's engines and robots: it still occurs, unless chance may hide it (`HIDDEN`). If its size is measured, there is one more: it
    /// has the known size on every robot. And there is one condition per lack.
    pub(crate) fn still_seen(&self, suite: &Suite, records: &[Row]) -> Vec<Expectation> {
        let asked = |engine: &String| suite.engines().contains(engine);
        let mut conditions = Vec::new();
        for known in self.deviations.iter().filter(|known| asked(&known.engine)) {
            let robots = self.robots_of(known, records);
            if records.iter().any(|row| known.concerns(row) && robots.contains(row.robot.as_str())) {
                let seen = records.iter().any(|row| self.is_excused(row, known));
                let what = format!("known deviation of {}, '{}', still seen: {}", known.engine, known.id, known.reason);
                if !self.is_rare(known, records) {
                    conditions.push(Expectation::new(GateKind::Seen, what, 1, u64::from(seen)).about(Culprit::engine(&known.engine)));
                }
                conditions.extend(self.still_large(known, records));
            }
        }
        for lack in self.lacks.iter().filter(|lack| asked(&lack.engine)) {
            if records.iter().any(|row| lack.concerns(row, self.properties(row))) {
                let seen = records.iter().any(|row| lack.explains(row, self.properties(row)));
                let what = format!("{} still does not offer: {}", lack.engine, lack.reason);
                conditions.push(Expectation::new(GateKind::Lack, what, 1, u64::from(seen)).about(Culprit::engine(&lack.engine)));
            }
        }
        conditions
    }

    /// The robots of a run on which a deviation is known: those with a size; those of its class, if no size is known.
    fn robots_of<'a>(&'a self, known: &Deviation, records: &'a [Row]) -> BTreeSet<&'a str> {
        let sizes = self.ranges.iter().filter(|(key, range)| range.deviation == known.id && known.has(key));
        let measured: BTreeSet<&str> = sizes.map(|(key, _)| key.robot.as_str()).collect();
        if !measured.is_empty() {
            return measured;
        }
        records.iter().filter(|row| known.class.holds(&row.robot, self.properties(row))).map(|row| row.robot.as_str()).collect()
    }

    /// Whether a run may be without a deviation by chance: no robot of the run shows it, each by the share of seeds that its sizes had.
    fn is_rare(&self, known: &Deviation, records: &[Row]) -> bool {
        let run: BTreeSet<&str> = records.iter().map(|row| row.robot.as_str()).collect();
        let mut shown: BTreeMap<&str, f64> = BTreeMap::new();
        for (key, range) in self.ranges.iter().filter(|(key, range)| range.deviation == known.id && known.has(key)) {
            if run.contains(key.robot.as_str()) {
                let share = range.outside as f64 / range.seeds as f64;
                shown.entry(&key.robot).and_modify(|most| *most = worst(*most, share)).or_insert(share);
            }
        }
        !shown.is_empty() && shown.values().map(|share| 1.0 - share).product::<f64>() > HIDDEN
    }

    /// Whether a deviation is the cause of a row's verdict.
    fn is_excused(&self, row: &Row, known: &Deviation) -> bool {
        known.is_about(row, self.properties(row)) && cause(row).is_some_and(|id| id == known.id)
    }

    /// The condition that a deviation has its known size on each of its robots; `None` if no robot of the run showed it at every seed.
    fn still_large(&self, known: &Deviation, records: &[Row]) -> Option<Expectation> {
        let mut found: BTreeMap<RangeKey, f64> = BTreeMap::new();
        let judged = records.iter().filter(|row| row.bound.is_some() && known.is_measured() && known.is_about(row, self.properties(row)));
        for (row, value) in judged.filter_map(|row| Some((row, row.value?))) {
            if self.ranges.get(row).is_some_and(|range| range.deviation == known.id && range.outside == range.seeds) {
                let largest = found.entry(RangeKey::of(row)).or_insert(value);
                *largest = worst(*largest, value);
            }
        }
        if found.is_empty() {
            return None;
        }
        let shrunk = found.iter().filter_map(|(key, &value)| {
            let range = self.ranges.of(key).filter(|range| range.has_shrunk(value))?;
            Some((key, format!("{} {} {} ({value:e}, known from {:e})", key.robot, key.method, key.quantity, range.low)))
        });
        let (keys, shrunk): (Vec<&RangeKey>, Vec<String>) = shrunk.unzip();
        let culprit = keys.first().map_or_else(|| Culprit::engine(&known.engine), |key| key.culprit());
        let what =
            format!("robots on which a known deviation of {}, '{}', is smaller than known: {}", known.engine, known.id, known.reason);
        let reason = format!("expected 0, found {}: {}", shrunk.len(), shrunk.join(", "));
        Some(Expectation::new(GateKind::Size, what, 0, shrunk.len() as u64).because(reason).about(culprit))
    }
}

/// A row with a known deviation as its cause: the parameters name it.
fn deviating(row: Row, known: &Deviation) -> Row {
    row.deviating(&known.reason).with_param(PARAMETER, known.id.as_str().into())
}

/// The id of the deviation that explains a row; `None` if none does.
///
/// ```
/// use featherbench_results::{Row, Verdict};
///
/// let row = Row { verdict: Verdict::Deviation, params: r#"{"deviation":"far-base"}"#.into(), ..Row::default() };
/// assert_eq!(featherbench_bench::cause(&row).as_deref(), Some("far-base"));
/// assert_eq!(featherbench_bench::cause(&Row::default()), None);
/// ```
pub fn cause(row: &Row) -> Option<String> {
    if row.verdict != Verdict::Deviation {
        return None;
    }
    Some(row.param(PARAMETER)?.as_str()?.to_owned())
}
