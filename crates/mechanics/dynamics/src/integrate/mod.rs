//! Integrators of the equations of motion, their derivatives forward along a trajectory, and the adjoint of each.
//!
//! The state is a configuration q on the robot's configuration space, and a velocity v. The equations are
//!
//! ```text
//! q̇ = v in the tangent space of q (quaternions: body axes)        v̇ = a(t, q, v)
//! ```
//!
//! `q ⊕ v` is [`featherbench_model::Topology::integrate`]: quaternions stay of length one, and no chart has a singularity.
//!
//! | integrator | order | evaluations of a | also |
//! |---|---|---|---|
//! | [`SymplecticEuler`] | 1 | 1 | symplectic for a constant M |
//! | [`ImplicitMidpoint`] | 2 | iterations | a step with −h undoes one with h; conserves what is quadratic in v |
//! | [`RungeKutta4`] | 4 | 4 | |
//! | [`DormandPrince`] | 5 | 6, and one more in the first step | an error estimate of order 4, hence adaptive steps |
//!
//! [`Integrator`] is what they have in common: a step, the step with what its derivative needs, the derivative times a direction, and its
//! transpose times a gradient. [`Forward`] chains the derivatives along a trajectory. [`Adjoint`] goes back and gives the gradient of a cost.
//!
//! [`Acceleration`] is the right-hand side: a closure, or [`Dynamics`], the articulated-body algorithm with a [`System`] of forces.
//! [`Linearise`] is the right-hand side with its derivatives: [`Analytic`] by recursions, [`ByDuals`] by dual numbers alone.
//!
//! Times of steps, linearised steps and [`Integrator::pull`]: `docs/kernels/integrators.md`.

mod adjoint;
mod analytic;
mod by_duals;
mod dense;
mod directions;
mod dormand_prince;
mod dynamics;
mod error;
mod explicit;
mod forward;
mod midpoint;
mod rk4;
mod rollout;
mod symplectic_euler;

pub use adjoint::{Adjoint, Cost, CostGradient, Visit};
pub use analytic::Analytic;
pub use by_duals::{ByDuals, Linearisation, Linearise};
pub use dormand_prince::{DormandPrince, Statistics, Tolerance};
pub use dynamics::{Acceleration, Dynamics, Instant, Motors, Passive, System};
pub use error::IntegrationError;
pub use forward::{Forward, sensitivity};
pub use midpoint::ImplicitMidpoint;
pub use rk4::RungeKutta4;
pub use rollout::{Rollout, rollout};
pub use symplectic_euler::SymplecticEuler;

use featherbench_spatial::Angle;

/// A method of integration: one step of a given length, and its derivative.
///
/// The derivative is that of the discrete step, not of the differential equation: what comes out is exact for the numbers that the steps give,
/// whatever their length. Directions and gradients are in the tangent spaces of q, v and the inputs. Inputs (controls, then parameters) are
/// constant during a step.
pub trait Integrator<T: Angle> {
    /// The order p: the error after a fixed time falls like hᵖ.
    const ORDER: u32;

    /// Replaces the state at time `t` by that at `t + h`. After an error the state is as before.
    ///
    /// # Errors
    /// [`IntegrationError`]: an argument does not fit, a joint meets no inertia, a number is not finite, or an implicit step does not converge.
    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError>;

    /// [`Integrator::step`], which also keeps what [`Integrator::push`] and [`Integrator::pull`] need. The workspace must have been made for
    /// derivatives with the inputs of `f`.
    ///
    /// # Errors
    /// As [`Integrator::step`]; also for a workspace without room for derivatives, and if the linear equations of an implicit step are singular.
    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError>;

    /// The derivative of the last linearised step times a direction: (δq, δv) before the step becomes that after it. δu are the inputs'.
    ///
    /// # Panics
    /// If the slices do not fit, or no step was linearised.
    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]);

    /// The transpose of that derivative times a gradient: (λq, λv) after the step becomes that before it, and the gradient of the inputs
    /// is added to λu.
    ///
    /// # Panics
    /// As [`Integrator::push`].
    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]);
}
