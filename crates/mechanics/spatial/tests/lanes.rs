//! Lanes against independent numbers: sine and cosine against double-double ones, and each lane against itself alone.

use featherbench_spatial::{DoubleDouble, Lift, Real};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;
use wide::{f32x8, f32x16, f64x4, f64x8};

/// Polynomial, reduction and sum round three times, and not all at the size of the result. The worst of these tests is 1.6 units.
const UNITS: f64 = 2.0;

/// Numbers uniform in [0, 1): an additive sequence, the same on every machine.
fn uniform(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|k| (k as f64 * 0.618_033_988_749_894_9).fract())
}

/// What the tests need to know of a type of lanes.
struct Kind<L> {
    /// Lanes of these numbers, repeated as often as they fit, each rounded to the precision of the lanes.
    pack: fn(&[f64]) -> L,
    unpack: fn(L) -> Vec<f64>,
    /// Sine and cosine of the standard library in the precision of the lanes.
    standard: fn(f64) -> (f64, f64),
    /// The unit in the last place.
    unit: fn(f64) -> f64,
    /// The largest angle that `wide` computes.
    largest: f64,
    /// What the digits of π/2 that `wide` holds leave, per radian.
    reduction: f64,
}

macro_rules! kind {
    ($lanes:ident, $scalar:ident, $largest:expr, $reduction:expr) => {
        Kind::<$lanes> {
            pack: |x| $lanes::new(std::array::from_fn(|lane| x[lane % x.len()] as $scalar)),
            unpack: |x| x.to_array().map(f64::from).to_vec(),
            standard: |x| {
                let (sin, cos) = (x as $scalar).sin_cos();
                (f64::from(sin), f64::from(cos))
            },
            unit: |x| {
                let size = (x as $scalar).abs();
                f64::from($scalar::from_bits(size.to_bits() + 1)) - f64::from(size)
            },
            largest: $largest,
            reduction: $reduction,
        }
    };
}

/// Runs a test on each type of lanes.
macro_rules! on_all_lanes {
    ($test:ident) => {
        $test(&kind!(f64x4, f64, 1e5, 2.0_f64.powi(-107)));
        $test(&kind!(f64x8, f64, 1e5, 2.0_f64.powi(-107)));
        $test(&kind!(f32x8, f32, 1e3, 2.0_f64.powi(-47)));
        $test(&kind!(f32x16, f32, 1e3, 2.0_f64.powi(-47)));
    };
}

impl<L: Real> Kind<L> {
    fn sin_cos(&self, x: L) -> (Vec<f64>, Vec<f64>) {
        let (sin, cos) = x.sin_cos();
        ((self.unpack)(sin), (self.unpack)(cos))
    }

    /// The largest error of sine and cosine at these angles, relative to its bound.
    fn worst(&self, angles: &[f64]) -> f64 {
        let mut worst: f64 = 0.0;
        for some in angles.chunks(4) {
            let x = (self.pack)(some);
            let (sin, cos) = self.sin_cos(x);
            for ((x, sin), cos) in (self.unpack)(x).into_iter().zip(sin).zip(cos) {
                let (true_sin, true_cos) = DoubleDouble::from_f64(x).sin_cos();
                for (found, truth) in [(sin, true_sin), (cos, true_cos)] {
                    let error = (DoubleDouble::from_f64(found) - truth).to_f64().abs();
                    let bound = UNITS * (self.unit)(truth.to_f64()) + x.abs() * self.reduction;
                    assert!(error.is_finite(), "at {x:e}");
                    worst = if error / bound > worst { error / bound } else { worst };
                }
            }
        }
        worst
    }
}

#[test]
fn sine_and_cosine_are_near_the_truth() {
    fn test<L: Real>(kind: &Kind<L>) {
        for reach in [1e-30, 1e-3, 1.0, 10.0, 1e3, kind.largest] {
            let angles: Vec<f64> = uniform(8000).map(|x| (2.0 * x - 1.0) * reach.min(kind.largest)).collect();
            let worst = kind.worst(&angles);
            assert!(worst <= 1.0, "{worst} of the bound, angles up to {reach:e}");
        }
        // The numbers nearest to multiples of π/2, and their neighbours.
        let turns = (kind.largest / FRAC_PI_2).floor();
        let zeros = uniform(8000).map(|x| 1.0 + (x * turns).floor()).chain((1..100).map(f64::from));
        let angles: Vec<f64> =
            zeros.map(|k| k.min(turns) * FRAC_PI_2).flat_map(|x| [x, -x, x + (kind.unit)(x), x - (kind.unit)(x)]).collect();
        let worst = kind.worst(&angles);
        assert!(worst <= 1.0, "{worst} of the bound next to multiples of π/2");
    }
    on_all_lanes!(test);
}

