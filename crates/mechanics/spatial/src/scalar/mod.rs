//! The scalar trait: the operations that a kernel may use.

mod angle;
mod compensated;
mod counted;
mod double_double;
mod dual;
mod error_free;
mod lanes;
mod logarithm;
mod part;
mod trigonometry;

pub use angle::Angle;
pub use compensated::Compensated;
pub use counted::{Counted, Operations};
pub use double_double::DoubleDouble;
pub use dual::Dual;
pub use logarithm::Logarithm;
pub use part::Part;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A scalar of the dynamics kernels: a ring with division, a fused multiply-add, square root, sine and cosine.
///
/// Nothing here compares. So kernels are branch-free in the scalar, and the same text runs on `f64`, `f32`, SIMD lanes, dual numbers and
/// extended precision. There are two exceptions. A factorization keeps its smallest pivot through `min_lane`. A body without mass has no
/// centre of mass, and `reciprocal_or_zero` gives it one.
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Whether kernels over this scalar are compiled as one text for all joint kinds. Over others each kind has a copy of its own
    /// (`docs/kernels/compilation.md`).
    const COMPACT: bool = false;

    /// The scalar nearest to `value`.
    fn from_f64(value: f64) -> Self;

    /// The scalar nearest to `exact`. An `f64` holds `rounded` of it, and a scalar that is no wider takes `rounded` as it is.
    #[inline(always)]
    fn from_exact(rounded: f64, _exact: DoubleDouble) -> Self {
        Self::from_f64(rounded)
    }

    /// `self · factor + addend`, rounded once where the hardware can.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// The non-negative square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// 1/x, and zero where x is zero; in lanes, lane by lane.
    fn reciprocal_or_zero(self) -> Self;

    /// The smallest real value that this scalar holds (itself, or its smallest lane); NaN if any lane is NaN.
    fn min_lane(self) -> f64;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::from_f64(1.0)
    }
}

/// A parameter that can be used in a computation over `T`.
///
/// Kernels have a state scalar `T` and parameters `P: Lift<T>`. Lanes of states keep `f64` parameters. Every scalar lifts to itself, so
/// duals or lanes of parameters need no other code.
pub trait Lift<T>: Copy {
    /// The parameter as a `T`.
    fn lift(self) -> T;
}

impl<T: Real> Lift<T> for T {
    #[inline(always)]
    fn lift(self) -> T {
        self
    }
}

impl Lift<f32> for f64 {
    #[inline(always)]
    fn lift(self) -> f32 {
        self as f32
    }
}

macro_rules! real_for_float {
    ($float:ident) => {
        impl Real for $float {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                if cfg!(target_feature = "fma") { $float::mul_add(self, factor, addend) } else { self * factor + addend }
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $float::sin_cos(self)
            }

            #[inline(always)]
            fn reciprocal_or_zero(self) -> Self {
                if self == 0.0 { 0.0 } else { 1.0 / self }
            }

            #[inline(always)]
            fn min_lane(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

real_for_float!(f64);
real_for_float!(f32);
