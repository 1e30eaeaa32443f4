//! Registers of several numbers as scalars: each lane computes as if it were alone.
//!
//! The lanes hold states of one robot, or joints of one state. The types are those of the crate `wide`: with AVX-512 an `f64x8` is one
//! register, with AVX2 it is two.
//!
//! Sine and cosine are those of `wide`, a few units in the last place at most, while every lane is below a limit. If a lane is larger or
//! not finite, each lane is computed by the standard library: there the reduction of `wide` would lose digits.

use super::{Lift, Real};
use wide::{f32x8, f32x16, f64x4, f64x8};

/// The largest angle that `wide` reduces to a unit in the last place.
const LARGEST: [f64; 2] = [1e5, 1e3];

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
                if self.abs().simd_le(Self::splat($largest as $scalar)).all() {
                    $lanes::sin_cos(self)
                } else {
                    let (mut sin, mut cos) = (self.to_array(), self.to_array());
                    for (sin, cos) in sin.iter_mut().zip(&mut cos) {
                        (*sin, *cos) = sin.sin_cos();
                    }
                    (Self::new(sin), Self::new(cos))
                }
            }

            #[inline(always)]
            fn min_lane(self) -> f64 {
                let smaller = |least: f64, lane: $scalar| if f64::from(lane) < least || lane.is_nan() { f64::from(lane) } else { least };
                self.to_array().into_iter().fold(f64::INFINITY, smaller)
            }
        }

        impl Lift<$lanes> for f64 {
            #[inline(always)]
            fn lift(self) -> $lanes {
                $lanes::from_f64(self)
            }
        }
    };
}

real_for_lanes!(f64x4, f64, LARGEST[0]);
real_for_lanes!(f64x8, f64, LARGEST[0]);
real_for_lanes!(f32x8, f32, LARGEST[1]);
real_for_lanes!(f32x16, f32, LARGEST[1]);
