//! Where a constraint holds a robot: a frame on a body, or in the world.

use featherbench_dynamics::{BodyMotion, Kinematics};
use featherbench_spatial::{Force, Lift, Mat3, Motion, Real, Transform, Vec3};

/// A frame fixed to a body, or to the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// The compiled body ([`Model::described`](featherbench_model::Model::described) gives it), or `None` for the world.
    pub body: Option<usize>,
    /// The frame's placement in the described axes of the body, or in the world.
    pub placement: Transform<f64>,
}

impl Attachment {
    /// A point of a body, with the axes of that body. Coordinates in m.
    pub fn point(body: usize, point: [f64; 3]) -> Self {
        Self { body: Some(body), placement: Transform::new(Mat3::identity(), Vec3::from_array(point)) }
    }

    /// A point of the world, with its axes. Coordinates in m.
    pub fn world(point: [f64; 3]) -> Self {
        Self { body: None, placement: Transform::new(Mat3::identity(), Vec3::from_array(point)) }
    }

    /// The same frame with these axes: `rotation` takes them to the axes of the body.
    pub fn with_axes(self, rotation: Mat3<f64>) -> Self {
        Self { placement: Transform::new(rotation, self.placement.translation), ..self }
    }
}

/// An attachment in motion. All in world axes; the acceleration is classical.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor<T> {
    body: Option<usize>,
    /// From the body's origin to the frame's.
    arm: Vec3<T>,
    pub(crate) placement: Transform<T>,
    pub(crate) velocity: Motion<T>,
    pub(crate) acceleration: Motion<T>,
}

impl<T: Real> Anchor<T>
where
    f64: Lift<T>,
{
    /// The attachment where the kinematics have its body; `None` if they have no such body.
    ///
    /// With `r` the arm: `ṗ = ṗ₀ + ω × r`, `p̈ = p̈₀ + ω̇ × r + ω × (ω × r)`.
    pub(crate) fn of(attachment: &Attachment, kinematics: &Kinematics<T>) -> Option<Self> {
        let own = attachment.placement.lift();
        let Some(body) = attachment.body else {
            let still = Motion::zero();
            return Some(Self { body: None, arm: Vec3::zero(), placement: own, velocity: still, acceleration: still });
        };
        let BodyMotion { placement, velocity, acceleration } = kinematics.body(body)?;
        let arm = placement.rotation * own.translation;
        let swing = velocity.ang.cross(arm);
        Some(Self {
            body: Some(body),
            arm,
            placement: Transform::new(placement.rotation * own.rotation, placement.translation + arm),
            velocity: Motion::new(velocity.ang, velocity.lin + swing),
            acceleration: Motion::new(acceleration.ang, acceleration.lin + velocity.ang.cross_add(swing, acceleration.ang.cross(arm))),
        })
    }

    /// A moment and a force at the frame's origin, as they are at the body's origin; nothing where the world takes them.
    pub(crate) fn wrench(&self, moment: Vec3<T>, force: Vec3<T>) -> Option<(usize, Force<T>)> {
        self.body.map(|body| (body, Force::new(moment + self.arm.cross(force), force)))
    }

    /// Axis `k` of the frame.
    pub(crate) fn axis(&self, k: usize) -> Vec3<T> {
        let columns = self.placement.rotation.transpose();
        match k {
            0 => columns.x,
            1 => columns.y,
            _ => columns.z,
        }
    }
}
