//! The heavy symmetric top on a fixed point: conserved quantities and steady precession.
//!
//! Computes, in Euler's angles R = R_z(φ) R_x(θ) R_z(ψ) with moments A (transverse, about the fixed point) and C (axial):
//!
//! ```text
//! p_ψ = C ω₃,  ω₃ = ψ̇ + φ̇ cos θ     p_φ = A φ̇ sin²θ + p_ψ cos θ     E = ½A(θ̇² + φ̇² sin²θ) + ½C ω₃² + mgl cos θ
//! steady: A cos θ φ̇² − C ω₃ φ̇ + mgl = 0, two rates where (Cω₃)² > 4 A mgl cos θ
//! ```
//!
//! Source: Goldstein, *Classical Mechanics* (1980), §5.7. Cost: a square root and two sines.

use crate::{Error, Mp};

/// A symmetric top, its symmetry axis being the body's z axis.
#[derive(Clone, Debug)]
pub struct HeavyTop {
    /// Moment of inertia about a transverse axis through the fixed point.
    pub transverse: Mp,
    /// Moment of inertia about the symmetry axis.
    pub axial: Mp,
    /// Mass times gravity times the centre's distance from the fixed point.
    pub weight: Mp,
}

/// The conserved quantities of a top.
#[derive(Clone, Debug)]
pub struct TopMomenta {
    /// Angular momentum about the symmetry axis.
    pub axial: Mp,
    /// Angular momentum about the vertical.
    pub vertical: Mp,
    /// Kinetic and potential energy.
    pub energy: Mp,
}

/// A top that precesses at a constant tilt.
#[derive(Clone, Debug)]
pub struct SteadyPrecession {
    /// θ.
    pub tilt: Mp,
    /// φ̇.
    pub precession: Mp,
    /// ψ̇.
    pub spin: Mp,
}

impl HeavyTop {
    /// The two steady precessions at tilt θ with the component ω₃ of the angular velocity along the symmetry axis: slow, then fast.
    ///
    /// # Errors
    /// [`Error::Domain`] when the spin is too slow for that tilt, or the top horizontal (where one rate is infinite).
    pub fn steady(&self, tilt: &Mp, along_axis: &Mp) -> Result<[SteadyPrecession; 2], Error> {
        let cos = tilt.sin_cos().1;
        let momentum = &self.axial * along_axis;
        let lever = &self.transverse * &cos;
        let discriminant = &momentum * &momentum - (&lever * &self.weight).twice().twice();
        if discriminant.is_negative() || lever.is_zero() {
            return Err(Error::Domain { what: "a steadily precessing top has (Cω₃)² ≥ 4 A mgl cos θ and is not horizontal" });
        }
        // One root is a sum. The other follows from their product mgl/(A cos θ): no cancellation.
        let root = discriminant.sqrt();
        let larger = if momentum.is_negative() { &momentum - root } else { &momentum + root };
        let at = |precession: Mp| SteadyPrecession { tilt: tilt.clone(), spin: along_axis - &precession * &cos, precession };
        Ok([at(self.weight.twice() / &larger), at(&larger / lever.twice())])
    }

    /// What is conserved, from tilt θ and the rates θ̇, φ̇, ψ̇.
    pub fn conserved(&self, tilt: &Mp, tilt_rate: &Mp, precession: &Mp, spin: &Mp) -> TopMomenta {
        let (sin, cos) = tilt.sin_cos();
        let along_axis = spin + precession * &cos;
        let axial = &self.axial * &along_axis;
        let across = precession * &sin;
        let vertical = &self.transverse * &across * &sin + &axial * &cos;
        let energy = (&self.transverse * (tilt_rate * tilt_rate + &across * &across) + &axial * &along_axis).half() + &self.weight * &cos;
        TopMomenta { axial, vertical, energy }
    }
}

impl SteadyPrecession {
    /// Angular velocity and its derivative in body axes, at the spin angle ψ.
    pub fn body_rates(&self, spin_angle: &Mp) -> ([Mp; 3], [Mp; 3]) {
        let across = &self.precession * self.tilt.sin_cos().0;
        let (sin, cos) = spin_angle.sin_cos();
        let along_axis = &self.spin + &self.precession * self.tilt.sin_cos().1;
        let (x, y) = (&across * sin, &across * cos);
        let acceleration = [&y * &self.spin, -(&x * &self.spin), Mp::zero()];
        ([x, y, along_axis], acceleration)
    }
}
