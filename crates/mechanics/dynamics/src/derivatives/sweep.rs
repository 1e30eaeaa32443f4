//! What the derivatives share: every body in the axes of the world, about one origin per tree, and sums over sub-trees.
//!
//! Source: S. Singh, R. Russell & P. Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra*
//! (2022). Forces are summed over sub-trees in one frame. So a column needs no transport from joint to joint.
//!
//! Frame: an inertial one, with the axes of the world. Its origin is that of the tree's first body, and it moves with that origin's
//! velocity. So neither the distance from the world's origin nor the speed of the robot as a whole costs a digit. Accelerations are the
//! book's spatial ones, with −g for the world.
//!
//! The Coriolis operator of a body is `B x = ½ (v ×* I x − I (v × x) + x ×* I v)`. For a particle of mass m at r with velocity u it is
//! `[r × (α × m u); α × m u]`, α the angular part of x: the linear part of x drops out. So for a body, and for a sum of bodies,
//!
//! ```text
//! B x = [D α; α × l]      Bᵀ y = [Dᵀ y_ang + l × y_lin; 0]
//! D = tr(E)·1 − E         E = Σ m u rᵀ = v₀ hᵀ + ω× (½ tr(Ī)·1 − Ī)        l = Σ m u
//! ```
//!
//! Twelve numbers, which add up like masses. v₀ is the velocity at the origin, h the first moment of mass, Ī the rotational inertia.
//! Units: SI. Cost: O(n). Nothing here allocates.

use crate::DimensionError;
use crate::error::expect;
use crate::step::{State, by_kind, expect_bodies, expect_wrenches, slides, turns};
use featherbench_model::{Axis, JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Mat3, Motion, Real, RigidBodyInertia, Sym3, Transform, Vec3};

/// Every body at one state.
#[derive(Clone, Debug)]
pub(super) struct Sweep<T> {
    pub(super) links: Vec<Link<T>>,
}

/// A body in the frame of its tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<T> {
    /// Placement in the frame.
    pub(super) place: Transform<T>,
    /// Velocity v and spatial acceleration a at the frame's origin.
    pub(super) v: Motion<T>,
    pub(super) a: Motion<T>,
    /// The same of the parent: v_p and a_p.
    pub(super) parent_v: Motion<T>,
    pub(super) parent_a: Motion<T>,
    /// Sums over the body and all that it supports.
    pub(super) sum: Composite<T>,
}

/// Sums over bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Composite<T> {
    /// Inertia Iᶜ.
    pub(super) inertia: RigidBodyInertia<T>,
    /// D of the Coriolis operator Bᶜ.
    pub(super) d: Mat3<T>,
    /// Momentum Σ I v; its linear part is l of the Coriolis operator.
    pub(super) momentum: Force<T>,
    /// Force Σ (I a + v ×* I v − f_ext).
    pub(super) force: Force<T>,
}

impl<T: Real> Composite<T> {
    fn zero() -> Self {
        Self { inertia: RigidBodyInertia::zero(), d: Mat3::zero(), momentum: Force::zero(), force: Force::zero() }
    }

    /// `B x`.
    #[inline(always)]
    pub(super) fn coriolis(&self, alpha: Vec3<T>) -> Force<T> {
        Force::new(self.d * alpha, alpha.cross(self.momentum.lin))
    }

    /// The angular part of `Bᵀ y`; the linear part is zero.
    #[inline(always)]
    pub(super) fn coriolis_transposed(&self, y: Motion<T>) -> Vec3<T> {
        self.momentum.lin.cross_add(y.lin, self.d.transpose_mul(y.ang))
    }
}

impl<T: Real> Link<T> {
    /// The motion `S x` across a joint of this kind in the frame, given in body axes at the body's origin.
    #[inline(always)]
    pub(super) fn in_frame(&self, kind: JointKind, m: Motion<T>) -> Motion<T> {
        in_frame(kind, &self.place, m)
    }
}

/// `[R m_ang; R m_lin + r × R m_ang]` of a motion across a joint of this kind.
#[inline(always)]
fn in_frame<T: Real>(kind: JointKind, place: &Transform<T>, m: Motion<T>) -> Motion<T> {
    let (r, p) = (&place.rotation, place.translation);
    let ang = match kind {
        JointKind::Revolute(Axis::Z) => r.column_z() * m.ang.z,
        _ if turns(kind) => *r * m.ang,
        _ => m.ang,
    };
    let slide = match kind {
        JointKind::Prismatic(Axis::Z) => r.column_z() * m.lin.z,
        _ if slides(kind) => *r * m.lin,
        _ => m.lin,
    };
    let lin = match (turns(kind), slides(kind)) {
        (true, true) => p.cross_add(ang, slide),
        (true, false) => p.cross(ang),
        (false, _) => slide,
    };
    Motion::new(ang, lin)
}

