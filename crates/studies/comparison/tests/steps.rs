//! The study of small steps on a test engine that is implicit, has an energy guard, and whose energy drifts in the first order.

use featherbench_bench::{Engine, Evaluation, Identity, NoAnswer, Quantity, Robot, Stepper};
use featherbench_comparison::Steps;
use featherbench_doubles::{gates, robot, whole};
use featherbench_dynamics::{energy, forward_dynamics};
use featherbench_results::{EngineSource, Row, Verdict};
use featherbench_robots::StateBatch;
use serde_json::Value;
use std::collections::BTreeMap;

/// The value of dt·‖v‖ from which the engine tests whether its implicit term adds energy.
const GUARD: f64 = 1e-3;
/// The value of dt·‖v‖ from which it does, and the step is explicit.
const EXPLICIT: f64 = 0.3;

/// An engine that only steps.
struct Implicit(Identity);

impl Implicit {
    fn new() -> Self {
        Self(Identity { name: "implicit".into(), version: "1".into(), source: EngineSource::Live, build: BTreeMap::new() })
    }
}

impl Engine for Implicit {
    fn identity(&self) -> &Identity {
        &self.0
    }

    fn methods(&self, _: Quantity) -> Vec<String> {
        Vec::new()
    }

    fn prepare<'a>(&'a self, _: &'a Robot, _: Quantity, _: &str, _: &'a StateBatch) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        Err(NoAnswer::NotOffered("it only steps".into()))
    }

    fn stepper(&self) -> Option<&dyn Stepper> {
        Some(self)
    }
}

fn speed(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

impl Stepper for Implicit {
    fn step_methods(&self) -> Vec<String> {
        vec!["step".into(), "step_default".into()]
    }

    /// The true acceleration a times 1 − dt·‖v‖ − d. The term dt·‖v‖ is zero if the step is explicit; d is 0.1 with damping, else zero.
    fn step_acceleration(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64) -> Result<Vec<f64>, NoAnswer> {
        let exact = forward_dynamics(&robot.model, states.q(k), states.v(k), states.tau(k)).unwrap();
        let first_order = dt * speed(states.v(k));
        let damped = if method == "step" { 0.0 } else { 0.1 };
        let share = 1.0 - damped - if first_order >= EXPLICIT { 0.0 } else { first_order };
        Ok(exact.iter().map(|a| share * a).collect())
    }

    fn guard(&self) -> Option<f64> {
        Some(GUARD)
    }

    fn fall(&self, robot: &Robot, _: &str, states: &StateBatch, k: usize, dt: f64, steps: usize) -> Result<Vec<f64>, NoAnswer> {
        let start = energy(&robot.model, states.q(k), states.v(k)).unwrap();
        Ok((1..=steps).map(|i| start.kinetic + start.potential + dt * i as f64 / steps as f64).collect())
    }
}

fn params(row: &Row) -> (f64, Option<String>) {
    let params: Value = serde_json::from_str(&row.params).unwrap();
    (params["dt"].as_f64().unwrap(), params["regime"].as_str().map(str::to_owned))
}

#[test]
fn each_step_names_its_regime() {
    for spec in ["chain:n=3,layout=spatial", "joints:kind=spherical,base=fixed", "joints:kind=revolute,base=fixed"] {
        let engines: [Box<dyn Engine>; 1] = [Box::new(Implicit::new())];
        let robot = robot(spec);
        let rows = whole(&Steps, &robot, &gates(""), &engines);
        let steps = |method: &str| -> Vec<&Row> { rows.iter().filter(|row| row.metric == "step_error" && row.method == method).collect() };
        assert_eq!((steps("step").len(), steps("step_default").len()), (18, 18), "{spec}");
        let (mut explicit, mut implicit_beyond) = (0, 0);
        for row in steps("step") {
            let ((dt, regime), value) = (params(row), row.value.unwrap());
            let state = robot.states.cases.iter().position(|case| case.name() == row.states).unwrap();
            let first_order = dt * speed(robot.states.v(state));
            implicit_beyond += usize::from((GUARD..EXPLICIT).contains(&first_order));
            if first_order >= EXPLICIT {
                explicit += 1;
                assert!(value < 1e-14 && row.reason.contains("this step is explicit"), "{dt}: {value:e}: {}", row.reason);
                assert_eq!(regime.as_deref(), Some("explicit"), "{dt}");
            } else {
                assert!(value > 1e-14 && row.reason.is_empty(), "{dt}: {value:e}: {}", row.reason);
                assert_eq!(regime.as_deref(), Some("implicit"), "{dt}");
            }
            assert_eq!(row.verdict, Verdict::Info);
        }
        assert!(explicit > 0 && implicit_beyond > 0, "{spec}: {explicit} {implicit_beyond}");
        // With damping the acceleration has another limit, and its error has no regime.
        assert!(steps("step_default").iter().all(|row| params(row).1.is_none() && row.reason.is_empty()));
        assert!(rows.iter().filter(|row| row.metric == "energy_drift").all(|row| params(row).1.is_none()));
        for quantity in ["fd", "kinetic_energy"] {
            let orders: Vec<f64> =
                rows.iter().filter(|row| row.metric == "order" && row.quantity == quantity).map(|row| row.value.unwrap()).collect();
            assert!(orders.len() == 1 && (orders[0] - 1.0).abs() < 0.01, "{spec} {quantity}: {orders:?}");
        }
    }
}
