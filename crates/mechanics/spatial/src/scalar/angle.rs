//! What configuration spaces ask of a scalar beyond [`Real`]: the angle of a point, and a choice by size.

use super::{DoubleDouble, Dual, Real};
use wide::{f32x8, f32x16, f64x4, f64x8};

/// A scalar in which rotations have logarithms.
///
/// The choice between a series and a closed form depends on a size. So each is computed, and `where_below` chooses lane by lane. The text stays
/// branch-free.
///
/// ```
/// use featherbench_spatial::{Angle, Dual};
/// assert_eq!(2.0_f64.atan2(-2.0), 0.75 * std::f64::consts::PI);
/// assert_eq!(0.5_f64.where_below(1.0, 10.0, 20.0), 10.0);
/// // d atan2(y, x) = (x dy − y dx) / (x² + y²)
/// let turning = Dual::new(1.0, 2.0).atan2(Dual::constant(1.0));
/// assert_eq!(turning.derivative, 1.0);
/// ```
pub trait Angle: Real {
    /// The angle of the point (x, y) from the x axis, in (−π, π]: `self` is y. The point is not the origin.
    fn atan2(self, x: Self) -> Self;

    /// `then` where this number is less than `limit`, `otherwise` elsewhere, and where it is NaN. Lane by lane; a dual chooses by its value.
    fn where_below(self, limit: f64, then: Self, otherwise: Self) -> Self;
}

macro_rules! angle_for_float {
    ($float:ident) => {
        impl Angle for $float {
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $float::atan2(self, x)
            }

            #[inline(always)]
            fn where_below(self, limit: f64, then: Self, otherwise: Self) -> Self {
                if self < limit as $float { then } else { otherwise }
            }
        }
    };
}

angle_for_float!(f64);
angle_for_float!(f32);

macro_rules! angle_for_lanes {
    ($lanes:ident) => {
        impl Angle for $lanes {
            /// Each lane has the bits of the standard library.
            #[inline]
            fn atan2(self, x: Self) -> Self {
                let mut angles = self;
                for (angle, x) in angles.as_mut_array().iter_mut().zip(x.to_array()) {
                    *angle = angle.atan2(x);
                }
                angles
            }

            #[inline(always)]
            fn where_below(self, limit: f64, then: Self, otherwise: Self) -> Self {
                self.simd_lt(Self::from_f64(limit)).select(then, otherwise)
            }
        }
    };
}

angle_for_lanes!(f64x4);
angle_for_lanes!(f64x8);
angle_for_lanes!(f32x8);
angle_for_lanes!(f32x16);

impl<T: Angle> Angle for Dual<T> {
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let (y, square) = (self, x.value.mul_add(x.value, self.value * self.value));
        let moment = x.value.mul_add(y.derivative, -(y.value * x.derivative));
        Self::new(y.value.atan2(x.value), moment / square)
    }

    #[inline(always)]
    fn where_below(self, limit: f64, then: Self, otherwise: Self) -> Self {
        Self::new(
            self.value.where_below(limit, then.value, otherwise.value),
            self.value.where_below(limit, then.derivative, otherwise.derivative),
        )
    }
}

impl Angle for DoubleDouble {
    /// The angle α of the upper parts, and the rest: `atan((y cos α − x sin α) / (x cos α + y sin α))`. The rest is below 2⁻⁵⁰ of α, so that
    /// its cube is nothing in 32 digits.
    fn atan2(self, x: Self) -> Self {
        let near = Self::from_f64(self.to_f64().atan2(x.to_f64()));
        let (sin, cos) = near.sin_cos();
        let (across, along) = (self.mul_add(cos, -(x * sin)), x.mul_add(cos, self * sin));
        near + across / along
    }

    #[inline(always)]
    fn where_below(self, limit: f64, then: Self, otherwise: Self) -> Self {
        if self < Self::from_f64(limit) { then } else { otherwise }
    }
}
