//! Double-double arithmetic against multi-precision arithmetic: the error bounds that its documentation states, in units of u² = 2⁻¹⁰⁶.

use super::multi_precision::{double_double, error_in_u2, exact, is_normalized, magnitude, nearly_opposite};
use crate::share::one_of;
use featherbench_spatial::{DoubleDouble, Dual, Lift, Real};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Exponents far enough apart for every way in which parts can overlap, and far from overflow and underflow.
const REACH: i32 = 200;

fn dd(x: f64) -> DoubleDouble {
    DoubleDouble::from_f64(x)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Joldes, Muller & Popescu, theorem 3.1: 3u² + 13u³.
    #[test]
    fn sums_have_three_roundings(a in double_double(REACH), b in double_double(REACH), shift in -110..110_i32) {
        let near = b * dd(2.0_f64.powi(shift) * a.to_f64().abs() / b.to_f64().abs());
        for b in [b, near] {
            let truth = exact(a) + exact(b);
            prop_assert!(error_in_u2(a + b, &truth, &truth) <= 3.0 + 1e-14);
            prop_assert!(is_normalized(a + b));
            prop_assert_eq!(a - b, a + -b);
            prop_assert_eq!(a + b, b + a);
        }
    }

    /// The same bound where no leading digit survives: it is relative to the sum.
    #[test]
    fn cancelling_sums_too(a in double_double(REACH), change in -1.0..1.0_f64, digits in 1..106_i32) {
        let b = nearly_opposite(a, change * 2.0_f64.powi(-digits));
        let truth = exact(a) + exact(b);
        prop_assert!(error_in_u2(a + b, &truth, &truth) <= 3.0 + 1e-14);
        prop_assert!(is_normalized(a + b));
    }

    /// Theorems on DWTimesDW3 (4u², with fused multiply-add) and DWTimesDW1 (5u², without).
    #[test]
    fn products_have_five_roundings(a in double_double(REACH), b in double_double(REACH)) {
        let truth = exact(a) * exact(b);
        let bound = if cfg!(target_feature = "fma") { 4.0 } else { 5.0 };
        prop_assert!(error_in_u2(a * b, &truth, &truth) <= bound);
        prop_assert!(is_normalized(a * b));
    }

    /// Theorem on DWDivDW2: 15u² + 56u³.
    #[test]
    fn quotients_have_fifteen_roundings(a in double_double(REACH), b in double_double(REACH)) {
        let truth = exact(a) / exact(b);
        prop_assert!(error_in_u2(a / b, &truth, &truth) <= 15.0 + 1e-14);
        prop_assert!(is_normalized(a / b));
    }

    /// Lefèvre et al., theorem on SQRTDWtoDW: 25/8·u².
    #[test]
    fn roots_have_four_roundings(a in double_double(REACH)) {
        let truth = exact(a.abs()).sqrt();
        prop_assert!(error_in_u2(a.abs().sqrt(), &truth, &truth) <= 3.125);
        prop_assert!(is_normalized(a.abs().sqrt()));
    }

    /// The product is as good as a product, and the sum as a sum whose first operand is not renormalized.
    #[test]
    fn fused_products_have_the_errors_of_their_parts(a in double_double(60), b in double_double(60), c in double_double(60), change in -1.0..1.0_f64, digits in 1..106_i32) {
        for c in [c, nearly_opposite(a * b, change * 2.0_f64.powi(-digits))] {
            let product = exact(a) * exact(b);
            let truth = &product + exact(c);
            let scale = magnitude(&product) * exact(dd(5.0)) + magnitude(&truth) * exact(dd(6.0));
            prop_assert!(error_in_u2(a.mul_add(b, c), &truth, &scale) <= 1.0);
            prop_assert!(is_normalized(a.mul_add(b, c)));
        }
    }

    /// Sums and products of two `f64` are exact.
    #[test]
    fn conversions_are_exact(a in -1e100..1e100_f64, b in -1e20..1e20_f64) {
        prop_assert_eq!(error_in_u2(DoubleDouble::from_sum(a, b), &(exact(dd(a)) + exact(dd(b))), &exact(dd(a))), 0.0);
        prop_assert_eq!(error_in_u2(DoubleDouble::from_product(a, b), &(exact(dd(a)) * exact(dd(b))), &exact(dd(a))), 0.0);
        prop_assert_eq!(dd(a).to_f64(), a);
        prop_assert_eq!(DoubleDouble::from(a), dd(a));
        prop_assert_eq!(Lift::<DoubleDouble>::lift(a), dd(a));
        prop_assert_eq!(Lift::<f64>::lift(DoubleDouble::from_sum(a, b)), a + b, "rounds");
    }

    /// Numbers compare like their exact values.
    #[test]
    fn order_is_that_of_the_numbers(a in double_double(3), change in -1.0..1.0_f64, digits in 1..104_i32) {
        let b = -nearly_opposite(a, change * 2.0_f64.powi(-digits));
        let sign = exact(a).cmp(&exact(b));
        prop_assert_eq!(a.partial_cmp(&b).expect("finite"), sign);
    }
}

