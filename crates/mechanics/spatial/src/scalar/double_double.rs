//! Double-double numbers: about 32 digits in two `f64`.
//!
//! Sources: M. Joldes, J.-M. Muller and V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*
//! (ACM TOMS 44, 2017). For the square root: V. Lefèvre, N. Louvet, J.-M. Muller, J. Picot and L. Rideau, *Accurate calculation of
//! Euclidean norms using double-word arithmetic* (ACM TOMS 49, 2023). The relative errors, with u = 2⁻⁵³, are at most
//!
//! - sum, difference: 3u² + 13u³, also where the operands cancel;
//! - product: 5u² (4u² with fused multiply-add);
//! - quotient: 15u² + 56u³;
//! - square root: 25/8·u²;
//! - `a·b + c`: 5u²·|a·b| + 6u²·|a·b + c|;
//! - sine, cosine: 28u² (seen: 3u²), also at huge angles and next to their zeros.
//!
//! The bounds hold while nothing overflows or underflows: every nonzero operand and result is within about 2⁻⁹⁰⁰ … 2⁹⁹⁰.
//!
//! Sums, products and quotients of numbers are calls, because a kernel holds thousands of them (`docs/kernels/compilation.md`). Those of registers
//! are parts of their callers.
//!
//! An infinite result becomes NaN in the next operation at the latest, and NaN stays NaN.

use super::error_free::{fast_two_sum, two_product, two_sum};
use super::trigonometry;
use super::{Lift, Part, Real};
use crate::operators::operators;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// The sum `hi + lo` of two `f64`, of which `hi` is the one nearest to the sum. With a register in place of `f64`, each lane is such a sum.
///
/// ```
/// use featherbench_spatial::{DoubleDouble, Real};
/// let third = DoubleDouble::one() / DoubleDouble::from_f64(3.0);
/// let error = third * DoubleDouble::from_f64(3.0) - DoubleDouble::one();
/// assert!(error.to_f64().abs() < 1e-31);
/// assert_eq!(third.to_f64(), 1.0 / 3.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble<T = f64> {
    hi: T,
    lo: T,
}

impl DoubleDouble {
    /// `a + b`, exactly.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_sum(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        Self { hi, lo }
    }

    /// `a · b`, exactly.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        Self { hi, lo }
    }

    /// The `f64` nearest to this number.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_f64(self) -> f64 {
        self.hi
    }

    /// The magnitude.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn abs(self) -> Self {
        if self.hi.is_sign_negative() { -self } else { self }
    }
}

impl<T: Part> DoubleDouble<T> {
    /// The two parts as they are: `hi` must be the number nearest to `hi + lo`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) const fn from_parts(hi: T, lo: T) -> Self {
        Self { hi, lo }
    }

    /// `hi + lo`, exactly, where |hi| ≥ |lo|.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn renormalized(hi: T, lo: T) -> Self {
        let (hi, lo) = fast_two_sum(hi, lo);
        Self { hi, lo }
    }

    /// The number nearest to this one, as a part.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn hi(self) -> T {
        self.hi
    }

    /// The rest of this number after [`DoubleDouble::to_f64`]: at most half a unit in the last place of that.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rest(self) -> T {
        self.lo
    }

    /// `self · factor` for a plain factor: relative error at most 3u².
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn scale(self, factor: T) -> Self {
        let (product, error) = two_product(self.hi, factor);
        Self::renormalized(product, T::mul_add(self.lo, factor, error))
    }

    /// The product with its parts not yet renormalized: the lower one is at most 4u of the upper one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn raw_product(self, other: Self) -> (T, T) {
        let (product, error) = two_product(self.hi, other.hi);
        let cross = T::mul_add(self.lo, other.hi, T::mul_add(self.hi, other.lo, self.lo * other.lo));
        (product, error + cross)
    }

    /// `a + b`, where `a` need not be renormalized.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sum((a_hi, a_lo): (T, T), b: Self) -> Self {
        let ((high, high_error), (low, low_error)) = (two_sum(a_hi, b.hi), two_sum(a_lo, b.lo));
        // `high` is a multiple of the last place of what is added to it, also after cancellation.
        let (high, rest) = fast_two_sum(high, high_error + low);
        Self::renormalized(high, low_error + rest)
    }

    /// `self + other` as a part of its caller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::sum((self.hi, self.lo), other)
    }

    /// `self · other` as a part of its caller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn times(self, other: Self) -> Self {
        let (hi, lo) = self.raw_product(other);
        Self::renormalized(hi, lo)
    }

    /// `self · factor + addend` as a part of its caller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn times_plus(self, factor: Self, addend: Self) -> Self {
        Self::sum(self.raw_product(factor), addend)
    }
}

impl Real for DoubleDouble {
    const COMPACT: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_f64(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_exact(_rounded: f64, exact: DoubleDouble) -> Self {
        exact
    }

    #[inline(never)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self.times_plus(factor, addend)
    }

    #[inline(never)]
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 {
            return Self::from_f64(root);
        }
        // The residual hi − root² is an f64.
        let (square, error) = two_product(root, root);
        let residual = self.lo + ((self.hi - square) - error);
        Self::renormalized(root, residual / (root + root))
    }

    fn sin_cos(self) -> (Self, Self) {
        trigonometry::sin_cos(self)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reciprocal_or_zero(self) -> Self {
        if self.hi == 0.0 { Self::zero() } else { Self::one() / self }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn min_lane(self) -> f64 {
        self.hi
    }
}

impl Lift<DoubleDouble> for f64 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> DoubleDouble {
        DoubleDouble::from_f64(self)
    }
}

/// Rounds: a model that was built in double-double gives its parameters to `f64` kernels.
impl Lift<f64> for DoubleDouble {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> f64 {
        self.to_f64()
    }
}

impl From<f64> for DoubleDouble {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from(value: f64) -> Self {
        Self::from_f64(value)
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Part> DoubleDouble<T>;
    Add: add(self, other: Self) -> Self { T::extended_sum(self, other) }
    Sub: sub(self, other: Self) -> Self { self + -other }
    Mul: mul(self, other: Self) -> Self { T::extended_product(self, other) }
    Neg: neg(self) -> Self { Self { hi: -self.hi, lo: -self.lo } }
    ; AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let quotient = self.hi / other.hi;
        let product = other.scale(quotient);
        let rest = (self.hi - product.hi) + (self.lo - product.lo);
        Self::renormalized(quotient, rest / other.hi)
    }
}
