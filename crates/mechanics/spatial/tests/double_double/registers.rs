//! Compensated numbers in registers, lane by lane to the bit against compensated numbers; and those of single precision.

use super::multi_precision::double_double;
use crate::share::one_of;
use featherbench_spatial::{Compensated, DoubleDouble, Lift, Real};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::f64::consts::FRAC_PI_2;
use wide::{f64x4, f64x8};

/// The bits of both parts; every NaN is one.
fn bits([value, rest]: [f64; 2]) -> Option<[u64; 2]> {
    (!value.is_nan()).then_some([value.to_bits(), rest.to_bits()])
}

/// Checks a function of a register against the function of each lane's number.
macro_rules! agree {
    ($lanes:ident, $numbers:expr, |$x:ident| $result:expr) => {{
        let numbers: Vec<DoubleDouble> = $numbers.to_vec();
        let number = |lane: usize| numbers[lane % numbers.len()];
        let count = $lanes::ZERO.to_array().len();
        for first in (0..numbers.len()).step_by(count) {
            let part = |part: fn(DoubleDouble) -> f64| $lanes::new(std::array::from_fn(|lane| part(number(first + lane))));
            // The register is the sum of two whose upper parts are exact and whose lower parts are too.
            let wide = {
                let $x: Compensated<$lanes> = Lift::<Compensated<$lanes>>::lift(part(DoubleDouble::to_f64))
                    + Lift::<Compensated<$lanes>>::lift(part(DoubleDouble::rest));
                $result.to_parts().map(|part| part.to_array())
            };
            for lane in 0..count {
                let alone = {
                    let $x: Compensated =
                        Compensated::<f64>::from_f64(number(first + lane).to_f64()) + Compensated::from_f64(number(first + lane).rest());
                    $result.to_parts()
                };
                let found = wide.map(|part| part[lane]);
                prop_assert_eq!(bits(found), bits(alone), "lane {} of {:?}: {}", lane, numbers, stringify!($result));
            }
        }
    }};
}

fn all_functions_agree(numbers: &[DoubleDouble]) -> Result<(), TestCaseError> {
    macro_rules! functions {
        ($($name:ident),+) => {$(
            agree!(f64x4, numbers, |x| $name(x));
            agree!(f64x8, numbers, |x| $name(x));
        )+};
    }
    functions!(sin, cos, root, arithmetic);
    Ok(())
}

fn sin<T: Real>(x: T) -> T {
    x.sin_cos().0
}

fn cos<T: Real>(x: T) -> T {
    x.sin_cos().1
}

fn root<T: Real>(x: T) -> T {
    (x * x).sqrt()
}

fn arithmetic<T: Real>(x: T) -> T {
    let y = x.mul_add(x, -T::one()) / (x - T::from_f64(3.0));
    y * x + y.reciprocal_or_zero()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Ordinary angles: the registers' own sine and cosine.
    #[test]
    fn usual_numbers(numbers in prop::collection::vec(double_double(6), 8)) {
        all_functions_agree(&numbers)?;
    }

    /// Among them some that are reduced by the digits of 2/π.
    #[test]
    fn numbers_of_every_size(numbers in prop::collection::vec(double_double(100), 8)) {
        all_functions_agree(&numbers)?;
    }
}

#[test]
fn special_numbers() {
    let multiples = (-40..40).flat_map(|k| {
        let x = f64::from(k) * FRAC_PI_2;
        [x, x * (1.0 + f64::EPSILON), x / 2.0, x + 1e-7]
    });
    let bad = [0.0, -0.0, 1e-300, -1e-310, 1.6e9, 1.7e9, 1e22, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let numbers: Vec<DoubleDouble> = multiples.chain(bad).map(DoubleDouble::from).collect();
    all_functions_agree(&numbers).unwrap();
    // One bad number among good ones.
    for bad in bad {
        let mut numbers: Vec<DoubleDouble> = (0..8).map(|k| DoubleDouble::from_sum(f64::from(k) - 3.3, 1e-18)).collect();
        numbers[5] = bad.into();
        all_functions_agree(&numbers).unwrap();
    }
}

/// Each part has 24 binary digits. The truth is in double-double.
#[test]
fn single_precision() {
    let u2 = 2.0_f64.powi(-48);
    let numbers: Vec<f32> = (1..400).map(|k| (k as f32 * 0.618_034).fract() * 20.0 - 10.0).collect();
    let (mut sum, mut truth, mut magnitudes) = (Compensated::<f32>::zero(), DoubleDouble::zero(), 0.0_f64);
    let to_f64 = |x: Compensated<f32>| {
        let [value, rest] = x.to_parts();
        f64::from(value) + f64::from(rest)
    };
    for (x, y) in numbers.iter().zip(numbers.iter().rev()) {
        let third = |x: f32| Compensated::<f32>::from_f64(f64::from(x)) / Compensated::from_f64(3.0);
        sum = third(*x).mul_add(third(*y), sum);
        let product = f64::from(*x) * f64::from(*y) / 9.0;
        truth += DoubleDouble::from_f64(f64::from(*x)) * DoubleDouble::from_f64(f64::from(*y)) / DoubleDouble::from_f64(9.0);
        magnitudes += product.abs();

        let angle = third(*x);
        let (sin, cos) = angle.sin_cos();
        let (true_sin, true_cos) = to_f64(angle).sin_cos();
        // rounded to two parts
        assert!((to_f64(sin) - true_sin).abs() <= u2 * true_sin.abs() && (to_f64(cos) - true_cos).abs() <= u2 * true_cos.abs(), "{x}");
        let root = (angle * angle).sqrt();
        assert!((to_f64(root) - to_f64(angle).abs()).abs() <= 8.0 * u2 * to_f64(angle).abs(), "{x}");
        assert_eq!(Lift::<f32>::lift(angle), (f64::from(*x) / 3.0) as f32);
    }
    // as for double precision, plus the quotients' 15u²
    let n = 2.0 * numbers.len() as f64;
    assert!((to_f64(sum) - truth.to_f64()).abs() <= n * n * u2 * magnitudes);
}
