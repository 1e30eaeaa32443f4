//! The natural logarithm, for the scalars that have one.
//!
//! The dynamics kernels need none: it is no part of [`Real`]. The logarithm of a determinant does.
//!
//! In double-double: `ln x = k ln 2 + ln m` with m in [√½, √2], and `ln m = 2 Σ s^(2j+1) / (2j+1)` with s = (m − 1)/(m + 1). Since s² < 0.0295,
//! 22 terms leave less than 10⁻³⁴ of the sum. With u = 2⁻⁵³ the relative error is at most
//!
//! - 40u² where k = 0, next to 1 as well: 21u² of s, 8u² of the sum, 5u² of the product, 6u² of the last operation;
//! - 60u² elsewhere: |ln x| is at least half of |k| ln 2, whose error adds 10u².

use super::{Compensated, Counted, DoubleDouble, Dual, Part, Real};
use wide::{f32x8, f32x16, f64x4, f64x8};

/// A scalar with a natural logarithm.
///
/// ```
/// use featherbench_spatial::{Dual, Logarithm};
/// let x = Dual::new(2.0, 3.0).ln();
/// assert_eq!((x.value, x.derivative), (std::f64::consts::LN_2, 1.5));
/// ```
pub trait Logarithm: Real {
    /// The natural logarithm: minus infinity of zero, NaN of a negative number.
    fn ln(self) -> Self;
}

impl Logarithm for f64 {
    fn ln(self) -> Self {
        f64::ln(self)
    }
}

impl Logarithm for f32 {
    fn ln(self) -> Self {
        f32::ln(self)
    }
}

/// It is not an operation that is counted.
impl Logarithm for Counted {
    fn ln(self) -> Self {
        Self(self.0.ln())
    }
}

impl<T: Logarithm> Logarithm for Dual<T> {
    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.derivative / self.value)
    }
}

impl<T: Part> Logarithm for Compensated<T> {
    fn ln(self) -> Self {
        Self::from_parts(T::in_extended(self.to_parts(), Logarithm::ln))
    }
}

/// The standard library's, lane by lane: the polynomials of registers are not as accurate.
macro_rules! lane_by_lane {
    ($($lanes:ident)+) => {
        $(
            impl Logarithm for $lanes {
                fn ln(mut self) -> Self {
                    for lane in self.as_mut_array() {
                        *lane = lane.ln();
                    }
                    self
                }
            }
        )+
    };
}

lane_by_lane!(f64x4 f64x8 f32x8 f32x16);

