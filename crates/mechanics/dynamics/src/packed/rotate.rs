//! Rotations of the lanes of a register, a register of two halves, and stores of some lanes.
//!
//! With AVX2 or AVX-512 each is one instruction. Written as loops over lanes, they become unaligned loads of a value that was just stored, and
//! such a load waits for the store (`docs/kernels/packed.md`).

use super::lanes::{LANES, Pack};
use wide::f64x4;

/// Lane k of the result is lane k − STRIDE of x; the lanes form a ring.
#[inline(always)]
pub(super) fn rotate_up<const STRIDE: usize>(x: Pack) -> Pack {
    match STRIDE {
        1 => ring::<{ LANES as i32 - 1 }>(x),
        2 => ring::<{ LANES as i32 - 2 }>(x),
        _ => ring::<{ LANES as i32 / 2 }>(x),
    }
}

/// Lane k of the result is lane k + STRIDE of x; the lanes form a ring.
#[inline(always)]
pub(super) fn rotate_down<const STRIDE: usize>(x: Pack) -> Pack {
    match STRIDE {
        1 => ring::<1>(x),
        2 => ring::<2>(x),
        _ => ring::<{ LANES as i32 / 2 }>(x),
    }
}

/// Lane k of the result is lane k + SHIFT of x.
#[inline(always)]
#[cfg(all(target_arch = "x86_64", target_feature = "avx512f"))]
#[expect(unsafe_code, reason = "an instruction of the processor")]
fn ring<const SHIFT: i32>(x: Pack) -> Pack {
    use core::arch::x86_64::{__m512i, _mm512_alignr_epi64};
    // SAFETY: this function is compiled only for processors with AVX-512F, which has the instruction. A `Pack` and a `__m512i` both have 64
    // bytes and no invalid values.
    unsafe {
        let x: __m512i = core::mem::transmute(x);
        core::mem::transmute(_mm512_alignr_epi64::<SHIFT>(x, x))
    }
}

/// Lane k of the result is lane k + SHIFT of x.
#[inline(always)]
#[cfg(all(target_arch = "x86_64", target_feature = "avx2", not(target_feature = "avx512f")))]
#[expect(unsafe_code, reason = "an instruction of the processor")]
fn ring<const SHIFT: i32>(x: Pack) -> Pack {
    use core::arch::x86_64::{__m256d, _mm256_permute4x64_pd};
    // SAFETY: this function is compiled only for processors with AVX2, which has the instruction. A `Pack` and a `__m256d` both have 32
    // bytes and no invalid values.
    unsafe {
        let x: __m256d = core::mem::transmute(x);
        core::mem::transmute(match SHIFT {
            1 => _mm256_permute4x64_pd::<0b00_11_10_01>(x),
            2 => _mm256_permute4x64_pd::<0b01_00_11_10>(x),
            _ => _mm256_permute4x64_pd::<0b10_01_00_11>(x),
        })
    }
}

/// Lane k of the result is lane k + SHIFT of x.
#[inline(always)]
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
fn ring<const SHIFT: i32>(x: Pack) -> Pack {
    let x = x.to_array();
    super::lanes::from_lanes(|k| x[(k + SHIFT as usize) % LANES])
}

/// The register whose halves are these.
#[inline(always)]
#[cfg(target_feature = "avx512f")]
#[expect(unsafe_code, reason = "an instruction of the processor")]
pub(super) fn joined([low, high]: [f64x4; 2]) -> Pack {
    use core::arch::x86_64::{__m256d, _mm512_castpd256_pd512, _mm512_insertf64x4};
    // SAFETY: this function is compiled only for processors with AVX-512F, which has the instruction. An `f64x4` and a `__m256d` both have 32
    // bytes, a `Pack` and a `__m512d` both have 64, and none has invalid values.
    unsafe {
        let low: __m256d = core::mem::transmute(low);
        let high: __m256d = core::mem::transmute(high);
        core::mem::transmute(_mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high))
    }
}

/// The register of one part.
#[inline(always)]
#[cfg(not(target_feature = "avx512f"))]
pub(super) fn joined([whole]: [f64x4; 1]) -> Pack {
    whole
}

/// Writes lanes `first..first + into.len()` of a register.
#[inline(always)]
#[cfg(target_feature = "avx512f")]
#[expect(unsafe_code, reason = "an instruction of the processor")]
pub(super) fn store_lanes(into: &mut [f64], x: Pack, first: usize) {
    use core::arch::x86_64::{__m512d, _mm512_mask_storeu_pd};
    let end = first + into.len();
    assert!(end <= LANES, "lanes of one register");
    let mask = ((1_u32 << end) - (1_u32 << first)) as u8;
    // SAFETY: this function is compiled only for processors with AVX-512F, which has the instruction. A `Pack` and a `__m512d` both have 64
    // bytes and no invalid values. The instruction writes the lanes of the mask alone, and these are the numbers of `into`.
    unsafe {
        let x: __m512d = core::mem::transmute(x);
        _mm512_mask_storeu_pd(into.as_mut_ptr().wrapping_sub(first), mask, x);
    }
}

/// Writes lanes `first..first + into.len()` of a register.
#[inline(always)]
#[cfg(not(target_feature = "avx512f"))]
pub(super) fn store_lanes(into: &mut [f64], x: Pack, first: usize) {
    let x = x.to_array();
    match *into {
        [ref mut a] => *a = x[first],
        [ref mut a, ref mut b] => (*a, *b) = (x[first], x[first + 1]),
        [ref mut a, ref mut b, ref mut c] => (*a, *b, *c) = (x[first], x[first + 1], x[first + 2]),
        _ => into.copy_from_slice(&x),
    }
}
