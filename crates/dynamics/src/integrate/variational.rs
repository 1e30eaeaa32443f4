//! The variational midpoint rule: steps that make a discrete action stationary.
//!
//! The discrete Lagrangian of a step is `h L(q̂, u)`, with `q' = q ⊕ h u` and the middle `q̂ = q ⊕ (h/2) u`. Its derivatives are the momenta
//! before and after the step. With μ = M(q̂) u, the force `g = ∂T/∂q − ∂V/∂q + τ` in the middle, the right Jacobian J of the exponential, and
//! `A(x) = Ad(exp x)⁻¹`:
//!
//! ```text
//! w = J(hu)⁻ᵀ (μ + (h/2) J(hu/2)ᵀ g)        M(q) v = A(hu)ᵀ w − h A(hu/2)ᵀ g        M(q') v' = w
//! ```
//!
//! The middle equation is solved for u: `u ← u + M(q)⁻¹ (M(q) v − …)`. The iteration ends as that of [`super::ImplicitMidpoint`].
//!
//! Armature A of a spherical joint: here the dynamics have A ω̇ and no more. A Lagrangian with ½ ωᵀAω would have ω × A ω as well. So that is
//! added to τ. It is zero where the three armatures are equal; elsewhere the map is not symplectic.
//!
//! Source: J. E. Marsden and M. West, *Discrete mechanics and variational integrators* (2001), with forces by the discrete
//! principle of d'Alembert; on Lie groups: N. Bou-Rabee and J. E. Marsden, *Hamilton–Pontryagin integrators on Lie groups* (2009).
//!
//! Order 2. A step with −h undoes one with h. Without dissipation (q, M v) moves by a symplectic map, so that the energy does not drift. A momentum
//! that belongs to a symmetry is conserved to rounding: of a floating robot without gravity, the linear and angular momentum in world axes.
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: two [`crate::Aba::run`], and one [`EnergyGradient`] and one
//! [`crate::Aba::solve`] per iteration. A call does not allocate.

use super::IntegrationError;
use super::dense::add_scaled;
use super::dynamics::{Acceleration, Dynamics, System};
use super::error::{expect_finite, largest};
use super::midpoint::{Iteration, scale};
use crate::error::expect;
use crate::{EnergyGradient, EnergyPartials};
use featherbench_model::{JointKind, TangentMap, Topology};
use featherbench_spatial::{Angle, Vec3};

/// The workspace of the variational midpoint rule.
///
/// ```
/// use featherbench_dynamics::centroidal_momentum;
/// use featherbench_dynamics::integrate::{Dynamics, Passive, VariationalMidpoint};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_spatial::Vec3;
///
/// // A floating robot without gravity: its linear momentum stays, however long the steps are.
/// let mut model: Model<f64> = Model::build(&Family::parse("quadruped")?.generate()?)?;
/// model.gravity = Vec3::zero();
/// let states = StateBatch::random(&model, 1, 1);
/// let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
/// let before = centroidal_momentum(&model, &q, &v)?.momentum.lin;
/// let mut f = Dynamics::new(&model, Passive, &[])?;
/// let mut integrator = VariationalMidpoint::new(&model.topology);
/// for step in 0..20 {
///     integrator.step(&mut f, 0.01 * step as f64, 0.01, &mut q, &mut v)?;
/// }
/// let after = centroidal_momentum(&model, &q, &v)?.momentum.lin;
/// assert!((after - before).norm() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VariationalMidpoint<T> {
    topology: Topology,
    gradient: EnergyGradient<T>,
    energy: EnergyPartials<T>,
    /// A(hu), J(hu)⁻¹, A(hu/2), J(hu/2).
    whole_by_q: TangentMap<T>,
    whole_inverse: TangentMap<T>,
    half_by_q: TangentMap<T>,
    half_by_step: TangentMap<T>,
    /// M(q) v, u, and a step.
    momentum: Vec<T>,
    u: Vec<T>,
    increment: Vec<T>,
    /// g and w, and products.
    force: Vec<T>,
    after: Vec<T>,
    x: Vec<T>,
    y: Vec<T>,
    q: Vec<T>,
    iterations: usize,
}

