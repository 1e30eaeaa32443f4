//! The plane pendulum: period and motion.
//!
//! Computes θ(t) of θ̈ = −ω₀² sin θ that passes the bottom at t = 0 with rate w; with k = w/(2ω₀):
//! - k < 1: sin(θ/2) = k sn(ω₀t, k), θ̇ = w cn(ω₀t, k), period 4K(k)/ω₀;
//! - k > 1: θ/2 = am(kω₀t, 1/k), θ̇ = w dn(kω₀t, 1/k), one turn in 2K(1/k)/(kω₀).
//!
//! Source: Whittaker, *Analytical Dynamics* (1937), §44. Cost: one evaluation of elliptic functions.

use super::Elliptic;
use crate::{Error, Mp};

/// A pendulum in motion, at its lowest point at time zero.
#[derive(Clone, Debug)]
pub struct Pendulum {
    natural: Mp,
    rate: Mp,
    turning: bool,
    elliptic: Elliptic,
}

impl Pendulum {
    /// The pendulum with small-swing angular frequency `natural` = √(mgl/J) that passes the bottom with the positive rate `rate`.
    ///
    /// # Errors
    /// [`Error::Domain`] unless both are positive; also for the motion that ends at rest, upright.
    pub fn passing(natural: &Mp, rate: &Mp) -> Result<Self, Error> {
        if natural.is_negative() || natural.is_zero() || rate.is_negative() || rate.is_zero() {
            return Err(Error::Domain { what: "a pendulum's frequency and its rate at the bottom are positive" });
        }
        let k = rate / natural.twice();
        let m = &k * &k;
        let one = m.precision().integer(1);
        let turning = m > one;
        let elliptic = Elliptic::new(&if turning { one / m } else { m })?;
        Ok(Self { natural: natural.clone(), rate: rate.clone(), turning, elliptic })
    }

    /// The pendulum that swings between ±`amplitude`, 0 < amplitude < π: its rate at the bottom is 2ω₀ sin(amplitude/2).
    ///
    /// # Errors
    /// As [`Pendulum::passing`].
    pub fn swinging(natural: &Mp, amplitude: &Mp) -> Result<Self, Error> {
        Self::passing(natural, &(natural.twice() * amplitude.half().sin_cos().0))
    }

    /// The time of a whole swing to and fro, or of a whole turn.
    pub fn period(&self) -> Mp {
        let quarter = self.elliptic.quarter_period();
        if self.turning { quarter.twice().twice() / &self.rate } else { quarter.twice().twice() / &self.natural }
    }

    /// θ and θ̇ at time t; the angle counts whole turns.
    pub fn at(&self, t: &Mp) -> (Mp, Mp) {
        if self.turning {
            // kω₀ = w/2
            let u = (&self.rate * t).half();
            let (_, _, dn) = self.elliptic.functions(&u);
            (self.elliptic.amplitude(&u).twice(), &self.rate * dn)
        } else {
            let (sn, cn, _) = self.elliptic.functions(&(&self.natural * t));
            let k = &self.rate / self.natural.twice();
            ((k * sn).asin().twice(), &self.rate * cn)
        }
    }

    /// θ̈ at an angle: −ω₀² sin θ.
    pub fn acceleration(&self, angle: &Mp) -> Mp {
        -(&self.natural * &self.natural * angle.sin_cos().0)
    }
}
