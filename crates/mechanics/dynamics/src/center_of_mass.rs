//! The robot's mass and centre of mass.
//!
//! Source: the definition `c = Σ m_i c_i / Σ m_i`, summed inward: each body adds its mass m and first moment of mass h to those of its
//! parent, `h_p += R h + m r`. The sum is taken about the first body's origin. So a robot far from the world's origin loses no digits of
//! its shape. Frame: world axes and origin. Shapes: q has `nq` numbers. Units: kg, m. Cost: O(n). A call does not allocate.

use crate::{DimensionError, Kinematics};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Lift, Real, Transform, Vec3};

/// The workspace of the centre of mass.
#[derive(Clone, Debug)]
pub struct CenterOfMass<T> {
    pub(crate) kinematics: Kinematics<T>,
    /// Per body: mass, and first moment of mass in its axes, of all that it supports.
    sums: Vec<(T, Vec3<T>)>,
}

/// A mass and where its centre is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassCenter<T> {
    /// Total mass.
    pub mass: T,
    /// Centre of mass in the world; not finite when there is no mass.
    pub position: Vec3<T>,
}

impl<T: Real> CenterOfMass<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { kinematics: Kinematics::new(topology), sums: vec![(T::zero(), Vec3::zero()); topology.bodies()] }
    }

    /// Mass and centre of mass at configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T]) -> Result<MassCenter<T>, DimensionError> {
        self.kinematics.place(model, q)?;
        let (mass, offset) = self.sum(model);
        Ok(MassCenter { mass, position: self.origin() + offset })
    }

    /// The point about which sums are taken: the first body's origin.
    pub(crate) fn origin(&self) -> Vec3<T> {
        self.kinematics.bodies().first().map_or(Vec3::zero(), |body| body.x.translation)
    }

    /// The placement of a root body as seen from [`CenterOfMass::origin`].
    pub(crate) fn seen_from_origin(&self, root: usize) -> Transform<T> {
        let x = self.kinematics.bodies()[root].x;
        Transform::new(x.rotation, x.translation - self.origin())
    }

    /// Total mass, and the centre of mass as seen from [`CenterOfMass::origin`], once the bodies are placed.
    pub(crate) fn sum<P: Real + Lift<T>>(&mut self, model: &Model<P>) -> (T, Vec3<T>) {
        for (sum, inertia) in self.sums.iter_mut().zip(&model.inertias) {
            *sum = (inertia.mass.lift(), inertia.first_moment.lift());
        }
        let (mut total, mut moment) = (T::zero(), Vec3::zero());
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            let (mass, h) = self.sums[i];
            let x = joint.parent.map_or_else(|| self.seen_from_origin(i), |_| self.kinematics.bodies()[i].x);
            // h_p += R h + m r
            let moved = x.rotation.mul_vec_add(h, x.translation * mass);
            let (sum_mass, sum_moment) = joint.parent.map_or((&mut total, &mut moment), |parent| {
                let (mass, h) = &mut self.sums[parent];
                (mass, h)
            });
            *sum_mass += mass;
            *sum_moment += moved;
        }
        (total, Vec3::new(moment.x / total, moment.y / total, moment.z / total))
    }
}

/// Mass and centre of mass, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when `q` does not fit the model.
pub fn center_of_mass<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T]) -> Result<MassCenter<T>, DimensionError> {
    CenterOfMass::new(&model.topology).run(model, q)
}
