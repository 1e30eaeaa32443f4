//! Forward kinematics: placement, velocity and acceleration of every body.
//!
//! Source: the book, section 5.3 (the outward pass of table 5.1), with classical accelerations.
//! Frames: results stand in world axes: the placement of the body's frame, the velocity [ω; ṗ] and acceleration [ω̇; p̈] of its origin p.
//! Gravity plays no part. Shapes: q has `nq` numbers; v and a have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::{add_joint, cross_joint, expect_bodies, parent_link};
use model::{Model, Topology};
use spatial::{Lift, Motion, Real, Transform};

/// The workspace of forward kinematics, and its results.
#[derive(Clone, Debug)]
pub struct Kinematics<T> {
    /// The world, then the bodies.
    links: Vec<Link<T>>,
}

/// How a body stands and moves, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion<T> {
    /// Placement of the body's frame in the world.
    pub placement: Transform<T>,
    /// Velocity [ω; ṗ] of the body's origin.
    pub velocity: Motion<T>,
    /// Classical acceleration [ω̇; p̈] of the body's origin.
    pub acceleration: Motion<T>,
}

/// A body's kinematics in its own axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<T> {
    /// Placement in the parent.
    pub(crate) x: Transform<T>,
    /// Placement in the world.
    pub(crate) world: Transform<T>,
    /// Velocity of the origin.
    pub(crate) v: Motion<T>,
    /// Classical acceleration of the origin.
    pub(crate) a: Motion<T>,
}

impl<T: Real> Kinematics<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let rest = Link { x: Transform::identity(), world: Transform::identity(), v: Motion::zero(), a: Motion::zero() };
        Self { links: vec![rest; topology.bodies() + 1] }
    }

    /// Moves every body to configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T], a: &[T]) -> Result<(), DimensionError> {
        expect("acceleration a", model.topology.nv(), a.len())?;
        self.place(model, q)?;
        self.set_moving(model, v)?;
        // a_i = X a_p + S q̈ + c
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let (kind, subspace, parent) = (joint.kind, &model.subspaces[i], self.links[parent_link(joint)]);
            let link = &mut self.links[i + 1];
            let (_, carried) = cross_joint(kind, &link.x, parent.v.ang, Some(parent.a), kind.motion(subspace, &v[joint.v..]));
            link.a = add_joint(kind, carried, kind.motion(subspace, &a[joint.v..]));
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

    /// The bodies' kinematics in their own axes.
    pub(crate) fn bodies(&self) -> &[Link<T>] {
        &self.links[1..]
    }

    /// Placements only: `X_i`, and `ᵂX_i = ᵂX_p ∘ X_i`.
    pub(crate) fn place<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T]) -> Result<(), DimensionError> {
        expect_bodies(model, self.links.len() - 1)?;
        expect("configuration q", model.topology.nq(), q.len())?;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let x = model.joint_transform(i, q);
            let world = self.links[parent_link(joint)].world.compose(&x);
            (self.links[i + 1].x, self.links[i + 1].world) = (x, world);
        }
        Ok(())
    }

    /// Velocities, once the bodies are placed: `v_i = X v_p + S q̇`.
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
        let r = &self.world.rotation;
        let turned = |m: Motion<T>| Motion::new(*r * m.ang, *r * m.lin);
        BodyMotion { placement: self.world, velocity: turned(self.v), acceleration: turned(self.a) }
    }
}

/// Forward kinematics in a workspace of its own; it allocates.
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
