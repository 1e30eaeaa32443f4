//! A scalar that is an `f64` in every respect but its type: kernels take the text for any scalar instead of the one for `f64`.

use featherbench_spatial::Real;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// An `f64` of another type.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Plain(pub f64);

macro_rules! operators {
    ($($trait:ident, $method:ident, $assign_trait:ident, $assign:ident;)*) => {
        $(
            impl $trait for Plain {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    Self(self.0.$method(other.0))
                }
            }

            impl $assign_trait for Plain {
                #[inline(always)]
                fn $assign(&mut self, other: Self) {
                    *self = self.$method(other);
                }
            }
        )*
    };
}

operators! { Add, add, AddAssign, add_assign; Sub, sub, SubAssign, sub_assign; Mul, mul, MulAssign, mul_assign; }

impl Div for Plain {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Plain {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Plain {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(Real::mul_add(self.0, factor.0, addend.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }

    #[inline(always)]
    fn reciprocal_or_zero(self) -> Self {
        Self(self.0.reciprocal_or_zero())
    }

    #[inline(always)]
    fn min_lane(self) -> f64 {
        self.0
    }
}
