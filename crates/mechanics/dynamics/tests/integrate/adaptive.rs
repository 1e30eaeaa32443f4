//! Steps chosen by a tolerance.

use crate::common;

use common::{distance, generated, larger, largest, within};
use featherbench_dynamics::Error;
use featherbench_dynamics::integrate::{DormandPrince, Dynamics, IntegrationError, Integrator, Passive, Statistics, Tolerance};
use featherbench_model::{Axis, JointKind, Model, Topology, difference};
use featherbench_robots::StateBatch;
use wide::f64x4;

fn quadruped() -> (Model<f64>, StateBatch) {
    let model = generated("quadruped");
    let states = StateBatch::random(&model, 4, 8);
    (model, states)
}

fn slider() -> Topology {
    Topology::new(&[(None, JointKind::Prismatic(Axis::Z))]).unwrap()
}

fn run(model: &Model<f64>, states: &StateBatch, [from, to]: [f64; 2], at: f64) -> (Vec<f64>, Vec<f64>, Statistics, Vec<f64>) {
    let (mut q, mut v, mut steps) = (states.q(0).to_vec(), states.v(0).to_vec(), Vec::new());
    let tolerance = Tolerance { absolute: at, relative: at, ..Tolerance::default() };
    let mut f = Dynamics::new(model, Passive, &[]).unwrap();
    let mut integrator = DormandPrince::new(&model.topology);
    let statistics = integrator.run(&mut f, [from, to], &mut q, &mut v, &tolerance, |h, _, _| steps.push(h)).unwrap();
    (q, v, statistics, steps)
}

#[test]
fn the_error_follows_the_tolerance() {
    let (model, states) = quadruped();
    let (q, v, _, _) = run(&model, &states, [0.0, 0.5], 1e-13);
    let mut before = f64::INFINITY;
    for at in [1e-5, 1e-7, 1e-9, 1e-11] {
        let (found_q, found_v, statistics, steps) = run(&model, &states, [0.0, 0.5], at);
        let error = larger(largest(&difference(&model.topology, &q, &found_q).unwrap()), distance(&found_v, &v));
        // The estimate is that of order 4, and the step has order 5: the sum over all steps stays below one step's tolerance.
        within(&format!("tolerance {at:e}"), error, at);
        assert!(error < before / 10.0, "{error:e} after {before:e}");
        before = error;

        assert_eq!(statistics.accepted, steps.len());
        assert_eq!(statistics.evaluations, 6 * (statistics.accepted + statistics.rejected) + 1, "the last stage is the next one's first");
        within("the steps fill the time", (steps.iter().sum::<f64>() - 0.5).abs(), 1e-14);
        let (shortest, longest) = steps[..steps.len() - 1]
            .iter()
            .fold((f64::INFINITY, 0.0), |(s, l): (f64, f64), &h| (if h < s { h } else { s }, if h > l { h } else { l }));
        assert_eq!(statistics.shortest, shortest);
        assert!(statistics.longest >= longest);

        // The accepted steps as fixed ones give the same state.
        let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
        let (mut again_q, mut again_v, mut t) = (states.q(0).to_vec(), states.v(0).to_vec(), 0.0);
        let mut integrator = DormandPrince::new(&model.topology);
        for h in steps {
            integrator.step(&mut f, t, h, &mut again_q, &mut again_v).unwrap();
            t += h;
        }
        // The last stage and the end of a step are sums in another order.
        within("fixed steps", larger(distance(&again_q, &found_q), distance(&again_v, &found_v)), 1e-14);
    }
}

#[test]
fn it_goes_back_in_time() {
    let (model, mut states) = quadruped();
    let (q, v, _, _) = run(&model, &states, [0.0, 0.5], 1e-11);
    let start = states.clone();
    states.q[..q.len()].copy_from_slice(&q);
    states.v[..v.len()].copy_from_slice(&v);
    let (back_q, back_v, _, steps) = run(&model, &states, [0.5, 0.0], 1e-11);
    assert!(steps.iter().all(|h| *h < 0.0));
    within("back", larger(largest(&difference(&model.topology, start.q(0), &back_q).unwrap()), distance(&back_v, start.v(0))), 2e-11);
}

