//! Kinetic energy `½ vᵀM v`, armature included, and potential energy `−Σ m g·c`.
//!
//! Source: the book, chapter 2: the kinetic energy of a body is `½ v·I v`. Frames: velocities are in body axes, heights in world axes.
//! Shapes: q has `nq` numbers, v has `nv`. Units: J. The potential energy is zero if every centre of mass is at the world's origin.
//! Cost: O(n). A call does not allocate.

use crate::{DimensionError, Kinematics};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Lift, Real, Vec3};

/// The workspace of energy.
#[derive(Clone, Debug)]
pub struct Energy<T> {
    kinematics: Kinematics<T>,
}

/// Kinetic and potential energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energies<T> {
    /// Kinetic energy, armature included.
    pub kinetic: T,
    /// Potential energy in the field of gravity.
    pub potential: T,
}

impl<T: Real> Energy<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { kinematics: Kinematics::new(topology) }
    }

    /// Kinetic and potential energy at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T]) -> Result<Energies<T>, DimensionError> {
        self.kinematics.place(model, q)?;
        self.kinematics.set_moving(model, v)?;

        let (mut twice_kinetic, mut moment) = (T::zero(), Vec3::zero());
        for (inertia, link) in model.inertias.iter().zip(self.kinematics.bodies()) {
            // 2T += v·I v,  m c += R h + m p
            let inertia = inertia.lift();
            twice_kinetic += link.v.dot(inertia.mul(link.v));
            moment += link.world.rotation.mul_vec_add(inertia.first_moment, link.world.translation * inertia.mass);
        }
        for (v, armature) in v.iter().zip(&model.armature) {
            // 2T += armature_k q̇_k²
            twice_kinetic = (armature.lift() * *v).mul_add(*v, twice_kinetic);
        }
        Ok(Energies { kinetic: twice_kinetic * T::from_f64(0.5), potential: -model.gravity.lift().dot(moment) })
    }
}

/// Kinetic and potential energy, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn energy<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<Energies<T>, DimensionError> {
    Energy::new(&model.topology).run(model, q, v)
}
