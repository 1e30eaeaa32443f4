//! Quantities of a robot in states, by the operations `evaluate` and `clock`.

use super::{Lent, shaped};
use crate::shape;
use featherbench_bench::{Engine, Evaluation, NoAnswer, Quantity, Robot, layout};
use featherbench_protocol::Memory;
use serde_json::{Value, json};
use std::ops::Range;
use std::time::Duration;

/// A question to a session that has robot and states.
pub(super) struct Asked<'a> {
    session: Lent<'a>,
    robot: &'a Robot,
    quantity: Quantity,
    method: String,
    values: Vec<f64>,
    /// The overhead that was subtracted from the last time of the oracle's clock.
    overhead: Option<Duration>,
}

impl<'a> Asked<'a> {
    pub(super) fn new(session: Lent<'a>, robot: &'a Robot, quantity: Quantity, method: &str) -> Self {
        Self { session, robot, quantity, method: method.to_owned(), values: Vec::new(), overhead: None }
    }

    /// The question about a range of states.
    fn question(&self, op: &str, range: &Range<usize>) -> Value {
        self.question_about(op, self.quantity, self.robot.deepest_body(), range)
    }

    /// The question about a quantity, of this body if it is one of a body.
    fn question_about(&self, op: &str, quantity: Quantity, body: usize, range: &Range<usize>) -> Value {
        json!({
            "op": op, "quantity": quantity.name(), "method": self.method,
            "first": range.start, "count": range.len(), "body": body,
        })
    }

    /// Asks for the Jacobian of every body, and multiplies each with the vectors of the probe. The Jacobians of one body at all states are
    /// in memory at a time.
    fn run_jacobians(&mut self, range: &Range<usize>) -> Result<(), NoAnswer> {
        let (robot, quantity) = (self.robot, Quantity::BodyJacobian);
        let (nv, probe, bodies) = (robot.states.nv, robot.probe(), robot.description.bodies.len());
        let due = shape::of_value(quantity, robot, range.len());
        let size = Quantity::BodyJacobians.size(robot);
        let each = size / bodies;
        self.values = vec![0.0; range.len() * size];
        for body in 0..bodies {
            let question = self.question_about("evaluate", quantity, body, range);
            let answer = self.session.open()?.ask(question, Vec::new())?;
            let jacobians = shaped(&answer, "value", &due)?;
            for (jacobian, out) in jacobians.chunks_exact(6 * nv).zip(self.values.chunks_exact_mut(size)) {
                layout::jacobian_products(|row, dof| jacobian[row * nv + dof], &probe, nv, &mut out[body * each..(body + 1) * each]);
            }
        }
        Ok(())
    }
}

impl Evaluation for Asked<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        let question = self.question("evaluate", &range);
        let session = self.session.open()?;
        if self.quantity == Quantity::Readback {
            self.values.clone_from(&session.readback);
            return Ok(());
        }
        if self.quantity == Quantity::BodyJacobians {
            return self.run_jacobians(&range);
        }
        let answer = session.ask(question, Vec::new())?;
        self.values = shaped(&answer, "value", &shape::of_value(self.quantity, self.robot, range.len()))?;
        Ok(())
    }

    /// By the oracle's own clock, if it has one. Then the values are not sent, and [`Evaluation::read`] still has those of the last `run`.
    /// A range that goes beyond the batch begins again at its first state.
    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
        let oracle = self.session.oracle;
        if !oracle.has_clock() {
            let start = oracle.clock.now();
            self.run(range)?;
            return Ok(oracle.clock.now() - start);
        }
        let question = self.question("clock", &range);
        let answer = self.session.ask(question, Vec::new())?;
        let time = |key: &str| answer.header.get(key).and_then(Value::as_u64).map(Duration::from_nanos);
        self.overhead = time("overhead");
        if oracle.estimates() && self.overhead.is_none() {
            return Err(NoAnswer::Failed("the oracle's answer has no overhead, and its times are estimates".into()));
        }
        time("nanoseconds").ok_or_else(|| NoAnswer::Failed("the oracle's answer has no nanoseconds".into()))
    }

    fn overhead(&self) -> Option<Duration> {
        self.overhead
    }

    fn relocate(&mut self, seed: u32) -> Result<bool, NoAnswer> {
        if !self.session.oracle.hello.relocate {
            return Ok(false);
        }
        self.session.ask(json!({"op": "relocate", "seed": seed}), Vec::new()).map(|_| true)
    }

    fn memory(&self) -> Option<Memory> {
        self.session.session.as_ref().and_then(|session| session.process.memory())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}
