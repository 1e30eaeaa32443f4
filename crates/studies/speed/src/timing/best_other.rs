//! Our methods beside the best of some engines: the time of the fastest of their methods over that of our own.

use super::rows::{Check, Experiment, RowParams, estimated, judged};
use super::samples::Candidate;
use super::{BEST_OTHER, REFERENCE};
use featherbench_bench::params;
use featherbench_results::Row;

impl Experiment<'_> {
    /// The rows `best_other`, one for each of our methods: the time of the fastest method of these engines over its own, in the same rounds.
    ///
    /// A method whose answers are wrong or missing does not count. Where none is left, there is no row.
    pub(super) fn beside(&self, best_of: &[String], checks: &[Check], noise: Option<&str>) -> Vec<Row> {
        let Ok(samples) = &self.samples else { return Vec::new() };
        let complaint = |candidate: &Candidate| Check::complaint(Check::find(checks, candidate));
        let all = || (0..self.candidates.len()).filter(|&which| samples.answered(which));
        let others: Vec<usize> = all()
            .filter(|&which| best_of.contains(&self.candidates[which].engine) && complaint(&self.candidates[which]).is_none())
            .collect();
        let named = |which: usize| format!("{} {}", self.candidates[which].engine, self.candidates[which].method);
        let own_noise = self.noise();
        let mut rows = Vec::new();
        for which in all().filter(|&which| self.candidates[which].engine == REFERENCE && !self.candidates[which].control) {
            let own = &self.candidates[which];
            let ratios = others.iter().map(|&other| (other, self.ratio(samples, other, which)));
            let Some((other, ratio)) = ratios.min_by(|(_, a), (_, b)| a.value.total_cmp(&b.value)) else { continue };
            let params = RowParams { others: Some(others.iter().map(|&other| named(other)).collect()), ..self.params.clone() };
            let blank = Row {
                engine: own.engine.clone(),
                engine_version: own.version.clone(),
                method: own.method.clone(),
                precision: own.precision().into(),
                metric: BEST_OTHER.into(),
                unit: "1".into(),
                reference: named(other),
                params: params::text(&params),
                estimated: self.candidates[other].estimate,
                ..self.blank.clone()
            };
            rows.push(judged(estimated(blank, &ratio), complaint(own).or(noise).or(own_noise.as_deref())));
        }
        rows
    }
}
