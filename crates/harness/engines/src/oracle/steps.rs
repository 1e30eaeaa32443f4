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

impl Steps {
    /// The steps that the header of a `hello` offers; `None` if it has no `steps`.
    ///
    /// # Errors
    /// A sentence, when `steps` are not what the protocol says.
    pub(crate) fn offered(steps: Option<&Value>) -> Result<Option<Self>, String> {
        let Some(steps) = steps else { return Ok(None) };
        let read: Self = serde_json::from_value(steps.clone()).map_err(|error| format!("`steps`: {error}"))?;
        if read.methods.is_empty() || read.methods.iter().any(String::is_empty) {
            return Err("`steps` have no method, or one without a name".into());
        }
        if read.guard.is_some_and(|guard| guard.is_nan() || guard <= 0.0) {
            return Err("the guard of `steps` must be positive".into());
        }
        Ok(Some(read))
    }
}

impl Oracle {
    /// One question about a state; returns the answer's numbers, of which `due` are expected.
    fn stepped(&self, robot: &Robot, states: &StateBatch, question: Value, due: usize) -> Result<Vec<f64>, NoAnswer> {
        let mut session = self.session()?;
        let built = session.build(robot).and_then(|()| session.send_states(robot, states));
        let answer = built.and_then(|()| shaped(&session.ask(question, Vec::new())?, "value", &[1, due]));
        self.give_back(session);
        answer
    }
}

impl Stepper for Oracle {
    fn step_methods(&self) -> Vec<String> {
        self.steps.as_ref().map(|steps| steps.methods.clone()).unwrap_or_default()
    }

    fn step_acceleration(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64) -> Result<Vec<f64>, NoAnswer> {
        let question = json!({"op": "step", "method": method, "first": k, "count": 1, "dt": dt});
        self.stepped(robot, states, question, states.nv)
    }

    fn guard(&self) -> Option<f64> {
        self.steps.as_ref().and_then(|steps| steps.guard)
    }

    fn fall(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64, steps: usize) -> Result<Vec<f64>, NoAnswer> {
        let question = json!({"op": "fall", "method": method, "first": k, "count": 1, "dt": dt, "steps": steps});
        self.stepped(robot, states, question, steps)
    }
}
