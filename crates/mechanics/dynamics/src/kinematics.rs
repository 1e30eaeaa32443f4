//! Forward kinematics: placement, velocity and acceleration of every body.
//!
//! Source: the book, section 5.3 (the outward pass of table 5.1), with classical accelerations.
//! Frames: results are in world axes: the placement of the body's frame, the velocity [ω; ṗ] and acceleration [ω̇; p̈] of its origin p.
//! Velocities and accelerations are added in world axes: `ω = ω_p + J_ω q̇`, `ṗ = ṗ_p + ω_p × r + J_p q̇`, and their derivatives.
//! Here r is the displacement from the parent's origin to the body's, and J = R S. So each term is rotated once, whatever the depth.
//! Gravity does not enter. Shapes: q has `nq` numbers; v and a have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not
//! allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::{add_joint, by_kind, expect_bodies, parent_link, slides, turns};
use featherbench_model::{Axis, JointKind, Label, Model, Topology};
use featherbench_spatial::{Lift, Mat3, Motion, Real, Transform, Vec3};

/// The workspace of forward kinematics, and its results.
#[derive(Clone, Debug)]
pub struct Kinematics<T> {
    /// Link 0 is the world; link i + 1 is body i.
    links: Vec<Link<T>>,
}

/// Placement, velocity and acceleration of a body, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion<T> {
    /// Placement of the described body's frame in the world.
    pub placement: Transform<T>,
    /// Velocity [ω; ṗ] of the body's origin.
    pub velocity: Motion<T>,
    /// Classical acceleration [ω̇; p̈] of the body's origin.
    pub acceleration: Motion<T>,
}

/// A body's kinematics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<T> {
    /// How its described axes are called.
    label: Label,
    /// Placement in the parent.
    pub(crate) x: Transform<T>,
    /// The displacement from the parent's origin, in world axes.
    step: Vec3<T>,
    /// Placement in the world.
    pub(crate) world: Transform<T>,
    /// Velocity of the origin in compiled body axes.
    pub(crate) v: Motion<T>,
    /// Velocity and classical acceleration of the origin in world axes.
    velocity: Motion<T>,
    acceleration: Motion<T>,
}

impl<T: Real> Kinematics<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let (place, still) = (Transform::identity(), Motion::zero());
        let label = Label::Z;
        let rest = Link { label, x: place, step: Vec3::zero(), world: place, v: still, velocity: still, acceleration: still };
        Self { links: vec![rest; topology.bodies() + 1] }
    }

    /// Moves every body to configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T], a: &[T]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("acceleration a", model.topology.nv(), a.len())?;
        self.place(model, q)?;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(T, joint.kind, move_body, model, i, parent, v, a, link);
        }
        Ok(())
    }

    /// Results for a compiled body, or `None` if there is no such body.
    pub fn body(&self, body: usize) -> Option<BodyMotion<T>> {
        self.bodies().get(body).map(Link::in_world)
    }

    /// Results for every compiled body.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = BodyMotion<T>> {
        self.bodies().iter().map(Link::in_world)
    }

    /// The bodies' kinematics.
    pub(crate) fn bodies(&self) -> &[Link<T>] {
        &self.links[1..]
    }

    /// Placements only: `X_i`, and `ᵂX_i = ᵂX_p ∘ X_i`.
    pub(crate) fn place<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T]) -> Result<(), DimensionError> {
        expect_bodies(model, self.links.len() - 1)?;
        expect("configuration q", model.topology.nq(), q.len())?;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let x = model.joint_transform(i, q);
            let parent = self.links[parent_link(joint)].world;
            let step = parent.rotation * x.translation;
            let world = Transform::new(parent.rotation * x.rotation, parent.translation + step);
            let link = &mut self.links[i + 1];
            (link.label, link.x, link.step, link.world) = (model.labels[i], x, step, world);
        }
        Ok(())
    }

    /// Velocities in body axes, once the bodies are placed: `v_i = X v_p + S q̇`.
    pub(crate) fn set_moving<P: Real + Lift<T>>(&mut self, model: &Model<P>, v: &[T]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let carried = self.links[i + 1].x.inverse_motion(self.links[parent_link(joint)].v);
            self.links[i + 1].v = add_joint(joint.kind, carried, joint.kind.motion(&model.subspaces[i], &v[joint.v..]));
        }
        Ok(())
    }
}

impl<T: Real> Link<T> {
    fn in_world(&self) -> BodyMotion<T> {
        let rotation = self.label.rotation_to_described(self.world.rotation);
        BodyMotion { placement: Transform::new(rotation, self.world.translation), velocity: self.velocity, acceleration: self.acceleration }
    }
}

/// Velocity and acceleration of one body, once it is placed.
#[inline(always)]
fn move_body<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    parent: &Link<T>,
    v: &[T],
    a: &[T],
    link: &mut Link<T>,
) {
    let (dof, subspace, r) = (model.topology.joints()[i].v, &model.subspaces[i], link.step);
    let turned = |m: Motion<T>| rotated(kind, &link.world.rotation, m);
    let (rate, rate_of_rate) = (turned(kind.motion(subspace, &v[dof..])), turned(kind.motion(subspace, &a[dof..])));
    // v = [ω_p; ṗ_p + ω_p × r] + J q̇
    let (omega, alpha) = (parent.velocity.ang, parent.acceleration.ang);
    let swing = omega.cross(r);
    let mut velocity = Motion::new(omega, parent.velocity.lin + swing);
    // a = [ω̇_p; p̈_p + ω̇_p × r + ω_p × (ω_p × r)] + [ω_p × ω_J; (ω_p + ω) × v_J] + J q̈
    let mut acceleration = Motion::new(alpha, parent.acceleration.lin + omega.cross_add(swing, alpha.cross(r)));
    if turns(kind) {
        velocity.ang += rate.ang;
        acceleration.ang = acceleration.ang + omega.cross(rate.ang) + rate_of_rate.ang;
    }
    if slides(kind) {
        velocity.lin += rate.lin;
        acceleration.lin = acceleration.lin + (omega + velocity.ang).cross(rate.lin) + rate_of_rate.lin;
    }
    (link.velocity, link.acceleration) = (velocity, acceleration);
}

/// A motion across a joint of this kind, turned by `r`.
#[inline(always)]
fn rotated<T: Real>(kind: JointKind, r: &Mat3<T>, m: Motion<T>) -> Motion<T> {
    match kind {
        JointKind::Revolute(Axis::Z) => Motion::new(r.column_z() * m.ang.z, m.lin),
        JointKind::Prismatic(Axis::Z) => Motion::new(m.ang, r.column_z() * m.lin.z),
        _ => Motion::new(if turns(kind) { *r * m.ang } else { m.ang }, if slides(kind) { *r * m.lin } else { m.lin }),
    }
}

/// Forward kinematics in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn forward_kinematics<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
    a: &[T],
) -> Result<Kinematics<T>, DimensionError> {
    let mut kinematics = Kinematics::new(&model.topology);
    kinematics.run(model, q, v, a)?;
    Ok(kinematics)
}
