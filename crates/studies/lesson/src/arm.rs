//! The lesson's planar arm with two hinges, three ways: its Lagrangian as symbols, a closed form, and a description for our kernels.
//!
//! Angles are measured from the upward vertical, the second relative to the first link. With the lever c of each link's centre of mass and
//! the inertia I about it
//!
//! ```text
//! 2T = (m₁c₁² + I₁) q̇₁² + m₂ (l₁² q̇₁² + c₂² (q̇₁ + q̇₂)² + 2 l₁ c₂ q̇₁ (q̇₁ + q̇₂) cos q₂) + I₂ (q̇₁ + q̇₂)²
//!  V = g (m₁ c₁ cos q₁ + m₂ (l₁ cos q₁ + c₂ cos(q₁ + q₂)))
//! ```
//!
//! Units: SI. The lesson's T has c = l and its V has c = l/2: no body has both.

use crate::algebra::{Algebra, AlgebraError, Expression};
use crate::claim::Failure;
use crate::lagrange::Equations;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Malformed, Model, Placement};
use featherbench_spatial::Real;

/// How the mass of a link is spread along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Links {
    /// As the lesson's T and V have it: first moment m l in T, m l/2 in V.
    Lesson,
    /// All mass at the far end.
    TipMasses,
    /// A thin uniform rod.
    UniformRods,
}

impl Links {
    /// All of them.
    pub const ALL: [Links; 3] = [Links::Lesson, Links::TipMasses, Links::UniformRods];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Links::Lesson => "lesson's T and V",
            Links::TipMasses => "masses at the tips",
            Links::UniformRods => "uniform rods",
        }
    }

    /// Levers of the mass in T and in V over l, and I over m l².
    fn shape(self) -> [f64; 3] {
        match self {
            Links::Lesson => [1.0, 0.5, 0.0],
            Links::TipMasses => [1.0, 1.0, 0.0],
            Links::UniformRods => [0.5, 0.5, 1.0 / 12.0],
        }
    }
}

/// The arm with its state and its joint torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// How mass is spread.
    pub links: Links,
    /// m₁, m₂ in kg.
    pub masses: [f64; 2],
    /// l₁, l₂ in m.
    pub lengths: [f64; 2],
    /// g in m/s².
    pub gravity: f64,
    /// q in rad.
    pub q: [f64; 2],
    /// q̇ in rad/s.
    pub v: [f64; 2],
    /// τ in N·m.
    pub tau: [f64; 2],
}

impl Default for Arm {
    /// Uniform rods: m = (2, 1), l = (1, ½), g = 9.81, q = (0.3, −0.5), q̇ = (0.7, 0.4), τ = (1, −0.5).
    fn default() -> Self {
        Self {
            links: Links::UniformRods,
            masses: [2.0, 1.0],
            lengths: [1.0, 0.5],
            gravity: 9.81,
            q: [0.3, -0.5],
            v: [0.7, 0.4],
            tau: [1.0, -0.5],
        }
    }
}

/// The arguments of the exported function, in this order.
pub const ARGUMENTS: [&str; 13] = ["q1", "q2", "dq1", "dq2", "tau1", "tau2", "d1", "d2", "m1", "m2", "l1", "l2", "g"];

/// The arm's equations as expressions.
#[derive(Clone, Debug)]
pub struct Symbolic {
    /// Where they live.
    pub algebra: Algebra,
    /// T.
    pub kinetic: Expression,
    /// V.
    pub potential: Expression,
    /// M and h.
    pub equations: Equations,
    /// q̈ for τ − d.
    pub accelerations: Vec<Expression>,
}

impl Arm {
    /// The arm with other links.
    #[must_use]
    pub fn with(self, links: Links) -> Self {
        Self { links, ..self }
    }

    /// The values of [`ARGUMENTS`], with residual torques d.
    pub fn arguments(&self, d: [f64; 2]) -> [f64; 13] {
        let ([q1, q2], [v1, v2], [t1, t2], [m1, m2], [l1, l2]) = (self.q, self.v, self.tau, self.masses, self.lengths);
        [q1, q2, v1, v2, t1, t2, d[0], d[1], m1, m2, l1, l2, self.gravity]
    }

    /// m₂ c₂ of T, kg·m.
    pub(crate) fn first_moment(&self) -> f64 {
        let [lever, _, _] = self.links.shape();
        self.masses[1] * lever * self.lengths[1]
    }

    /// M (m₁₁, m₁₂, m₂₂) and h in closed form, in any scalar, with the masses m.
    pub fn closed_form<T: Real>(&self, masses: [T; 2]) -> ([T; 3], [T; 2]) {
        let number = T::from_f64;
        let [kinetic, potential, inertia] = self.links.shape();
        // 1/12 has more digits than a double.
        let inertia = if inertia == 0.0 { T::zero() } else { T::one() / number(12.0) };
        let ([m1, m2], [l1, l2]) = (masses, self.lengths.map(number));
        let ([c1, c2], [w1, w2]) = ([l1, l2].map(|l| number(kinetic) * l), [l1, l2].map(|l| number(potential) * l));
        let ([i1, i2], [v1, v2]) = ([inertia * m1 * l1 * l1, inertia * m2 * l2 * l2], self.v.map(number));
        let (q1, q2) = (number(self.q[0]), number(self.q[1]));
        let ((sine, cosine), (sine_1, _), (sine_12, _)) = (q2.sin_cos(), q1.sin_cos(), (q1 + q2).sin_cos());
        let outer = m2 * c2 * c2 + i2;
        let cross = m2 * l1 * c2;
        let mass = [m1 * c1 * c1 + i1 + m2 * l1 * l1 + outer + (cross + cross) * cosine, outer + cross * cosine, outer];
        let (turn, g) = (cross * sine, number(self.gravity));
        let weight_2 = g * m2 * w2 * sine_12;
        let weight_1 = g * (m1 * w1 + m2 * l1) * sine_1 + weight_2;
        let bias = [-(turn * (v1 * v2 + v1 * v2 + v2 * v2)) - weight_1, turn * v1 * v1 - weight_2];
        (mass, bias)
    }

