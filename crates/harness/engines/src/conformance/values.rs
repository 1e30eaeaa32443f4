//! The answers of a right oracle, and of one with some mistakes.

use super::coordinate_change::{CoordinateChange, State};
use super::hypotheses::Hypothesis;
use crate::Featherbench;
use featherbench_bench::measure::{ForwardScale, Magnitudes, scaled_error, worst};
use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_robots::StateBatch;

/// The tolerance. Conformance tests the meaning of numbers; the agreement study tests their digits. Mistaken conventions give errors of
/// 1e-3 and more, rounding gives 1e-15, and an inaccurate but right algorithm something between.
pub(super) const RIGHT: f64 = 1e-11;
/// The same for forward dynamics, where an explicit inverse loses the condition number of M, here up to a thousand.
pub(super) const RIGHT_FORWARD: f64 = 1e-9;

/// The same for an oracle in single precision: its rounding is 1e-7, times the condition number of M at most 1e-4. Mistaken conventions that
/// change less are not seen.
pub(super) const RIGHT_SINGLE: f64 = 1e-3;
/// The same for its forward dynamics. At the fast states tau - h is a small difference: of a cylindrical joint MuJoCo Warp then loses 1e-3
/// and MJX 2e-3, each as much as the h that it is computed with.
pub(super) const RIGHT_SINGLE_FORWARD: f64 = 1e-2;

/// The same for derivatives by finite differences, whose digits belong to the study of derivatives. Steps of 1e-4 to 1e-8 leave 1e-2 at fast
/// states. A mistaken sign, order or frame changes the largest entries by their own size.
pub(super) const RIGHT_DIFFERENCES: f64 = 0.1;

/// A robot with featherbench's answers to every question.
pub(super) struct Scene {
    pub(super) shows: &'static str,
    pub(super) robot: Robot,
    at: Vec<Magnitudes>,
    /// featherbench's [`Quantity::BodyPlacement`].
    placement: Option<Vec<f64>>,
    /// The rounding of the oracle's arithmetic, over that of double precision.
    rounding: f64,
}

impl Scene {
    pub(super) fn new(shows: &'static str, robot: Robot, rounding: f64) -> Self {
        let (at, placement) = (robot.magnitudes(), featherbench(&robot, Quantity::BodyPlacement));
        Self { shows, robot, at, placement, rounding }
    }

    /// The worst error of an answer over all states, in the measures of `featherbench_bench`.
    pub(super) fn error(&self, quantity: Quantity, reference: &[f64], value: &[f64]) -> f64 {
        let size = quantity.size(&self.robot);
        let states = reference.chunks_exact(size).zip(value.chunks_exact(size)).zip(&self.at);
        if quantity == Quantity::ForwardDynamics {
            let scales = ForwardScale::all(&self.robot, &self.at);
            return states.zip(scales).map(|(((r, x), _), scale)| scale.forward_error(r, x)).fold(0.0, worst);
        }
        states.map(|((r, x), at)| scaled_error(&self.robot, quantity, at, r, x)).fold(0.0, worst)
    }

    /// The largest difference of energies from featherbench's at the first state, in the measure of the potential energy.
    pub(super) fn drift(&self, energies: &[f64]) -> Option<f64> {
        let start = self.featherbench(Quantity::KineticEnergy)?[0] + self.featherbench(Quantity::PotentialEnergy)?[0];
        let off = |&energy: &f64| scaled_error(&self.robot, Quantity::PotentialEnergy, &self.at[0], &[start], &[energy]);
        Some(energies.iter().map(off).fold(0.0, worst))
    }

    /// The error up to which an answer by a method is right.
    pub(super) fn tolerance(&self, quantity: Quantity, method: &str) -> f64 {
        if self.rounding > 1.0 {
            return if quantity == Quantity::ForwardDynamics { RIGHT_SINGLE_FORWARD } else { RIGHT_SINGLE };
        }
        match quantity {
            _ if Quantity::DERIVATIVES.contains(&quantity) && method.starts_with("difference") => RIGHT_DIFFERENCES,
            Quantity::ForwardDynamics | Quantity::ForwardDynamicsDq | Quantity::ForwardDynamicsDv => RIGHT_FORWARD,
            _ => RIGHT,
        }
    }

    /// featherbench's answer at every state.
    pub(super) fn featherbench(&self, quantity: Quantity) -> Option<Vec<f64>> {
        featherbench(&self.robot, quantity)
    }

