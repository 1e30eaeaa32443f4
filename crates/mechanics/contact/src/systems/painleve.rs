//! Painlevé's rod: a rigid rod whose tip slides on the ground, and the map of how many forces obey the laws.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// A uniform rod whose tip slides along +t with the centre of mass behind it: the tip is at r = l (cos θ, −sin θ) from the centre.
///
/// ```text
/// c̈_n = b + p N    p = (1 + 3 cos θ (cos θ − μ sin θ))/m    b = l θ̇² sin θ − g
/// ```
///
/// Source: P. Painlevé 1895; F. Génot and B. Brogliato, *New results on Painlevé paradoxes* (1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PainleveRod {
    /// m in kg.
    pub mass: f64,
    /// l, half the length, in m.
    pub half_length: f64,
    /// g in m/s².
    pub gravity: f64,
    /// μ.
    pub friction: f64,
    /// θ in rad: how far the rod is turned from the ground's direction.
    pub angle: f64,
    /// θ̇ in rad/s.
    pub rate: f64,
}

impl Default for PainleveRod {
    /// m = 1, l = 1, g = 9.81, μ = 1, tan θ = 2, at rest in rotation.
    fn default() -> Self {
        Self { mass: 1.0, half_length: 1.0, gravity: 9.81, friction: 1.0, angle: 2.0_f64.atan(), rate: 0.0 }
    }
}

/// How many normal forces obey the laws while the tip slides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answers {
    /// One positive force.
    Contact,
    /// One: no force, the tip lifts off.
    LiftOff,
    /// None.
    None,
    /// Two: no force, and a positive one.
    Two,
}

impl PainleveRod {
    /// The problem of the sliding tip, at the level of forces.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or a mass or length is not positive.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        self.problem_with("painleve_rod", Level::Force, Contact::sliding("tip", self.friction, 1.0), None)
    }

    /// The same contact at the level of impulses, with this tangential velocity of the tip (m/s): it always has a solution, an impact
    /// without collision where there is no force.
    ///
    /// # Errors
    /// As [`PainleveRod::problem`].
    pub fn impact(&self, slip: f64, duration: f64) -> Result<Problem, Malformed> {
        self.problem_with("painleve_impact", Level::Impulse, Contact::planar("tip", self.friction), Some((slip, duration)))
    }

    fn problem_with(&self, name: &str, level: Level, contact: Contact, step: Option<(f64, f64)>) -> Result<Problem, Malformed> {
        let (sine, cosine) = self.angle.sin_cos();
        let (l, m) = (self.half_length, self.mass);
        let mass = DMatrix::from_diagonal(&DVector::from_vec(vec![m, m, m * l * l / 3.0]));
        // The tip moves by ω × r = ω (l sin θ, l cos θ) in (t, n).
        let jacobian = DMatrix::from_row_slice(2, 3, &[0.0, 1.0, l * cosine, 1.0, 0.0, l * sine]);
        // The centripetal acceleration −θ̇² r of the tip is that of a free point of the rod; it enters as motion of the centre.
        let along = [-self.rate * self.rate * l * cosine, self.rate * self.rate * l * sine - self.gravity];
        let free = match step {
            None => vec![along[0], along[1], 0.0],
            Some((slip, duration)) => vec![slip + duration * along[0], duration * along[1], 0.0],
        };
        Problem::from_mechanism(name, level, vec![contact], Mechanism { mass, jacobian, free: DVector::from_vec(free) })
    }

    /// p in kg⁻¹ and b in m/s² of c̈_n = b + p N.
    pub fn effective(&self) -> (f64, f64) {
        let (sine, cosine) = self.angle.sin_cos();
        let p = (1.0 + 3.0 * cosine * (cosine - self.friction * sine)) / self.mass;
        (p, self.half_length * self.rate * self.rate * sine - self.gravity)
    }

    /// How many forces obey the laws, from the signs of p and b. The boundaries p = 0 and b = 0 count to the positive side.
    pub fn answers(&self) -> Answers {
        let (p, b) = self.effective();
        match (p >= 0.0, b >= 0.0) {
            (true, true) => Answers::LiftOff,
            (true, false) => Answers::Contact,
            (false, true) => Answers::Two,
            (false, false) => Answers::None,
        }
    }

    /// The least μ at which p can be negative: 4/3 for a uniform rod.
    pub fn critical_friction(&self) -> f64 {
        4.0 / 3.0
    }

    /// The angles between which p < 0: p = 0 where tan²θ − 3μ tan θ + 4 = 0. None up to the critical friction.
    pub fn paradox(&self) -> Option<(f64, f64)> {
        let half = 1.5 * self.friction;
        let discriminant = half * half - 4.0;
        let upper = half + discriminant.sqrt();
        // The product of the roots is 4: so the smaller one does not cancel.
        (discriminant > 0.0).then(|| ((4.0 / upper).atan(), upper.atan()))
    }
}
