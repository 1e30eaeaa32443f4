//! A scalar whose multiply-add is rounded once also in a build without the instruction: the arithmetic of registers that have it.

use featherbench_spatial::{Lift, Real};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// An `f64` or `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Fused<S>(pub S);

macro_rules! real {
    ($scalar:ident) => {
        impl Real for Fused<$scalar> {
            fn from_f64(value: f64) -> Self {
                Self(value as $scalar)
            }

            /// By the standard library, exactly rounded: a call where there is no instruction.
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                Self($scalar::mul_add(self.0, factor.0, addend.0))
            }

            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }

            fn sin_cos(self) -> (Self, Self) {
                let (sin, cos) = self.0.sin_cos();
                (Self(sin), Self(cos))
            }

            fn reciprocal_or_zero(self) -> Self {
                Self(self.0.reciprocal_or_zero())
            }

            fn min_lane(self) -> f64 {
                f64::from(self.0)
            }
        }

        impl Lift<Fused<$scalar>> for $scalar {
            fn lift(self) -> Fused<$scalar> {
                Fused(self)
            }
        }
    };
}

real!(f64);
real!(f32);

impl<S: Real> Add for Fused<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl<S: Real> Sub for Fused<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl<S: Real> Mul for Fused<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl<S: Real> Div for Fused<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl<S: Real> Neg for Fused<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Real> AddAssign for Fused<S> {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl<S: Real> SubAssign for Fused<S> {
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}

impl<S: Real> MulAssign for Fused<S> {
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}
