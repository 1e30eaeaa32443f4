//! A point on an inclined plane: round and elliptic cones, and pyramids seen from any heading.

use crate::malformed::Malformed;
use crate::problem::{Contact, Friction, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// The section of the friction cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Section {
    /// The disk ‖λ_t‖ ≤ μ λ_n.
    Round,
    /// An ellipse: this second coefficient belongs to t2.
    Elliptic(f64),
    /// |λ_1| + |λ_2| ≤ μ λ_n: inside the disk.
    Inscribed,
    /// |λ_1| ≤ μ λ_n and |λ_2| ≤ μ λ_n: around the disk.
    Box,
}

/// A point on an inclined plane during one step. Downhill is at the angle `heading` from t1.
///
/// ```
/// use featherbench_contact::systems::Incline;
/// use featherbench_contact::{Newton, Solver};
/// let incline = Incline::default();
/// let solution = Newton::default().solve(&incline.problem()?)?;
/// let speed = solution.point().ok_or("no answer")?.velocities.rows(1, 2).norm();
/// // a = g (sin θ − μ cos θ)
/// assert!((speed - 2.548298 * incline.duration).abs() < 1e-6 * incline.duration);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// The plane's angle in rad.
    pub angle: f64,
    /// μ.
    pub friction: f64,
    /// The section of the cone.
    pub section: Section,
    /// The angle from t1 to downhill, in rad.
    pub heading: f64,
    /// The mass in kg.
    pub mass: f64,
    /// g in m/s².
    pub gravity: f64,
    /// The step in s.
    pub duration: f64,
    /// The speed downhill before the step, in m/s.
    pub speed: f64,
}

impl Default for Incline {
    /// 40°, μ = 0.5, a round cone, heading 45°, 1 kg, g = 9.81, a step of 10 ms from rest.
    fn default() -> Self {
        let (angle, heading) = (40.0_f64.to_radians(), std::f64::consts::FRAC_PI_4);
        Self { angle, friction: 0.5, section: Section::Round, heading, mass: 1.0, gravity: 9.81, duration: 0.01, speed: 0.0 }
    }
}

impl Incline {
    /// The problem of the step.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let mu = self.friction;
        let friction = match self.section {
            Section::Round => Friction::Coulomb { coefficients: vec![mu; 2] },
            Section::Elliptic(second) => Friction::Coulomb { coefficients: vec![mu, second] },
            Section::Inscribed => Friction::Pyramid { vertices: vec![[mu, 0.0], [0.0, mu], [-mu, 0.0], [0.0, -mu]] },
            Section::Box => Friction::Pyramid { vertices: vec![[mu, mu], [-mu, mu], [-mu, -mu], [mu, -mu]] },
        };
        let (sine, cosine) = self.heading.sin_cos();
        let downhill = self.speed + self.duration * self.gravity * self.angle.sin();
        let free = vec![-self.duration * self.gravity * self.angle.cos(), downhill * cosine, downhill * sine];
        let mass = DMatrix::identity(3, 3) * self.mass;
        let mechanism = Mechanism { mass, jacobian: DMatrix::identity(3, 3), free: DVector::from_vec(free) };
        Problem::from_mechanism("incline", Level::Impulse, vec![Contact::new("point", friction)], mechanism)
    }

    /// The speed downhill after the step with the felt friction μ: max(v + h g (sin θ − μ cos θ), 0).
    pub fn speed_after(&self, felt: f64) -> f64 {
        let speed = self.speed + self.duration * self.gravity * (self.angle.sin() - felt * self.angle.cos());
        if speed < 0.0 { 0.0 } else { speed }
    }

    /// The answer of the convex relaxation with a round cone that slides: speed s and opening velocity μ s, from c ∈ K*, λ ∈ K, λ ⊥ c:
    /// s = (b_t + μ b_n)/(1 + μ²).
    pub fn relaxed(&self) -> (f64, f64) {
        let normal = -self.duration * self.gravity * self.angle.cos();
        let downhill = self.speed + self.duration * self.gravity * self.angle.sin();
        let speed = (downhill + self.friction * normal) / (1.0 + self.friction * self.friction);
        (speed, self.friction * speed)
    }
}
