//! Residuals with an inner state: lag, delay and series elastic drives, against closed forms.

use crate::support::cart;
use featherbench_residuals::{Corrected, Delay, Lag, Residual, ResidualError, Rigid, SeriesElastic, State, Sum, Viscous};

/// Runge and Kutta's fourth-order rule for [q, v, inner] of a box under a constant command.
fn run<R: Residual>(residual: R, start: &[f64], command: f64, time: f64, steps: usize) -> Vec<f64> {
    let model = cart(2.0);
    let mut box_ = Corrected::new(Rigid::new(&model), residual).unwrap();
    let mut rate = |x: &[f64]| {
        let (q, v, inner) = (&x[..1], &x[1..2], &x[2..]);
        let a = box_.forward_of(q, v, &[command], inner).unwrap();
        let mut own = vec![0.0; inner.len()];
        box_.residual().inner_rate(&State::new(q, v, &a).with_command(&[command]).with_inner(inner), &mut own).unwrap();
        [v, &a, &own].concat()
    };
    let h = time / steps as f64;
    let mut x = start.to_vec();
    for _ in 0..steps {
        let at = |k: &[f64], part: f64| x.iter().zip(k).map(|(x, k)| x + part * h * k).collect::<Vec<f64>>();
        let k1 = rate(&x);
        let k2 = rate(&at(&k1, 0.5));
        let k3 = rate(&at(&k2, 0.5));
        let k4 = rate(&at(&k3, 1.0));
        x = (0..x.len()).map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])).collect();
    }
    x
}

/// A lag from rest: z = u (1 − e^(−t/T)), v = (u / m)(t − T (1 − e^(−t/T))).
#[test]
fn a_lag_answers_exponentially() {
    let (time, u, t) = (0.2_f64, 6.0, 0.5_f64);
    let end = run(Lag::new(vec![time]).unwrap(), &[0.0; 3], u, t, 200);
    let late = 1.0 - (-t / time).exp();
    // h = T/80: the rule's error is h⁴/120 of the scale, some 1e-10.
    assert!((end[2] - u * late).abs() < 1e-9, "{end:?}");
    assert!((end[1] - u / 2.0 * (t - time * late)).abs() < 1e-9, "{end:?}");
}

/// A motor and a box on a spring, without command: they swing about their common centre with ω² = K (1/m + 1/B).
#[test]
fn a_series_elastic_drive_swings() {
    let (k, b, m) = (50.0_f64, 0.5_f64, 2.0);
    let omega = (k * (1.0 / m + 1.0 / b)).sqrt();
    let t = 0.7;
    let end = run(SeriesElastic::new(vec![k], vec![0.0], vec![b]).unwrap(), &[0.0, 0.0, 0.1, 0.0], 0.0, t, 400);
    let stretch = 0.1 * (omega * t).cos();
    let centre = 0.1 * b / (m + b);
    assert!((end[2] - end[0] - stretch).abs() < 1e-8, "{end:?}"); // (ωh)⁴/120 per radian
    assert!((m * end[0] + b * end[2] - (m + b) * centre).abs() < 1e-13, "no force acts on both: {end:?}");
}

/// A delay of three periods puts out the first command after three.
#[test]
fn a_delay_is_late_by_its_periods() {
    let delay = Delay::new(1, 3);
    let mut inner = vec![0.0; 3];
    let commands = [1.0, 2.0, 3.0, 4.0, 5.0];
    let mut put_out = Vec::new();
    for u in commands {
        let r = delay.value(&State::new(&[0.0], &[0.0], &[0.0]).with_command(&[u]).with_inner(&inner)).unwrap();
        put_out.push(u - r[0]);
        delay.advance(&mut inner, &[u]).unwrap();
    }
    assert_eq!(put_out, [0.0, 0.0, 0.0, 1.0, 2.0]);
    // Without periods it is none.
    let none = Delay::new(1, 0);
    none.advance(&mut [], &[1.0]).unwrap();
    assert_eq!(none.value(&State::new(&[0.0], &[0.0], &[0.0]).with_command(&[7.0])).unwrap(), [0.0]);
}

/// Inner states of a sum stand one after the other, and a residual of commands wants them.
#[test]
fn sums_share_out_their_inner_state() {
    let parts: Vec<Box<dyn Residual>> = vec![
        Box::new(Lag::new(vec![0.5]).unwrap()),
        Box::new(Viscous::new(vec![2.0]).unwrap()),
        Box::new(SeriesElastic::new(vec![10.0], vec![1.0], vec![0.5]).unwrap()),
    ];
    let sum = Sum::new(1, parts).unwrap();
    assert_eq!((sum.inner(), sum.nq()), (3, Some(1)));
    let (q, v, a, u, inner) = ([0.1], [0.2], [0.0], [3.0], [1.0, 0.4, -0.3]);
    let state = State::new(&q, &v, &a).with_command(&u).with_inner(&inner);
    let spring = 10.0 * (0.4 - 0.1) + (-0.3 - 0.2);
    assert!((sum.value(&state).unwrap()[0] - ((3.0 - 1.0) + 2.0 * 0.2 + (3.0 - spring))).abs() < 1e-15);
    let mut rate = vec![0.0; 3];
    sum.inner_rate(&state, &mut rate).unwrap();
    assert_eq!(rate, [(3.0 - 1.0) / 0.5, -0.3, (3.0 - spring) / 0.5]);
    assert_eq!(sum.value(&State::new(&q, &v, &a).with_inner(&inner)), Err(ResidualError::NoCommand));
}
