//! The operations of a scalar, and dual numbers over any scalar.
//!
//! Computes: with x + ẋε and ε² = 0, a function's value and its derivative along ẋ. Nested duals give mixed second and third derivatives,
//! without any differences. Source: Griewank & Walther, *Evaluating Derivatives* (2008), chapter 3 (forward mode).
//! Cost: each level doubles the cost of a sum and triples that of a product.

use crate::Mp;

/// The operations that positions and energies need.
pub(crate) trait Scalar: Clone {
    /// A constant.
    fn constant(value: &Mp) -> Self;
    /// Zero.
    fn zero() -> Self {
        Self::constant(&Mp::zero())
    }
    /// The sum.
    fn plus(&self, other: &Self) -> Self;
    /// The difference.
    fn minus(&self, other: &Self) -> Self;
    /// The product.
    fn times(&self, other: &Self) -> Self;
    /// The opposite.
    fn negated(&self) -> Self;
    /// Half of it.
    fn half(&self) -> Self;
    /// Sine and cosine.
    fn sin_cos(&self) -> (Self, Self);
}

impl Scalar for Mp {
    fn constant(value: &Mp) -> Self {
        value.clone()
    }
    fn plus(&self, other: &Self) -> Self {
        self + other
    }
    fn minus(&self, other: &Self) -> Self {
        self - other
    }
    fn times(&self, other: &Self) -> Self {
        // This saves time: half of the entries of Jacobians are exactly zero.
        if self.is_zero() || other.is_zero() { Self::zero() } else { self * other }
    }
    fn negated(&self) -> Self {
        -self
    }
    fn half(&self) -> Self {
        Self::half(self)
    }
    fn sin_cos(&self) -> (Self, Self) {
        Self::sin_cos(self)
    }
}

/// x + ẋε.
#[derive(Clone, Debug)]
pub(crate) struct Dual<T> {
    /// The value.
    pub value: T,
    /// Its derivative.
    pub rate: T,
}

impl<T: Scalar> Scalar for Dual<T> {
    fn constant(value: &Mp) -> Self {
        Self { value: T::constant(value), rate: T::zero() }
    }
    fn plus(&self, other: &Self) -> Self {
        Self { value: self.value.plus(&other.value), rate: self.rate.plus(&other.rate) }
    }
    fn minus(&self, other: &Self) -> Self {
        Self { value: self.value.minus(&other.value), rate: self.rate.minus(&other.rate) }
    }
    fn times(&self, other: &Self) -> Self {
        let rate = self.value.times(&other.rate).plus(&self.rate.times(&other.value));
        Self { value: self.value.times(&other.value), rate }
    }
    fn negated(&self) -> Self {
        Self { value: self.value.negated(), rate: self.rate.negated() }
    }
    fn half(&self) -> Self {
        Self { value: self.value.half(), rate: self.rate.half() }
    }
    fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        let (sin_rate, cos_rate) = (cos.times(&self.rate), sin.times(&self.rate).negated());
        (Self { value: sin, rate: sin_rate }, Self { value: cos, rate: cos_rate })
    }
}