/// Four states in a register take the steps of the worst, and are as accurate.
#[test]
fn lanes_go_together() {
    let (model, states) = quadruped();
    let lanes = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64x4> {
        let rows: Vec<_> = (0..4).map(of).collect();
        (0..rows[0].len()).map(|k| f64x4::new(std::array::from_fn(|lane| rows[lane][k]))).collect()
    };
    let (mut q, mut v) = (lanes(&|k| states.q(k).to_vec()), lanes(&|k| states.v(k).to_vec()));
    let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
    let tolerance = Tolerance { absolute: 1e-9, relative: 1e-9, ..Tolerance::default() };
    let (zero, end) = (f64x4::splat(0.0), f64x4::splat(0.3));
    DormandPrince::new(&model.topology).run(&mut f, [zero, end], &mut q, &mut v, &tolerance, |_, _, _| ()).unwrap();
    let (alone_q, alone_v, _, _) = run(&model, &states, [0.0, 0.3], 1e-12);
    let first = |x: &[f64x4]| x.iter().map(|x| x.to_array()[0]).collect::<Vec<_>>();
    let error = larger(largest(&difference(&model.topology, &alone_q, &first(&q)).unwrap()), distance(&first(&v), &alone_v));
    within("lane 0", error, 1e-9);
}

/// Writes the acceleration at a time, a configuration and a velocity.
type Acceleration<'a> = dyn FnMut(f64, &[f64], &[f64], &mut [f64]) -> Result<(), Error> + 'a;

#[test]
fn what_cannot_be_integrated_is_an_error() {
    let slider = slider();
    let mut integrator = DormandPrince::new(&slider);
    let mut go = |f: &mut Acceleration, tolerance: &Tolerance, start: f64| {
        let (mut q, mut v) = ([start], [0.0]);
        let mut f = |t: f64, q: &[f64], v: &[f64], a: &mut [f64]| f(t, q, v, a);
        (integrator.run(&mut f, [0.0, 2.0], &mut q, &mut v, tolerance, |_, _, _| ()), q, v)
    };
    // q̈ = 6 q², q = 1/(1 − t)²-like: infinite in finite time.
    let mut blow_up = |_: f64, q: &[f64], _: &[f64], a: &mut [f64]| {
        a[0] = 6.0 * q[0] * q[0];
        Ok(())
    };
    let (result, q, _) = go(&mut blow_up, &Tolerance::default(), 1.0);
    let error = result.unwrap_err();
    assert!(matches!(error, IntegrationError::StepTooSmall { time, .. } if time > 0.5 && time < 2.0), "{error}");
    assert!(q[0] > 1e6 && q[0].is_finite(), "the state is the last one accepted: {}", q[0]);

    let (result, ..) = go(&mut blow_up, &Tolerance { steps: 5, ..Tolerance::default() }, 1.0);
    assert!(matches!(result, Err(IntegrationError::TooManySteps { steps: 5, .. })));

    let mut lost = |_: f64, _: &[f64], _: &[f64], a: &mut [f64]| {
        a[0] = f64::NAN;
        Ok(())
    };
    assert_eq!(go(&mut lost, &Tolerance::default(), 1.0).0, Err(IntegrationError::NotFinite { time: 0.0 }));
    assert_eq!(go(&mut blow_up, &Tolerance::default(), f64::NAN).0, Err(IntegrationError::NotFinite { time: 0.0 }));
    let none = Tolerance { absolute: f64::NAN, ..Tolerance::default() };
    assert!(matches!(go(&mut blow_up, &none, 1.0).0, Err(IntegrationError::StepTooSmall { .. })));

    // An acceleration that is not a number later on is met with shorter steps, and then reported.
    let mut ends = |t: f64, _: &[f64], _: &[f64], a: &mut [f64]| {
        a[0] = (1.0 - t).sqrt();
        Ok(())
    };
    let (result, ..) = go(&mut ends, &Tolerance::default(), 1.0);
    assert!(matches!(result, Err(IntegrationError::StepTooSmall { time, .. }) if (time - 1.0).abs() < 1e-6), "{result:?}");

    // A longest step is kept, and a rejection is counted.
    let mut kick = |t: f64, _: &[f64], _: &[f64], a: &mut [f64]| {
        a[0] = if t < 1.0 { 0.0 } else { 1.0 };
        Ok(())
    };
    let (result, q, _) = go(&mut kick, &Tolerance { longest_step: 0.3, ..Tolerance::default() }, 0.0);
    let statistics = result.unwrap();
    assert!(statistics.longest <= 0.3 * (1.0 + 1e-3) && statistics.rejected > 0, "{statistics:?}");
    within("½ (t − 1)²", (q[0] - 0.5).abs(), 1e-7);
}
