//! The limit of small steps: how an engine whose acceleration is that of a step approaches the true one, and what its steps do to energy.
//!
//! *Acceleration*: the step's acceleration against native forward dynamics, in the kinetic-energy norm, at steps of 1e-2 … 1e-10 s, with the order
//! of convergence: the slope of a line through the logarithms, over the steps whose error is neither rounding nor beyond a tenth.
//! *Energy*: a motion under gravity alone over [`HORIZON`] seconds, the largest difference of the energy from that at the start, with its order
//! over the steps below [`GUARD`].

use crate::row;
use dynamics::{energy, forward_dynamics};
use harness::measure::{ForwardScale, worst};
use harness::{Cell, Context, Finished, Outcome, Problem, Quantity, Refusal, Stepper, Study};
use record::{Record, Verdict};
use serde_json::json;

/// Steps of the acceleration, s.
const STEPS: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// Steps of the motion, s: whole fractions of the horizon.
const MOTION_STEPS: [f64; 6] = [2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4];
/// Length of the motion, s.
const HORIZON: f64 = 0.2;
/// The straight part of the errors: below, the curvature of a first-order error shows less than a tenth of it; above, rounding does.
const STRAIGHT: std::ops::Range<f64> = 1e-11..1e-2;
/// The state asked about: a random one of ordinary speed.
const STATE: usize = 0;

/// The study of small steps.
pub struct StepLimit;

impl Study for StepLimit {
    fn name(&self) -> &'static str {
        "step_limit"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for problem in context.problems.iter().filter(|problem| problem.takes(self.name())) {
            for subject in context.subjects {
                let Some(stepper) = subject.stepper() else { continue };
                let identity = subject.identity();
                for method in stepper.step_methods() {
                    for quantity in [Quantity::ForwardDynamics, Quantity::KineticEnergy] {
                        cells.push(Cell {
                            study: self.name().into(),
                            problem: problem.name.clone(),
                            problem_hash: problem.hash.clone(),
                            params: json!({}),
                            subject: identity.name.clone(),
                            version: identity.version.clone(),
                            method: method.clone(),
                            quantity: quantity.name().into(),
                            scalar: "f64".into(),
                        });
                    }
                }
            }
        }
        cells
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let lost = || Outcome::Refused(Refusal::Failed("there is no problem or stepping subject of this cell".into()));
        let Some(problem) = context.problem(&cell.problem) else { return lost() };
        let Some(stepper) = context.subject(&cell.subject).and_then(|subject| subject.stepper()) else { return lost() };
        match Quantity::parse(&cell.quantity) {
            Some(Quantity::ForwardDynamics) => accelerations(problem, stepper, &cell.method).into(),
            _ => drifts(problem, stepper, &cell.method).into(),
        }
    }

    fn compare(&self, context: &Context, problem: &Problem, finished: &[Finished]) -> Vec<Record> {
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            let blank = Record { case: "random".into(), unit: "1".into(), reference: "native".into(), ..row(cell, problem) };
            let values = match outcome {
                Outcome::Values(values) => values,
                Outcome::Refused(refusal) => {
                    let verdict = if matches!(refusal, Refusal::Unsupported(_)) { Verdict::Skip } else { Verdict::Error };
                    rows.push(context.gates.explain(blank.without_value(verdict, refusal.to_string())));
                    continue;
                }
            };
            let acceleration = cell.quantity == Quantity::ForwardDynamics.name();
            let (steps, metric) = if acceleration { (&STEPS[..], "step_error") } else { (&MOTION_STEPS[..], "energy_drift") };
            for (dt, &value) in steps.iter().zip(values) {
                let params = record::canonical_json(&json!({"dt": dt}));
                rows.push(Record { metric: metric.into(), params, ..blank.clone() }.informed(value));
            }
            let points: Vec<(f64, f64)> = steps.iter().copied().zip(values.iter().copied()).collect();
            let straight: Vec<_> = points.into_iter().filter(|(_, error)| !acceleration || STRAIGHT.contains(error)).collect();
            let order = Record { metric: "order".into(), ..blank.clone() };
            match slope(&straight) {
                Some(slope) => {
                    rows.push(order.informed(slope));
                    let off = Record { metric: "order_off_one".into(), ..blank };
                    rows.push(context.gates.judge(off, (slope - 1.0).abs(), 1.0));
                }
                None => rows.push(context.gates.explain(order.without_value(Verdict::Error, "too few steps on the straight part"))),
            }
        }
        rows
    }
}

/// The error of the acceleration at each step length.
fn accelerations(problem: &Problem, stepper: &dyn Stepper, method: &str) -> Result<Vec<f64>, Refusal> {
    let at = problem.magnitudes();
    let scale = &ForwardScale::all(problem, &at)[STATE];
    let states = &problem.states;
    let (q, v, tau) = (states.q(STATE), states.v(STATE), states.tau(STATE));
    let exact = forward_dynamics(&problem.model, q, v, tau).map_err(|error| Refusal::Failed(error.to_string()))?;
    STEPS.iter().map(|&dt| Ok(scale.forward_error(&exact, &stepper.step_acceleration(problem, method, states, STATE, dt)?))).collect()
}

/// The largest difference of the energy from the start's, over the kinetic energy at the start, at each step length.
fn drifts(problem: &Problem, stepper: &dyn Stepper, method: &str) -> Result<Vec<f64>, Refusal> {
    let states = &problem.states;
    let start = energy(&problem.model, states.q(STATE), states.v(STATE)).map_err(|error| Refusal::Failed(error.to_string()))?;
    let drift = |dt: f64| {
        let energies = stepper.fall(problem, method, states, STATE, dt, (HORIZON / dt).round() as usize)?;
        let drifts = energies.iter().map(|energy| (energy - start.kinetic - start.potential).abs() / start.kinetic);
        Ok(drifts.fold(0.0, worst))
    };
    MOTION_STEPS.iter().map(|&dt| drift(dt)).collect()
}

/// The slope of the line through the points' logarithms by least squares, of at least three points.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.iter().filter(|(_, y)| *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    if logs.len() < 3 {
        return None;
    }
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / n, sum.1 + point.1 / n));
    let (xx, xy) = logs.iter().fold((0.0, 0.0), |sum, point| (sum.0 + (point.0 - x).powi(2), sum.1 + (point.0 - x) * (point.1 - y)));
    Some(xy / xx)
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> = [1e-2, 1e-3, 1e-5].iter().map(|x: &f64| (*x, 7.0 * x.powf(1.5))).collect();
        assert!((slope(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(slope(&points[..2]), None);
    }
}
