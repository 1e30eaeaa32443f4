//! Means: bounds on the rows of many robots together.

use crate::measure::worst;
use featherbench_results::{Culprit, Expectation, GateKind, Row};
use serde::Deserialize;

/// A bound on the geometric mean of a metric over the robots of a run, and on the largest value.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mean {
    /// The study.
    pub study: String,
    /// The metric, of positive values.
    pub metric: String,
    /// The quantities; each has its own mean.
    pub quantities: Vec<String>,
    /// The largest allowed geometric mean.
    pub mean: f64,
    /// The largest allowed value.
    pub bound: f64,
    /// The reason for the values.
    pub reason: String,
    /// Robots with a known value beyond the bound.
    #[serde(default)]
    pub known: Vec<Known>,
}

/// A robot on which the value of a quantity is known to be beyond the bound. It still counts for the mean.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// The quantity.
    pub quantity: String,
    /// The robot.
    pub robot: String,
    /// The largest allowed value.
    pub up_to: f64,
    /// The cause.
    pub reason: String,
}

impl Mean {
    /// Two conditions per quantity: the mean, and the largest value. If no row has a value, neither is met. And one condition per known
    /// robot: its value is between the bound and the known size.
    pub(crate) fn conditions(&self, records: &[Row]) -> Vec<Expectation> {
        let of = |quantity: &String| {
            let rows = records.iter().filter(|row| row.study == self.study && row.metric == self.metric && row.quantity == *quantity);
            // A row without a value counts as infinite.
            let values: Vec<(&str, f64)> = rows.map(|row| (row.robot.as_str(), row.value.unwrap_or(f64::NAN))).collect();
            let count = values.len();
            let mean = (values.iter().map(|(_, value)| value.ln()).sum::<f64>() / count as f64).exp();
            let known = |robot: &str| self.known.iter().find(|known| known.quantity == *quantity && known.robot == robot);
            let others = values.iter().filter(|(robot, _)| known(robot).is_none()).map(|&(_, value)| value);
            let largest = others.reduce(worst).unwrap_or(f64::NAN);
            let condition = |what: String, met: bool, robot: &str| {
                let culprit = Culprit {
                    study: self.study.clone(),
                    robot: robot.to_owned(),
                    quantity: quantity.clone(),
                    ..Culprit::engine(crate::OWN)
                };
                Expectation::new(GateKind::Mean, what, 1, u64::from(met)).about(culprit)
            };
            let held = |value: f64, bound: f64, name: &str| {
                let what = format!("{name} of {} on {quantity} over {count} robots is {value:.2}, at most {bound}", self.metric);
                condition(what, value <= bound, "")
            };
            let mut conditions = vec![held(mean, self.mean, "geometric mean"), held(largest, self.bound, "largest")];
            conditions.extend(values.iter().filter_map(|&(robot, value)| {
                let Known { up_to, reason, .. } = known(robot)?;
                let what =
                    format!("{} on {quantity} of {robot} is {value:.2}, known from {} to {up_to}: {reason}", self.metric, self.bound);
                Some(condition(what, self.bound < value && value <= *up_to, robot))
            }));
            conditions
        };
        self.quantities.iter().flat_map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::Verdict;

    fn rows(values: &[f64]) -> Vec<Row> {
        let row = Row { study: "agreement".into(), metric: "over_best".into(), quantity: "id".into(), ..Row::default() };
        values.iter().map(|&value| row.clone().informed(value)).collect()
    }

    #[test]
    fn the_mean_and_the_largest_value_are_held_and_nothing_is_not_enough() {
        let (study, metric, reason) = ("agreement".to_owned(), "over_best".to_owned(), String::new());
        let mean = Mean { study, metric, quantities: vec!["id".into()], mean: 1.5, bound: 3.0, reason, known: Vec::new() };
        let met = |values: &[f64]| mean.conditions(&rows(values)).iter().map(|c| c.verdict == Verdict::Pass).collect::<Vec<_>>();
        assert_eq!(met(&[1.0, 2.25]), [true, true], "√(1·2.25) = 1.5");
        assert_eq!(met(&[1.0, 2.3]), [false, true]);
        assert_eq!(met(&[0.1, 3.0]), [true, true]);
        assert_eq!(met(&[0.1, 3.01]), [true, false]);
        assert_eq!(met(&[]), [false, false], "no row");
        assert_eq!(met(&[f64::NAN, 1.0]), [false, false], "a row without a value");
        // A known robot counts for the mean, and must have its known size.
        let named = |value: f64| {
            let mut records = rows(&[1.0, value]);
            records[1].robot = "far".into();
            records
        };
        let known = Known { quantity: "id".into(), robot: "far".into(), up_to: 4.0, reason: "a cause".into() };
        let excusing = Mean { known: vec![known], ..mean.clone() };
        let met = |value: f64| excusing.conditions(&named(value)).iter().map(|c| c.verdict == Verdict::Pass).collect::<Vec<_>>();
        assert_eq!(met(3.5), [false, true, true], "√3.5 > 1.5");
        assert_eq!(met(4.1), [false, true, false], "more than is known");
        assert_eq!(met(2.0), [true, true, false], "no longer seen");
        assert_eq!(met(f64::NAN), [false, true, false]);
        let mut other = rows(&[1.0]);
        other[0].quantity = "bias".into();
        assert!(mean.conditions(&other).iter().all(|c| c.verdict == Verdict::Fail), "another quantity");
    }
}
