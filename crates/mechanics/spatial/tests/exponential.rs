//! Exponential and logarithm against power series in double-double, at angles from nothing to more than a turn.

use featherbench_spatial::{Angle, DoubleDouble, Dual, Lift, Motion, Quaternion, Real, TangentBlock, Vec3};
use std::f64::consts::PI;
use wide::{f32x8, f32x16, f64x4, f64x8};

type Extended = DoubleDouble;

/// Angles: nothing, where squares underflow, small ones, the ends of the series, π, and a turn and more.
const ANGLES: [f64; 19] = [
    0.0,
    1e-200,
    1e-20,
    1e-8,
    1e-3,
    0.0625,
    0.0626,
    0.5,
    1.0 - 1e-9,
    1.0 + 1e-9,
    2.0,
    3.0,
    PI - 1e-9,
    PI,
    PI + 1e-9,
    5.0,
    2.0 * PI - 1e-6,
    2.0 * PI,
    7.0,
];

/// A motion with this angle about a skew axis.
fn screw(angle: f64) -> [f64; 6] {
    let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0].map(|x| x * angle);
    [axis[0], axis[1], axis[2], 1.25, -0.5, 0.75]
}

fn motion<T: Real>(numbers: [f64; 6]) -> Motion<T> {
    Motion::from_array(numbers.map(T::from_f64))
}

type Matrix = [[Extended; 6]; 6];

fn zero() -> Matrix {
    [[Extended::zero(); 6]; 6]
}

/// `Σ (−ad ξ)ᵏ/(k + shift)!` on [linear; angular]: for shift 0 Ad(exp ξ)⁻¹, for shift 1 the right Jacobian.
fn power_series(numbers: [f64; 6], shift: u32) -> Matrix {
    let m: Motion<Extended> = motion(numbers);
    let columns: [[Extended; 6]; 6] = std::array::from_fn(|column| {
        let unit = |k: usize| if k == column { Extended::one() } else { Extended::zero() };
        let moved = m.cross_motion(Motion::new(Vec3::new(unit(3), unit(4), unit(5)), Vec3::new(unit(0), unit(1), unit(2))));
        let ([a, b, c], [d, e, f]) = (moved.lin.to_array(), moved.ang.to_array());
        [a, b, c, d, e, f]
    });
    let ad: Matrix = std::array::from_fn(|row| std::array::from_fn(|column| -columns[column][row]));
    let (mut sum, mut term) = (zero(), zero());
    for (k, row) in term.iter_mut().enumerate() {
        row[k] = Extended::one();
    }
    // Angles of up to seven: 7ᵏ/k! is below 10⁻³⁵ at k = 64.
    for k in 0..64_u32 {
        let mut next = zero();
        for row in 0..6 {
            for column in 0..6 {
                sum[row][column] += term[row][column];
                let product = (0..6).fold(Extended::zero(), |s, j| ad[row][j].mul_add(term[j][column], s));
                next[row][column] = product / Extended::from_f64(f64::from(k + 1 + shift));
            }
        }
        term = next;
    }
    sum
}

fn largest_gap<T: Angle + Lift<Extended>>(block: &TangentBlock<T>, expected: &Matrix) -> f64 {
    let all = block.to_array();
    let gaps = (0..36).map(|k| (Lift::<Extended>::lift(all[k]) - expected[k / 6][k % 6]).to_f64().abs());
    worst(gaps)
}

