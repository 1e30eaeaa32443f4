//! Sine and cosine of registers.
//!
//! The formulas and their order are those of the crate `wide`, which takes them from A. Fog's vector class library and so from S. Moshier's
//! Cephes. So results have the same bits as at the width of the build, if that has fused multiply-add. The quarter turns are counted in another
//! way, with the same outcome: a number that is added rounds, and its last two bits are those of the count. Angles beyond a limit, infinite ones
//! and NaN get those of the standard library, as [`featherbench_spatial`]'s registers do.

use featherbench_spatial::Real;

/// What sine and cosine ask of a register beyond [`Real`].
pub(super) trait Turns: Real {
    /// The magnitude.
    fn abs(self) -> Self;

    /// Whether all magnitudes are at most `limit`; false if a lane is NaN.
    fn all_within(self, limit: f64) -> bool;

    /// Sine and cosine of x, from those of the rest of x after `count` quarter turns. `count` is a number of quarter turns that stands in the
    /// last bits.
    fn turn(self, count: Self, sin: Self, cos: Self) -> (Self, Self);

    /// Those of the standard library, in lanes whose magnitude is not at most `limit`.
    fn mend(self, limit: f64, sin_cos: (Self, Self)) -> (Self, Self);
}

/// The largest angle in double precision for which the parts of π/2 hold enough digits.
const LARGEST: f64 = 1e5;
/// The same in single precision.
const LARGEST_SINGLE: f64 = 1e3;

/// Sine and cosine in double precision.
#[inline(always)]
pub(super) fn sin_cos<T: Turns>(x: T) -> (T, T) {
    // 1.5·2⁵²: a sum with it is a whole number
    let whole = T::from_f64(6_755_399_441_055_744.0);
    let parts = [2.0 * 0.7853981554508209, 2.0 * 7.946627356147928e-09, 2.0 * 3.061616997868383e-17];
    let magnitude = x.abs();
    let count = magnitude * T::from_f64(std::f64::consts::FRAC_2_PI) + whole;
    let r = reduced(magnitude, count - whole, parts);
    let z = r * r;
    let sin = polynomial(
        z,
        [
            -0.1666666666666663,
            0.008333333333322118,
            -0.0001984126982958954,
            2.7557313621385722e-06,
            -2.5050747762857807e-08,
            1.5896230157654656e-10,
        ],
    );
    let cos = polynomial(
        z,
        [
            0.041666666666666595,
            -0.0013888888888873056,
            2.4801587288851704e-05,
            -2.755731417929674e-07,
            2.087570084197473e-09,
            -1.1358536521387682e-11,
        ],
    );
    let sin = (r * z).mul_add(sin, r);
    let cos = (z * z).mul_add(cos, (-z).mul_add(T::from_f64(0.5), T::one()));
    let turned = x.turn(count, sin, cos);
    if x.all_within(LARGEST) { turned } else { x.mend(LARGEST, turned) }
}

/// Sine and cosine in single precision.
#[inline(always)]
pub(super) fn sin_cos_single<T: Turns>(x: T) -> (T, T) {
    // 1.5·2²³
    let whole = T::from_f64(12_582_912.0);
    let parts = [2.0 * 0.785_156_25_f32, 2.0 * 2.418_756_5e-4_f32, 2.0 * 3.774_895e-8_f32].map(f64::from);
    let magnitude = x.abs();
    let count = magnitude * single::<T>(2.0 / std::f32::consts::PI) + whole;
    let r = reduced(magnitude, count - whole, parts);
    let z = r * r;
    let zz = z * z;
    let sin = zz.mul_add(single::<T>(-1.951_529_6e-4), z.mul_add(single::<T>(8.332_161e-3), single::<T>(-1.666_665_5e-1))) * (r * z) + r;
    let cos = zz.mul_add(single::<T>(2.443_315_7e-5), z.mul_add(single::<T>(-1.388_731_6e-3), single::<T>(4.166_664_6e-2))) * zz
        + (-z).mul_add(single::<T>(0.5), T::one());
    let turned = x.turn(count, sin, cos);
    if x.all_within(LARGEST_SINGLE) { turned } else { x.mend(LARGEST_SINGLE, turned) }
}

/// A constant in single precision.
#[inline(always)]
fn single<T: Real>(number: f32) -> T {
    T::from_f64(f64::from(number))
}

/// `x − turns·π/2`, π/2 in three parts.
#[inline(always)]
fn reduced<T: Real>(x: T, turns: T, parts: [f64; 3]) -> T {
    let ([high, middle, low], negative) = (parts, -turns);
    negative.mul_add(T::from_f64(low), negative.mul_add(T::from_f64(middle), negative.mul_add(T::from_f64(high), x)))
}

/// `Σ c_k xᵏ`, in the order of few dependent steps.
#[inline(always)]
fn polynomial<T: Real>(x: T, coefficients: [f64; 6]) -> T {
    let [c0, c1, c2, c3, c4, c5] = coefficients;
    let x2 = x * x;
    let x4 = x2 * x2;
    pair(x, c2, c3).mul_add(x2, pair(x, c4, c5).mul_add(x4, pair(x, c0, c1)))
}

/// `c_0 + c_1 x`
#[inline(always)]
fn pair<T: Real>(x: T, c0: f64, c1: f64) -> T {
    T::from_f64(c1).mul_add(x, T::from_f64(c0))
}

/// [`Turns::mend`].
macro_rules! mend {
    ($scalar:ident) => {
        #[cold]
        #[inline(never)]
        fn mend(self, limit: f64, (sin, cos): (Self, Self)) -> (Self, Self) {
            let (mut sin, mut cos) = (*sin.as_array(), *cos.as_array());
            for ((x, sin), cos) in self.as_array().iter().zip(&mut sin).zip(&mut cos) {
                let fits = x.abs() <= limit as $scalar;
                if !fits {
                    (*sin, *cos) = x.sin_cos();
                }
            }
            (Self::new(sin), Self::new(cos))
        }
    };
}
pub(super) use mend;
