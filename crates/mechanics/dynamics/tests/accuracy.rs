//! Accuracy against the same text in double-double arithmetic, on chains up to two hundred deep; and of `f32` against `f64`.
//!
//! The measures are those of the reports. An entry of M: √(M_ii·M_jj). Inverse dynamics: the sum of the magnitudes that form each force.
//! Forward dynamics: its own norm.

use crate::common;

use common::{ROBOTS, build, dyadic_chain, larger, largest, lifted, within};
use featherbench_dynamics::{bias_force, forward_dynamics, forward_kinematics, inverse_dynamics, jacobian, mass_matrix};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{DoubleDouble, Lift, Real};

const PLANAR: [[f64; 3]; 1] = [[0.0, 1.0, 0.0]];
const SPACE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const SKEW: [[f64; 3]; 2] = [[0.6, 0.0, 0.8], [0.0, 0.8, -0.6]];

/// Difference of an `f64` from the truth, exactly enough.
fn error(value: f64, truth: DoubleDouble) -> f64 {
    (DoubleDouble::from_f64(value) - truth).to_f64().abs()
}

/// The reference chains and their states: name, model, states, reach of the angles.
fn chains(mut each: impl FnMut(&str, usize, &Model<f64>, &StateBatch)) {
    for (name, axes, reach) in
        [("planar, straight", &PLANAR[..], 0.0), ("planar", &PLANAR, 0.2 / 3.15), ("space", &SPACE, 1.0), ("skew", &SKEW, 1.0)]
    {
        for n in [10, 50, 200] {
            let model = dyadic_chain(axes, n);
            let mut states = StateBatch::random(&model, 3, 17);
            states.q.iter_mut().for_each(|q| *q *= reach);
            each(name, n, &model, &states);
        }
    }
}

#[test]
fn inverse_dynamics_is_good_to_the_last_digits() {
    chains(|name, n, model, states| {
        let mut worst = 0.0_f64;
        for k in 0..states.count() {
            let (q, v, a) = (states.q(k), states.v(k), states.a(k));
            let tau = inverse_dynamics(model, q, v, a).unwrap();
            let truth = inverse_dynamics(model, &lifted::<DoubleDouble>(q), &lifted(v), &lifted(a)).unwrap();
            let (matrix, bias) = (mass_matrix(model, q).unwrap().to_dense(), bias_force(model, q, v).unwrap());
            for i in 0..n {
                let terms = (0..n).map(|j| (matrix[(i, j)] * a[j]).abs()).sum::<f64>() + bias[i].abs() + tau[i].abs();
                worst = larger(worst, error(tau[i], truth[i]) / terms);
                assert!(tau[i].is_finite());
            }
        }
        within(&format!("{name} {n}: ID"), worst, 1e-14);
    });
}

#[test]
fn mass_matrix_is_good_to_the_last_digits() {
    chains(|name, n, model, states| {
        let mut worst = 0.0_f64;
        let (q, diagonal) = (states.q(0), mass_matrix(model, states.q(0)).unwrap().diagonal().collect::<Vec<_>>());
        let (matrix, truth) = (mass_matrix(model, q).unwrap(), mass_matrix(model, &lifted::<DoubleDouble>(q)).unwrap());
        for i in 0..n {
            for j in 0..=i {
                let off = error(matrix.get(i, j), truth.get(i, j)) / (diagonal[i] * diagonal[j]).sqrt();
                assert!(off.is_finite());
                worst = larger(worst, off);
            }
        }
        within(&format!("{name} {n}: M"), worst, 1e-14);
    });
}

/// Rotations about parallel axes keep the axis to the bit, along any chain: no 1 is ever rounded.
#[test]
fn parallel_axes_stay_parallel_to_the_bit() {
    let mut seen = 0;
    chains(|name, n, model, states| {
        if !name.starts_with("planar") {
            return;
        }
        for k in 0..states.count() {
            let columns = jacobian(model, states.q(k), n - 1).unwrap();
            assert!(columns.iter().all(|column| column.ang.to_array() == PLANAR[0]), "{name} {n}: an axis is turned");
            let kinematics = forward_kinematics(model, states.q(k), states.v(k), states.a(k)).unwrap();
            for (i, body) in kinematics.iter().enumerate() {
                let rates: f64 = states.v(k)[..=i].iter().sum();
                let velocity = body.velocity.ang.to_array();
                assert_eq!((velocity[0], velocity[2]), (0.0, 0.0), "{name} {n}: body {i} leaves its plane");
                // The same numbers in the same order.
                assert_eq!(velocity[1], rates, "{name} {n}: body {i}");
            }
            seen += 1;
        }
    });
    assert!(seen >= 18, "{seen} states");
}

