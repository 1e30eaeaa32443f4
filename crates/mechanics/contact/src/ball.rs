//! Balls: numbers with a bound of their error. A proof rests on them.
//!
//! A ball is every real number within `radius` of `middle`. The operations contain each result of what their operands contain: the radius
//! takes what it carries over, and the bounds of double-double arithmetic (`featherbench_spatial::DoubleDouble`), each rounded up. Where an
//! operation is exact, it adds nothing, so that a zero can be proven.
//!
//! Those bounds hold where nothing underflows or overflows: a number outside 10⁻¹²⁰ … 10¹²⁰ has an infinite radius.

use featherbench_spatial::{DoubleDouble, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and a bound of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    middle: DoubleDouble,
    radius: f64,
}

/// u², with u = 2⁻⁵³.
const UNIT: f64 = 0.25 * f64::EPSILON * f64::EPSILON;
/// A radius is a sum of at most six products of `f64`, each step within u: this rounds it up.
const UP: f64 = 1.0 + 16.0 * f64::EPSILON;
/// The magnitude of a double-double may be this much less than that of its upper part.
const DOWN: f64 = 1.0 - 4.0 * f64::EPSILON;

impl Ball {
    /// A middle with what the operands carry over and what the operation rounds.
    fn new(middle: DoubleDouble, carried: f64, rounded: f64) -> Self {
        let size = middle.to_f64().abs();
        let radius = match carried + rounded {
            _ if size != 0.0 && !(1e-120..=1e120).contains(&size) => f64::INFINITY,
            0.0 => 0.0,
            // A product that underflowed is less than the smallest number.
            radius => radius.mul_add(UP, f64::MIN_POSITIVE),
        };
        Self { middle, radius }
    }

    /// A number, exactly.
    pub fn exact(value: f64) -> Self {
        Self::new(DoubleDouble::from_f64(value), 0.0, 0.0)
    }

    /// A double-double, exactly.
    pub fn at(middle: DoubleDouble) -> Self {
        Self::new(middle, 0.0, 0.0)
    }

    /// A number that is known to `radius`.
    pub fn within(value: f64, radius: f64) -> Self {
        Self::new(DoubleDouble::from_f64(value), radius, 0.0)
    }

    /// The product of two numbers, exactly.
    pub fn product(a: f64, b: f64) -> Self {
        Self::exact(a) * Self::exact(b)
    }

    pub fn middle(self) -> DoubleDouble {
        self.middle
    }

    pub fn to_f64(self) -> f64 {
        self.middle.to_f64()
    }

    /// |x|, which is as far from |middle| as x from the middle at most.
    pub fn abs(self) -> Self {
        Self { middle: self.middle.abs(), ..self }
    }

    /// Whether every number of the ball is zero.
    pub fn is_zero(self) -> bool {
        self.to_f64() == 0.0 && self.radius == 0.0
    }

    /// Whether no number of the ball is zero. A NaN is no such ball.
    pub fn is_nonzero(self) -> bool {
        self.to_f64().abs() * DOWN > self.radius
    }

    /// Whether every number of the ball is above zero.
    pub fn is_positive(self) -> bool {
        self.to_f64() > 0.0 && self.is_nonzero()
    }

    /// Whether every number of the ball is below zero.
    pub fn is_negative(self) -> bool {
        (-self).is_positive()
    }

    /// Whether this is an `f64`.
    fn is_short(self) -> bool {
        self.middle.rest() == 0.0
    }
}

impl Neg for Ball {
    type Output = Self;
    fn neg(self) -> Self {
        Self { middle: -self.middle, ..self }
    }
}

impl Add for Ball {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let middle = self.middle + other.middle;
        // Sums of two `f64` are exact; a sum that is zero is, since its error is relative.
        let exact = self.is_short() && other.is_short() || self.to_f64() == 0.0 || other.to_f64() == 0.0;
        let rounded = if exact { 0.0 } else { 4.0 * UNIT * middle.to_f64().abs() };
        Self::new(middle, self.radius + other.radius, rounded)
    }
}

impl Sub for Ball {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::exact(0.0);
        }
        let middle = self.middle * other.middle;
        let (a, b) = (self.to_f64().abs(), other.to_f64().abs());
        let rounded = if self.is_short() && other.is_short() { 0.0 } else { 6.0 * UNIT * middle.to_f64().abs() };
        Self::new(middle, a * other.radius + b * self.radius + self.radius * other.radius, rounded)
    }
}

impl Div for Ball {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if self.is_zero() && other.is_nonzero() {
            return Self::exact(0.0);
        }
        let middle = self.middle / other.middle;
        let quotient = middle.to_f64().abs();
        // |a/b − a'/b'| ≤ (r_a + |a/b| r_b) / (|b| − r_b).
        let least = other.to_f64().abs() * DOWN - other.radius;
        let carried = if least > 0.0 { (self.radius + quotient * other.radius) / least } else { f64::INFINITY };
        let back = DoubleDouble::from_product(middle.to_f64(), other.to_f64());
        let exact = other.is_short() && middle.rest() == 0.0 && back == self.middle;
        Self::new(middle, carried, if exact { 0.0 } else { 16.0 * UNIT * quotient })
    }
}
