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
//! Derivative, with p = M(q) v, p⁻(q, u) the right-hand side of the middle equation, and p' = M(q') v':
//!
//! ```text
//! ∂p⁻/∂u δu = M(q) δv + ∂(p − p⁻)/∂q δq        M(q') δv' = ∂w/∂q δq + ∂w/∂u δu − ∂p'/∂q' δq'
//! ```
//!
//! Inputs enter as q does. It is that of the solution, whatever the iterations that led there.
//!
//! Armature A of a spherical joint: here the dynamics have A ω̇ and no more. A Lagrangian with ½ ωᵀAω would have ω × A ω as well. So that is
//! added to τ. It is zero where the three armatures are equal; elsewhere the map is not symplectic.
//!
//! Source: J. E. Marsden and M. West, *Discrete mechanics and variational integrators* (2001), with forces by the discrete
//! principle of d'Alembert; on Lie groups: N. Bou-Rabee and J. E. Marsden, *Hamilton–Pontryagin integrators on Lie groups* (2009).
//!
//! Order 2. A step with −h undoes one with h. Without dissipation (q, M v) moves by a symplectic map, so that the energy does not drift. A momentum
//! that belongs to a symmetry is conserved to rounding: of a floating robot without gravity, the linear and angular momentum in world axes.
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: two [`crate::Aba::run`], and one [`crate::EnergyGradient`] and one
//! [`crate::Aba::solve`] per iteration. The derivative adds one [`Linearise::linearise_lagrangian`], three [`crate::Crba::run`], two
//! [`crate::MassGradient::run`], and the factors of ∂p⁻/∂u. [`Integrator::push`] and [`Integrator::pull`] take five products with dense
//! matrices and two solutions. A call does not allocate.

mod derivative;
mod momenta;

use self::derivative::{Derivative, Ends};
use self::momenta::Momenta;
use super::dense::add_scaled;
use super::dynamics::Acceleration;
use super::error::{expect_finite, largest, no_room};
use super::lagrangian::{Lagrangian, MomentumAndForce};
use super::midpoint::{Iteration, scale};
use super::{IntegrationError, Integrator, Linearise};
use crate::error::expect;
use featherbench_model::Topology;
use featherbench_spatial::Angle;

/// The workspace of the variational midpoint rule.
///
/// ```
/// use featherbench_dynamics::centroidal_momentum;
/// use featherbench_dynamics::integrate::{Dynamics, Integrator, Passive, VariationalMidpoint};
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
    /// μ and g in the middle.
    middle: MomentumAndForce<T>,
    momenta: Momenta<T>,
    /// M(q) v and u.
    momentum: Vec<T>,
    u: Vec<T>,
    /// A step, and what the iteration lacks.
    increment: Vec<T>,
    gap: Vec<T>,
    /// The configuration in the middle, then the state after the step.
    q: Vec<T>,
    v: Vec<T>,
    iterations: usize,
    derivative: Option<Derivative<T>>,
}

impl<T: Angle> VariationalMidpoint<T> {
    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        let zeros = || vec![T::zero(); topology.nv()];
        Self {
            topology: topology.clone(),
            middle: MomentumAndForce::new(topology),
            momenta: Momenta::new(topology),
            momentum: zeros(),
            u: zeros(),
            increment: zeros(),
            gap: zeros(),
            q: vec![T::zero(); topology.nq()],
            v: zeros(),
            iterations: 0,
            derivative: None,
        }
    }

    /// A workspace for steps and their derivatives with this many inputs.
    pub fn with_derivatives(topology: &Topology, inputs: usize) -> Self {
        Self { derivative: Some(Derivative::new(topology, inputs)), ..Self::new(topology) }
    }

    /// The iterations of the last step.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Solves for u, and computes the state after the step in `self.q` and `self.v`.
    fn solve<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &[T], v: &[T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        let f = f.lagrangian().ok_or(IntegrationError::NoEnergies)?;

        // M(q) v; u begins at v + (h/2) a, and that acceleration leaves the factors of M(q)
        self.middle.set_momentum(f.model(), q, v)?;
        self.momentum.copy_from_slice(self.middle.momentum());
        f.acceleration(t, q, v, &mut self.v)?;
        self.u.copy_from_slice(v);
        add_scaled(h * T::from_f64(0.5), &self.v, &mut self.u);

        let mut iteration = Iteration::new(t.min_lane());
        loop {
            self.set_momenta(f, t, h, q)?;
            for ((gap, momentum), before) in self.gap.iter_mut().zip(&self.momentum).zip(self.momenta.before()) {
                *gap = *momentum - *before;
            }
            f.solve(&self.gap, &mut self.v)?;
            add_scaled(T::one(), &self.v, &mut self.u);
            if iteration.ends(largest(self.v.iter().copied()), largest(self.u.iter().copied()))? {
                break;
            }
        }
        self.iterations = iteration.count;

        // q' = q ⊕ h u, and v' = M(q')⁻¹ w
        self.set_momenta(f, t, h, q)?;
        scale(h, &self.u, &mut self.increment);
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        f.acceleration(t + h, &self.q, &self.u, &mut self.v)?;
        f.solve(self.momenta.after(), &mut self.v)?;
        expect_finite(t, &self.q, &self.v)
    }

    /// The momenta of a step with u from `q`.
    fn set_momenta(&mut self, f: &mut dyn Lagrangian<T>, t: T, h: T, q: &[T]) -> Result<(), IntegrationError> {
        let half = h * T::from_f64(0.5);
        scale(half, &self.u, &mut self.increment);
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        self.middle.set(f, t + half, &self.q, &self.u)?;
        self.momenta.set_step(h, &self.u)?;
        Ok(self.momenta.set(self.middle.momentum(), self.middle.force())?)
    }
}

impl<T: Angle> Integrator<T> for VariationalMidpoint<T> {
    const ORDER: u32 = 2;

    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.solve(f, t, h, q, v)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.solve(f, t, h, q, v)?;
        let Self { topology, middle, momenta, u, derivative, .. } = self;
        let ends = Ends { t, h, q, v, next_q: &self.q, next_v: &self.v };
        derivative.as_mut().ok_or_else(no_room)?.set(f, topology, &ends, u, middle, momenta)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        let derivative = self.derivative.as_mut().expect("a workspace made for derivatives");
        derivative.push(dq, dv, du).expect("directions have the sizes of the tree");
    }

    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        let derivative = self.derivative.as_mut().expect("a workspace made for derivatives");
        derivative.pull(lq, lv, lu).expect("gradients have the sizes of the tree");
    }
}