#[test]
fn angles_that_are_too_large_or_not_finite_are_those_of_the_standard_library() {
    fn test<L: Real>(kind: &Kind<L>) {
        let beyond = kind.largest + (kind.unit)(kind.largest);
        for bad in [beyond, -beyond, 1e10, -1e30, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let (sin, cos) = kind.sin_cos((kind.pack)(&[bad]));
            let (true_sin, true_cos) = (kind.standard)(bad);
            let same = |found: &[f64], truth: f64| found.iter().all(|x| x.to_bits() == truth.to_bits() || x.is_nan() && truth.is_nan());
            assert!(same(&sin, true_sin) && same(&cos, true_cos), "{bad}");

            // one such lane does not change its neighbours
            let (sin, cos) = kind.sin_cos((kind.pack)(&[0.5, bad, -3.0, kind.largest]));
            let (alone_sin, alone_cos) = kind.sin_cos((kind.pack)(&[0.5, 0.25, -3.0, kind.largest]));
            for lane in [0, 2, 3] {
                assert_eq!((sin[lane].to_bits(), cos[lane].to_bits()), (alone_sin[lane].to_bits(), alone_cos[lane].to_bits()), "{bad}");
            }
            assert!(same(&sin[1..2], true_sin) && same(&cos[1..2], true_cos), "{bad}");
        }
    }
    on_all_lanes!(test);
}

#[test]
fn zero_keeps_its_sign() {
    fn test<L: Real>(kind: &Kind<L>) {
        let (sin, cos) = kind.sin_cos((kind.pack)(&[0.0, -0.0]));
        assert_eq!((sin[0].to_bits(), sin[1].to_bits()), (0.0_f64.to_bits(), (-0.0_f64).to_bits()));
        assert!(cos.iter().all(|&cos| cos == 1.0));
    }
    on_all_lanes!(test);
}

#[test]
fn the_smallest_lane_is_nan_if_any_is() {
    fn test<L: Real>(kind: &Kind<L>) {
        let smallest = |x: &[f64]| (kind.pack)(x).min_lane();
        assert_eq!(smallest(&[3.0, 1.0, -2.0, 5.0]), -2.0);
        assert_eq!(smallest(&[f64::INFINITY]), f64::INFINITY);
        assert_eq!(smallest(&[1.0, f64::NEG_INFINITY, 2.0]), f64::NEG_INFINITY);
        for place in 0..4 {
            let mut lanes = [-1.0, 2.0, f64::NEG_INFINITY, f64::INFINITY];
            lanes[place] = f64::NAN;
            assert!(smallest(&lanes).is_nan(), "NaN at {place}");
        }
    }
    on_all_lanes!(test);
}

/// Every operation of the trait, lane by lane, is that of the scalar.
#[test]
fn lanes_compute_as_scalars_do() {
    fn test<S: Real + Into<f64>, L: Real>(lanes: impl Fn(&[S]) -> L, values: impl Fn(L) -> Vec<S>)
    where
        f64: Lift<L> + Lift<S>,
    {
        let scalars = |offset: f64| -> Vec<S> { (0..16).map(|k| S::from_f64(offset + f64::from(k).sqrt())).collect() };
        let (x, y, z) = (scalars(0.3), scalars(-1.7), scalars(0.01));
        let (a, b, c) = (lanes(&x), lanes(&y), lanes(&z));
        let check = |found: L, truth: &dyn Fn(S, S, S) -> S| {
            for (lane, found) in values(found).into_iter().enumerate() {
                assert_eq!(Into::<f64>::into(found), truth(x[lane], y[lane], z[lane]).into(), "lane {lane}");
            }
        };
        check(a + b, &|x, y, _| x + y);
        check(a - b, &|x, y, _| x - y);
        check(a * b, &|x, y, _| x * y);
        check(a / b, &|x, y, _| x / y);
        check(-a, &|x, _, _| -x);
        check(a.sqrt(), &|x, _, _| x.sqrt());
        check(a.mul_add(b, c), &|x, y, z| x.mul_add(y, z));
        check(0.1.lift(), &|_, _, _| 0.1.lift());
        check(L::from_f64(0.1), &|_, _, _| S::from_f64(0.1));
    }
    fn first<S: Copy + Debug, const N: usize>(x: &[S]) -> [S; N] {
        std::array::from_fn(|lane| x[lane])
    }
    test::<f64, f64x4>(|x| f64x4::new(first(x)), |x| x.to_array().to_vec());
    test::<f64, f64x8>(|x| f64x8::new(first(x)), |x| x.to_array().to_vec());
    test::<f32, f32x8>(|x| f32x8::new(first(x)), |x| x.to_array().to_vec());
    test::<f32, f32x16>(|x| f32x16::new(first(x)), |x| x.to_array().to_vec());
}
