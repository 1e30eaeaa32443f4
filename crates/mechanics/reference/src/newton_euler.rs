//! Newton's and Euler's equations of every body, projected on the degrees of freedom by explicit Jacobians.
//!
//! Computes, with J_b = ∂ċ_b/∂v and W_b = ∂ω_b/∂v and their derivatives in time written out,
//!
//! ```text
//! c̈ = J a + J̇ v    α = W a + Ẇ v
//! τ = Σ_b Jᵀ m (c̈ − g) + Wᵀ (I α + ω × I ω) + A a          (inverse dynamics; the bias force is a = 0)
//! M = Σ_b m JᵀJ + Wᵀ I W + A                                (A: armature)
//! q̈ = M⁻¹ (τ − h)                                           (by L D Lᵀ)
//! ```
//!
//! The sum over bodies in M is taken once per column k. For a unit rate of k alone, all bodies together have the momentum P_k = Σ m J_k,
//! and H_k = Σ c × m J_k + I z_k about the world's origin. Jᵀ of these is M_kl = l_l·P_k + z_l·(H_k − p_l × P_k).
//!
//! Source: d'Alembert's principle; Kane & Levinson (1985), chapter 4. Frame: world; no recursion over forces or composite bodies.
//! Cost: O(n·depth) for τ and M, O(n³) for q̈.

use crate::linear::{Factors, Matrix};
use crate::motion::Motion;
use crate::robot::Robot;
use crate::space::Vec3;
use crate::{Error, Mp};

/// The columns of one body: velocity of the centre of mass and angular velocity per unit rate, and the derivatives of both.
struct BodyJacobian<'a> {
    linear: Vec<Vec3<Mp>>,
    linear_rate: Vec<Vec3<Mp>>,
    path: &'a [usize],
}

