//! An engine with a residual: any engine, ours, behind an oracle or recorded, corrected to τ = ID + r.
//!
//! | quantity | answer | what the engine is asked |
//! |---|---|---|
//! | `id` | ID(q, v, a) + r(q, v, a) | `id` |
//! | `fd`, r without a | FD(q, v, τ − r) | `fd` with other joint forces |
//! | `fd`, r with a | a with M (a − a₀) + r(q, v, a) = 0, a₀ = FD(q, v, τ) | `fd` and `mass_matrix` |
//!
//! Where r is zero the engine's answer comes back to the bit. Other quantities are those of a nominal model, and are not offered. Recorded answers
//! belong to the states that were recorded: so a recorded engine has no `fd` with other joint forces, and says so.

use crate::{Engine, Evaluation, Identity, NoAnswer, Quantity, Robot};
use featherbench_residuals::{Residual, State, add_unless_zero, corrected_acceleration};
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use nalgebra::DMatrix;
use std::ops::Range;

/// An engine and the residual that corrects it.
///
/// ```
/// use featherbench_bench::{Engine, Quantity, WithResidual};
/// use featherbench_residuals::Viscous;
/// # fn of(engine: &dyn Engine, robot: &featherbench_bench::Robot) -> Result<(), Box<dyn std::error::Error>> {
/// let friction = Viscous::new(vec![0.1; robot.states.nv])?;
/// let corrected = WithResidual::new(engine, &friction);
/// let mut prepared = corrected.prepare(robot, Quantity::InverseDynamics, &corrected.methods(Quantity::InverseDynamics)[0], &robot.states)?;
/// prepared.run(0..robot.states.count())?;
/// println!("{:?}", prepared.read());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy)]
pub struct WithResidual<'e> {
    engine: &'e dyn Engine,
    residual: &'e dyn Residual,
}

impl<'e> WithResidual<'e> {
    /// The engine, corrected by the residual.
    pub fn new(engine: &'e dyn Engine, residual: &'e dyn Residual) -> Self {
        Self { engine, residual }
    }
}

impl Engine for WithResidual<'_> {
    fn identity(&self) -> &Identity {
        self.engine.identity()
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        match quantity {
            Quantity::InverseDynamics | Quantity::ForwardDynamics => self.engine.methods(quantity),
            _ => Vec::new(),
        }
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        if !matches!(quantity, Quantity::InverseDynamics | Quantity::ForwardDynamics) {
            return Err(NoAnswer::NotOffered(format!("a residual corrects id and fd; {} is that of the nominal model", quantity.name())));
        }
        if self.residual.inner() > 0 {
            return Err(NoAnswer::NotOffered("the residual has an inner state, which states of a robot do not hold".into()));
        }
        if self.residual.nv() != states.nv || self.residual.nq().is_some_and(|nq| nq != states.nq) {
            return Err(NoAnswer::Failed(format!("the residual is for {} dofs, the robot has {}", self.residual.nv(), states.nv)));
        }
        Ok(Box::new(Evaluated { of: *self, robot, quantity, method: method.into(), states, values: Vec::new() }))
    }
}

/// An evaluation; the engine is prepared when it runs, because its joint forces depend on the residual.
struct Evaluated<'a> {
    of: WithResidual<'a>,
    robot: &'a Robot,
    quantity: Quantity,
    method: String,
    states: &'a StateBatch,
    values: Vec<f64>,
}

fn failed(error: impl std::fmt::Display) -> NoAnswer {
    NoAnswer::Failed(error.to_string())
}

impl Evaluated<'_> {
    fn ask(&self, quantity: Quantity, method: &str, states: &StateBatch, range: Range<usize>) -> Result<Vec<f64>, NoAnswer> {
        let due = range.len() * quantity.size(self.robot);
        let mut prepared = self.of.engine.prepare(self.robot, quantity, method, states)?;
        prepared.run(range)?;
        let values = prepared.read().to_vec();
        if values.len() == due { Ok(values) } else { Err(failed(format!("{} numbers came, {due} are due", values.len()))) }
    }

    fn inverse(&self, range: Range<usize>) -> Result<Vec<f64>, NoAnswer> {
        let mut tau = self.ask(Quantity::InverseDynamics, &self.method, self.states, range.clone())?;
        for (k, tau) in range.zip(tau.chunks_exact_mut(self.states.nv.max(1))) {
            let state = State::new(self.states.q(k), self.states.v(k), self.states.a(k));
            add_unless_zero(tau, &self.of.residual.value(&state).map_err(failed)?, 1.0);
        }
        Ok(tau)
    }

    fn forward(&self, range: Range<usize>) -> Result<Vec<f64>, NoAnswer> {
        let (states, nv) = (self.states, self.states.nv);
        let still = vec![0.0; nv];
        let state = |k: usize| State::new(states.q(k), states.v(k), &still).with_command(states.tau(k));
        if self.of.residual.has_acceleration() {
            let mut a = self.ask(Quantity::ForwardDynamics, &self.method, states, range.clone())?;
            let usual = self.of.engine.methods(Quantity::MassMatrix);
            let usual = usual.first().ok_or_else(|| NoAnswer::NotOffered("the engine has no mass matrix to correct".into()))?;
            let masses = self.ask(Quantity::MassMatrix, usual, states, range.clone())?;
            for (at, k) in range.enumerate() {
                let mass = DMatrix::from_row_slice(nv, nv, &masses[at * nv * nv..(at + 1) * nv * nv]);
                let found = corrected_acceleration(self.of.residual, &mass, &a[at * nv..(at + 1) * nv], &state(k)).map_err(failed)?;
                a[at * nv..(at + 1) * nv].copy_from_slice(&found);
            }
            return Ok(a);
        }
        let mut other = states.clone();
        let mut changed = false;
        for k in range.clone() {
            let r = self.of.residual.value(&state(k)).map_err(failed)?;
            changed |= r.iter().any(|&r| r != 0.0);
            add_unless_zero(&mut other.tau[k * nv..(k + 1) * nv], &r, -1.0);
        }
        if changed && self.of.engine.identity().source == EngineSource::Recorded {
            return Err(NoAnswer::NotOffered("the recorded answers belong to other joint forces".into()));
        }
        self.ask(Quantity::ForwardDynamics, &self.method, if changed { &other } else { states }, range)
    }
}

impl Evaluation for Evaluated<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.values = if self.quantity == Quantity::InverseDynamics { self.inverse(range)? } else { self.forward(range)? };
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}
