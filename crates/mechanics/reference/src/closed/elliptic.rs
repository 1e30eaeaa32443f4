//! Jacobi's elliptic functions and the complete integral of the first kind, by the arithmetic-geometric mean.
//!
//! Computes: with a₀ = 1, b₀ = √(1 − m), c₀ = √m and a' = (a + b)/2, b' = √(ab), c' = (a − b)/2: K = π/(2a_N), and the amplitude
//! φ_N = 2ᴺ a_N u, φ_{n−1} = (φ_n + arcsin(c_n/a_n · sin φ_n))/2; sn = sin φ₀, cn = cos φ₀, dn = √(1 − m sn²).
//! Source: Abramowitz & Stegun (1964), §16.4 and §17.6. Cost: log₂(bits) steps with one sine and one arcsine each.

use crate::{Error, Mp};

/// The elliptic functions of one parameter m = k², 0 ≤ m < 1.
#[derive(Clone, Debug)]
pub struct Elliptic {
    m: Mp,
    /// a_n and c_n, n = 0 … N.
    means: Vec<(Mp, Mp)>,
}

impl Elliptic {
    /// The functions of the parameter m = k², at its precision.
    ///
    /// # Errors
    /// [`Error::Domain`] unless 0 ≤ m < 1.
    pub fn new(m: &Mp) -> Result<Self, Error> {
        let precision = m.precision();
        let one = precision.integer(1);
        if m.is_negative() || *m >= one {
            return Err(Error::Domain { what: "the parameter m = k² of elliptic functions lies in [0, 1)" });
        }
        let tiny = (0..precision.get()).fold(one.clone(), |tiny, _| tiny.half());
        let (mut a, mut b, mut c) = (one.clone(), (&one - m).sqrt(), m.sqrt());
        let mut means = Vec::new();
        loop {
            means.push((a.clone(), c.clone()));
            if c.abs() <= tiny {
                return Ok(Self { m: m.clone(), means });
            }
            (a, b, c) = ((&a + &b).half(), (&a * &b).sqrt(), (&a - &b).half());
        }
    }

    /// K, a quarter of the period of sn.
    pub fn quarter_period(&self) -> Mp {
        let (mean, _) = &self.means[self.means.len() - 1];
        self.m.precision().pi().half() / mean
    }

    /// The amplitude am u, which grows by π when u grows by 2K.
    pub fn amplitude(&self, u: &Mp) -> Mp {
        let last = self.means.len() - 1;
        let mut phi = (0..last).fold(&self.means[last].0 * u, |phi, _| phi.twice());
        for (a, c) in self.means[1..].iter().rev() {
            phi = (&phi + (c / a * phi.sin_cos().0).asin()).half();
        }
        phi
    }

    /// sn u, cn u and dn u.
    pub fn functions(&self, u: &Mp) -> (Mp, Mp, Mp) {
        let (sn, cn) = self.amplitude(u).sin_cos();
        let dn = (self.m.precision().integer(1) - &self.m * &sn * &sn).sqrt();
        (sn, cn, dn)
    }
}
