//! A number with the sum of its rounding errors. In `f64` it is as accurate as double-double at half the cost, where no divisor has
//! cancelled.
//!
//! Source: the pair arithmetic of M. Lange and S. M. Rump, *Faithfully rounded floating-point computations* (ACM TOMS 46, 2020). It makes a
//! number type of the compensated dot product of Ogita, Rump and Oishi (2005).
//! The upper part is what plain arithmetic would compute. The lower part sums the errors to first order, and is never carried over.
//!
//! The error of an expression of sums and products is at most about n²u² times the same expression of magnitudes.
//! Here u = 2⁻⁵³ for `f64` and 2⁻²⁴ for `f32`, and n is the number of operations on the longest path.
//! So cancellation costs digits as in a double-double of 106 − 2·log₂ n bits. Sine, cosine, quotients and roots renormalize their operands.
//!
//! The parts may be registers ([`Part`]). Then each lane computes as if it were alone, to the bit.

use super::error_free::{two_product, two_sum};
use super::{DoubleDouble, Lift, Part, Real};
use crate::operators::operators;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// The sum `value + error`, where `error` is usually, but not always, the smaller.
///
/// Two pairs can be the same number with different parts. So they cannot be compared; [`Compensated::to_double_double`] can.
///
/// ```
/// use featherbench_spatial::{Compensated, Lift, Real};
/// let [large, small] = [1e20, 1.0].map(Compensated::<f64>::from_f64);
/// let difference: f64 = (large * large + small - large * large).lift();
/// assert_eq!(difference, 0.0, "32 digits are not 40");
/// let difference: f64 = (large + small - large).lift();
/// assert_eq!(difference, 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Compensated<T = f64> {
    value: T,
    error: T,
}

impl Compensated {
    /// The same number with parts that do not overlap.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_double_double(self) -> DoubleDouble {
        DoubleDouble::from_sum(self.value, self.error)
    }
}

impl<T: Part> Compensated<T> {
    /// The part nearest to this number, and the rest: at most half a unit in the last place of that.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_parts(self) -> [T; 2] {
        let (value, error) = two_sum(self.value, self.error);
        [value, error]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn from_parts([value, error]: [T; 2]) -> Self {
        Self { value, error }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn renormalized(self) -> Self {
        Self::from_parts(self.to_parts())
    }
}

impl From<DoubleDouble> for Compensated {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from(number: DoubleDouble) -> Self {
        Self { value: number.to_f64(), error: number.rest() }
    }
}

impl<T: Part> Real for Compensated<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_f64(value: f64) -> Self {
        Self { value: T::from_f64(value), error: T::zero() }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_exact(_rounded: f64, exact: DoubleDouble) -> Self {
        exact.lift()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let (product, product_error) = two_product(self.value, factor.value);
        let (value, sum_error) = two_sum(product, addend.value);
        let errors = (product_error + sum_error) + addend.error;
        Self { value, error: T::mul_add(self.error, factor.value, T::mul_add(self.value, factor.error, errors)) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        Self::from_parts(T::in_extended(self.to_parts(), DoubleDouble::sqrt))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos(self) -> (Self, Self) {
        let [sin, cos] = T::sin_cos_extended(self.to_parts());
        (Self::from_parts(sin), Self::from_parts(cos))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reciprocal_or_zero(self) -> Self {
        Self::from_parts(T::in_extended(self.to_parts(), DoubleDouble::reciprocal_or_zero))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn min_lane(self) -> f64 {
        (self.value + self.error).min_lane()
    }
}

impl<T: Part> Lift<Compensated<T>> for T {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> Compensated<T> {
        Compensated { value: self, error: T::zero() }
    }
}

impl<T: Part> Lift<Compensated<T>> for DoubleDouble {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> Compensated<T> {
        Compensated::from_parts(T::split(self))
    }
}

/// Rounds.
impl<T: Part> Lift<T> for Compensated<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> T {
        self.value + self.error
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Part> Compensated<T>;
    Add: add(self, other: Self) -> Self {
        let (value, error) = two_sum(self.value, other.value);
        Self { value, error: error + (self.error + other.error) }
    }
    Sub: sub(self, other: Self) -> Self { self + -other }
    Mul: mul(self, other: Self) -> Self {
        let (value, error) = two_product(self.value, other.value);
        Self { value, error: T::mul_add(self.error, other.value, T::mul_add(self.value, other.error, error)) }
    }
    Div: div(self, other: Self) -> Self {
        let other = other.renormalized();
        let value = self.value / other.value;
        let (product, error) = two_product(value, other.value);
        // the remainder of the dividend; the first difference is exact
        let rest = ((self.value - product) - error) + T::mul_add(-value, other.error, self.error);
        Self { value, error: rest / other.value }
    }
    Neg: neg(self) -> Self { Self { value: -self.value, error: -self.error } }
    ; AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *
}
