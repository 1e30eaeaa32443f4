//! The limit of small steps: how an engine whose acceleration is that of a step approaches the true one, and what its steps do to energy.
//!
//! *Acceleration*: the step's acceleration against our forward dynamics, in the kinetic-energy norm, at steps of 1e-2 … 1e-10 s. Its order
//! of convergence is the slope of a line through the logarithms, over the straight part.
//! *Energy*: a motion under gravity alone over [`HORIZON`] seconds. Its value is the largest difference of the energy from that at the
//! start, with its order.
//!
//! Orders are those of the engine's first method to step. The effects of its own settings (damping, substeps) and of high speed are in
//! other rows.
//!
//! An engine may leave out the term that makes its steps implicit when a step is long and the robot fast ([`Stepper::guard`]). Such a step
//! is
//! *explicit*, and begins with the true acceleration: its error is rounding. A shorter, *implicit* step has an error of first order. A row
//! names the regime of its step, and an order is fitted over implicit steps alone.

pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::measure::{ForwardScale, scaled_error, worst};
use featherbench_bench::{
    Asked, Cell, Context, Engine, Finished, NoAnswer, NoSettings, OWN, Outcome, Quantity, Robot, Stepper, Study, params,
};
use featherbench_dynamics::{energy, forward_dynamics};
use featherbench_results::{Row, Verdict};
use featherbench_robots::Case;
use featherbench_study::{Entry, row, unanswered};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::ops::RangeInclusive;

/// Steps of the acceleration, s.
const STEPS: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// Steps of the motion, s: whole fractions of the horizon.
const MOTION_STEPS: [f64; 6] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4];
/// Length of the motion, s.
const HORIZON: f64 = 0.2;
/// Errors of the straight part. Below it is rounding. Above it is the second order, whose relative share of an error e is about e.
const STRAIGHT: RangeInclusive<f64> = 1e-11..=1e-2;
/// Steps of the straight part of the energy, s: the share of the second order falls with the step.
const STRAIGHT_MOTION: RangeInclusive<f64> = 0.0..=1e-3;
/// The cases: the first state of each is used. The motion begins at the first.
const CASES: [Case; 2] = [Case::Random, Case::Fast];

/// The study of small steps.
pub struct Steps;

/// The study in the registry.
pub const ENTRY: Entry =
    Entry { name: "steps", make: |setup| setup.made("steps", |_: NoSettings| Steps), sections: section::sections, words: words::WORDS };

impl Study for Steps {
    fn name(&self) -> &'static str {
        "steps"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        true
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            for engine in context.engines {
                let Some(stepper) = engine.stepper() else { continue };
                let identity = engine.identity();
                for method in stepper.step_methods() {
                    for quantity in [Quantity::ForwardDynamics, Quantity::KineticEnergy] {
                        cells.push(Cell::new(self.name(), robot, identity, quantity.name(), method.as_str(), json!({})));
                    }
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let errors = || {
            let (robot, stepper) = (asked.robot()?, asked.offered(|engine| engine.stepper())?);
            let of = if asked.quantity()? == Quantity::ForwardDynamics { accelerations } else { drifts };
            of(robot, stepper, &asked.cell.method)
        };
        errors().into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            let blank = Row { unit: "1".into(), reference: OWN.into(), ..row(cell, robot) };
            let values = match outcome.answer() {
                Ok(values) => values,
                Err(no_answer) => {
                    rows.push(context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip)));
                    continue;
                }
            };
            let acceleration = cell.quantity == Quantity::ForwardDynamics.name();
            let (steps, metric) = if acceleration { (&STEPS[..], "step_error") } else { (&MOTION_STEPS[..], "energy_drift") };
            let stepper = context.engine(&cell.engine).and_then(|engine| engine.stepper());
            let first = stepper.and_then(|stepper| stepper.step_methods().into_iter().next());
            let plain = first.as_ref() == Some(&cell.method);
            for ((case, state), values) in states(robot).into_iter().zip(values.chunks_exact(steps.len())) {
                let blank = Row { states: case.name().into(), ..blank.clone() };
                // If no force depends on velocity, a step of any length is exact and has no order.
                let exact = values.iter().all(|error| error < STRAIGHT.start());
                let guard = stepper.and_then(|stepper| stepper.guard()).filter(|_| acceleration && plain && !exact);
                let regime = |dt: f64, error: f64| Some(Regime::of(dt, error, speed(robot.states.v(state)), guard?));
                for (&dt, &value) in steps.iter().zip(values) {
                    let regime = regime(dt, value);
                    let mut row =
                        Row { metric: metric.into(), params: params::text(&Step { dt, regime }), ..blank.clone() }.informed(value);
                    if regime == Some(Regime::Explicit) && row.value.is_some() {
                        row.reason = EXPLICIT.into();
                    }
                    rows.push(row);
                }
                // An explicit step's error is below the straight part: an order belongs to implicit steps.
                let straight = |&(dt, error): &(f64, f64)| {
                    if acceleration { STRAIGHT.contains(&error) } else { STRAIGHT_MOTION.contains(&dt) }
                };
                let points: Vec<(f64, f64)> = steps.iter().copied().zip(values.iter().copied()).filter(straight).collect();
                if case == Case::Random && plain && !exact {
                    rows.extend(orders(context, &blank, &points));
                }
            }
        }
        rows
    }
}

