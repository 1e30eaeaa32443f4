//! What the recursions share: the step across one joint, and the equations of motion of one body.
//!
//! Source: the book, sections 2.11 (spatial and classical acceleration) and 2.14 (equation of motion), written in 3-D vectors.
//! Accelerations are *classical*: [ω̇; p̈], the rate of change of angular velocity and of the velocity of the body's origin, in body axes.
//! They transform between frames like the book's spatial accelerations. Only the velocity products differ, and these contain no linear
//! velocity.
//! So no digit is lost on a robot that moves fast as a whole, and linear velocities need not be computed.
//! Frames: each body's own axes and origin. Units: SI. Cost: O(1) for a joint or a body. Nothing here allocates.

use crate::DimensionError;
use crate::error::expect;
use featherbench_model::{Axis, Joint, JointKind, Model, Topology};
use featherbench_spatial::{Force, Motion, Real, RigidBodyInertia, Transform, Vec3};

/// A state: the configuration, the velocity, what is given with them, and external wrenches.
#[derive(Clone, Copy, Debug)]
pub struct State<'a, T> {
    /// The configuration q.
    pub q: &'a [T],
    /// The velocity v.
    pub v: &'a [T],
    /// Of inverse dynamics the acceleration v̇, of forward dynamics the joint forces τ.
    pub given: &'a [T],
    /// External wrenches [moment; force], one per compiled body, in the described axes.
    pub wrenches: Option<&'a [Force<T>]>,
}

/// Calls `step(kind, …)` from one arm per kind, so that each inlined copy is compiled with its kind known. Over a scalar that is
/// [`Real::COMPACT`], and in a debug build, there is one copy, which reads the kind (`docs/kernels/compilation.md`).
macro_rules! by_kind {
    ($scalar:ty, $kind:expr, $step:expr, $($argument:expr),+ $(,)?) => {{
        use featherbench_model::Axis::{Skew, Z};
        use featherbench_model::JointKind::{Free, Helical, Prismatic, Revolute, Spherical};
        if cfg!(debug_assertions) || <$scalar as featherbench_spatial::Real>::COMPACT {
            $crate::step::arm!($step($kind, $($argument),+))
        } else {
            match $kind {
                Revolute(Z) => $crate::step::arm!($step(Revolute(Z), $($argument),+)),
                Revolute(Skew) => $crate::step::arm!($step(Revolute(Skew), $($argument),+)),
                Prismatic(Z) => $crate::step::arm!($step(Prismatic(Z), $($argument),+)),
                Prismatic(Skew) => $crate::step::arm!($step(Prismatic(Skew), $($argument),+)),
                Helical => $crate::step::arm!($step(Helical, $($argument),+)),
                Spherical => $crate::step::arm!($step(Spherical, $($argument),+)),
                Free => $crate::step::arm!($step(Free, $($argument),+)),
            }
        }
    }};
}
pub(crate) use by_kind;

/// An arm of `by_kind`. In a debug build it has a stack frame of its own: one frame with the variables of all arms would fill the stack of a
/// thread. Otherwise it is no closure, because a closure cannot be always inlined, and a batch needs that.
#[cfg(debug_assertions)]
macro_rules! arm {
    ($call:expr) => {
        $crate::step::in_own_frame(|| $call)
    };
}
#[cfg(not(debug_assertions))]
macro_rules! arm {
    ($call:expr) => {
        $call
    };
}
pub(crate) use arm;

#[cfg(debug_assertions)]
#[inline(always)]
pub(crate) fn in_own_frame<R>(step: impl FnOnce() -> R) -> R {
    step()
}

/// Where the parent's link stands in a workspace whose first link is the world.
#[inline(always)]
pub(crate) fn parent_link(joint: &Joint) -> usize {
    joint.parent.map_or(0, |parent| parent + 1)
}

/// Whether a joint of this kind turns its body.
#[inline(always)]
pub(crate) fn turns(kind: JointKind) -> bool {
    !matches!(kind, JointKind::Prismatic(_))
}

/// Whether a joint of this kind moves its body's origin in the parent.
#[inline(always)]
pub(crate) fn slides(kind: JointKind) -> bool {
    !matches!(kind, JointKind::Revolute(_) | JointKind::Spherical)
}

/// Whether a joint of this kind moves its body about or along z of the body.
#[inline(always)]
fn is_along_z(kind: JointKind) -> bool {
    matches!(kind, JointKind::Revolute(Axis::Z) | JointKind::Prismatic(Axis::Z))
}

/// `v + across`, where `across` is a part of the motion across a joint of this kind.
#[inline(always)]
fn add<T: Real>(kind: JointKind, v: Vec3<T>, across: Vec3<T>) -> Vec3<T> {
    if is_along_z(kind) { Vec3::new(v.x, v.y, v.z + across.z) } else { v + across }
}

/// `v × across`, where `across` is a part of the motion across a joint of this kind.
#[inline(always)]
fn cross<T: Real>(kind: JointKind, v: Vec3<T>, across: Vec3<T>) -> Vec3<T> {
    if is_along_z(kind) { Vec3::new(v.y * across.z, -(v.x * across.z), T::zero()) } else { v.cross(across) }
}

