//! A scalar that divides as the factorization over lanes does: by a product with the reciprocal.

use featherbench_spatial::{Lift, Real};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// An `f64` with `a / b = a · (1/b)`, rounded twice.
#[derive(Clone, Copy, Debug)]
pub struct ByReciprocal(pub f64);

impl Real for ByReciprocal {
    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(Real::mul_add(self.0, factor.0, addend.0))
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
        self.0
    }
}

impl Lift<ByReciprocal> for f64 {
    fn lift(self) -> ByReciprocal {
        ByReciprocal(self)
    }
}

impl Add for ByReciprocal {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for ByReciprocal {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for ByReciprocal {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for ByReciprocal {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0 * (1.0 / other.0))
    }
}

impl Neg for ByReciprocal {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for ByReciprocal {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for ByReciprocal {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for ByReciprocal {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
