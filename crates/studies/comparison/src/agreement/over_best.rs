//! Our error over that of the best engine, for every quantity.
//!
//! Both errors are distances from the truth in double-double arithmetic ([`featherbench_bench::truth`]), in the measures of the agreement
//! study, at the worst of the states. Ours is that of our usual method. The best engine's is the smallest of all other engines and their
//! methods. An error below half an ulp, 2⁻⁵³, counts as half an ulp: rounding the exact answer causes as much.

use crate::agreement::QUANTITIES;
use featherbench_bench::measure::{ForwardScale, Magnitudes, ratio, scaled_error, worst};
use featherbench_bench::truth::TruthModel;
use featherbench_bench::{Finished, Quantity, Robot};
use featherbench_results::Row;
use featherbench_study::row;
use serde_json::json;

/// The metric of the rows.
const METRIC: &str = "over_best";
/// Half an ulp of one.
const FLOOR: f64 = 0.5 * f64::EPSILON;
/// Robots with more dofs are left out: their matrices in double-double take seconds.
const DOFS: usize = 300;

/// One row for each quantity that we and another engine answered.
pub(crate) fn over_best(own: &str, robot: &Robot, finished: &[Finished], at: &[Magnitudes], forward: &[ForwardScale]) -> Vec<Row> {
    let Some(truth) = TruthModel::new(robot).filter(|_| robot.states.nv <= DOFS) else { return Vec::new() };
    let of = |quantity: Quantity| -> Option<Row> {
        let answers: Vec<&Finished> =
            finished.iter().filter(|(cell, outcome)| cell.quantity == quantity.name() && outcome.values().is_some()).collect();
        let (ours, _) = answers.iter().find(|(cell, _)| cell.engine == own)?;
        answers.iter().find(|(cell, _)| cell.engine != own)?;
        let count = robot.asked(quantity);
        let true_values: Vec<Vec<f64>> = (0..count).map(|k| truth.answer(robot, quantity, k)).collect::<Option<_>>()?;
        let error = |values: &[f64]| {
            let states = values.chunks_exact(quantity.size(robot)).zip(&true_values).enumerate();
            let errors = states.map(|(k, (value, truth))| match quantity {
                Quantity::ForwardDynamics => forward[k].forward_error(truth, value),
                _ => scaled_error(robot, quantity, &at[k], truth, value),
            });
            errors.fold(0.0, worst)
        };
        let errors: Vec<(&Finished, f64)> =
            answers.iter().filter_map(|item| item.1.values().map(|values| (*item, error(values)))).collect();
        let (_, ours_error) = errors.iter().find(|((cell, _), _)| cell == ours)?;
        let others = errors.iter().filter(|((cell, _), error)| cell.engine != own && !error.is_nan());
        let ((best, _), best_error) = others.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let (above, below) = (worst(*ours_error, FLOOR), worst(*best_error, FLOOR));
        let mut row =
            Row { states: "all".into(), metric: METRIC.into(), unit: "1".into(), reference: best.engine.clone(), ..row(ours, robot) };
        let params = json!({"base": robot.base(), "ours": ours_error, "best": best_error, "by": best.method});
        row.params = featherbench_results::canonical_json(&params);
        Some(row.informed(ratio(above, below)))
    };
    QUANTITIES.into_iter().filter(|&quantity| quantity != Quantity::Readback).filter_map(of).collect()
}
