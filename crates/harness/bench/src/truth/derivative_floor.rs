//! The conditioning bound of the derivatives of forward dynamics: how far they move when the inputs do.

use crate::by_duals::{ByDuals, Point};
use crate::measure::{Magnitudes, derivative_size};
use crate::truth::parameters;
use crate::{Quantity, Robot};
use featherbench_model::Model;
use featherbench_spatial::{Dual, Real};

type Number = Dual<f64>;

/// The relative change of a true derivative at state `k` when every input changes by half an ulp, and the magnitudes of all changes add up:
/// [`derivative_size`] of `u Σ_x |∂D/∂x|·|x|`, with u = 2⁻⁵³. The inputs are those of
/// [`conditioning_bound`](crate::truth::conditioning_bound). `None` where M is singular, or the quantity is no derivative of ID or FD.
///
/// Cost: one run of the derivative, on duals of duals, for each input: O(n³).
pub fn derivative_floor(robot: &Robot, quantity: Quantity, k: usize) -> Option<f64> {
    let states = &robot.states;
    let constant = |values: &[f64]| -> Vec<Number> { values.iter().map(|&x| Dual::constant(x)).collect() };
    let size = quantity.size(robot);
    let mut inputs = Inputs {
        duals: ByDuals::new(robot.model.lift()),
        quantity,
        blocks: [states.q(k), states.v(k), states.a(k), states.tau(k)].map(constant),
        out: vec![Dual::zero(); size],
        moved: vec![0.0; size],
    };
    for block in 0..inputs.blocks.len() {
        for at in 0..inputs.blocks[block].len() {
            let still = inputs.blocks[block][at];
            inputs.blocks[block][at].derivative = still.value.abs();
            inputs.add(still.value)?;
            inputs.blocks[block][at] = still;
        }
    }
    for dof in 0..states.nv {
        inputs.move_parameter(|model| &mut model.armature[dof])?;
    }
    for parameter in parameters() {
        for body in 0..robot.model.topology.bodies() {
            inputs.move_parameter(|model| parameter(model, body))?;
        }
    }
    inputs.move_parameter(|model| &mut model.gravity.x)?;
    inputs.move_parameter(|model| &mut model.gravity.y)?;
    inputs.move_parameter(|model| &mut model.gravity.z)?;
    let answer: Vec<f64> = inputs.out.iter().map(|x| x.value).collect();
    let moved: Vec<f64> = inputs.moved.iter().map(|x| 0.5 * f64::EPSILON * x).collect();
    Some(derivative_size(robot, quantity, &Magnitudes::new(robot, k), &answer, &moved))
}

/// The inputs of a derivative, and the change of the answer so far.
struct Inputs {
    duals: ByDuals<Number>,
    quantity: Quantity,
    /// q, v, a and τ.
    blocks: [Vec<Number>; 4],
    out: Vec<Number>,
    moved: Vec<f64>,
}

impl Inputs {
    /// Changes one parameter at the rate of its own magnitude.
    fn move_parameter(&mut self, parameter: impl Fn(&mut Model<Dual<Number>>) -> &mut Dual<Number>) -> Option<()> {
        let value = parameter(self.duals.model_mut()).value.value;
        parameter(self.duals.model_mut()).value.derivative = value.abs();
        self.add(value)?;
        parameter(self.duals.model_mut()).value.derivative = 0.0;
        Some(())
    }

    /// Adds the change by the input of this value. An input that is zero is exact and does not change.
    fn add(&mut self, value: f64) -> Option<()> {
        if value == 0.0 {
            return Some(());
        }
        let [q, v, a, tau] = &self.blocks;
        if !self.duals.run(self.quantity, Point { q, v, a, tau }, &mut self.out).ok()? {
            return None;
        }
        self.moved.iter_mut().zip(&self.out).for_each(|(moved, x)| *moved += x.derivative.abs());
        Some(())
    }
}