impl Motion<'_> {
    /// J and J̇ of a body's centre of mass: J_k = l_k + z_k × (c − p_k).
    fn jacobian(&self, body: usize) -> BodyJacobian<'_> {
        let b = &self.bodies[body];
        let column = |&k: &usize| {
            let column = &self.columns[k];
            let carrier = &self.bodies[column.body];
            let (arm, arm_rate) = (b.com.minus(&carrier.origin), b.com_velocity.minus(&carrier.velocity));
            let linear = column.l.plus(&column.z.cross(&arm));
            let linear_rate = column.l_rate.plus(&column.z_rate.cross(&arm)).plus(&column.z.cross(&arm_rate));
            (linear, linear_rate)
        };
        let (linear, linear_rate) = b.path.iter().map(column).unzip();
        BodyJacobian { linear, linear_rate, path: &b.path }
    }

    /// τ = M a + h.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn inverse_dynamics(&self, a: &[Mp]) -> Result<Vec<Mp>, Error> {
        Robot::check("a", a.len(), self.robot.nv())?;
        Ok(self.torques(Some(a)))
    }

    /// The bias force h: the joint forces at zero acceleration.
    pub fn bias(&self) -> Vec<Mp> {
        self.torques(None)
    }

    fn torques(&self, a: Option<&[Mp]>) -> Vec<Mp> {
        let zeros = vec![Mp::zero(); self.robot.nv()];
        let a = a.unwrap_or(&zeros);
        let mut tau: Vec<Mp> = a.iter().zip(&self.robot.armature).map(|(a, armature)| a * armature).collect();
        for (index, body) in self.robot.bodies.iter().enumerate() {
            let b = &self.bodies[index];
            let jacobian = self.jacobian(index);
            // c̈ − g and α
            let (mut linear, mut angular) = (Vec3::zero().minus(&self.robot.gravity), Vec3::zero());
            for (i, &k) in jacobian.path.iter().enumerate() {
                let column = &self.columns[k];
                linear = linear.plus(&jacobian.linear[i].times(&a[k])).plus(&jacobian.linear_rate[i].times(&self.v[k]));
                angular = angular.plus(&column.z.times(&a[k])).plus(&column.z_rate.times(&self.v[k]));
            }
            let force = linear.times(&body.mass);
            let moment = b.inertia.apply(&angular).plus(&b.omega.cross(&b.inertia.apply(&b.omega)));
            for (i, &k) in jacobian.path.iter().enumerate() {
                tau[k] = &tau[k] + jacobian.linear[i].dot(&force) + self.columns[k].z.dot(&moment);
            }
        }
        tau
    }

    /// The mass matrix.
    pub fn mass_matrix(&self) -> Matrix {
        let n = self.robot.nv();
        // (P_k, H_k): momenta of all bodies for a unit rate of degree of freedom k alone.
        let mut momenta = vec![(Vec3::zero(), Vec3::zero()); n];
        for (index, body) in self.robot.bodies.iter().enumerate() {
            let b = &self.bodies[index];
            let jacobian = self.jacobian(index);
            for (linear, &k) in jacobian.linear.iter().zip(jacobian.path) {
                let momentum = linear.times(&body.mass);
                let (all, moment) = &momenta[k];
                let spin = b.inertia.apply(&self.columns[k].z).plus(&b.com.cross(&momentum));
                momenta[k] = (all.plus(&momentum), moment.plus(&spin));
            }
        }
        let mut mass = Matrix::zero(n);
        for (k, (momentum, moment)) in momenta.iter().enumerate() {
            for &l in self.bodies[self.columns[k].body].path.iter().take_while(|&&l| l <= k) {
                let column = &self.columns[l];
                let about_joint = moment.minus(&self.bodies[column.body].origin.cross(momentum));
                mass.set(k, l, column.l.dot(momentum) + column.z.dot(&about_joint));
            }
        }
        for k in 0..self.robot.nv() {
            mass.set(k, k, mass.get(k, k) + &self.robot.armature[k]);
            for l in 0..k {
                mass.set(l, k, mass.get(k, l).clone());
            }
        }
        mass
    }

    /// q̈ = M⁻¹(τ − h).
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::NotPositiveDefinite`] when M is not.
    pub fn forward_dynamics(&self, tau: &[Mp]) -> Result<Vec<Mp>, Error> {
        Robot::check("tau", tau.len(), self.robot.nv())?;
        let factors = Factors::new(&self.mass_matrix())?;
        let force: Vec<Mp> = tau.iter().zip(self.bias()).map(|(tau, h)| tau - h).collect();
        Ok(factors.solve(&force))
    }

    /// ½ vᵀ M v from the bodies' velocities, armature included.
    pub fn kinetic_energy(&self) -> Mp {
        let mut twice = self.v.iter().zip(&self.robot.armature).map(|(v, armature)| v * v * armature).sum::<Mp>();
        for (body, b) in self.robot.bodies.iter().zip(&self.bodies) {
            twice = twice + b.com_velocity.dot(&b.com_velocity) * &body.mass + b.omega.dot(&b.inertia.apply(&b.omega));
        }
        twice.half()
    }

    /// −Σ m g·c.
    pub fn potential_energy(&self) -> Mp {
        -self.robot.bodies.iter().zip(&self.bodies).map(|(body, b)| &body.mass * self.robot.gravity.dot(&b.com)).sum::<Mp>()
    }
}

/// Answers for doubles, which are taken exactly. Each is a multi-precision computation.
impl Robot {
    /// τ = M(q) a + h(q, v).
    ///
    /// # Errors
    /// As [`Robot::moving`] and [`Motion::inverse_dynamics`].
    pub fn inverse_dynamics(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<Mp>, Error> {
        self.moving(q, v)?.inverse_dynamics(&self.numbers("a", a)?)
    }

    /// h(q, v), gravity included.
    ///
    /// # Errors
    /// As [`Robot::moving`].
    pub fn bias(&self, q: &[f64], v: &[f64]) -> Result<Vec<Mp>, Error> {
        Ok(self.moving(q, v)?.bias())
    }

    /// M(q).
    ///
    /// # Errors
    /// As [`Robot::moving`].
    pub fn mass_matrix(&self, q: &[f64]) -> Result<Matrix, Error> {
        Ok(self.moving(q, &vec![0.0; self.nv()])?.mass_matrix())
    }

    /// q̈ = M⁻¹(τ − h).
    ///
    /// # Errors
    /// As [`Robot::moving`] and [`Motion::forward_dynamics`].
    pub fn forward_dynamics(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<Mp>, Error> {
        self.moving(q, v)?.forward_dynamics(&self.numbers("tau", tau)?)
    }
}