/// The reason in the row of an explicit step.
const EXPLICIT: &str = "the engine's energy guard left out the implicit term: this step is explicit, and begins with the true acceleration";

/// The parameters of the row of a step.
#[derive(Serialize, Deserialize)]
struct Step {
    dt: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    regime: Option<Regime>,
}

/// The kind of a step by an engine that has a guard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Regime {
    /// With the term that makes it implicit: the error is of first order in its length.
    Implicit,
    /// Without it: the error is rounding.
    Explicit,
}

impl Regime {
    /// The regime of a step with this error from a state with this speed. A step is explicit if dt·|v| ≥ guard and its error is not of
    /// first order. (From the guard on, dt·|v| is 1e-3 and more, and so is the implicit term's share.)
    fn of(dt: f64, error: f64, speed: f64, guard: f64) -> Self {
        if dt * speed >= guard && error < *STRAIGHT.start() { Self::Explicit } else { Self::Implicit }
    }
}

/// ‖v‖₂: at least the largest velocity in any axes that an engine may use for a joint.
fn speed(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The fitted order, and how far it is from one.
fn orders(context: &Context, blank: &Row, points: &[(f64, f64)]) -> Vec<Row> {
    let order = Row { metric: "order".into(), ..blank.clone() };
    let Some(slope) = slope(points) else {
        return vec![context.gates.explain(order.without_value(Verdict::Error, "too few steps on the straight part"))];
    };
    let off = Row { metric: "order_off_one".into(), ..blank.clone() };
    vec![order.informed(slope), context.gates.judge(off, (slope - 1.0).abs(), 1.0)]
}

/// The first state of each case that the robot has.
fn states(robot: &Robot) -> Vec<(Case, usize)> {
    let first = |case| robot.states.cases.iter().position(|&other| other == case).map(|state| (case, state));
    CASES.into_iter().filter_map(first).collect()
}

/// The error of the acceleration, case after case, at each step length.
fn accelerations(robot: &Robot, stepper: &dyn Stepper, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let (at, batch) = (robot.magnitudes(), &robot.states);
    let scales = ForwardScale::all(robot, &at);
    let mut errors = Vec::new();
    for (_, k) in states(robot) {
        let exact = forward_dynamics(&robot.model, batch.q(k), batch.v(k), batch.tau(k));
        let exact = exact.map_err(|error| NoAnswer::Failed(error.to_string()))?;
        for dt in STEPS {
            errors.push(scales[k].forward_error(&exact, &stepper.step_acceleration(robot, method, batch, k, dt)?));
        }
    }
    Ok(errors)
}

/// The largest difference of the energy from the start's at each step length, in the measure of the potential energy.
fn drifts(robot: &Robot, stepper: &dyn Stepper, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let batch = &robot.states;
    let Some(&(_, k)) = states(robot).first() else { return Ok(Vec::new()) };
    let start = energy(&robot.model, batch.q(k), batch.v(k)).map_err(|error| NoAnswer::Failed(error.to_string()))?;
    let (start, at) = (start.kinetic + start.potential, robot.magnitudes());
    let drift = |dt: f64| {
        let energies = stepper.fall(robot, method, batch, k, dt, (HORIZON / dt).round() as usize)?;
        let drifts = energies.iter().map(|&energy| scaled_error(robot, Quantity::PotentialEnergy, &at[k], &[start], &[energy]));
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
    use super::{Regime, STRAIGHT, slope, speed};

    #[test]
    fn an_explicit_step_is_long_fast_and_exact() {
        let of = |dt, error, speed| Regime::of(dt, error, speed, 1e-3);
        assert_eq!(of(1e-3, 3e-16, 1000.0), Regime::Explicit);
        assert_eq!(of(1e-4, 5e-2, 1000.0), Regime::Implicit, "the guard looked and left the term in");
        assert_eq!(of(1e-3, 3e-16, 0.9), Regime::Implicit, "the guard does not look");
        assert_eq!(of(1e-3, 3e-16, 1.0), Regime::Explicit, "from its limit on it does");
        assert_eq!(of(1e-3, f64::NAN, 1000.0), Regime::Implicit);
        let edge = *STRAIGHT.start();
        assert_eq!(
            (of(1.0, edge, 1.0), of(1.0, edge.next_down(), 1.0)),
            (Regime::Implicit, Regime::Explicit),
            "no explicit step has an order"
        );
        assert_eq!(serde_json::json!([Regime::Implicit, Regime::Explicit]), serde_json::json!(["implicit", "explicit"]));
        assert_eq!((speed(&[3.0, -4.0]), speed(&[])), (5.0, 0.0));
    }

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> = [1e-2, 1e-3, 1e-5].iter().map(|x: &f64| (*x, 7.0 * x.powf(1.5))).collect();
        assert!((slope(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(slope(&points[..2]), None);
    }
}
