//! The error of our forward dynamics against the truth, at any size: everything here is O(n) but the method `ltdl`.

use featherbench_bench::measure::ratio;
use featherbench_bench::truth::TruthModel;
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};

/// The true acceleration at the robot's first state: the articulated-body algorithm in double-double arithmetic, from the description's own
/// numbers, rounded to f64. Its own error is 1e-32 times what the algorithm loses.
///
/// # Errors
/// [`NoAnswer::Failed`] where M is singular.
pub(crate) fn truth(robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
    let answer = TruthModel::new(robot).and_then(|model| model.answer(robot, Quantity::ForwardDynamics, 0));
    answer.ok_or_else(|| NoAnswer::Failed("M is singular: there is no true answer".into()))
}

/// ‖a − truth‖₂ / ‖truth‖₂; NaN if the lengths differ.
pub(crate) fn relative_error(a: &[f64], truth: &[f64]) -> f64 {
    if a.len() != truth.len() {
        return f64::NAN;
    }
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    ratio(norm(&mut a.iter().zip(truth).map(|(a, t)| a - t)), norm(&mut truth.iter().copied()))
}

/// The error of a method of ours.
///
/// # Errors
/// [`NoAnswer`] of the engine, or of the truth.
pub(super) fn error(engine: &dyn Engine, robot: &Robot, method: &str) -> Result<f64, NoAnswer> {
    let mut prepared = engine.prepare(robot, Quantity::ForwardDynamics, method, &robot.states)?;
    prepared.run(0..1)?;
    Ok(relative_error(prepared.read(), &truth(robot)?))
}
