//! The momenta before and after a step of the variational midpoint rule, from the momentum μ and the force g in its middle.
//!
//! ```text
//! after: w = J(hu)⁻ᵀ (μ + (h/2) J(hu/2)ᵀ g)        before: A(hu)ᵀ w − h A(hu/2)ᵀ g
//! ```
//!
//! Both are linear in μ and g; the maps depend on u alone. Source and names: see [`super::VariationalMidpoint`].
//! Frames: tangent spaces of the configurations before, in the middle, after. Shapes: `nv` numbers. Units: as ∂T/∂v. Cost: O(n). A call
//! does not allocate.

use crate::DimensionError;
use crate::integrate::dense::add_scaled;
use crate::integrate::midpoint::scale;
use featherbench_model::{TangentMap, Topology};
use featherbench_spatial::Angle;

/// The maps of a step, and the last momenta.
#[derive(Clone, Debug)]
pub(super) struct Momenta<T> {
    h: T,
    /// A(hu), J(hu)⁻¹, A(hu/2), J(hu/2).
    whole_by_q: TangentMap<T>,
    whole_inverse: TangentMap<T>,
    half_by_q: TangentMap<T>,
    half_by_step: TangentMap<T>,
    before: Vec<T>,
    after: Vec<T>,
    x: Vec<T>,
}

impl<T: Angle> Momenta<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        let (zeros, map) = (vec![T::zero(); topology.nv()], TangentMap::new(topology));
        Self {
            h: T::zero(),
            whole_by_q: map.clone(),
            whole_inverse: map.clone(),
            half_by_q: map.clone(),
            half_by_step: map,
            before: zeros.clone(),
            after: zeros.clone(),
            x: zeros,
        }
    }

    /// The maps of a step of h u.
    pub(super) fn set_step(&mut self, h: T, u: &[T]) -> Result<(), DimensionError> {
        self.h = h;
        scale(h * T::from_f64(0.5), u, &mut self.x);
        self.half_by_q.d_integrate_q(&self.x)?;
        self.half_by_step.d_integrate_v(&self.x)?;
        scale(h, u, &mut self.x);
        self.whole_by_q.d_integrate_q(&self.x)?;
        self.whole_inverse.d_difference_to(&self.x)
    }

    /// The momenta of that step, from μ and g.
    pub(super) fn set(&mut self, momentum: &[T], force: &[T]) -> Result<(), DimensionError> {
        let half = self.h * T::from_f64(0.5);
        self.half_by_step.transpose_mul(force, &mut self.x)?;
        self.before.copy_from_slice(momentum);
        add_scaled(half, &self.x, &mut self.before);
        self.whole_inverse.transpose_mul(&self.before, &mut self.after)?;

        self.whole_by_q.transpose_mul(&self.after, &mut self.before)?;
        self.half_by_q.transpose_mul(force, &mut self.x)?;
        add_scaled(-self.h, &self.x, &mut self.before);
        Ok(())
    }

    /// The momentum before the step.
    pub(super) fn before(&self) -> &[T] {
        &self.before
    }

    /// The momentum after it.
    pub(super) fn after(&self) -> &[T] {
        &self.after
    }

    /// A(hu/2), by which a change of q changes the configuration in the middle.
    pub(super) fn half_by_q(&self) -> &TangentMap<T> {
        &self.half_by_q
    }

    /// J(hu/2), by which a change of (h/2) u does.
    pub(super) fn half_by_step(&self) -> &TangentMap<T> {
        &self.half_by_step
    }
}