impl<T: Angle> VariationalMidpoint<T> {
    /// The order p: the error after a fixed time falls like hᵖ.
    pub const ORDER: u32 = 2;

    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        let (zeros, map) = (|| vec![T::zero(); topology.nv()], TangentMap::new(topology));
        Self {
            topology: topology.clone(),
            gradient: EnergyGradient::new(topology),
            energy: EnergyPartials::new(topology),
            whole_by_q: map.clone(),
            whole_inverse: map.clone(),
            half_by_q: map.clone(),
            half_by_step: map,
            momentum: zeros(),
            u: zeros(),
            increment: zeros(),
            force: zeros(),
            after: zeros(),
            x: zeros(),
            y: zeros(),
            q: vec![T::zero(); topology.nq()],
            iterations: 0,
        }
    }

    /// The iterations of the last step.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Replaces the state at time `t` by that at `t + h`. After an error the state is as before.
    ///
    /// # Errors
    /// [`IntegrationError`]: an argument does not fit, a joint meets no inertia, a number is not finite, or the iteration does not converge.
    pub fn step<S: System>(&mut self, f: &mut Dynamics<S, T>, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        let half = h * T::from_f64(0.5);

        // M(q) v; u begins at v + (h/2) a, and that acceleration leaves the factors of M(q)
        self.gradient.run(f.model(), q, v, &mut self.energy)?;
        self.momentum.copy_from_slice(&self.energy.kinetic_by_v);
        f.acceleration(t, q, v, &mut self.x)?;
        self.u.copy_from_slice(v);
        add_scaled(half, &self.x, &mut self.u);

        let mut iteration = Iteration::new(t.min_lane());
        loop {
            self.momenta(f, t, h, q)?;
            for (y, momentum) in self.y.iter_mut().zip(&self.momentum) {
                *y = *momentum - *y;
            }
            f.solve(&self.y, &mut self.x)?;
            add_scaled(T::one(), &self.x, &mut self.u);
            if iteration.ends(largest(self.x.iter().copied()), largest(self.u.iter().copied()))? {
                break;
            }
        }
        self.iterations = iteration.count;

        // q' = q ⊕ h u, and v' = M(q')⁻¹ w
        self.momenta(f, t, h, q)?;
        scale(h, &self.u, &mut self.increment);
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        f.acceleration(t + h, &self.q, &self.u, &mut self.x)?;
        f.solve(&self.after, &mut self.x)?;
        expect_finite(t, &self.q, &self.x)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.x);
        Ok(())
    }

    /// The momenta of a step with u from `q`: that before it in `self.y`, that after it in `self.after`.
    fn momenta<S: System>(&mut self, f: &mut Dynamics<S, T>, t: T, h: T, q: &[T]) -> Result<(), IntegrationError> {
        let half = h * T::from_f64(0.5);
        scale(half, &self.u, &mut self.increment);
        self.half_by_q.d_integrate_q(&self.increment)?;
        self.half_by_step.d_integrate_v(&self.increment)?;
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        scale(h, &self.u, &mut self.increment);
        self.whole_by_q.d_integrate_q(&self.increment)?;
        self.whole_inverse.d_difference_to(&self.increment)?;

        // g = ∂T/∂q − ∂V/∂q + τ
        self.gradient.run(f.model(), &self.q, &self.u, &mut self.energy)?;
        f.joint_forces(t + half, &self.q, &self.u, &mut self.force)?;
        for joint in self.topology.joints().iter().filter(|joint| joint.kind == JointKind::Spherical) {
            let three = |x: &[T]| Vec3::new(x[joint.v], x[joint.v + 1], x[joint.v + 2]);
            let (omega, armature) = (three(&self.u), three(&f.model().armature));
            let spin = omega.cross(Vec3::new(armature.x * omega.x, armature.y * omega.y, armature.z * omega.z));
            add_scaled(T::one(), &spin.to_array(), &mut self.force[joint.v..]);
        }
        add_scaled(T::one(), &self.energy.kinetic_by_q, &mut self.force);
        add_scaled(-T::one(), &self.energy.potential_by_q, &mut self.force);

        // w = J(hu)⁻ᵀ (μ + (h/2) J(hu/2)ᵀ g)
        self.half_by_step.transpose_mul(&self.force, &mut self.x)?;
        self.y.copy_from_slice(&self.energy.kinetic_by_v);
        add_scaled(half, &self.x, &mut self.y);
        self.whole_inverse.transpose_mul(&self.y, &mut self.after)?;

        // before: A(hu)ᵀ w − h A(hu/2)ᵀ g
        self.whole_by_q.transpose_mul(&self.after, &mut self.y)?;
        self.half_by_q.transpose_mul(&self.force, &mut self.x)?;
        add_scaled(-h, &self.x, &mut self.y);
        Ok(())
    }
}