    /// q̈ by Cramer's rule from the closed form.
    pub fn accelerations<T: Real>(&self, masses: [T; 2]) -> [T; 2] {
        let ([m11, m12, m22], h) = self.closed_form(masses);
        let [x, y] = [T::from_f64(self.tau[0]) - h[0], T::from_f64(self.tau[1]) - h[1]];
        let determinant = m11 * m22 - m12 * m12;
        [(x * m22 - y * m12) / determinant, (y * m11 - x * m12) / determinant]
    }

    /// The torques M a + h of the closed form.
    pub fn torques<T: Real>(&self, masses: [T; 2], a: [T; 2]) -> [T; 2] {
        let ([m11, m12, m22], h) = self.closed_form(masses);
        [m11 * a[0] + m12 * a[1] + h[0], m12 * a[0] + m22 * a[1] + h[1]]
    }

    /// The arm for our kernels: hinges about y, links along z, so that q = 0 points upwards. `None` for the lesson's links: no body has them.
    pub fn description(&self) -> Option<Description> {
        let [lever, weight, inertia] = self.links.shape();
        if lever != weight {
            return None;
        }
        let body = |k: usize| {
            let (m, l) = (self.masses[k], self.lengths[k]);
            let about = inertia * m * l * l;
            let translation = [0.0, 0.0, if k == 0 { 0.0 } else { self.lengths[0] }];
            let placement = Placement { translation, ..Placement::default() };
            let kind = JointType::Revolute { axis: [0.0, 1.0, 0.0] };
            BodyDescription {
                name: format!("link {}", k + 1),
                parent: k.checked_sub(1),
                mass: m,
                com: [0.0, 0.0, lever * l],
                inertia: [about, 0.0, 0.0, about, 0.0, 0.0],
                joint: JointDescription { name: format!("hinge {}", k + 1), kind, placement, ..JointDescription::default() },
            }
        };
        let bodies = vec![body(0), body(1)];
        Some(Description { name: "arm".into(), gravity: [0.0, 0.0, -self.gravity], bodies, ..Description::default() })
    }

    /// The compiled model, `None` as in [`Arm::description`].
    ///
    /// # Errors
    /// [`Malformed`] if a number is not finite or a mass is negative.
    pub fn model(&self) -> Result<Option<Model<f64>>, Malformed> {
        self.description().map(|description| Model::build(&description)).transpose()
    }

    /// The compiled model of links that a body has.
    pub(crate) fn body(&self) -> Result<Model<f64>, Failure> {
        self.model()?.ok_or_else(|| Failure::of("no body has the lesson's links; take rods or tip masses"))
    }
}

impl Symbolic {
    /// The Lagrangian of an arm with such links, and what follows from it.
    ///
    /// ```
    /// use featherbench_lesson::arm::{ARGUMENTS, Arm, Links, Symbolic};
    /// let tips = Symbolic::of(Links::TipMasses)?;
    /// let arm = Arm::default().with(Links::TipMasses);
    /// let a = tips.algebra.evaluate(&tips.accelerations, &ARGUMENTS, &arm.arguments([0.0; 2]))?;
    /// assert!((a[0] - 5.5110867986).abs() < 1e-10 && (a[1] + 20.6120093841).abs() < 1e-10);
    /// # Ok::<(), featherbench_lesson::AlgebraError>(())
    /// ```
    ///
    /// # Errors
    /// [`AlgebraError`], which no links here give.
    pub fn of(links: Links) -> Result<Self, AlgebraError> {
        let mut algebra = Algebra::default();
        let a = &mut algebra;
        let [q1, q2, v1, v2, tau1, tau2, d1, d2, m1, m2, l1, l2, g] = ARGUMENTS.map(|name| a.symbol(name));
        let [lever, weight, inertia] = links.shape();
        let [half, two, lever, weight] = [0.5, 2.0, lever, weight].map(|value| a.number(value));
        let inertia = if inertia == 0.0 {
            a.number(0.0)
        } else {
            let (one, twelve) = (a.number(1.0), a.number(12.0));
            a.div(one, twelve)
        };
        let turn = a.add(v1, v2);
        let (c1, c2) = (a.mul(lever, l1), a.mul(lever, l2));
        let cosine = a.cos(q2);
        let terms = [
            a.product(&[m1, c1, c1, v1, v1]),
            a.product(&[inertia, m1, l1, l1, v1, v1]),
            a.product(&[m2, l1, l1, v1, v1]),
            a.product(&[m2, c2, c2, turn, turn]),
            a.product(&[two, m2, l1, c2, v1, turn, cosine]),
            a.product(&[inertia, m2, l2, l2, turn, turn]),
        ];
        let twice = a.sum(&terms);
        let kinetic = a.mul(half, twice);
        let both = a.add(q1, q2);
        let (up_1, up_12) = (a.cos(q1), a.cos(both));
        let terms = [a.product(&[m1, g, weight, l1, up_1]), a.product(&[m2, g, l1, up_1]), a.product(&[m2, g, weight, l2, up_12])];
        let potential = a.sum(&terms);
        let lagrangian = a.sub(kinetic, potential);
        let equations = Equations::of(a, lagrangian, &[q1, q2], &[v1, v2])?;
        let forces = [a.sub(tau1, d1), a.sub(tau2, d2)];
        let accelerations = equations.accelerations(a, &forces)?;
        Ok(Self { algebra, kinetic, potential, equations, accelerations })
    }
}