#[test]
fn forward_dynamics_loses_little_where_the_condition_number_loses_everything() {
    chains(|name, n, model, states| {
        let mut worst = 0.0_f64;
        for k in 0..states.count() {
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            let a = forward_dynamics(model, q, v, tau).unwrap();
            let truth = forward_dynamics(model, &lifted::<DoubleDouble>(q), &lifted(v), &lifted(tau)).unwrap();
            let off = a.iter().zip(&truth).map(|(a, t)| error(*a, *t).powi(2)).sum::<f64>().sqrt();
            let norm = a.iter().map(|a| a * a).sum::<f64>().sqrt();
            assert!(norm.is_finite());
            worst = larger(worst, off / norm);
        }
        // κ(M) is 4e9 for the longest straight chain.
        within(&format!("{name} {n}: ABA"), worst, 1e-13);
    });
}

/// Robots with every kind of joint, fast and slow. An offset of the base by a thousand kilometres and a speed of a thousand metres per
/// second change nothing in the relative motion.
#[test]
fn far_and_fast_bases_lose_no_digits() {
    let model = dyadic_chain(&SPACE, 20);
    let mut far = model.clone();
    far.placements[0].translation = featherbench_spatial::Vec3::new(1e6, -1e6, 1e6);
    let states = StateBatch::random(&model, 3, 4);
    for k in 0..states.count() {
        let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
        assert_eq!(inverse_dynamics(&model, q, v, a).unwrap(), inverse_dynamics(&far, q, v, a).unwrap());
        assert_eq!(forward_dynamics(&model, q, v, tau).unwrap(), forward_dynamics(&far, q, v, tau).unwrap());
        assert_eq!(mass_matrix(&model, q).unwrap(), mass_matrix(&far, q).unwrap());
    }

    let floating = build(&ROBOTS[7].1);
    let states = StateBatch::random(&floating, 3, 4);
    for k in 0..states.count() {
        let (q, a) = (states.q(k), states.a(k));
        // Without rotation of the base, a common velocity is no acceleration.
        let mut slow = states.v(k).to_vec();
        slow[3..6].fill(0.0);
        let mut fast = slow.clone();
        fast[0] += 1024.0;
        let (slow, fast) = (inverse_dynamics(&floating, q, &slow, a).unwrap(), inverse_dynamics(&floating, q, &fast, a).unwrap());
        assert_eq!(slow, fast);
    }
}

/// The same text in single precision: its unit of rounding, and so its error, is 2²⁹ times as large.
#[test]
fn single_precision_is_as_much_worse_as_its_rounding() {
    fn residual<T: Real>(model: &Model<f64>, states: &StateBatch, k: usize) -> f64
    where
        f64: Lift<T>,
    {
        let [q, v, a] = [states.q(k), states.v(k), states.a(k)].map(lifted::<T>);
        let tau = inverse_dynamics(model, &q, &v, &a).unwrap();
        let back = forward_dynamics(model, &q, &v, &tau).unwrap();
        let off: Vec<f64> = back.iter().zip(&a).map(|(x, y)| (*x - *y).min_lane()).collect();
        largest(&off)
    }
    let mut ratios = Vec::new();
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 20, 6);
        let mean = |residual: &dyn Fn(usize) -> f64| (0..states.count()).map(residual).map(f64::ln).sum::<f64>() / states.count() as f64;
        let ratio =
            (mean(&|k| residual::<f32>(&model, &states, k)) - mean(&|k| residual::<f64>(&model, &states, k))) / std::f64::consts::LN_2;
        // Medians over the states of one robot vary by a factor of about two: one bit of twenty-nine.
        within(&format!("{name}: log₂ of the f32 to f64 residual, less 29"), (ratio - 29.0).abs(), 1.5);
        ratios.push(ratio);
    }
    assert_eq!(ratios.len(), ROBOTS.len());
}

#[test]
fn single_precision_inverse_dynamics_has_single_precision() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 5, 6);
        for k in 0..states.count() {
            let (q, v, a) = (states.q(k), states.v(k), states.a(k));
            let truth = inverse_dynamics(&model, q, v, a).unwrap();
            let single = inverse_dynamics(&model, &lifted::<f32>(q), &lifted(v), &lifted(a)).unwrap();
            let off: Vec<f64> = single.iter().zip(&truth).map(|(s, t)| f64::from(*s) - t).collect();
            // Inputs rounded to ½ ulp, and about ten bodies of a dozen roundings each.
            within(&format!("{name}: f32 ID"), largest(&off) / largest(&truth), 64.0 * f64::from(f32::EPSILON));
        }
    }
}