/// ln 2: the `f64` nearest to it, and the one nearest to the rest.
const LN_2: DoubleDouble = DoubleDouble::from_parts(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// Terms of the series.
const TERMS: u32 = 22;

impl Logarithm for DoubleDouble {
    fn ln(self) -> Self {
        let x = self.to_f64();
        let in_range = (f64::MIN_POSITIVE..f64::INFINITY).contains(&x);
        if !in_range {
            return Self::from_f64(x.ln());
        }
        // x = m 2ᵏ, by the bits of the exponent; the product with a power of two is exact, in two steps so that the power is a number
        let exponent = (x.to_bits() >> 52) as i32 - 1023;
        let halved = exponent / 2;
        let power = |exponent: i32| f64::from_bits(((1023 - exponent) as u64) << 52);
        let (mut m, mut k) = (self.scale(power(halved)).scale(power(exponent - halved)), f64::from(exponent));
        if m.to_f64() > std::f64::consts::SQRT_2 {
            (m, k) = (m.scale(0.5), k + 1.0);
        }
        let s = (m - Self::one()) / (m + Self::one());
        let square = s * s;
        let mut sum = Self::zero();
        for j in (0..TERMS).rev() {
            sum = sum.mul_add(square, Self::one() / Self::from_f64(f64::from(2 * j + 1)));
        }
        LN_2.mul_add(Self::from_f64(k), sum * s.scale(2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::array::from_fn;

    /// u².
    const SMALL: f64 = 1.0 / (1_u64 << 53) as f64 / (1_u64 << 53) as f64;

    /// ln 2 = Σ 1/(j 2ʲ), in double-double, the small terms first.
    #[test]
    fn the_constant_is_its_series() {
        let sum = (1..=115)
            .rev()
            .fold(DoubleDouble::zero(), |sum, j| sum + DoubleDouble::from_f64(0.5_f64.powi(j)) / DoubleDouble::from_f64(f64::from(j)));
        let off = (sum - LN_2).to_f64().abs();
        // 115 sums of 3u² at most, each below ln 2
        assert!(off <= 32.0 * SMALL, "{:e}", off / SMALL);
    }

    /// e^y by its series at y/2¹⁰, squared ten times: another route than the logarithm's.
    fn exponential(y: DoubleDouble) -> DoubleDouble {
        let small = y * DoubleDouble::from_f64(1.0 / 1024.0);
        let mut sum = DoubleDouble::one();
        for j in (1..=24).rev() {
            sum = sum * small / DoubleDouble::from_f64(f64::from(j)) + DoubleDouble::one();
        }
        (0..10).fold(sum, |power, _| power * power)
    }

    #[test]
    fn the_exponential_undoes_it() {
        let mut worst = 0.0_f64;
        for k in 0..2000 {
            let x = DoubleDouble::from_f64(1.0 + f64::from(k) / 700.0) * DoubleDouble::from_f64(2.0_f64.powi(k % 41 - 20))
                / DoubleDouble::from_f64(3.0);
            let back = exponential(x.ln());
            let off = ((back - x) / x).to_f64().abs();
            worst = if off > worst || off.is_nan() { off } else { worst };
        }
        // An error of 60u² of ln x, |ln x| < 15, and those of ten squarings: 2¹⁰·5u².
        assert!(worst <= 6100.0 * SMALL, "{:e} u²", worst / SMALL);
    }

    /// ln(1 + x) = x − x²/2 + …: no digits are lost next to 1.
    #[test]
    fn next_to_one_no_digits_are_lost() {
        for x in [1e-5, -1e-7, 3e-9] {
            let x = DoubleDouble::from_f64(x);
            let terms = (1..=8).rev().fold(DoubleDouble::zero(), |sum, j| {
                let term = DoubleDouble::one() / DoubleDouble::from_f64(f64::from(j));
                if j % 2 == 0 { sum * x - term } else { sum * x + term }
            });
            let expected = terms * x;
            let off = (((DoubleDouble::one() + x).ln() - expected) / expected).to_f64().abs();
            // 1 + x is rounded at 3u², which is 3u²/x of its logarithm.
            let tolerance = (40.0 + 3.0 / x.to_f64().abs()) * SMALL;
            assert!(off <= tolerance, "{off:e} {tolerance:e}");
        }
        assert_eq!(DoubleDouble::one().ln(), DoubleDouble::zero());
    }

    #[test]
    fn what_has_no_logarithm_is_as_for_doubles() {
        assert_eq!(DoubleDouble::zero().ln().to_f64(), f64::NEG_INFINITY);
        assert!(DoubleDouble::from_f64(-1.0).ln().to_f64().is_nan() && DoubleDouble::from_f64(f64::NAN).ln().to_f64().is_nan());
        for x in [1e-300, 0.3, 7.0, 1e300, f64::MAX, f64::MIN_POSITIVE] {
            let off = (DoubleDouble::from_f64(x).ln().to_f64() - x.ln()).abs();
            assert!(off <= f64::EPSILON * x.ln().abs(), "{x}: {off:e}");
        }
    }

    #[test]
    fn every_scalar_gives_the_logarithm_of_its_value() {
        let numbers: [f64; 8] = from_fn(|k| 0.37 * (1.0 + k as f64));
        assert_eq!(Logarithm::ln(f64x8::new(numbers)).to_array(), numbers.map(f64::ln));
        let single = numbers.map(|x| x as f32);
        assert_eq!(Logarithm::ln(f32x8::new(single)).to_array(), single.map(f32::ln));
        assert_eq!((2.5_f32.ln(), Counted(2.5).ln().0), (Logarithm::ln(2.5_f32), 2.5_f64.ln()));
        let compensated = Compensated::<f64>::from_f64(2.5).ln().to_double_double();
        assert!((compensated - DoubleDouble::from_f64(2.5).ln()).to_f64().abs() <= 8.0 * SMALL);
        let second = Dual::new(Dual::new(2.0, 1.0), Dual::constant(1.0)).ln();
        assert_eq!(second.derivative.derivative, -0.25, "d²ln/dx² = −1/x²");
    }
}
