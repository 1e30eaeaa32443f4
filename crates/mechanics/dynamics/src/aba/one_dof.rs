//! Elimination of a joint with one dof: S is one column, D one number.
//!
//! A revolute or prismatic joint about or along z of its body has S = 1 in one place. So S picks a column of Iᴬ, and no product is formed.

use super::Link;
use featherbench_model::{Axis, JointKind};
use featherbench_spatial::{ArticulatedInertia, Force, Motion, Real, Vec3};

/// `(Iᵃ, pᵃ, D)`. Keeps U D⁻¹, D⁻¹ and D⁻¹ u in the link.
#[inline(always)]
pub(super) fn eliminate<T: Real>(
    kind: JointKind,
    subspace: Motion<T>,
    armature: T,
    tau: T,
    inertia: &ArticulatedInertia<T>,
    link: &mut Link<T>,
) -> (ArticulatedInertia<T>, Force<T>, T) {
    let p = link.p;
    // U = Iᴬ S,  D = Sᵀ U + armature,  u = τ − Sᵀ pᴬ
    let upper_u = times_subspace(kind, inertia, subspace);
    let d = along(kind, subspace, upper_u) + armature;
    let u = tau - along(kind, subspace, p);

    let d_inverse = T::one() / d;
    let scaled = upper_u * d_inverse;
    (link.u_d_inverse, link.d_inverse, link.d_inverse_u) = (scaled, d_inverse, u * d_inverse);
    // Iᵃ = Iᴬ − U D⁻¹ Uᵀ,  pᵃ = pᴬ + Iᵃ c + U D⁻¹ u
    let apparent = inertia.subtract_rank_one(scaled, upper_u);
    (apparent, upper_u.scale_add(link.d_inverse_u, p + times_velocity_product(kind, &apparent, link.c)), d)
}

/// pᵃ with c = 0, by U D⁻¹ and D⁻¹ of the link.
#[inline(always)]
pub(super) fn apparent_force<T: Real>(kind: JointKind, subspace: Motion<T>, f: T, link: &mut Link<T>) -> Force<T> {
    let u = f - along(kind, subspace, link.p);
    link.d_inverse_u = u * link.d_inverse;
    link.u_d_inverse.scale_add(u, link.p)
}

/// q̈, where `carried` is a'.
#[inline(always)]
pub(super) fn acceleration<T: Real>(link: &Link<T>, carried: Motion<T>) -> T {
    // two short sums: the angular part is known first (docs/kernels/aba.md)
    link.d_inverse_u - link.u_d_inverse.ang.dot(carried.ang) - link.u_d_inverse.lin.dot(carried.lin)
}

/// `Iᴬ S`.
#[inline(always)]
fn times_subspace<T: Real>(kind: JointKind, inertia: &ArticulatedInertia<T>, subspace: Motion<T>) -> Force<T> {
    let ArticulatedInertia { rotational: i, coupling: h, translational: m } = inertia;
    match kind {
        JointKind::Revolute(Axis::Z) => Force::new(Vec3::new(i.xz, i.yz, i.zz), h.z),
        JointKind::Prismatic(Axis::Z) => Force::new(h.column_z(), Vec3::new(m.xz, m.yz, m.zz)),
        JointKind::Revolute(Axis::Skew) => Force::new(*i * subspace.ang, h.transpose_mul(subspace.ang)),
        JointKind::Prismatic(Axis::Skew) => Force::new(*h * subspace.lin, *m * subspace.lin),
        _ => inertia.mul(subspace),
    }
}

/// `Sᵀ f`.
#[inline(always)]
fn along<T: Real>(kind: JointKind, subspace: Motion<T>, f: Force<T>) -> T {
    match kind {
        JointKind::Revolute(Axis::Z) => f.ang.z,
        JointKind::Prismatic(Axis::Z) => f.lin.z,
        JointKind::Revolute(Axis::Skew) => subspace.ang.dot(f.ang),
        JointKind::Prismatic(Axis::Skew) => subspace.lin.dot(f.lin),
        _ => subspace.dot(f),
    }
}

/// `Iᵃ c`. The angular part `ω_p × ω_J` of c is zero along the axis, and of a joint that does not turn it is zero.
#[inline(always)]
fn times_velocity_product<T: Real>(kind: JointKind, apparent: &ArticulatedInertia<T>, c: Motion<T>) -> Force<T> {
    let ArticulatedInertia { rotational: i, coupling: h, translational: m } = apparent;
    match kind {
        JointKind::Revolute(Axis::Z) => {
            let (x, y) = (c.ang.x, c.ang.y);
            let turned = Vec3::new(i.xx.mul_add(x, i.xy * y), i.xy.mul_add(x, i.yy * y), i.xz.mul_add(x, i.yz * y));
            Force::new(h.mul_vec_add(c.lin, turned), h.x.scale_add(x, h.y.scale_add(y, *m * c.lin)))
        }
        JointKind::Prismatic(_) => Force::new(*h * c.lin, *m * c.lin),
        _ => apparent.mul(c),
    }
}
