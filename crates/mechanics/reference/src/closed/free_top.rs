//! The free rigid body with three different moments of inertia: its angular velocity in body axes.
//!
//! Computes the solution of Euler's equations I₁ω̇₁ = (I₂ − I₃)ω₂ω₃ (cyclic), I₁ < I₂ < I₃, that has ω₂ = 0 at t = 0. Around the third
//! axis, where k² = (I₂ − I₁)I₁ω₁(0)² / ((I₃ − I₂)I₃ω₃(0)²) < 1:
//!
//! ```text
//! ω₁ = ω₁(0) cn u   ω₂ = ±√(I₁(I₃ − I₁)/(I₂(I₃ − I₂))) |ω₁(0)| sn u   ω₃ = ω₃(0) dn u   u = |ω₃(0)| √((I₃ − I₂)(I₃ − I₁)/(I₁I₂)) t
//! ```
//!
//! The sign is that of ω₁(0)ω₃(0). Otherwise it is around the first axis, with 1 and 3 exchanged. Source: Landau & Lifshitz, *Mechanics*
//! (1976), §37. The attitude (a third kind of elliptic integral) is not given. Cost: one evaluation of elliptic functions.

use super::Elliptic;
use crate::{Error, Mp};

/// A free rotating body, without rotation about its middle axis at time zero.
#[derive(Clone, Debug)]
pub struct FreeTop {
    moments: [Mp; 3],
    /// ω₁(0), the amplitude of ω₂ with its sign, ω₃(0).
    amplitude: [Mp; 3],
    /// du/dt.
    pace: Mp,
    /// Around the third axis (or the first).
    third: bool,
    elliptic: Elliptic,
}

impl FreeTop {
    /// The body with these ascending principal moments and ω(0) = (`first`, 0, `third`).
    ///
    /// # Errors
    /// [`Error::Domain`] unless 0 < I₁ < I₂ < I₃ and the body neither rests nor approaches the middle axis for ever.
    pub fn new(moments: [Mp; 3], first: &Mp, third: &Mp) -> Result<Self, Error> {
        let [i1, i2, i3] = &moments;
        if !(i1 > &Mp::zero() && i2 > i1 && i3 > i2) || (first.is_zero() && third.is_zero()) {
            return Err(Error::Domain { what: "a free top has moments 0 < I₁ < I₂ < I₃ and turns" });
        }
        let (low, high, all) = (i2 - i1, i3 - i2, i3 - i1);
        let (share1, share3) = (&low * i1 * first * first, &high * i3 * third * third);
        let around_third = share3 > share1;
        let (m, pace, width) = if around_third {
            let pace = third.abs() * (&high * &all / (i1 * i2)).sqrt();
            (share1 / share3, pace, first.abs() * (i1 * &all / (i2 * &high)).sqrt())
        } else {
            let pace = first.abs() * (&low * &all / (i3 * i2)).sqrt();
            (share3 / share1, pace, third.abs() * (i3 * &all / (i2 * &low)).sqrt())
        };
        let opposed = first.is_negative() != third.is_negative();
        let width = if opposed { -width } else { width };
        let elliptic = Elliptic::new(&m)?;
        Ok(Self { amplitude: [first.clone(), width, third.clone()], moments, pace, third: around_third, elliptic })
    }

    /// ω at time t, in principal axes.
    pub fn at(&self, t: &Mp) -> [Mp; 3] {
        let (sn, cn, dn) = self.elliptic.functions(&(&self.pace * t));
        let [first, width, third] = &self.amplitude;
        if self.third { [first * cn, width * sn, third * dn] } else { [first * dn, width * sn, third * cn] }
    }

    /// The time after which ω returns.
    pub fn period(&self) -> Mp {
        self.elliptic.quarter_period().twice().twice() / &self.pace
    }

    /// ½ ω·Iω.
    pub fn energy(&self) -> Mp {
        let [first, _, third] = &self.amplitude;
        (&self.moments[0] * first * first + &self.moments[2] * third * third).half()
    }

    /// |Iω|².
    pub fn squared_momentum(&self) -> Mp {
        let [first, _, third] = &self.amplitude;
        let (first, third) = (&self.moments[0] * first, &self.moments[2] * third);
        &first * &first + &third * &third
    }
}
