//! Error-free transforms: sums and products of two numbers as the rounded result and its rounding error, exactly; in registers lane by lane.
//!
//! Sources: Knuth's two-sum and Dekker's fast two-sum. The product is by fused multiply-add. Where the machine has none, it is by
//! Veltkamp's splitting and Dekker's product (T. J. Dekker, *A floating-point technique for extending the available precision*, 1971).
//! All are exact in round-to-nearest unless something overflows. A product also needs that its error does not underflow (|a·b| above
//! 2⁻⁹⁶⁹ in double, 2⁻¹⁰² in single precision).

use super::{Part, Real};

/// `a + b` and its error, exactly.
#[inline(always)]
pub(crate) fn two_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a + b` and its error, exactly, if `a` is a multiple of the last place of `b`. That holds if |a| ≥ |b|, or if a is zero.
#[inline(always)]
pub(crate) fn fast_two_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// `a · b` and its error, exactly.
#[inline(always)]
pub(crate) fn two_product<T: Part>(a: T, b: T) -> (T, T) {
    if cfg!(target_feature = "fma") {
        let product = a * b;
        (product, a.mul_add(b, -product))
    } else {
        dekker_product(a, b)
    }
}

/// [`two_product`] without fused multiply-add; it also overflows for factors above 2⁹⁹⁶ in double, 2¹¹⁵ in single precision.
#[inline(always)]
fn dekker_product<T: Part>(a: T, b: T) -> (T, T) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let rest = ((a_high * b_high - product) + a_high * b_low) + a_low * b_high;
    (product, rest + a_low * b_low)
}

/// `a` as the sum of two numbers of half its bits (Veltkamp).
#[inline(always)]
fn split<T: Part>(a: T) -> (T, T) {
    let scaled = T::from_f64(T::SPLITTER) * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        /// Integers of 53 bits, whose sums and products `i128` holds exactly.
        #[test]
        fn transforms_are_exact(a in -(1_i64 << 53)..=1 << 53, b in -(1_i64 << 53)..=1 << 53, shift in 0..53) {
            let b = b >> shift;
            let (x, y) = (a as f64, b as f64);
            let exact = |(high, low): (f64, f64)| high as i128 + low as i128;
            prop_assert_eq!(exact(two_sum(x, y)), i128::from(a) + i128::from(b));
            prop_assert_eq!(exact(two_product(x, y)), i128::from(a) * i128::from(b));
            prop_assert_eq!(exact(dekker_product(x, y)), i128::from(a) * i128::from(b), "the product without fused multiply-add");
            let (larger, smaller) = if x.abs() >= y.abs() { (x, y) } else { (y, x) };
            prop_assert_eq!(fast_two_sum(larger, smaller), two_sum(x, y));
        }
    }
}
