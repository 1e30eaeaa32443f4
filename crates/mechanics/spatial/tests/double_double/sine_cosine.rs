//! Double-double sine and cosine against multi-precision ones: the relative error at every angle, in units of u² = 2⁻¹⁰⁶.

use super::multi_precision::{Big, double_double, error_in_u2, exact, is_normalized, parse};
use crate::share::one_of;
use featherbench_spatial::{DoubleDouble, Real};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// The proven bound is 28u². Roundings rarely add up: the worst of 20000 angles of every magnitude is 2.9u², and this is twice that.
const BOUND: f64 = 6.0;

/// The larger relative error of the two, in u².
fn worst(x: DoubleDouble) -> f64 {
    // Half a thousand bits hold the angle exactly, and are more than its sine needs.
    let ((sin, cos), (true_sin, true_cos)) = (x.sin_cos(), exact(x).with_precision(512).value().sin_cos());
    assert!(is_normalized(sin) && is_normalized(cos), "{x:?}");
    error_in_u2(sin, &true_sin, &true_sin).max(error_in_u2(cos, &true_cos, &true_cos))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// All magnitudes for which parts are normal numbers.
    #[test]
    fn at_every_magnitude(x in double_double(900)) {
        prop_assert!(worst(x) <= BOUND);
    }

    /// The angles of robots.
    #[test]
    fn within_a_few_turns(hi in -20.0..20.0_f64, lo in -1.1e-16..1.1e-16_f64) {
        prop_assert!(worst(DoubleDouble::from_sum(hi, hi * lo)) <= BOUND);
    }

    /// Up to where the reduction changes its method, and beyond.
    #[test]
    fn over_many_turns(hi in -4e9..4e9_f64, lo in -1.1e-16..1.1e-16_f64) {
        prop_assert!(worst(DoubleDouble::from_sum(hi, hi * lo)) <= BOUND);
    }

    /// Next to zeros of sine and cosine the error stays relative, as near as a double-double can come to one.
    #[test]
    fn next_to_zeros(quarters in prop_oneof![1..40_u64, 1..1_u64 << 34, 1..1_u64 << 60], digits in 5..120_i32, change in -1.0..1.0_f64) {
        let half_pi = parse("1.5707963267948966192313216916397514420985846996875529104874722961539082031431044993140174126710585339910740432566411533");
        let zero = half_pi * Big::from(quarters);
        let near = round(&(zero + exact(DoubleDouble::from_f64(change * 2.0_f64.powi(-digits)))));
        prop_assert!(worst(near) <= BOUND);
    }
}

/// A double-double next to a multi-precision number.
fn round(x: &Big) -> DoubleDouble {
    let hi = x.to_f64().value();
    DoubleDouble::from_sum(hi, (x - exact(DoubleDouble::from_f64(hi))).to_f64().value())
}

/// Digits of another library, at angles chosen to be hard.
#[test]
fn golden_values_of_mpmath() {
    let golden = include_str!("sin_cos.txt");
    let mut lines = 0;
    for line in golden.lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let part = |k: usize| f64::from_bits(u64::from_str_radix(fields[k], 16).expect("hexadecimal bits"));
        let (sin, cos) = DoubleDouble::from_sum(part(0), part(1)).sin_cos();
        for (value, digits) in [(sin, fields[2]), (cos, fields[3])] {
            let truth = parse(digits);
            // Below 1e-308 numbers lose precision. The lower part of a sine of 1e-300, and products on the way to it, would be there.
            let bound = if value.abs().to_f64() < 1e-290 { 2.0_f64.powi(106 - 52) } else { BOUND };
            let error = error_in_u2(value, &truth, &truth);
            assert!(error <= bound, "{line}: {error} u²");
        }
        lines += 1;
    }
    assert_eq!(lines, 168, "the whole file was read");
}

/// Against the multi-precision library itself, at every table entry and at its edges.
#[test]
fn at_every_table_entry() {
    let mut most = 0.0_f64;
    for k in -128..=128 {
        for offset in [-0.5, -0.49999, -1e-20, 0.0, 1e-9, 0.3, 0.5] {
            let x = DoubleDouble::from_sum(f64::from(k) / 64.0, offset / 64.0);
            let error = worst(x);
            assert!(error.is_finite());
            most = if error > most { error } else { most };
        }
    }
    assert!(most <= BOUND, "{most} u²");
}

#[test]
fn zero_and_not_a_number() {
    let (zero, one) = (DoubleDouble::zero(), DoubleDouble::one());
    assert_eq!(zero.sin_cos(), (zero, one));
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (sin, cos) = DoubleDouble::from_f64(x).sin_cos();
        assert!(sin.min_lane().is_nan() && cos.min_lane().is_nan());
    }
}