#[test]
fn whole_numbers_and_signs_are_exact() {
    let (six, seven) = (dd(6.0), dd(7.0));
    assert_eq!((six * seven, six + seven, six - seven, -six), (dd(42.0), dd(13.0), dd(-1.0), dd(-6.0)));
    assert_eq!((dd(42.0) / seven, dd(49.0).sqrt(), six.mul_add(seven, -dd(42.0))), (six, seven, dd(0.0)));
    assert_eq!((dd(-3.0).abs(), dd(3.0).abs(), DoubleDouble::zero().sqrt()), (dd(3.0), dd(3.0), dd(0.0)));
    let (mut sum, mut difference, mut product) = (six, six, six);
    sum += seven;
    difference -= seven;
    product *= seven;
    assert_eq!((sum, difference, product), (dd(13.0), dd(-1.0), dd(42.0)));
}

#[test]
fn what_is_not_a_number_stays_so() {
    let (nan, infinite) = (dd(f64::NAN), dd(f64::INFINITY));
    for x in [nan + dd(1.0), dd(1.0) - nan, nan * dd(0.0), nan / dd(1.0), nan.sqrt(), nan.mul_add(dd(1.0), dd(1.0))] {
        assert!(x.min_lane().is_nan());
    }
    assert!(dd(-1.0).sqrt().min_lane().is_nan() && (dd(0.0) / dd(0.0)).min_lane().is_nan());
    assert!((infinite - infinite).min_lane().is_nan() && !(dd(1.0) / dd(0.0)).min_lane().is_finite());
}

/// Derivatives in double-double: d(√x · sin x / y) at x = 2 along x′ = 1, y′ = 3, by the quotient rule in the other order.
#[test]
fn duals_over_double_doubles_differentiate() {
    let (x, y) = (Dual::new(dd(2.0), dd(1.0)), Dual::new(dd(7.0), dd(3.0)));
    let dual = x.sqrt() * x.sin_cos().0 / y;
    let ((s, c), root) = (dd(2.0).sin_cos(), dd(2.0).sqrt());
    let expected = (s / (dd(2.0) * root) + root * c) / dd(7.0) - root * s * dd(3.0) / dd(49.0);
    // A dozen operations of at most 16u² each.
    assert!((dual.derivative - expected).to_f64().abs() <= 200.0 * 2.0_f64.powi(-106));
}

/// The measure of these tests sees an error of one unit, and nothing where there is none.
#[test]
fn the_measure_measures() {
    let unit = 2.0_f64.powi(-106);
    let truth = exact(dd(1.0));
    assert_eq!(error_in_u2(DoubleDouble::from_sum(1.0, -3.0 * unit), &truth, &truth), 3.0);
    assert_eq!(error_in_u2(dd(1.0), &truth, &truth), 0.0);
    assert_eq!(error_in_u2(dd(f64::NAN), &truth, &truth), f64::INFINITY);
}
