//! What variational rules ask of a right-hand side: momenta and forces from energies, and their derivatives.
//!
//! Computes, with T and V the energies and τ the joint forces, external wrenches included:
//!
//! ```text
//! μ = ∂T/∂v = M(q) v        g = ∂T/∂q − ∂V/∂q + τ        ∂(∂T/∂q)/∂v = (∂μ/∂q)ᵀ
//! ```
//!
//! Armature A of a spherical joint adds ω × A ω to g: see [`super::VariationalMidpoint`].
//! Source: the definitions; the derivatives are those of forward-mode differentiation, one direction at a time, and the last equation.
//! Frames, shapes, units: as in [`EnergyGradient`]; matrices are dense, row after row, `nv` rows.
//! Cost of the derivatives: one [`EnergyGradient::run`] over duals per dof and per parameter, and the joint forces over duals in each
//! direction.
//! A call does not allocate.

use super::by_duals::{enter, leave};
use super::dense::add_scaled;
use super::directions::{Directions, Input};
use super::dynamics::{Acceleration, Dynamics, System};
use crate::error::expect;
use crate::{DimensionError, EnergyGradient, EnergyPartials, Error};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Angle, Dual, Real, Vec3};

/// An acceleration with the mechanics behind it: energies of a model, and joint forces.
///
/// ```
/// use featherbench_dynamics::integrate::{Acceleration, Dynamics, Motors};
/// use featherbench_model::Model;
/// use featherbench_robots::Family;
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=3,layout=spatial")?.generate()?)?;
/// let mut f = Dynamics::new(&model, Motors { dofs: vec![2] }, &[])?;
/// f.set_controls(&[0.5])?;
/// let mechanics = f.lagrangian().ok_or("dynamics have energies")?;
/// let mut tau = [0.0; 3];
/// mechanics.joint_forces(0.0, &[0.1; 3], &[0.0; 3], &mut tau)?;
/// assert_eq!(tau, [0.0, 0.0, 0.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Lagrangian<T>: Acceleration<T> {
    /// The model with its parameters.
    fn model(&self) -> &Model<T>;

    /// The joint forces of a state, external wrenches included: τ + Σ Jᵀf.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument does not fit.
    fn joint_forces(&mut self, t: T, q: &[T], v: &[T], result: &mut [T]) -> Result<(), DimensionError>;

    /// `x = M⁻¹ f` at the configuration of the last acceleration.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument does not fit.
    fn solve(&mut self, f: &[T], x: &mut [T]) -> Result<(), DimensionError>;
}

/// The derivatives of the momentum μ = M v and of the force g = ∂T/∂q − ∂V/∂q + τ at one state.
///
/// ```
/// use featherbench_dynamics::integrate::{Analytic, LagrangianPartials, Linearise, Motors};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=3,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let mut f = Analytic::new(&model, Motors { dofs: vec![0, 1, 2] }, &[])?;
/// let mut partials = LagrangianPartials::new(3, 3);
/// f.linearise_lagrangian(0.0, states.q(0), states.v(0), &mut partials)?;
/// // A motor is a force on its own dof, and no momentum. No momentum depends on the first angle of a chain.
/// assert!((0..3).all(|k| partials.force_by_input[4 * k] == 1.0));
/// assert!(partials.momentum_by_input.iter().all(|x| *x == 0.0));
/// assert!((0..3).all(|row| partials.momentum_by_q[3 * row].abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LagrangianPartials<T> {
    /// ∂μ/∂q on the tangent space of q, with the numbers in v held: nv × nv, row after row.
    pub momentum_by_q: Vec<T>,
    /// ∂μ/∂u: nv × inputs.
    pub momentum_by_input: Vec<T>,
    /// ∂g/∂q: nv × nv.
    pub force_by_q: Vec<T>,
    /// ∂g/∂v: nv × nv.
    pub force_by_v: Vec<T>,
    /// ∂g/∂u: nv × inputs.
    pub force_by_input: Vec<T>,
}

impl<T: Real> LagrangianPartials<T> {
    /// Room for a tree of this many dofs with this many inputs.
    pub fn new(nv: usize, inputs: usize) -> Self {
        let (square, of_inputs) = (vec![T::zero(); nv * nv], vec![T::zero(); nv * inputs]);
        Self {
            momentum_by_q: square.clone(),
            momentum_by_input: of_inputs.clone(),
            force_by_q: square.clone(),
            force_by_v: square,
            force_by_input: of_inputs,
        }
    }

    /// An error if the matrices have other sizes.
    fn expect_size(&self, nv: usize, inputs: usize) -> Result<(), DimensionError> {
        for (what, expected, matrix) in [
            ("∂μ/∂q", nv * nv, &self.momentum_by_q),
            ("∂μ/∂u", nv * inputs, &self.momentum_by_input),
            ("∂g/∂q", nv * nv, &self.force_by_q),
            ("∂g/∂v", nv * nv, &self.force_by_v),
            ("∂g/∂u", nv * inputs, &self.force_by_input),
        ] {
            expect(what, expected, matrix.len())?;
        }
        Ok(())
    }
}

/// The momentum and the force of a state, with the workspace.
#[derive(Clone, Debug)]
pub(super) struct MomentumAndForce<T> {
    gradient: EnergyGradient<T>,
    energy: EnergyPartials<T>,
    force: Vec<T>,
}

