//! The derivatives of forward dynamics by the inertial parameters: `∂v̇/∂π = −M⁻¹ Y(q, v, v̇)`.
//!
//! Source: `τ = Y(q, v, v̇) π + armature ∘ v̇` stays as it is, and `∂τ/∂v̇ = M`. The order of π is that of
//! [`inertial_parameters`](crate::inertial_parameters). External wrenches do not depend on π, so they enter through v̇ alone.
//! Shapes: q has `nq` numbers; v and τ have `nv`; the result has `nv` rows of ten numbers per described body, row after row. Units: SI.
//! Cost: O(Σ d_k·(d_k + bodies)). A call does not allocate.

use super::regressor::{Regressor, RegressorMatrix};
use super::solve::solve_negated;
use crate::{Aba, Crba, Error, Ltdl, State};
use featherbench_model::Model;
use featherbench_spatial::{Lift, Real};

/// The workspace of the derivatives by inertial parameters.
///
/// ```
/// use featherbench_dynamics::{ParameterSensitivity, State, forward_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=3,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
/// let (mut a, mut by_parameters) = ([0.0; 3], [0.0; 3 * 30]);
/// ParameterSensitivity::new(&model).run(&model, State { q, v, given: tau, wrenches: None }, &mut a, &mut by_parameters)?;
///
/// // A gram more at the origin of the last body.
/// let mut heavier = model.clone();
/// heavier.inertias[2].mass += 1e-3;
/// let moved = forward_dynamics(&heavier, q, v, tau)?;
/// for i in 0..3 {
///     assert!((moved[i] - a[i] - 1e-3 * by_parameters[30 * i + 20]).abs() < 1e-3 * (1e-2 * by_parameters[30 * i + 20].abs() + 1e-3));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParameterSensitivity<T> {
    aba: Aba<T>,
    crba: Crba<T>,
    ltdl: Ltdl<T>,
    regressor: Regressor<T>,
    matrix: RegressorMatrix<T>,
}

impl<T: Real> ParameterSensitivity<T> {
    /// A workspace for a model.
    pub fn new<P>(model: &Model<P>) -> Self {
        let topology = &model.topology;
        let (regressor, matrix) = (Regressor::new(topology), RegressorMatrix::new(model));
        Self { aba: Aba::new(topology), crba: Crba::new(topology), ltdl: Ltdl::new(topology), regressor, matrix }
    }

    /// The accelerations `a` at a state with joint forces, and their derivatives.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        state: State<'_, T>,
        a: &mut [T],
        by_parameters: &mut [T],
    ) -> Result<(), Error> {
        let State { q, v, given: tau, wrenches } = state;
        self.aba.run(model, q, v, tau, wrenches, a)?;
        self.regressor.torque(model, q, v, a, &mut self.matrix)?;
        self.matrix.write_dense(by_parameters)?;
        self.crba.run(model, q, self.ltdl.matrix_mut())?;
        self.ltdl.factor()?;
        solve_negated(self.ltdl.factors(), by_parameters, self.matrix.columns());
        Ok(())
    }
}
