//! The parts of extended numbers: numbers, and registers of them.
//!
//! What has a table or a branch is written here for each kind of part: sine and cosine, square root and reciprocal. The arithmetic of
//! [`Compensated`] and [`DoubleDouble`] is one text for all.
//!
//! Registers of `f64` compute their sines and cosines together, by the operations of the text for one number. So each lane gets what a number
//! alone gets, to the bit. If the angle of some lane has a rare kind of reduction, all lanes are computed one by one.
//! Two parts in single precision are one number in double precision. So `f32` needs no table: its 48 bits come from `f64`.

use super::double_double::DoubleDouble;
use super::trigonometry::{FRAC_2_PI, MODERATE, NOT_TINY, SIN_COS_OF_64THS, near_tabulated, subtract_quarter_turns};
use super::{Compensated, Lift, Real};
use std::array::from_fn;
use wide::{f32x8, f32x16, f64x4, f64x8};

/// A number or a register of numbers, of which a [`Compensated`] has two. In what follows two parts are a number that is rounded to the first
/// part, and the rest; of registers, lane by lane.
pub trait Part: Real {
    /// 2ᵏ + 1, where a number has 2k or 2k − 1 binary digits.
    const SPLITTER: f64;

    /// The two parts of a number, which is rounded to so many digits.
    fn split(number: DoubleDouble) -> [Self; 2];

    /// A function of a number in two parts.
    fn in_extended(parts: [Self; 2], function: impl Fn(DoubleDouble) -> DoubleDouble) -> [Self; 2];

    /// Sine and cosine of an angle in radians, all in two parts.
    fn sin_cos_extended(angle: [Self; 2]) -> [[Self; 2]; 2];

    /// The sum of double-doubles.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn extended_sum(a: DoubleDouble<Self>, b: DoubleDouble<Self>) -> DoubleDouble<Self> {
        a.plus(b)
    }

    /// The product of double-doubles.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn extended_product(a: DoubleDouble<Self>, b: DoubleDouble<Self>) -> DoubleDouble<Self> {
        a.times(b)
    }
}

impl Part for f64 {
    const SPLITTER: f64 = 134_217_729.0;

    #[inline(always)]
    fn split(number: DoubleDouble) -> [f64; 2] {
        [number.to_f64(), number.rest()]
    }

    #[inline(always)]
    fn in_extended([value, rest]: [f64; 2], function: impl Fn(DoubleDouble) -> DoubleDouble) -> [f64; 2] {
        Self::split(function(DoubleDouble::from_parts(value, rest)))
    }

    #[inline(always)]
    fn sin_cos_extended([value, rest]: [f64; 2]) -> [[f64; 2]; 2] {
        let (sin, cos) = DoubleDouble::from_parts(value, rest).sin_cos();
        [sin, cos].map(Self::split)
    }

    #[inline(never)]
    fn extended_sum(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
        a.plus(b)
    }

    #[inline(never)]
    fn extended_product(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
        a.times(b)
    }
}

impl Part for f32 {
    const SPLITTER: f64 = 4097.0;

    #[inline(always)]
    fn split(number: DoubleDouble) -> [f32; 2] {
        let value = number.to_f64() as f32;
        [value, ((number.to_f64() - f64::from(value)) + number.rest()) as f32]
    }

    #[inline(always)]
    fn in_extended([value, rest]: [f32; 2], function: impl Fn(DoubleDouble) -> DoubleDouble) -> [f32; 2] {
        Self::split(function(DoubleDouble::from_sum(f64::from(value), f64::from(rest))))
    }

    #[inline(always)]
    fn sin_cos_extended([value, rest]: [f32; 2]) -> [[f32; 2]; 2] {
        let (sin, cos) = (f64::from(value) + f64::from(rest)).sin_cos();
        [sin, cos].map(|number| Self::split(number.into()))
    }
}

/// What registers have in common: splitting, and functions lane by lane.
macro_rules! lane_by_lane {
    ($lanes:ident, $scalar:ident) => {
        const SPLITTER: f64 = $scalar::SPLITTER;

        #[inline(always)]
        fn split(number: DoubleDouble) -> [Self; 2] {
            $scalar::split(number).map(Self::splat)
        }

        #[inline(always)]
        fn in_extended(parts: [Self; 2], function: impl Fn(DoubleDouble) -> DoubleDouble) -> [Self; 2] {
            let [value, rest] = parts.map(Self::to_array);
            let mut results = [Self::splat(0.0); 2];
            for lane in 0..value.len() {
                let result = $scalar::in_extended([value[lane], rest[lane]], &function);
                for (register, number) in results.iter_mut().zip(result) {
                    register.as_mut_array()[lane] = number;
                }
            }
            results
        }
    };
}