impl<T: Angle> MomentumAndForce<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        let (gradient, energy) = (EnergyGradient::new(topology), EnergyPartials::new(topology));
        Self { gradient, energy, force: vec![T::zero(); topology.nv()] }
    }

    /// μ of the last state.
    pub(super) fn momentum(&self) -> &[T] {
        &self.energy.kinetic_by_v
    }

    /// g of the last state.
    pub(super) fn force(&self) -> &[T] {
        &self.force
    }

    /// μ alone.
    pub(super) fn set_momentum(&mut self, model: &Model<T>, q: &[T], v: &[T]) -> Result<(), DimensionError> {
        self.gradient.run(model, q, v, &mut self.energy)
    }

    /// μ and g.
    pub(super) fn set<F: Lagrangian<T> + ?Sized>(&mut self, f: &mut F, t: T, q: &[T], v: &[T]) -> Result<(), DimensionError> {
        self.set_momentum(f.model(), q, v)?;
        self.set_joint_forces(f, t, q, v)?;
        add_scaled(T::one(), &self.energy.kinetic_by_q, &mut self.force);
        add_scaled(-T::one(), &self.energy.potential_by_q, &mut self.force);
        Ok(())
    }

    /// The part of g that is not of an energy.
    fn set_joint_forces<F: Lagrangian<T> + ?Sized>(&mut self, f: &mut F, t: T, q: &[T], v: &[T]) -> Result<(), DimensionError> {
        f.joint_forces(t, q, v, &mut self.force)?;
        let model = f.model();
        for joint in model.topology.joints().iter().filter(|joint| joint.kind == JointKind::Spherical) {
            let three = |x: &[T]| Vec3::new(x[joint.v], x[joint.v + 1], x[joint.v + 2]);
            let (omega, armature) = (three(v), three(&model.armature));
            let spin = omega.cross(Vec3::new(armature.x * omega.x, armature.y * omega.y, armature.z * omega.z));
            add_scaled(T::one(), &spin.to_array(), &mut self.force[joint.v..]);
        }
        Ok(())
    }
}

impl<T: Angle> MomentumAndForce<Dual<T>> {
    /// The derivatives at a state, with `f` over duals at the inputs of `at`.
    pub(super) fn linearise<S: System>(
        &mut self,
        f: &mut Dynamics<S, Dual<T>>,
        at: &mut Directions<T>,
        (t, q, v): (T, &[T], &[T]),
        result: &mut LagrangianPartials<T>,
    ) -> Result<(), Error> {
        at.set_state(q, v)?;
        let (nv, inputs, t) = (v.len(), at.inputs(), Dual::constant(t));
        result.expect_size(nv, inputs)?;
        at.by_q(|at, k| {
            self.set(f, t, &at.q, &at.v)?;
            write_column(self.momentum(), &mut result.momentum_by_q, nv, k);
            write_column(&self.force, &mut result.force_by_q, nv, k);
            Ok(())
        })?;
        at.by_v(|at, k| {
            self.set_joint_forces(f, t, &at.q, &at.v)?;
            write_column(&self.force, &mut result.force_by_v, nv, k);
            Ok(())
        })?;
        for (row, by_v) in result.force_by_v.chunks_exact_mut(nv.max(1)).enumerate() {
            // ∂(∂T/∂q)/∂v = (∂μ/∂q)ᵀ
            by_v.iter_mut().enumerate().for_each(|(column, x)| *x += result.momentum_by_q[column * nv + row]);
        }
        result.momentum_by_input.fill(T::zero());
        at.by_inputs(|at, input, k| {
            enter(f, at, input)?;
            match input {
                // Controls do not change the model, hence no energy.
                Input::Control => self.set_joint_forces(f, t, &at.q, &at.v)?,
                Input::Parameter => {
                    self.set(f, t, &at.q, &at.v)?;
                    write_column(self.momentum(), &mut result.momentum_by_input, inputs, k);
                }
            }
            write_column(&self.force, &mut result.force_by_input, inputs, k);
            Ok(())
        })?;
        Ok(leave(f, at)?)
    }

    /// ∂μ/∂u at a state.
    pub(super) fn momentum_by_inputs<S: System>(
        &mut self,
        f: &mut Dynamics<S, Dual<T>>,
        at: &mut Directions<T>,
        (q, v): (&[T], &[T]),
        result: &mut [T],
    ) -> Result<(), Error> {
        at.set_state(q, v)?;
        let inputs = at.inputs();
        expect("∂μ/∂u", v.len() * inputs, result.len())?;
        result.fill(T::zero());
        at.by_inputs(|at, input, k| {
            // Controls do not change the model.
            if input == Input::Parameter {
                enter(f, at, input)?;
                self.set_momentum(f.model(), &at.q, &at.v)?;
                write_column(self.momentum(), result, inputs, k);
            }
            Ok(())
        })?;
        Ok(leave(f, at)?)
    }
}

/// The derivatives of a vector into column `column` of a matrix of this width.
fn write_column<T: Real>(from: &[Dual<T>], matrix: &mut [T], width: usize, column: usize) {
    for (row, x) in from.iter().enumerate() {
        matrix[row * width + column] = x.derivative;
    }
}
