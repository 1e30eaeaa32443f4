//! Gradients of energy: ∂T/∂q, ∂T/∂v = M v, and ∂V/∂q.
//!
//! Source: the definitions `2T = Σ v·I v` and `V = −Σ m g·c`. If dof j turns all that it supports by S_j, then v_k changes by
//! `S_j × v_k + v_p × S_j`, and the first term does not change T. With the momentum pᶜ and the weight wᶜ of the sub-tree:
//!
//! ```text
//! ∂T/∂q_j = (v_p × S_j) · pᶜ_j      ∂T/∂v_j = S_j · pᶜ_j + armature_j v_j      ∂V/∂q_j = −S_j · wᶜ_j
//! ```
//!
//! Frames: each body's own axes and origin, as compiled; q moves on the tangent space of the configurations, while the numbers in v stay.
//! Shapes: q has `nq` numbers, v has `nv`; each gradient has `nv`. Units: N·m, N; for ∂T/∂v those of momentum. Cost: O(n). A call does not
//! allocate.

use crate::error::expect;
use crate::{DimensionError, Kinematics};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real, Vec3};

/// Gradients of energy.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyPartials<T> {
    /// ∂T/∂q on the tangent space of the configurations.
    pub kinetic_by_q: Vec<T>,
    /// ∂T/∂v = M v, the momenta of the dofs, armature included.
    pub kinetic_by_v: Vec<T>,
    /// ∂V/∂q: the joint forces that hold the robot against gravity.
    pub potential_by_q: Vec<T>,
}

impl<T: Real> EnergyPartials<T> {
    /// Zero gradients for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let zeros = || vec![T::zero(); topology.nv()];
        Self { kinetic_by_q: zeros(), kinetic_by_v: zeros(), potential_by_q: zeros() }
    }
}

/// The workspace of the gradients of energy.
///
/// ```
/// use featherbench_dynamics::{EnergyGradient, EnergyPartials, bias_force};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("hand")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, n) = (states.q(0), states.v(0), model.topology.nv());
/// let mut gradients = EnergyPartials::new(&model.topology);
/// EnergyGradient::new(&model.topology).run(&model, q, v, &mut gradients)?;
///
/// // At rest the bias force is the gradient of the potential energy.
/// let weight = bias_force(&model, q, &vec![0.0; n])?;
/// assert!((0..n).all(|k| (gradients.potential_by_q[k] - weight[k]).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct EnergyGradient<T> {
    kinematics: Kinematics<T>,
    /// Of each body with all that it supports, in its axes: momentum, mass and first moment of mass.
    sums: Vec<Sum<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Sum<T> {
    momentum: Force<T>,
    mass: T,
    first_moment: Vec3<T>,
}

impl<T: Real> EnergyGradient<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let nothing = Sum { momentum: Force::zero(), mass: T::zero(), first_moment: Vec3::zero() };
        Self { kinematics: Kinematics::new(topology), sums: vec![nothing; topology.bodies()] }
    }

    /// The gradients at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `gradients` does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        gradients: &mut EnergyPartials<T>,
    ) -> Result<(), DimensionError> {
        let nv = model.topology.nv();
        expect("∂T/∂q", nv, gradients.kinetic_by_q.len())?;
        expect("∂T/∂v", nv, gradients.kinetic_by_v.len())?;
        expect("∂V/∂q", nv, gradients.potential_by_q.len())?;
        self.kinematics.place(model, q)?;
        self.kinematics.set_moving(model, v)?;
        let bodies = self.kinematics.bodies();

        for ((sum, inertia), link) in self.sums.iter_mut().zip(&model.inertias).zip(bodies) {
            let inertia = inertia.lift::<T>();
            *sum = Sum { momentum: inertia.mul(link.v), mass: inertia.mass, first_moment: inertia.first_moment };
        }
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            let (sum, link) = (self.sums[i], &bodies[i]);
            // w = [h × g; m g]
            let g = link.world.rotation.transpose_mul(model.gravity.lift());
            let weight = Force::new(sum.first_moment.cross(g), g * sum.mass);
            let parent_v = joint.parent.map_or(Motion::zero(), |parent| link.x.inverse_motion(bodies[parent].v));
            for k in 0..joint.kind.nv() {
                let (s, dof): (Motion<T>, usize) = (joint.kind.column(&model.subspaces[i], k), joint.v + k);
                gradients.kinetic_by_q[dof] = parent_v.cross_motion(s).dot(sum.momentum);
                gradients.kinetic_by_v[dof] = v[dof].mul_add(model.armature[dof].lift(), s.dot(sum.momentum));
                gradients.potential_by_q[dof] = -s.dot(weight);
            }
            if let Some(parent) = joint.parent {
                let moved = link.x.rotation.mul_vec_add(sum.first_moment, link.x.translation * sum.mass);
                let total = &mut self.sums[parent];
                total.momentum += link.x.force(sum.momentum);
                total.mass += sum.mass;
                total.first_moment += moved;
            }
        }
        Ok(())
    }
}

/// The gradients of energy in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn energy_gradient<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<EnergyPartials<T>, DimensionError> {
    let mut gradients = EnergyPartials::new(&model.topology);
    EnergyGradient::new(&model.topology).run(model, q, v, &mut gradients)?;
    Ok(gradients)
}