/// Sine and cosine lane by lane.
macro_rules! sin_cos_by_lane {
    ($lanes:ident, $scalar:ident, $angle:expr) => {{
        let [value, rest] = $angle.map($lanes::to_array);
        let mut results = [[$lanes::splat(0.0); 2]; 2];
        for lane in 0..value.len() {
            let result = $scalar::sin_cos_extended([value[lane], rest[lane]]);
            for (register, number) in results.as_flattened_mut().iter_mut().zip(result.as_flattened()) {
                register.as_mut_array()[lane] = *number;
            }
        }
        results
    }};
}

macro_rules! registers_of_f64 {
    ($lanes:ident) => {
        impl Part for $lanes {
            lane_by_lane!($lanes, f64);

            #[inline]
            fn sin_cos_extended(angle: [Self; 2]) -> [[Self; 2]; 2] {
                #[cold]
                #[inline(never)]
                fn rarely(angle: [$lanes; 2]) -> [[$lanes; 2]; 2] {
                    sin_cos_by_lane!($lanes, f64, angle)
                }
                let (zero, one) = (Self::splat(0.0), Self::splat(1.0));

                // r = x − n·π/2 and its sign
                let turns = (angle[0] * FRAC_2_PI).round_ties_even();
                let (rest, errors) = subtract_quarter_turns(DoubleDouble::from_parts(angle[0], angle[1]), turns);
                let is_usual =
                    angle[0].abs().simd_lt(Self::splat(MODERATE)) & (turns.simd_eq(zero) | rest.abs().simd_gt(Self::splat(NOT_TINY)));
                if !is_usual.all() {
                    return rarely(angle);
                }
                let r = DoubleDouble::renormalized(rest, errors);
                let sign = r.hi().simd_lt(zero).select(-one, one);

                // sine and cosine of |r|, from those of k/64
                let r = DoubleDouble::from_parts(r.hi() * sign, r.rest() * sign);
                let k = (r.hi() * 64.0).round_ties_even();
                let tabulated = k.to_array().map(|k| SIN_COS_OF_64THS[k as usize]);
                let tabulated = from_fn(|part| Self::new(from_fn(|lane| tabulated[lane][part])));
                let (sin, cos) = near_tabulated(r, k, tabulated);
                let (sin, cos) = ([sin.hi() * sign, sin.rest() * sign], [cos.hi(), cos.rest()]);

                // n modulo 4, in quarters: 0 (sin, cos), 1 (cos, −sin), 2 (−sin, −cos), 3 (−cos, sin)
                let quadrant = turns * 0.25 - (turns * 0.25).floor();
                let [first, second, third] = [0.25, 0.5, 0.75].map(|quarters| quadrant.simd_eq(Self::splat(quarters)));
                let exchanged = first | third;
                let sign_of_sin = (second | third).select(-one, one);
                let sign_of_cos = (first | second).select(-one, one);
                [
                    from_fn(|part| exchanged.select(cos[part], sin[part]) * sign_of_sin),
                    from_fn(|part| exchanged.select(sin[part], cos[part]) * sign_of_cos),
                ]
            }
        }

        impl Lift<Compensated<$lanes>> for f64 {
            #[inline(always)]
            fn lift(self) -> Compensated<$lanes> {
                Compensated::from_f64(self)
            }
        }

        impl Lift<$lanes> for DoubleDouble {
            #[inline(always)]
            fn lift(self) -> $lanes {
                $lanes::splat(self.to_f64())
            }
        }
    };
}

macro_rules! registers_of_f32 {
    ($lanes:ident) => {
        impl Part for $lanes {
            lane_by_lane!($lanes, f32);

            #[inline]
            fn sin_cos_extended(angle: [Self; 2]) -> [[Self; 2]; 2] {
                sin_cos_by_lane!($lanes, f32, angle)
            }
        }

        impl Lift<Compensated<$lanes>> for f32 {
            #[inline(always)]
            fn lift(self) -> Compensated<$lanes> {
                Lift::<$lanes>::lift(self).lift()
            }
        }
    };
}

registers_of_f64!(f64x4);
registers_of_f64!(f64x8);
registers_of_f32!(f32x8);
registers_of_f32!(f32x16);
