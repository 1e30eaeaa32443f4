//! An `f64` with the sum of its rounding errors. It is as accurate as double-double at half the cost, where no divisor has cancelled.
//!
//! Source: the pair arithmetic of M. Lange and S. M. Rump, *Faithfully rounded floating-point computations* (ACM TOMS 46, 2020). It makes a
//! number type of the compensated dot product of Ogita, Rump and Oishi (2005).
//! The upper part is what plain `f64` would compute. The lower part sums the errors to first order, and is never carried over.
//!
//! The error of an expression of sums and products is at most about n²u² times the same expression of magnitudes.
//! Here u = 2⁻⁵³, and n is the number of operations on the longest path.
//! So cancellation costs digits as in a double-double of 106 − 2·log₂ n bits. Sine, cosine, quotients and roots renormalize their operands.

use super::error_free::{two_product, two_sum};
use super::{DoubleDouble, Lift, Real};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// The sum `value + error`, where `error` is usually, but not always, the smaller.
///
/// Two pairs can be the same number with different parts. So they cannot be compared; [`Compensated::to_double_double`] can.
///
/// ```
/// use featherbench_spatial::{Compensated, Lift, Real};
/// let [large, small] = [1e20, 1.0].map(Compensated::from_f64);
/// let difference: f64 = (large * large + small - large * large).lift();
/// assert_eq!(difference, 0.0, "32 digits are not 40");
/// let difference: f64 = (large + small - large).lift();
/// assert_eq!(difference, 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Compensated {
    value: f64,
    error: f64,
}

impl Compensated {
    /// The same number with parts that do not overlap.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_double_double(self) -> DoubleDouble {
        DoubleDouble::from_sum(self.value, self.error)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn renormalized(self) -> Self {
        let (value, error) = two_sum(self.value, self.error);
        Self { value, error }
    }
}

impl From<DoubleDouble> for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from(number: DoubleDouble) -> Self {
        Self { value: number.to_f64(), error: number.rest() }
    }
}

impl Real for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_f64(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_exact(_rounded: f64, exact: DoubleDouble) -> Self {
        exact.into()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let (product, product_error) = two_product(self.value, factor.value);
        let (value, sum_error) = two_sum(product, addend.value);
        let errors = (product_error + sum_error) + addend.error;
        Self { value, error: Real::mul_add(self.error, factor.value, Real::mul_add(self.value, factor.error, errors)) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        self.to_double_double().sqrt().into()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.to_double_double().sin_cos();
        (sin.into(), cos.into())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reciprocal_or_zero(self) -> Self {
        self.to_double_double().reciprocal_or_zero().into()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn min_lane(self) -> f64 {
        self.value + self.error
    }
}

impl Lift<Compensated> for f64 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> Compensated {
        Compensated::from_f64(self)
    }
}

impl Lift<Compensated> for DoubleDouble {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> Compensated {
        self.into()
    }
}

/// Rounds.
impl Lift<f64> for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> f64 {
        self.value + self.error
    }
}

impl Add for Compensated {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(self, other: Self) -> Self {
        let (value, error) = two_sum(self.value, other.value);
        Self { value, error: error + (self.error + other.error) }
    }
}

impl Sub for Compensated {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Compensated {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, other: Self) -> Self {
        let (value, error) = two_product(self.value, other.value);
        Self { value, error: Real::mul_add(self.error, other.value, Real::mul_add(self.value, other.error, error)) }
    }
}

impl Div for Compensated {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn div(self, other: Self) -> Self {
        let other = other.renormalized();
        let value = self.value / other.value;
        let (product, error) = two_product(value, other.value);
        // the remainder of the dividend; the first difference is exact
        let rest = ((self.value - product) - error) + Real::mul_add(-value, other.error, self.error);
        Self { value, error: rest / other.value }
    }
}

impl Neg for Compensated {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg(self) -> Self {
        Self { value: -self.value, error: -self.error }
    }
}

impl AddAssign for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
