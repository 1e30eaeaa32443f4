//! Registers of AVX2.
#![allow(unsafe_code, reason = "instructions that the processor may not have, after a check that it has them")]

use super::operations::{functions_with, register};
use super::turns::{Turns, mend, sin_cos, sin_cos_single};
use super::{Avx2, Instructions};
use crate::Error;
use crate::batch::kernels::{Inlined, Workspace};
use crate::batch::register::{Register, kernels_of_register, methods_of_register};
use crate::batch::{NoSuchWidth, Number, Width};
use featherbench_model::Model;
use featherbench_spatial::{Force, Lift, Real};
use std::arch::is_x86_feature_detected;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

impl Instructions for Avx2 {
    type F64 = F64x4;
    type F32 = F32x8;

    fn check(width: Width) -> Result<(), NoSuchWidth> {
        // The standard library asks the processor once, and keeps the answer.
        let is_detected = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        if is_detected { Ok(()) } else { Err(NoSuchWidth::Processor(width)) }
    }
}

functions_with!("avx2,fma,bmi1,bmi2,lzcnt,popcnt", with_instructions, run_kernel);

register! {
    /// Four doubles.
    F64x4(__m256d): f64, 4, 1, transposed by F64x4, 4;
    with_instructions, run_kernel, sin_cos;
    _mm256_set1_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd, _mm256_sqrt_pd, _mm256_fmadd_pd
}

register! {
    /// Eight singles.
    F32x8(__m256): f32, 8, 1, transposed by F32x8, 8;
    with_instructions, run_kernel, sin_cos_single;
    _mm256_set1_ps, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps, _mm256_sqrt_ps, _mm256_fmadd_ps
}

/// What is not one instruction of the same name for both precisions.
macro_rules! bitwise {
    (
        $name:ident, $scalar:ident, $to_sign:literal, $to_mask:literal; $set:ident, $and:ident, $and_not:ident, $xor:ident, $compare:ident,
        $signs:ident, $blend:ident; $set_bits:ident, $add_bits:ident, $shift_left:ident, $to_bits:ident, $from_bits:ident
    ) => {
        impl $name {
            /// This where `x` is not zero, zero where it is.
            #[inline(always)]
            fn zero_where_zero(self, x: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $and($compare::<_CMP_NEQ_UQ>(x.0, $set(0.0)), self.0) })
            }

            #[inline(always)]
            fn has_nan(self) -> bool {
                // SAFETY: as the type says.
                unsafe { $signs($compare::<_CMP_UNORD_Q>(self.0, self.0)) != 0 }
            }
        }

        impl Turns for $name {
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $and_not($set(-0.0), self.0) })
            }

            #[inline(always)]
            fn all_within(self, limit: f64) -> bool {
                // SAFETY: as the type says.
                unsafe { $signs($compare::<_CMP_NLE_UQ>(self.abs().0, $set(limit as $scalar))) == 0 }
            }

            #[inline(always)]
            fn turn(self, count: Self, sin: Self, cos: Self) -> (Self, Self) {
                // SAFETY: as the type says.
                unsafe {
                    let count = $to_bits(count.0);
                    // an odd count exchanges the two
                    let exchanged = $from_bits($shift_left::<$to_mask>(count));
                    let (sin, cos) = ($blend(sin.0, cos.0, exchanged), $blend(cos.0, sin.0, exchanged));
                    // the second bit of the count is the sign of the sine, that of the next one the sign of the cosine
                    let sign = $set(-0.0);
                    let sign_of_sin = $and($xor($from_bits($shift_left::<$to_sign>(count)), self.0), sign);
                    let sign_of_cos = $and($from_bits($shift_left::<$to_sign>($add_bits(count, $set_bits(1)))), sign);
                    (Self($xor(sin, sign_of_sin)), Self($xor(cos, sign_of_cos)))
                }
            }

            mend!($scalar);
        }
    };
}

bitwise!(
    F64x4, f64, 62, 63; _mm256_set1_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_xor_pd, _mm256_cmp_pd,
    _mm256_movemask_pd, _mm256_blendv_pd; _mm256_set1_epi64x, _mm256_add_epi64, _mm256_slli_epi64, _mm256_castpd_si256, _mm256_castsi256_pd
);
bitwise!(
    F32x8, f32, 30, 31; _mm256_set1_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_xor_ps, _mm256_cmp_ps,
    _mm256_movemask_ps, _mm256_blendv_ps; _mm256_set1_epi32, _mm256_add_epi32, _mm256_slli_epi32, _mm256_castps_si256, _mm256_castsi256_ps
);

impl F64x4 {
    /// The columns of a square of rows.
    #[inline(always)]
    pub(super) fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        // SAFETY: as the type says.
        unsafe {
            // columns 0 and 2, and columns 1 and 3, of two rows each
            let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
            let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
            [
                Self(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                Self(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                Self(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                Self(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
            ]
        }
    }
}

impl F32x8 {
    /// The columns of a square of rows.
    #[inline(always)]
    pub(super) fn transpose([a, b, c, d, e, f, g, h]: [Self; 8]) -> [Self; 8] {
        // SAFETY: as the type says.
        unsafe {
            let (upper, lower) = (Self::columns_of_four(a, b, c, d), Self::columns_of_four(e, f, g, h));
            [
                Self(_mm256_permute2f128_ps::<0x20>(upper[0], lower[0])),
                Self(_mm256_permute2f128_ps::<0x20>(upper[1], lower[1])),
                Self(_mm256_permute2f128_ps::<0x20>(upper[2], lower[2])),
                Self(_mm256_permute2f128_ps::<0x20>(upper[3], lower[3])),
                Self(_mm256_permute2f128_ps::<0x31>(upper[0], lower[0])),
                Self(_mm256_permute2f128_ps::<0x31>(upper[1], lower[1])),
                Self(_mm256_permute2f128_ps::<0x31>(upper[2], lower[2])),
                Self(_mm256_permute2f128_ps::<0x31>(upper[3], lower[3])),
            ]
        }
    }

    /// Columns k and k + 4 of four rows, for k from 0 to 3.
    #[inline(always)]
    fn columns_of_four(a: Self, b: Self, c: Self, d: Self) -> [__m256; 4] {
        // SAFETY: as the type says.
        unsafe {
            let (ab_low, ab_high) = (_mm256_unpacklo_ps(a.0, b.0), _mm256_unpackhi_ps(a.0, b.0));
            let (cd_low, cd_high) = (_mm256_unpacklo_ps(c.0, d.0), _mm256_unpackhi_ps(c.0, d.0));
            [
                _mm256_shuffle_ps::<0x44>(ab_low, cd_low),
                _mm256_shuffle_ps::<0xee>(ab_low, cd_low),
                _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
                _mm256_shuffle_ps::<0xee>(ab_high, cd_high),
            ]
        }
    }
}
