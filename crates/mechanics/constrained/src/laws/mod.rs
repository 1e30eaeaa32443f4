//! The rows of each kind of constraint: residual, wrenches on the bodies, bias.
//!
//! A row of the Jacobian is what the constraint does with a unit multiplier. So each row is kept as at most two wrenches, one per body, or
//! as numbers per dof. Rows of J, propagated forces and multipliers follow from these.
//!
//! Symbols: A and B are the first and the second frame, d = p_B − p_A, a_k the axes of A, all in world axes.

pub(crate) mod coordinates;
pub(crate) mod distance;
pub(crate) mod orientation;
pub(crate) mod parallel;
pub(crate) mod point;

use crate::attachment::Anchor;
use featherbench_spatial::{Force, Lift, Real, Vec3};

/// One row of constraints at a state.
#[derive(Clone, Debug)]
pub struct Row<T> {
    /// What a unit multiplier does to bodies: the compiled body, and [moment; force] in world axes at the origin of its frame.
    pub wrenches: [Option<(usize, Force<T>)>; 2],
    /// What a unit multiplier does to dofs.
    pub dofs: Vec<(usize, T)>,
    /// The residual φ(q).
    pub residual: T,
    /// The bias J̇v.
    pub bias: T,
}

impl<T: Real> Row<T> {
    pub(crate) fn empty() -> Self {
        Self { wrenches: [None; 2], dofs: Vec::new(), residual: T::zero(), bias: T::zero() }
    }
}

impl<T: Real> Row<T>
where
    f64: Lift<T>,
{
    /// Opposite moments on two frames.
    fn set_moments(&mut self, [a, b]: &[Anchor<T>; 2], moment: Vec3<T>) {
        self.wrenches = [a.wrench(-moment, Vec3::zero()), b.wrench(moment, Vec3::zero())];
    }
}
