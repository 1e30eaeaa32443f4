//! Centroidal momentum: angular momentum about the centre of mass, and linear momentum, without armature.
//!
//! Source: Orin, Goswami & Lee (2013), "Centroidal dynamics of a humanoid robot". It is the sum over bodies of `X* I v`, formed inward like
//! the book's composite inertias. Frame: world axes, at the centre of mass. Shapes: q has `nq` numbers, v has `nv`. Units: kg·m²/s and
//! kg·m/s. Cost: O(n). A call does not allocate.

use crate::{CenterOfMass, DimensionError, MassCenter};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Lift, Real};

/// The workspace of centroidal momentum.
#[derive(Clone, Debug)]
pub struct Momentum<T> {
    center: CenterOfMass<T>,
    /// Momentum of each body with all that it supports, in its axes.
    sums: Vec<Force<T>>,
}

/// A robot's momentum about its centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentroidalMomentum<T> {
    /// Mass and centre of mass.
    pub center: MassCenter<T>,
    /// [angular; linear] momentum about the centre of mass, in world axes.
    pub momentum: Force<T>,
}

impl<T: Real> Momentum<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { center: CenterOfMass::new(topology), sums: vec![Force::zero(); topology.bodies()] }
    }

    /// Centroidal momentum at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T]) -> Result<CentroidalMomentum<T>, DimensionError> {
        self.recurse(model, q, v)
    }

    /// [`Momentum::run`] as a part of its caller.
    #[inline(always)]
    pub(crate) fn recurse<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
    ) -> Result<CentroidalMomentum<T>, DimensionError> {
        let Self { center, sums } = self;
        center.kinematics.place(model, q)?;
        center.kinematics.set_moving(model, v)?;
        let (mass, offset) = center.sum(model);

        // h_i = I v_i
        for ((sum, inertia), link) in sums.iter_mut().zip(&model.inertias).zip(center.kinematics.bodies()) {
            *sum = inertia.lift().mul(link.v);
        }
        // h_p += X* h_i
        let mut total = Force::zero();
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            match joint.parent {
                Some(parent) => {
                    let moved = center.kinematics.bodies()[i].x.force(sums[i]);
                    sums[parent] += moved;
                }
                None => total += center.seen_from_origin(i).force(sums[i]),
            }
        }
        // n_c = n − c × f
        let momentum = Force::new(total.ang - offset.cross(total.lin), total.lin);
        Ok(CentroidalMomentum { center: MassCenter { mass, position: center.origin() + offset }, momentum })
    }
}

/// Centroidal momentum, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn centroidal_momentum<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
) -> Result<CentroidalMomentum<T>, DimensionError> {
    Momentum::new(&model.topology).run(model, q, v)
}
