//! Elimination of a free joint: S = 1, D = Iᴬ, no armature. So Iᵃ = 0 and pᵃ = τ: the parent feels the joint's force alone.

use super::{Link, note_pivots, schur, vec3};
use crate::error::Pivot;
use featherbench_spatial::{ArticulatedInertia, Force, Motion, Real};

/// pᵃ: the joint force, in the order [force; moment] of a free joint's dofs.
#[inline(always)]
pub(crate) fn apparent_force<T: Real>(tau: &[T]) -> Force<T> {
    Force::new(vec3(&tau[3..]), vec3(tau))
}

/// q̈ = Iᴬ⁻¹ u − a' with u = τ − pᴬ, where `carried` is a'; `smallest` takes note of the pivots.
#[inline(always)]
pub(super) fn acceleration<T: Real>(tau: &[T], link: &Link<T>, carried: Motion<T>, dof: usize, smallest: &mut Pivot) -> Motion<T> {
    solve(&link.inertia, apparent_force(tau) - link.p, dof, smallest) - carried
}

/// `Iᴬ⁻¹ f` by a blocked LDLᵀ, translation first, as the dofs of a free joint are ordered.
#[inline(always)]
pub(crate) fn solve<T: Real>(inertia: &ArticulatedInertia<T>, f: Force<T>, dof: usize, smallest: &mut Pivot) -> Motion<T> {
    let translation = inertia.translational.factor();
    note_pivots(smallest, dof, &translation);
    let (w, rotational) = schur(inertia.rotational, inertia.coupling, &translation);
    let rotation = rotational.factor();
    note_pivots(smallest, dof + 3, &rotation);
    let ang = rotation.solve(f.ang - w * f.lin);
    Motion::new(ang, translation.solve(f.lin) - w.transpose_mul(ang))
}