/// `v × across + addend`, where `across` is a part of the motion across a joint of this kind.
#[inline(always)]
fn cross_add<T: Real>(kind: JointKind, v: Vec3<T>, across: Vec3<T>, addend: Vec3<T>) -> Vec3<T> {
    if is_along_z(kind) {
        Vec3::new(v.y.mul_add(across.z, addend.x), (-v.x).mul_add(across.z, addend.y), addend.z)
    } else {
        v.cross_add(across, addend)
    }
}

/// `m + joint`, where `joint` is a motion across a joint of this kind.
#[inline(always)]
pub(crate) fn add_joint<T: Real>(kind: JointKind, m: Motion<T>, joint: Motion<T>) -> Motion<T> {
    Motion::new(
        if turns(kind) { add(kind, m.ang, joint.ang) } else { m.ang },
        if slides(kind) { add(kind, m.lin, joint.lin) } else { m.lin },
    )
}

/// The body's angular velocity, and its acceleration while the joint's own rates of change are zero: `X a_p + c`.
///
/// `x` is the body's placement in its parent, `joint = S q̇`. Without the parent's acceleration, what is returned is
/// `c = [ω_p × ω_J; ω_p × (ω_p × r) + (ω_p + ω) × v_J]` alone.
#[inline(always)]
pub(crate) fn cross_joint<T: Real>(
    kind: JointKind,
    x: &Transform<T>,
    parent_omega: Vec3<T>,
    parent_acceleration: Option<Motion<T>>,
    joint: Motion<T>,
) -> (Vec3<T>, Motion<T>) {
    let (r, p) = (&x.rotation, x.translation);
    let carried = r.transpose_mul(parent_omega);
    let omega = if turns(kind) { add(kind, carried, joint.ang) } else { carried };

    // ṗ_p + ω̇_p × r + ω_p × (ω_p × r), still in parent axes
    let swing = parent_omega.cross(p);
    let lin = match parent_acceleration {
        // The products first: their sum is rounded once to the size of p̈_p.
        Some(a) => a.lin + parent_omega.cross_add(swing, a.ang.cross(p)),
        None => parent_omega.cross(swing),
    };
    let lin = r.transpose_mul(lin);
    let lin = if slides(kind) { cross_add(kind, carried + omega, joint.lin, lin) } else { lin };

    let ang = match parent_acceleration {
        Some(a) if turns(kind) => cross_add(kind, carried, joint.ang, r.transpose_mul(a.ang)),
        Some(a) => r.transpose_mul(a.ang),
        None if turns(kind) => cross(kind, carried, joint.ang),
        None => Vec3::zero(),
    };
    (omega, Motion::new(ang, lin))
}

/// Newton's and Euler's equations at the body's origin: the force that gives a body its acceleration. h is the first moment of mass.
///
/// `f = I a + [ω × Ī ω; ω × (ω × h)]`; without an acceleration, the velocity-dependent part alone.
#[inline(always)]
pub(crate) fn newton_euler<T: Real>(inertia: &RigidBodyInertia<T>, omega: Vec3<T>, acceleration: Option<Motion<T>>) -> Force<T> {
    let h = inertia.first_moment;
    let (spin, swing) = (inertia.rotational * omega, omega.cross(h));
    match acceleration {
        Some(a) => Force::new(
            omega.cross_add(spin, h.cross_add(a.lin, inertia.rotational * a.ang)),
            omega.cross_add(swing, a.ang.cross_add(h, a.lin * inertia.mass)),
        ),
        None => Force::new(omega.cross(spin), omega.cross(swing)),
    }
}

/// Checks that the model's parts have the sizes of its topology, and that the workspace has the same number of bodies.
pub(crate) fn expect_bodies<P>(model: &Model<P>, workspace: usize) -> Result<(), DimensionError> {
    let bodies = model.topology.bodies();
    expect("bodies of the workspace", bodies, workspace)?;
    expect("labels of the model", bodies, model.labels.len())?;
    expect("placements of the model", bodies, model.placements.len())?;
    expect("subspaces of the model", bodies, model.subspaces.len())?;
    expect("inertias of the model", bodies, model.inertias.len())?;
    expect("armature of the model", model.topology.nv(), model.armature.len())
}

/// Checks an optional list of external wrenches, one per body.
pub(crate) fn expect_wrenches<T>(topology: &Topology, wrenches: Option<&[Force<T>]>) -> Result<(), DimensionError> {
    wrenches.map_or(Ok(()), |wrenches| expect("external wrenches", topology.bodies(), wrenches.len()))
}

/// Checks the model, and that the workspace has its number of bodies and of path slots.
pub(crate) fn expect_workspace<P>(model: &Model<P>, bodies: usize, slots: usize) -> Result<(), DimensionError> {
    expect_bodies(model, bodies)?;
    expect("path slots of the workspace", model.topology.slots(), slots)
}