/// The largest, NaN if any is.
fn worst(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

fn check_jacobians<T: Angle + Lift<Extended>>(tolerance: f64) {
    for angle in ANGLES {
        let (numbers, m) = (screw(angle), motion::<T>(screw(angle)));
        let jacobian = largest_gap(&m.right_jacobian(), &power_series(numbers, 1));
        assert!(jacobian <= tolerance, "J at {angle}: {jacobian:e}");
        let carried = largest_gap(&m.carried(), &power_series(numbers, 0));
        assert!(carried <= 4.0 * tolerance, "Ad(exp)⁻¹ at {angle}: {carried:e}");

        // J⁻¹ J = 1. J⁻¹ has a pole at 2π: the error grows with its square.
        let (a, b) = (m.inverse_right_jacobian().to_array(), m.right_jacobian().to_array());
        let gaps = (0..36).map(|k| {
            let unit = if k % 7 == 0 { T::one() } else { T::zero() };
            let product = (0..6).fold(-unit, |s, j| a[k / 6 * 6 + j].mul_add(b[6 * j + k % 6], s));
            Lift::<Extended>::lift(product).to_f64().abs()
        });
        let gap = worst(gaps);
        let pole = 2.0 * PI / (2.0 * PI - angle);
        if angle < 6.5 && pole < 1e7 {
            assert!(gap <= 4.0 * tolerance * pole * pole, "J⁻¹ at {angle}: {gap:e}");
        }
    }
}

#[test]
fn jacobians_are_those_of_the_power_series() {
    // A dozen roundings of numbers of about one; the argument's own at θ = 7 is 4 ε.
    check_jacobians::<f64>(16.0 * f64::EPSILON);
    // The power series itself cancels: its terms reach 7⁷/7! = 160 times the result.
    check_jacobians::<Extended>(1e-28);
}

fn check_logarithm<T: Angle + Lift<Extended>>(tolerance: f64) {
    for angle in ANGLES.into_iter().filter(|angle| *angle < PI) {
        let m = motion::<T>(screw(angle));
        let (rotation, translation) = m.exp();
        let minus = Quaternion { v: -rotation.v, w: -rotation.w };
        let three = T::from_f64(3.0);
        let long = Quaternion { v: rotation.v * three, w: rotation.w * three };
        for rotation in [rotation, minus, long] {
            let back = Motion::log(rotation, translation) - m;
            let gap = worst(back.to_array().into_iter().map(|x| Lift::<Extended>::lift(x).to_f64().abs()));
            assert!(gap <= tolerance, "log exp at {angle}: {gap:e}");
        }
        // Small rotation vectors keep their leading digits too.
        let relative = (rotation.log() - m.ang) * (T::one() / T::from_f64(if angle > 0.0 { angle } else { 1.0 }));
        let gap = worst(relative.to_array().into_iter().map(|x| Lift::<Extended>::lift(x).to_f64().abs()));
        assert!(gap <= tolerance, "relative error of the logarithm at {angle}: {gap:e}");
    }
    // The way over π is the long one: back by 2π − angle.
    for angle in [PI + 1e-9, 5.0, 2.0 * PI - 1e-6] {
        let m = motion::<T>(screw(angle));
        let length = Lift::<Extended>::lift(m.exp().0.log().norm());
        let shorter = Extended::from_f64(2.0) * Extended::zero().atan2(-Extended::one()) - Lift::<Extended>::lift(m.ang.norm());
        assert!((length - shorter).to_f64().abs() <= tolerance, "the shortest way at {angle}");
    }
}

#[test]
fn logarithm_inverts_the_exponential_the_shortest_way() {
    // Translations of one, a dozen roundings, at π as elsewhere.
    check_logarithm::<f64>(16.0 * f64::EPSILON);
    check_logarithm::<Extended>(1e-30);
}

#[test]
fn rotation_and_quaternion_agree_with_the_power_series() {
    for angle in ANGLES {
        let numbers = screw(angle);
        let carried = power_series(numbers, 0);
        let rotation = motion::<Extended>(numbers).exp().0.to_rotation().transpose().to_array();
        let gap = worst((0..9).map(|k| (rotation[k] - carried[k / 3][k % 3]).to_f64().abs()));
        assert!(gap < 1e-28, "R at {angle}: {gap:e}");
        let unit = motion::<f64>(numbers).exp().0;
        assert!((unit.w.mul_add(unit.w, unit.v.dot(unit.v)) - 1.0).abs() < 4.0 * f64::EPSILON);
    }
}

/// Duals through `exp` and `log` are J and J⁻¹, also where the closed forms are 0/0.
#[test]
fn duals_give_the_jacobians() {
    for angle in ANGLES.into_iter().filter(|angle| *angle < PI - 1e-3) {
        let numbers = screw(angle);
        let at = motion::<f64>(numbers);
        let block = at.right_jacobian().to_array();
        for column in 0..6 {
            let along = |k: usize| if k == column { 1.0 } else { 0.0 };
            let dual = |k: usize, j: usize| Dual::new(numbers[j], along(k));
            let moving = Motion::new(Vec3::new(dual(3, 0), dual(4, 1), dual(5, 2)), Vec3::new(dual(0, 3), dual(1, 4), dual(2, 5)));
            let (rotation, translation) = moving.exp();
            // What moves, seen from where it is.
            let constant = at.exp();
            let fixed = Quaternion { v: constant.0.v.lift::<Dual<f64>>(), w: Dual::constant(constant.0.w) };
            let shift = translation - constant.1.lift();
            let way = Motion::log(fixed.conjugate() * rotation, fixed.to_rotation().transpose_mul(shift));
            let rates = way.lin.to_array().into_iter().chain(way.ang.to_array()).map(|x| x.derivative);
            let gap = worst(rates.enumerate().map(|(row, rate)| (rate - block[6 * row + column]).abs()));
            assert!(gap < 1e-14, "column {column} at {angle}: {gap:e}");
        }
    }
}

/// Lanes on both sides of the series' end compute as the scalar does.
#[test]
fn lanes_choose_one_by_one() {
    fn check<T: Angle>(lanes: &[f64], splat: impl Fn(&dyn Fn(f64) -> f64) -> T, read: impl Fn(T) -> Vec<f64>, tolerance: f64) {
        let m = Motion::from_array(std::array::from_fn(|k| splat(&|angle| screw(angle)[k])));
        let (rotation, translation) = m.exp();
        let back = Motion::log(rotation, translation).to_array();
        let jacobian = m.right_jacobian().to_array();
        for (lane, &angle) in lanes.iter().enumerate() {
            let alone = motion::<f64>(screw(angle)).right_jacobian().to_array();
            let gap = worst((0..36).map(|k| (read(jacobian[k])[lane] - alone[k]).abs()));
            assert!(gap <= tolerance, "J in lane {lane}: {gap:e}");
            let gap = worst((0..6).map(|k| (read(back[k])[lane] - screw(angle)[k]).abs()));
            assert!(gap <= tolerance, "log exp in lane {lane}: {gap:e}");
        }
    }
    const LANES: [f64; 16] = [0.0, 3.0, 0.5, 1.5, 1e-8, 2.0, 1e-3, 0.99, 3.1, 0.0, 1.01, 2.9, 1e-20, 0.06, 0.07, 1.7];
    let (double, single) = (16.0 * f64::EPSILON, 24.0 * f64::from(f32::EPSILON));
    check(&LANES[..4], |f| f64x4::new(std::array::from_fn(|k| f(LANES[k]))), |x| x.to_array().to_vec(), double);
    check(&LANES[..8], |f| f64x8::new(std::array::from_fn(|k| f(LANES[k]))), |x| x.to_array().to_vec(), double);
    check(&LANES[..8], |f| f32x8::new(std::array::from_fn(|k| f(LANES[k]) as f32)), |x| x.to_array().map(f64::from).to_vec(), single);
    check(&LANES, |f| f32x16::new(std::array::from_fn(|k| f(LANES[k]) as f32)), |x| x.to_array().map(f64::from).to_vec(), single);
}

#[test]
fn what_is_not_a_number_stays_so() {
    let nan = motion::<f64>([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(nan.exp().0.w.is_nan() && nan.right_jacobian().diagonal.x.x.is_nan());
    let quaternion = Quaternion::from_array([0.0, 0.0, 0.0, f64::NAN]);
    assert!(quaternion.log().x.is_nan() && quaternion.normalised().w.is_nan());
    assert!(Quaternion::<f64>::from_array([0.0; 4]).log().x.is_nan(), "zero is no rotation");
    assert_eq!(Quaternion::from_array([0.0; 4]).normalised(), Quaternion::<f64>::identity());
}

/// x sin α = y cos α, and both have the sign of the angle's quadrant.
#[test]
fn the_angle_of_a_point_has_all_digits() {
    let third = Extended::one() / Extended::from_f64(3.0);
    for (y, x) in [(1.0, 2.0), (1e-12, 3.0), (2.0, -1.0), (-1e-9, -1.0), (-3.0, 1e-5), (0.0, 5.0), (7.0, 0.0)] {
        let (y, x) = (Extended::from_f64(y) * third, Extended::from_f64(x));
        let (sin, cos) = y.atan2(x).sin_cos();
        let length = x.mul_add(x, y * y).sqrt();
        assert!(((sin * length - y).to_f64() / length.to_f64()).abs() < 1e-31);
        assert!(((cos * length - x).to_f64() / length.to_f64()).abs() < 1e-31);
    }
}
