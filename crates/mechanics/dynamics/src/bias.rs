//! The bias force `h(q, v) = C(q, v) v + g(q)`: the joint forces at which the robot does not accelerate.
//!
//! Source: the book, chapter 6 (`C` there): inverse dynamics with v̇ = 0. It is the recursion of [`Rnea`](crate::Rnea), compiled without
//! the terms in v̇. Frames, shapes, units and cost O(n) are the same. A call does not allocate.

use crate::{DimensionError, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Lift, Real};

/// The workspace of the bias force.
#[derive(Clone, Debug)]
pub struct Bias<T>(Rnea<T>);

impl<T: Real> Bias<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self(Rnea::new(topology))
    }

    /// The bias force `h` of configuration `q` and velocity `v`; external wrenches enter as `−Σ Jᵀf`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        wrenches: Option<&[Force<T>]>,
        h: &mut [T],
    ) -> Result<(), DimensionError> {
        self.0.recurse::<P, false>(model, q, v, &[], wrenches, h)
    }
}

/// The bias force that makes its own workspace, without external wrenches; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn bias_force<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<Vec<T>, DimensionError> {
    let mut h = vec![T::zero(); model.topology.nv()];
    Bias::new(&model.topology).run(model, q, v, None, &mut h)?;
    Ok(h)
}
