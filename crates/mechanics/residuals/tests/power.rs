//! The balance of power along an exact motion: the error falls with the order of the quadrature.

use crate::support::{arm, lesson};
use featherbench_dynamics::{energy, inverse_dynamics};
use featherbench_model::Model;
use featherbench_residuals::{Payload, PowerBalance, Quadrature};

#[test]
fn the_error_falls_with_the_order() {
    let nominal: Model<f64> = Model::build(&lesson()).unwrap();
    let truth: Model<f64> = Model::build(&arm([2.0, 1.2], [1.0, 0.5])).unwrap();
    let payload = Payload::new(&lesson(), 1, 0.2, [0.0, 0.0, 0.25], [0.0, 0.0, 0.0, 0.2 * 0.25 / 12.0, 0.0, 0.0]).unwrap();
    // Not periodic over the time, or every rule would be exact.
    let motion = |t: f64| {
        let wave = |amplitude: f64, rate: f64| {
            let (s, c) = (rate * t).sin_cos();
            [amplitude * s, amplitude * rate * c, -amplitude * rate * rate * s]
        };
        let [first, second] = [wave(0.8, 1.3), wave(-0.6, 2.1)];
        [0, 1, 2].map(|k| vec![first[k] + 0.3 * f64::from(u8::from(k == 0)), second[k]])
    };
    for rule in Quadrature::ALL {
        let balance = |intervals: usize| {
            let forces = |state: &featherbench_residuals::State<'_>| Ok(inverse_dynamics(&truth, state.q, state.v, state.a)?);
            let stored = |q: &[f64], v: &[f64]| energy(&nominal, q, v).map(|e| e.kinetic + e.potential).map_err(Into::into);
            PowerBalance::of((rule, intervals, 1.7), motion, &payload, forces, stored).unwrap()
        };
        let [coarse, fine] = [balance(16).error(), balance(32).error()];
        let order = (coarse / fine).log2();
        // The next term of the error is h² of the first: 1 % here; at 64 intervals Gauss's rule would reach rounding.
        assert!((order - f64::from(rule.order())).abs() < 0.05, "{rule:?}: {order}");
        assert!(balance(32).residual.abs() > 0.1);
        println!("{rule:?} {order} {:?} {fine:e}", balance(32));
    }
}
