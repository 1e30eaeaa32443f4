//! Registers of selected widths against numbers, lane by lane, where the processor has their instructions.

use super::{Avx2, Avx512, Instructions};
use crate::batch::Width;
use crate::batch::register::Register;
use featherbench_spatial::{DoubleDouble, Real};
use std::f64::consts::FRAC_PI_2;

/// What the tests need to know of a scalar.
trait Scalar: Real {
    /// The largest angle that registers compute themselves.
    const LARGEST: f64;
    /// What the digits of π/2 leave, per radian.
    const REDUCTION: f64;

    /// The unit in the last place.
    fn unit(self) -> f64;

    /// Multiply-add that is rounded once, in every build.
    fn fused(self, factor: Self, addend: Self) -> Self;
}

macro_rules! scalar {
    ($scalar:ident, $largest:literal, $digits:literal) => {
        impl Scalar for $scalar {
            const LARGEST: f64 = $largest;
            const REDUCTION: f64 = 1.0 / (1_u128 << $digits) as f64;

            fn unit(self) -> f64 {
                f64::from($scalar::from_bits(self.abs().to_bits() + 1)) - f64::from(self.abs())
            }

            fn fused(self, factor: Self, addend: Self) -> Self {
                $scalar::mul_add(self, factor, addend)
            }
        }
    };
}

scalar!(f64, 1e5, 107);
scalar!(f32, 1e3, 47);

/// Runs a test on the registers of each width that is selected and there.
macro_rules! on_all_registers {
    ($test:ident) => {
        for width in Width::available() {
            match width {
                Width::AsBuilt => {}
                Width::Avx2 => {
                    $test::<f64, <Avx2 as Instructions>::F64>();
                    $test::<f32, <Avx2 as Instructions>::F32>();
                }
                Width::Avx512 => {
                    $test::<f64, <Avx512 as Instructions>::F64>();
                    $test::<f32, <Avx512 as Instructions>::F32>();
                }
            }
        }
    };
}

/// Numbers uniform in [0, 1): an additive sequence.
fn uniform(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|k| (k as f64 * 0.618_033_988_749_894_9).fract())
}

fn pack<S: Scalar, L: Register<S>>(numbers: &[f64]) -> L {
    L::pack(|lane| S::from_f64(numbers[lane % numbers.len()]))
}

#[test]
fn every_operation_is_that_of_the_scalar() {
    fn test<S: Scalar, L: Register<S>>() {
        let [x, y, z] = [0.3, -1.7, 0.01].map(|offset| uniform(L::LANES).map(|x| offset + x).collect::<Vec<_>>());
        let [a, b, c] = [&x, &y, &z].map(|numbers| pack::<S, L>(numbers));
        let check = |name: &str, found: L, truth: &dyn Fn(S, S, S) -> S| {
            for (lane, found) in found.lanes().iter().enumerate() {
                let [x, y, z] = [&x, &y, &z].map(|numbers| S::from_f64(numbers[lane]));
                assert_eq!(found.min_lane().to_bits(), truth(x, y, z).min_lane().to_bits(), "{name}, lane {lane}");
            }
        };
        check("sum", a + b, &|x, y, _| x + y);
        check("difference", a - b, &|x, y, _| x - y);
        check("product", a * b, &|x, y, _| x * y);
        check("quotient", a / b, &|x, y, _| x / y);
        check("sign", -a, &|x, _, _| -x);
        check("root", a.sqrt(), &|x, _, _| x.sqrt());
        check("multiply-add", a.mul_add(b, c), &|x, y, z| x.fused(y, z));
        check("constant", L::from_f64(0.1), &|_, _, _| S::from_f64(0.1));
        check("reciprocal", a.reciprocal_or_zero(), &|x, _, _| x.reciprocal_or_zero());
        assert!(pack::<S, L>(&[0.0, -0.0]).reciprocal_or_zero().lanes().iter().all(|x| x.min_lane() == 0.0));

        assert_eq!(pack::<S, L>(&[3.0, 1.0, -2.0, 5.0]).min_lane(), -2.0);
        assert_eq!(pack::<S, L>(&[f64::INFINITY]).min_lane(), f64::INFINITY);
        for place in 0..4 {
            let mut lanes = [-1.0, 2.0, f64::NEG_INFINITY, f64::INFINITY];
            lanes[place] = f64::NAN;
            assert!(pack::<S, L>(&lanes).min_lane().is_nan(), "NaN at {place}");
        }
    }
    on_all_registers!(test);
}

/// The bounds of `featherbench_spatial`'s registers: two units in the last place, and what the digits of π/2 leave.
#[test]
fn sine_and_cosine_are_near_the_truth() {
    fn test<S: Scalar, L: Register<S>>() {
        let turns = (S::LARGEST / FRAC_PI_2).floor();
        let near_zeros = uniform(4000).map(|x| (1.0 + (x * turns).floor()).min(turns) * FRAC_PI_2);
        let reaches = [1e-30, 1e-3, 1.0, 10.0, S::LARGEST];
        let spread = reaches.into_iter().flat_map(|reach| uniform(4000).map(move |x| (2.0 * x - 1.0) * reach));
        let angles: Vec<f64> = near_zeros.chain(spread).chain([0.0, -0.0]).collect();
        for some in angles.chunks(4) {
            let x = pack::<S, L>(some);
            let (sin, cos) = x.sin_cos();
            for ((x, sin), cos) in x.lanes().iter().zip(sin.lanes()).zip(cos.lanes()) {
                let (true_sin, true_cos) = DoubleDouble::from_f64(x.min_lane()).sin_cos();
                for (found, truth) in [(sin, true_sin), (cos, true_cos)] {
                    let error = (DoubleDouble::from_f64(found.min_lane()) - truth).to_f64().abs();
                    let bound = 2.0 * S::from_f64(truth.to_f64()).unit() + x.min_lane().abs() * S::REDUCTION;
                    assert!(error <= bound, "{error:e} at {x:?}: more than {bound:e}");
                }
                assert!(x.min_lane() != 0.0 || sin.min_lane().to_bits() == x.min_lane().to_bits(), "the sign of zero");
            }
        }
    }
    on_all_registers!(test);
}

#[test]
fn other_angles_have_those_of_the_standard_library() {
    fn test<S: Scalar, L: Register<S>>() {
        let beyond = S::LARGEST + S::from_f64(S::LARGEST).unit();
        for bad in [beyond, -beyond, 1e10, -1e30, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let (sin, cos) = pack::<S, L>(&[0.5, bad, -3.0, S::LARGEST]).sin_cos();
            let (alone_sin, alone_cos) = pack::<S, L>(&[0.5, 0.25, -3.0, S::LARGEST]).sin_cos();
            let (true_sin, true_cos) = S::from_f64(bad).sin_cos();
            for lane in 0..4 {
                let expected = if lane == 1 { [true_sin, true_cos] } else { [alone_sin.lanes()[lane], alone_cos.lanes()[lane]] };
                for (found, expected) in [sin, cos].iter().zip(expected) {
                    let (found, expected) = (found.lanes()[lane].min_lane(), expected.min_lane());
                    assert!(found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(), "{bad}, lane {lane}");
                }
            }
        }
    }
    on_all_registers!(test);
}