impl<T: Real> Sweep<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        let still = Motion::zero();
        let rest = Link { place: Transform::identity(), v: still, a: still, parent_v: still, parent_a: still, sum: Composite::zero() };
        Self { links: vec![rest; topology.bodies()] }
    }

    /// Places the bodies, and sums over sub-trees.
    ///
    /// Without `MOVING` all velocities are zero, and D and the momenta are not set. Without `FORCED` accelerations and forces are not set, and
    /// of the state only q and v are read. What is absent costs nothing.
    pub(super) fn run<P: Real + Lift<T>, const MOVING: bool, const FORCED: bool>(
        &mut self,
        model: &Model<P>,
        state: State<'_, T>,
    ) -> Result<(), DimensionError> {
        let nv = model.topology.nv();
        expect_bodies(model, self.links.len())?;
        expect("configuration q", model.topology.nq(), state.q.len())?;
        if MOVING {
            expect("velocity v", nv, state.v.len())?;
        }
        if FORCED {
            expect("acceleration a", nv, state.given.len())?;
            expect_wrenches(&model.topology, state.wrenches)?;
        }
        let joints = model.topology.joints();

        // outward: v_i = v_p + S q̇,  a_i = a_p + S q̈ + v_i × S q̇, and the body's own share of the sums
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i);
            let parent = joint.parent.map(|parent| &before[parent]);
            by_kind!(T, joint.kind, outward::<T, P, MOVING, FORCED>, model, i, parent, state, &mut rest[0]);
        }
        // inward: sums over sub-trees
        for (i, joint) in joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                let (before, rest) = self.links.split_at_mut(i);
                let (sum, share) = (&mut before[parent].sum, &rest[0].sum);
                sum.inertia += share.inertia;
                if MOVING {
                    sum.d = sum.d + share.d;
                    sum.momentum += share.momentum;
                }
                if FORCED {
                    sum.force += share.force;
                }
            }
        }
        Ok(())
    }
}

/// The outward step of one body.
#[inline(always)]
fn outward<T: Real, P: Real + Lift<T>, const MOVING: bool, const FORCED: bool>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    parent: Option<&Link<T>>,
    state: State<'_, T>,
    link: &mut Link<T>,
) {
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    let x = kind.transform(&model.placements[i], subspace, &state.q[joint.q..]);
    link.place = match parent {
        Some(parent) => parent.place.compose(&x),
        // The frame's origin is that of the tree's first body.
        None => Transform::new(x.rotation, Vec3::zero()),
    };
    let own: RigidBodyInertia<T> = model.inertias[i].lift::<T>().to_parent(&link.place);
    link.sum.inertia = own;
    let mut across = Motion::zero();
    if MOVING {
        across = in_frame(kind, &link.place, kind.motion(subspace, &state.v[joint.v..]));
        // Seen from the frame, the world moves against the velocity of the tree's first origin.
        link.parent_v = parent.map_or_else(|| Motion::new(Vec3::zero(), -across.lin), |parent| parent.v);
        link.v = match parent {
            Some(parent) => parent.v + across,
            None => Motion::new(across.ang, Vec3::zero()),
        };
        link.sum.momentum = own.mul(link.v);
        link.sum.d = coriolis_moment(&own, link.v);
    }
    if FORCED {
        link.parent_a = match parent {
            Some(parent) => parent.a,
            None => Motion::new(Vec3::zero(), -model.gravity.lift()),
        };
        link.a = link.parent_a + in_frame(kind, &link.place, kind.motion(subspace, &state.given[joint.v..]));
        let mut force = Force::zero();
        if MOVING {
            link.a += link.v.cross_motion(across);
            force = link.v.cross_force(link.sum.momentum);
        }
        force += own.mul(link.a);
        if let Some(wrenches) = state.wrenches {
            force -= link.place.force(model.labels[i].force_to_compiled(wrenches[i]));
        }
        link.sum.force = force;
    }
}

/// D of one body: `(v₀·h)·1 − v₀ hᵀ − ω× Σ`, with the second moment of mass `Σ = ½ tr(Ī)·1 − Ī`.
#[inline(always)]
pub(super) fn coriolis_moment<T: Real>(inertia: &RigidBodyInertia<T>, v: Motion<T>) -> Mat3<T> {
    let RigidBodyInertia { first_moment: h, rotational: i, .. } = *inertia;
    let half = T::from_f64(0.5);
    let trace = (i.xx + i.yy + i.zz) * half;
    let second = Sym3 { xx: trace - i.xx, xy: -i.xy, xz: -i.xz, yy: trace - i.yy, yz: -i.yz, zz: trace - i.zz };
    // −ω× Σ = (Σ ω×)ᵀ, and row k of Σ ω× is (row k of Σ) × ω
    let rows = second.to_mat3();
    let turned = Mat3::from_rows(rows.x.cross(v.ang), rows.y.cross(v.ang), rows.z.cross(v.ang)).transpose();
    let trace = v.lin.dot(h);
    let row = |turned: Vec3<T>, v: T| h.scale_add(-v, turned);
    let (x, y, z) = (row(turned.x, v.lin.x), row(turned.y, v.lin.y), row(turned.z, v.lin.z));
    Mat3::from_rows(Vec3::new(x.x + trace, x.y, x.z), Vec3::new(y.x, y.y + trace, y.z), Vec3::new(z.x, z.y, z.z + trace))
}
