//! Elimination of a spherical joint: S = [1; 0], D = I + R is 3×3. R is the diagonal matrix of armatures.

use super::{Link, note_pivots, schur, vec3};
use crate::error::Pivot;
use featherbench_spatial::{ArticulatedInertia, Force, Ldl3, Mat3, Motion, Real, Sym3, Vec3};

/// `(Iᵃ, pᵃ)`; `smallest` takes note of the pivots of D.
#[inline(always)]
pub(super) fn eliminate<T: Real>(
    armature: Vec3<T>,
    tau: &[T],
    link: &Link<T>,
    dof: usize,
    smallest: &mut Pivot,
) -> (ArticulatedInertia<T>, Force<T>) {
    let (apparent, d) = apparent_inertia(&link.inertia, armature, dof, smallest);
    (apparent, pushed(link, &d, tau) + apparent.mul(link.c))
}

/// pᵃ with c = 0.
#[inline(always)]
pub(super) fn apparent_force<T: Real>(armature: Vec3<T>, f: &[T], link: &Link<T>) -> Force<T> {
    pushed(link, &(link.inertia.rotational + diagonal(armature)).factor(), f)
}

/// q̈, where `carried` is a'.
#[inline(always)]
pub(super) fn acceleration<T: Real>(armature: Vec3<T>, tau: &[T], link: &Link<T>, carried: Motion<T>) -> Vec3<T> {
    let d = (link.inertia.rotational + diagonal(armature)).factor();
    d.solve(vec3(tau) - link.p.ang - link.inertia.mul(carried).ang)
}

/// Iᵃ and the factors of D.
///
/// With Iᴬ = [I H; Hᵀ M]: U = [I; Hᵀ]. The formulas form no difference of nearly equal numbers:
/// Iᵃ = R − R D⁻¹ R,  Hᵃ = R D⁻¹ H,  Mᵃ = M − Hᵀ D⁻¹ H
#[inline(always)]
pub(crate) fn apparent_inertia<T: Real>(
    inertia: &ArticulatedInertia<T>,
    armature: Vec3<T>,
    dof: usize,
    smallest: &mut Pivot,
) -> (ArticulatedInertia<T>, Ldl3<T>) {
    let d = (inertia.rotational + diagonal(armature)).factor();
    note_pivots(smallest, dof, &d);
    let (w, translational) = schur(inertia.translational, inertia.coupling.transpose(), &d);
    let carried = w.transpose();
    let scale_rows = |m: Mat3<T>| Mat3::from_rows(m.x * armature.x, m.y * armature.y, m.z * armature.z);
    let r = diagonal(armature).to_mat3();
    let inverse = Mat3::from_rows(d.solve(r.x), d.solve(r.y), d.solve(r.z)).transpose();
    let rotational = diagonal(armature) - Sym3::from_upper(scale_rows(inverse));
    (ArticulatedInertia { rotational, coupling: scale_rows(carried), translational }, d)
}

/// `pᴬ + U D⁻¹ u`, u = τ − Sᵀ pᴬ.
#[inline(always)]
fn pushed<T: Real>(link: &Link<T>, d: &Ldl3<T>, tau: &[T]) -> Force<T> {
    let d_inverse_u = d.solve(vec3(tau) - link.p.ang);
    link.p + link.inertia.mul(Motion::new(d_inverse_u, Vec3::zero()))
}

/// The diagonal matrix with these entries.
#[inline(always)]
fn diagonal<T: Real>(d: Vec3<T>) -> Sym3<T> {
    let zero = T::zero();
    Sym3 { xx: d.x, xy: zero, xz: zero, yy: d.y, yz: zero, zz: d.z }
}
