//! Registers of several numbers as scalars: each lane computes as if it were alone.
//!
//! The lanes hold states of one robot, or joints of one state. The types are those of the crate `wide`: with AVX-512 an `f64x8` is one
//! register, with AVX2 it is two.
//!
//! Sine and cosine are those of `wide` up to a limit, 1e5 in double and 1e3 in single precision. A lane that is larger, infinite or NaN gets
//! those of the standard library; its neighbours are not changed by that. Below the limit the error is at most
//!
//! - 2 units in the last place of the result: polynomial and roundings,
//! - and |x|·2⁻¹⁰⁷ in double, |x|·2⁻⁴⁷ in single precision: `wide` subtracts the multiple of π/2 in three parts, which hold no more digits.
//!
//! The second term is far below a unit in the last place of 1. It can only be seen where a sine or cosine is almost zero.

use super::{Lift, Real};
use wide::{f32x8, f32x16, f64x4, f64x8};

macro_rules! real_for_lanes {
    ($lanes:ident, $scalar:ident, $largest:expr) => {
        impl Real for $lanes {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                Self::splat(value as $scalar)
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                $lanes::mul_add(self, factor, addend)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $lanes::sqrt(self)
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                /// Replaces the sine and cosine of each lane that is too large for `wide`, or not finite.
                #[cold]
                #[inline(never)]
                fn mend(x: $lanes, mut sin: $lanes, mut cos: $lanes) -> ($lanes, $lanes) {
                    for ((x, sin), cos) in x.to_array().into_iter().zip(sin.as_mut_array()).zip(cos.as_mut_array()) {
                        let fits = x.abs() <= $largest;
                        if !fits {
                            (*sin, *cos) = x.sin_cos();
                        }
                    }
                    (sin, cos)
                }
                let (sin, cos) = $lanes::sin_cos(self);
                if self.abs().simd_le(Self::splat($largest)).all() { (sin, cos) } else { mend(self, sin, cos) }
            }

            #[inline(always)]
            fn reciprocal_or_zero(self) -> Self {
                let (zero, one) = (Self::splat(0.0), Self::splat(1.0));
                self.simd_eq(zero).select(zero, one / self)
            }

            #[inline(always)]
            fn min_lane(self) -> f64 {
                if !self.simd_eq(self).all() {
                    return f64::NAN;
                }
                // by halves: a factorization waits for this number
                let mut lanes = self.to_array();
                let mut count = lanes.len();
                while count > 1 {
                    count /= 2;
                    for lane in 0..count {
                        let other = lanes[lane + count];
                        lanes[lane] = if other < lanes[lane] { other } else { lanes[lane] };
                    }
                }
                f64::from(lanes[0])
            }
        }

        impl Lift<$lanes> for $scalar {
            #[inline(always)]
            fn lift(self) -> $lanes {
                $lanes::splat(self)
            }
        }
    };
}

real_for_lanes!(f64x4, f64, 1e5);
real_for_lanes!(f64x8, f64, 1e5);
real_for_lanes!(f32x8, f32, 1e3);
real_for_lanes!(f32x16, f32, 1e3);

impl Lift<f32x8> for f64 {
    #[inline(always)]
    fn lift(self) -> f32x8 {
        f32x8::from_f64(self)
    }
}

impl Lift<f32x16> for f64 {
    #[inline(always)]
    fn lift(self) -> f32x16 {
        f32x16::from_f64(self)
    }
}