    /// The answer of an oracle that is right but for these mistakes. `None` if the robot cannot be built with them, or if they do not
    /// affect the quantity.
    pub(super) fn supposed(&self, hypotheses: &[&Hypothesis], quantity: Quantity) -> Option<Vec<f64>> {
        let mut misread = self.robot.description.clone();
        hypotheses.iter().for_each(|hypothesis| (hypothesis.robot)(&mut misread));
        let Robot { description, origin, family, states, .. } = &self.robot;
        let robot = if misread == *description { self.robot.clone() } else { Robot::new(&misread, family, *origin, 1, 0).ok()? };
        let (mut batch, mut seen) = (StateBatch { cases: states.cases.clone(), ..self.empty() }, Vec::new());
        let placement = self.placement.as_ref()?;
        for k in 0..states.count() {
            let mut state = State {
                q: states.q(k).to_vec(),
                v: states.v(k).to_vec(),
                // h is inverse dynamics at a = 0; a mistake about accelerations changes that zero as well.
                a: if quantity == Quantity::Bias { vec![0.0; states.nv] } else { states.a(k).to_vec() },
                tau: states.tau(k).to_vec(),
                wrench: states.wrench(k).to_vec(),
                placement: part(placement, states.count(), k),
                ..State::default()
            };
            seen.push(hypotheses.iter().map(|hypothesis| self.misread(hypothesis, &mut state)).collect::<Vec<_>>());
            batch.q.extend(state.q);
            batch.v.extend(state.v);
            batch.a.extend(state.a);
            batch.tau.extend(state.tau);
            batch.wrench.extend(state.wrench);
        }
        let robot = robot.at(batch);
        let mut value = featherbench(&robot, if quantity == Quantity::Bias { Quantity::InverseDynamics } else { quantity })?;
        let (size, count) = (quantity.size(&robot), states.count());
        let bodies = if hypotheses.iter().any(|hypothesis| hypothesis.answer.is_some()) { Some(Bodies::of(&robot)?) } else { None };
        for (k, (value, seen)) in value.chunks_exact_mut(size).zip(seen).enumerate() {
            for (hypothesis, (mut state, change)) in hypotheses.iter().zip(seen).rev() {
                if let Some(change) = change {
                    returned(&change, quantity, value);
                }
                if let (Some(answer), Some(bodies)) = (hypothesis.answer, &bodies) {
                    bodies.put(&mut state, count, k);
                    answer(&self.robot, quantity, &state, value);
                }
            }
        }
        Some(value)
    }

    /// Interprets a state by a mistake; returns the state before, and the change of velocities.
    fn misread(&self, hypothesis: &Hypothesis, state: &mut State) -> (State, Option<CoordinateChange>) {
        let given = state.clone();
        (hypothesis.state)(&self.robot.description, state);
        let change = hypothesis.velocities.map(|velocities| velocities(&self.robot.description, state));
        if let Some(change) = &change {
            let rest: Vec<f64> = state.a.iter().zip(&change.b).map(|(a, b)| a - b).collect();
            (state.v, state.a, state.tau) = (change.back(&state.v), change.back(&rest), change.back(&state.tau));
        }
        (given, change)
    }

    fn empty(&self) -> StateBatch {
        let StateBatch { nq, nv, bodies, .. } = self.robot.states;
        StateBatch { nq, nv, bodies, ..StateBatch::default() }
    }
}

/// featherbench's results for the bodies, at every state. Mistakes in what is sent back may use them.
struct Bodies {
    placement: Vec<f64>,
    velocity: Vec<f64>,
    com: Vec<f64>,
    momentum: Vec<f64>,
}

impl Bodies {
    fn of(robot: &Robot) -> Option<Self> {
        Some(Self {
            placement: featherbench(robot, Quantity::BodyPlacement)?,
            velocity: featherbench(robot, Quantity::BodyVelocity)?,
            com: featherbench(robot, Quantity::CenterOfMass)?,
            momentum: featherbench(robot, Quantity::Momentum)?,
        })
    }

    /// Puts the results at state `k` of `count` into a state.
    fn put(&self, state: &mut State, count: usize, k: usize) {
        state.placement = part(&self.placement, count, k);
        state.velocity = part(&self.velocity, count, k);
        state.com = part(&self.com, count, k);
        state.momentum = part(&self.momentum, count, k);
    }
}

/// The answer in the velocities that the oracle took for ours.
fn returned(change: &CoordinateChange, quantity: Quantity, value: &mut [f64]) {
    let n = change.b.len();
    match quantity {
        Quantity::InverseDynamics | Quantity::InverseDynamicsWrench | Quantity::Bias => {
            let changed = change.forth(value);
            value.copy_from_slice(&changed);
        }
        Quantity::ForwardDynamics => {
            let changed = change.forth(value);
            value.iter_mut().zip(changed.iter().zip(&change.b)).for_each(|(x, (a, b))| *x = a + b);
        }
        // J T', row by row.
        Quantity::BodyJacobian => rows(change, value, n),
        // T M T' = T (T M)' for a symmetric M.
        Quantity::MassMatrix => {
            rows(change, value, n);
            let columns: Vec<f64> = (0..n * n).map(|at| value[n * (at % n) + at / n]).collect();
            value.copy_from_slice(&columns);
            rows(change, value, n);
        }
        _ => {}
    }
}

fn rows(change: &CoordinateChange, value: &mut [f64], n: usize) {
    for row in value.chunks_exact_mut(n) {
        let changed = change.forth(row);
        row.copy_from_slice(&changed);
    }
}

fn part(all: &[f64], count: usize, k: usize) -> Vec<f64> {
    let size = all.len() / count;
    all[k * size..(k + 1) * size].to_vec()
}

fn featherbench(robot: &Robot, quantity: Quantity) -> Option<Vec<f64>> {
    let featherbench = Featherbench::new();
    let method = featherbench.methods(quantity).into_iter().next()?;
    let mut prepared = featherbench.prepare(robot, quantity, &method, &robot.states).ok()?;
    prepared.run(0..robot.states.count()).ok()?;
    Some(prepared.read().to_vec())
}

/// Whether two answers are the same to the bit.
pub(super) fn same_bits(one: &[f64], other: &[f64]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits())
}
