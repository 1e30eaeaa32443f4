//! Compensated numbers against multi-precision ones, in units of u² times the magnitudes that were added.

use super::multi_precision::{Big, double_double, error_in_u2, exact, magnitude};
use crate::share::one_of;
use featherbench_spatial::{Compensated, DoubleDouble, Lift, Real};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn error(x: Compensated, truth: &Big, scale: &Big) -> f64 {
    error_in_u2(x.to_double_double(), truth, scale)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Ogita, Rump & Oishi, proposition 5.5, for the sum before its last rounding: γ² ≈ (2n)²u² of the magnitudes, whatever cancels.
    #[test]
    fn dot_products_that_cancel(x in prop::collection::vec(double_double(30), 1..20), y in prop::collection::vec(double_double(30), 20), digits in 0..100_i32) {
        let mut terms: Vec<(DoubleDouble, DoubleDouble)> = x.iter().copied().zip(y.iter().copied()).collect();
        // the same terms again with the opposite sign, but for a few of the last digits
        let change = DoubleDouble::from_f64(1.0 + 2.0_f64.powi(-digits));
        terms.extend(x.iter().zip(&y).map(|(x, y)| (-*x * change, *y)));
        let (mut sum, mut fused) = (Compensated::<f64>::zero(), Compensated::zero());
        let (mut truth, mut magnitudes) = (exact(DoubleDouble::zero()), exact(DoubleDouble::zero()));
        for (x, y) in &terms {
            let (a, b): (Compensated, Compensated) = (x.lift(), y.lift());
            sum += a * b;
            fused = a.mul_add(b, fused);
            let product = exact(*x) * exact(*y);
            (truth, magnitudes) = (truth + &product, magnitudes + magnitude(&product));
        }
        let n = 2.0 * terms.len() as f64;
        prop_assert!(error(sum, &truth, &magnitudes) <= n * n);
        prop_assert!(error(fused, &truth, &magnitudes) <= n * n);
    }

    /// A renormalized operand is a double-double, and so is the result, to a few u².
    #[test]
    fn quotients_roots_and_sines(a in double_double(100), b in double_double(100), angle in double_double(10)) {
        let (x, y, z): (Compensated, Compensated, Compensated) = (a.lift(), b.lift(), angle.lift());
        let quotient = exact(a) / exact(b);
        prop_assert!(error(x / y, &quotient, &quotient) <= 15.0);
        let root = exact(a.abs()).sqrt();
        prop_assert!(error(Compensated::from(a.abs()).sqrt(), &root, &root) <= 3.125);
        let (sin, cos) = exact(angle).with_precision(512).value().sin_cos();
        prop_assert!(error(z.sin_cos().0, &sin, &sin) <= 28.0);
        prop_assert!(error(z.sin_cos().1, &cos, &cos) <= 28.0);
    }

    /// A divisor that has cancelled costs the digits that cancelled, and no more: the divisor is renormalized.
    #[test]
    fn quotients_by_what_has_cancelled(a in 1.0..2.0_f64, b in 1.0..2.0_f64, digits in 1..50_i32) {
        let small = 2.0_f64.powi(-digits) / 3.0;
        let divisor = (Compensated::from_f64(b) + Compensated::from_f64(small)) - Compensated::from_f64(b);
        let truth = exact(a.into()) / exact(small.into());
        prop_assert!(error(Compensated::from_f64(a) / divisor, &truth, &truth) <= 15.0);
    }
}

#[test]
fn conversions_and_signs() {
    let x = DoubleDouble::from_sum(1.5, 2.0_f64.powi(-70));
    let y = Compensated::from(x);
    assert_eq!(y.to_double_double(), x);
    assert_eq!(Lift::<f64>::lift(y), 1.5);
    assert_eq!(y.min_lane(), 1.5);
    assert_eq!((-y - y).to_double_double(), -x - x);
    let mut z = y;
    z *= Compensated::from_f64(4.0);
    z -= y;
    assert_eq!(z.to_double_double(), x * DoubleDouble::from_f64(3.0));
    assert!((y - Compensated::from_f64(f64::NAN)).min_lane().is_nan());
    assert_eq!(Compensated::<f64>::zero().sqrt().min_lane(), 0.0);
}
