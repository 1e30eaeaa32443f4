//! Registers of AVX-512.
#![allow(unsafe_code, reason = "instructions that the processor may not have, after a check that it has them")]

// Squares are transposed in registers of AVX2, which are those of the build if it has them.
#[cfg(not(all(target_feature = "avx2", target_feature = "fma")))]
use super::avx2::{F32x8 as Eight, F64x4 as Four};
use super::operations::{functions_with, register};
use super::turns::{Turns, mend, sin_cos, sin_cos_single};
use super::{Avx512, Instructions};
use crate::Error;
use crate::batch::kernels::{Inlined, Workspace};
use crate::batch::register::{Register, kernels_of_register, methods_of_register};
use crate::batch::{NoSuchWidth, Number, Width};
use featherbench_model::Model;
use featherbench_spatial::{Force, Lift, Real};
use std::arch::is_x86_feature_detected;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};
#[cfg(all(target_feature = "avx2", target_feature = "fma"))]
use wide::{f32x8 as Eight, f64x4 as Four};

impl Instructions for Avx512 {
    type F64 = F64x8;
    type F32 = F32x16;

    fn check(width: Width) -> Result<(), NoSuchWidth> {
        // The standard library asks the processor once, and keeps the answer.
        let is_detected = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        if is_detected { Ok(()) } else { Err(NoSuchWidth::Processor(width)) }
    }
}

functions_with!("avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl", with_instructions, run_kernel);

register! {
    /// Eight doubles.
    F64x8(__m512d): f64, 8, 2, transposed by Four, 4;
    with_instructions, run_kernel, sin_cos;
    _mm512_set1_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_sqrt_pd, _mm512_fmadd_pd
}

register! {
    /// Sixteen singles.
    F32x16(__m512): f32, 16, 2, transposed by Eight, 8;
    with_instructions, run_kernel, sin_cos_single;
    _mm512_set1_ps, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps, _mm512_div_ps, _mm512_sqrt_ps, _mm512_fmadd_ps
}

/// What is not one instruction of the same name for both precisions.
macro_rules! bitwise {
    (
        $name:ident, $scalar:ident, $integer:ident, $shift:literal; $set:ident, $abs:ident, $compare:ident, $keep:ident, $blend:ident;
        $set_bits:ident, $test:ident, $add_bits:ident, $shift_left:ident, $to_bits:ident, $from_bits:ident, $mask:ident
    ) => {
        impl $name {
            /// This where `x` is not zero, zero where it is.
            #[inline(always)]
            fn zero_where_zero(self, x: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $keep($compare::<_CMP_NEQ_UQ>(x.0, $set(0.0)), self.0) })
            }

            #[inline(always)]
            fn has_nan(self) -> bool {
                // SAFETY: as the type says.
                unsafe { $compare::<_CMP_UNORD_Q>(self.0, self.0) != 0 }
            }
        }

        impl Turns for $name {
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $abs(self.0) })
            }

            #[inline(always)]
            fn all_within(self, limit: f64) -> bool {
                // SAFETY: as the type says.
                unsafe { $compare::<_CMP_LE_OQ>($abs(self.0), $set(limit as $scalar)) == $mask::MAX }
            }

            #[inline(always)]
            fn turn(self, count: Self, sin: Self, cos: Self) -> (Self, Self) {
                // SAFETY: as the type says.
                unsafe {
                    let (count, one) = ($to_bits(count.0), $set_bits(1));
                    // an odd count exchanges the two
                    let exchanged = $test(count, one);
                    let (sin, cos) = ($blend(exchanged, sin.0, cos.0), $blend(exchanged, cos.0, sin.0));
                    // the second bit of the count is the sign of the sine, that of the next one the sign of the cosine
                    let sign = $set_bits($integer::MIN);
                    let sign_of_sin = _mm512_and_si512(_mm512_xor_si512($shift_left::<$shift>(count), $to_bits(self.0)), sign);
                    let sign_of_cos = _mm512_and_si512($shift_left::<$shift>($add_bits(count, one)), sign);
                    let signed = |x, sign| Self($from_bits(_mm512_xor_si512($to_bits(x), sign)));
                    (signed(sin, sign_of_sin), signed(cos, sign_of_cos))
                }
            }

            mend!($scalar);
        }
    };
}

bitwise!(
    F64x8, f64, i64, 62; _mm512_set1_pd, _mm512_abs_pd, _mm512_cmp_pd_mask, _mm512_maskz_mov_pd, _mm512_mask_blend_pd;
    _mm512_set1_epi64, _mm512_test_epi64_mask, _mm512_add_epi64, _mm512_slli_epi64, _mm512_castpd_si512, _mm512_castsi512_pd, __mmask8
);
bitwise!(
    F32x16, f32, i32, 30; _mm512_set1_ps, _mm512_abs_ps, _mm512_cmp_ps_mask, _mm512_maskz_mov_ps, _mm512_mask_blend_ps;
    _mm512_set1_epi32, _mm512_test_epi32_mask, _mm512_add_epi32, _mm512_slli_epi32, _mm512_castps_si512, _mm512_castsi512_ps, __mmask16
);
