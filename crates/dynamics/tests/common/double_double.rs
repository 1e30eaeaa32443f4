//! A double-double scalar, about 32 digits: the truth that `f64` kernels are measured against.
//!
//! Sources: Dekker (1971), Knuth's two-sum, and products by fused multiply-add; sine and cosine by Taylor series after halving.

use spatial::{Lift, Real};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// An unevaluated sum `hi + lo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    pub hi: f64,
    pub lo: f64,
}

fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let b_part = hi - a;
    DoubleDouble { hi, lo: (a - (hi - b_part)) + (b - b_part) }
}

fn quick_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble { hi, lo: b - (hi - a) }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let sum = quick_two_sum(high.hi, high.lo + low.hi);
        quick_two_sum(sum.hi, sum.lo + low.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.hi * other.hi;
        let error = f64::mul_add(self.hi, other.hi, -product);
        quick_two_sum(product, error + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let rest = self - other * Self { hi: first, lo: 0.0 };
        let second = rest.hi / other.hi;
        let rest = rest - other * Self { hi: second, lo: 0.0 };
        quick_two_sum(first, second) + Self { hi: rest.hi / other.hi, lo: 0.0 }
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for DoubleDouble {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for DoubleDouble {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Real for DoubleDouble {
    fn from_f64(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    fn sqrt(self) -> Self {
        let root = Self::from_f64(self.hi.sqrt());
        root + (self - root * root) / (root + root)
    }

    fn sin_cos(self) -> (Self, Self) {
        // x / 2⁶ is small; sin x and 1 − cos x by Taylor, then six doublings: s' = 2 s c, (1−c)' = 2 s²
        const HALVINGS: i32 = 6;
        let x = self * Self::from_f64(0.5_f64.powi(HALVINGS));
        let (mut sin, mut versine, mut term) = (Self::zero(), Self::zero(), x);
        let mut k = 1.0;
        while k < 40.0 {
            // term is ±xᵏ/k!, next ±xᵏ⁺¹/(k+1)!
            sin += term;
            let next = term * x / Self::from_f64(k + 1.0);
            versine += next;
            term = -(next * x / Self::from_f64(k + 2.0));
            k += 2.0;
        }
        for _ in 0..HALVINGS {
            let cos = Self::one() - versine;
            let two = Self::from_f64(2.0);
            (sin, versine) = (two * sin * cos, two * sin * sin);
        }
        (sin, Self::one() - versine)
    }

    fn min_lane(self) -> f64 {
        self.hi
    }
}

impl Lift<DoubleDouble> for f64 {
    fn lift(self) -> DoubleDouble {
        DoubleDouble::from_f64(self)
    }
}
