//! Steps of an engine that integrates, asked by the operations `step` and `fall`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, Robot, Stepper};
use featherbench_robots::StateBatch;
use serde::Deserialize;
use serde_json::{Value, json};

/// The part of `hello` about steps.
#[derive(Clone, Debug, PartialEq, Default, Deserialize)]
pub(crate) struct Steps {
    /// The methods to step, the one without extras first.
    pub(crate) methods: Vec<String>,
    /// See [`Stepper::guard`].
    pub(crate) guard: Option<f64>,
}

impl Oracle {
    /// One question about a state; returns the answer's numbers, of which `due` are expected.
    fn stepped(&self, robot: &Robot, states: &StateBatch, question: Value, due: usize) -> Result<Vec<f64>, NoAnswer> {
        let mut session = self.session()?;
        session.open()?.hold(robot, states)?;
        shaped(&session.ask(question, Vec::new())?, "value", &[1, due])
    }
}

impl Stepper for Oracle {
    fn step_methods(&self) -> Vec<String> {
        self.hello.steps.as_ref().map(|steps| steps.methods.clone()).unwrap_or_default()
    }

    fn step_acceleration(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64) -> Result<Vec<f64>, NoAnswer> {
        let question = json!({"op": "step", "method": method, "first": k, "count": 1, "dt": dt});
        self.stepped(robot, states, question, states.nv)
    }

    fn guard(&self) -> Option<f64> {
        self.hello.steps.as_ref().and_then(|steps| steps.guard)
    }

    fn fall(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64, steps: usize) -> Result<Vec<f64>, NoAnswer> {
        let question = json!({"op": "fall", "method": method, "first": k, "count": 1, "dt": dt, "steps": steps});
        self.stepped(robot, states, question, steps)
    }
}
