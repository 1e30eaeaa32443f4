//! The sizes of known deviations, measured over runs.

use crate::measure::worst;
use crate::{Gates, Range, RangeKey, Ranges};
use featherbench_results::{Row, Verdict};
use std::collections::BTreeMap;

/// Ranges while runs are added: the worst values of each run, for each deviation that may be their cause.
#[derive(Clone, Debug, Default)]
pub struct RangesMeter(BTreeMap<RangeKey, BTreeMap<String, Vec<Worst>>>);

/// The worst value of one run.
#[derive(Clone, Copy, Debug)]
struct Worst {
    value: f64,
    outside: bool,
}

impl RangesMeter {
    /// Adds the rows of one run, with the gates that know its robots. Rows of a deviation with the verdict `fail` count with their value,
    /// whether they miss their bound in this run or not.
    pub fn add(&mut self, gates: &Gates, records: &[Row]) {
        let mut run: BTreeMap<(RangeKey, String), Worst> = BTreeMap::new();
        for row in records.iter().filter(|row| row.bound.is_some()) {
            let Some(value) = row.value else { continue };
            let outside = matches!(row.verdict, Verdict::Fail | Verdict::Deviation);
            for known in gates.measured(row) {
                let found = run.entry((RangeKey::of(row), known.id.clone())).or_insert(Worst { value, outside });
                *found = Worst { value: worst(found.value, value), outside: found.outside || outside };
            }
        }
        for ((key, id), found) in run {
            self.0.entry(key).or_default().entry(id).or_default().push(found);
        }
    }

    /// The ranges of the keys that were outside their bound in one of the runs. If several deviations may be the cause, `known` says which
    /// one it is: the ranges so far, of any version.
    ///
    /// # Errors
    /// A sentence that names the key and the deviations, if nothing says which one it is.
    pub fn ranges(&self, known: &Ranges) -> Result<Ranges, String> {
        let mut ranges = BTreeMap::new();
        for (key, causes) in &self.0 {
            let outside: Vec<(&String, &Vec<Worst>)> = causes.iter().filter(|(_, runs)| runs.iter().any(|run| run.outside)).collect();
            let known = || known.iter().find(|(other, _)| other.is_alike(key)).map(|(_, range)| range.deviation.as_str());
            let (id, runs) = match outside.as_slice() {
                [] => continue,
                [one] => *one,
                several => {
                    let known = known();
                    *several.iter().find(|(id, _)| Some(id.as_str()) == known).ok_or_else(|| {
                        let ids: Vec<&str> = several.iter().map(|(id, _)| id.as_str()).collect();
                        format!(
                            "{key}: the deviations {} may be its cause; add a row of the right one to ci/deviations/SUITE.csv, with any size, \
                             and measure again",
                            ids.join(", ")
                        )
                    })?
                }
            };
            let range = Range {
                deviation: id.clone(),
                low: -runs.iter().map(|run| -run.value).fold(f64::NEG_INFINITY, worst),
                high: runs.iter().map(|run| run.value).fold(0.0, worst),
                outside: runs.iter().filter(|run| run.outside).count() as u64,
                seeds: runs.len() as u64,
            };
            ranges.insert(key.clone(), range);
        }
        Ok(ranges.into_iter().collect())
    }

    /// How far the extreme run of each range is from the others, as sorted factors: largest / second largest. And second smallest / smallest,
    /// if every run was outside its bound. [`SLACK`](crate::SLACK) is chosen from them.
    pub fn leaps(&self, ranges: &Ranges) -> (Vec<f64>, Vec<f64>) {
        let (mut up, mut down) = (Vec::new(), Vec::new());
        let measured = ranges.iter().filter_map(|(key, range)| self.0.get(key)?.get(&range.deviation));
        for runs in measured.filter(|runs| runs.len() > 1) {
            let mut values: Vec<f64> = runs.iter().map(|run| run.value).collect();
            values.sort_unstable_by(f64::total_cmp);
            let last = values.len() - 1;
            up.push(values[last] / values[last - 1]);
            if runs.iter().all(|run| run.outside) {
                down.push(values[1] / values[0]);
            }
        }
        up.sort_unstable_by(f64::total_cmp);
        down.sort_unstable_by(f64::total_cmp);
        (up, down)
    }
}
