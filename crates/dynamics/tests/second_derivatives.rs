//! Weighted second derivatives against nested duals through the plain recursions.

use crate::common;

use common::{constant, flow, larger, robots, unit, within, wrenches};
use featherbench_dynamics::{IdHessian, IdSecondPartials, Rnea};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Dual, Force, Real};
use nalgebra::DMatrix;

/// Moves in one direction, and in another one after it.
type Nested = Dual<Dual<f64>>;

/// A vector that moves first along `inner`, then along `outer`, if at all.
fn moving(values: &[f64], outer: Option<usize>, inner: Option<usize>) -> Vec<Nested> {
    let along = |direction: Option<usize>, k: usize| if direction == Some(k) { 1.0 } else { 0.0 };
    let number = |(k, &x): (usize, &f64)| Dual::new(Dual::new(x, along(inner, k)), Dual::constant(along(outer, k)));
    values.iter().enumerate().map(number).collect()
}

/// The same of a configuration: the derivative by `outer` is taken first, and its derivative by `inner` then.
fn configuration(model: &Model<f64>, q: &[f64], outer: Option<usize>, inner: Option<usize>) -> Vec<Nested> {
    let n = model.topology.nv();
    let still = vec![0.0; n];
    let q = inner.map_or_else(|| flow(model, q, &still), |k| flow(model, q, &unit(n, k)));
    let still: Vec<Dual<f64>> = constant(&still);
    outer.map_or_else(|| flow(model, &q, &still), |j| flow(model, &q, &unit(n, j)))
}

/// The second derivatives of `evaluate`, for directions j of the first argument and k of the second.
fn second(n: usize, evaluate: impl Fn(usize, usize) -> Nested) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |j, k| evaluate(j, k).derivative.derivative)
}

/// The largest difference over the largest entry.
fn relative(truth: &DMatrix<f64>, found: &DMatrix<f64>) -> f64 {
    let over = |m: &DMatrix<f64>| m.iter().map(|x| x.abs()).fold(0.0, larger);
    let error = over(&(truth - found));
    if error == 0.0 { 0.0 } else { error / over(truth) }
}

/// States of few dofs are enough: n² evaluations of nested duals for each matrix.
fn each_state(mut check: impl FnMut(&str, &Model<f64>, [&[f64]; 4], &[Force<f64>])) {
    for (name, model) in &robots() {
        let states = StateBatch::agreement(model, if model.topology.nv() > 30 { 1 } else { 4 }, 3);
        for k in 0..states.count() {
            let label = format!("{name}, state {k} ({})", states.cases[k].name());
            check(&label, model, [states.q(k), states.v(k), states.a(k), states.tau(k)], &wrenches(model, k as u64));
        }
    }
}

#[test]
fn second_derivatives_of_inverse_dynamics_are_those_of_nested_duals() {
    each_state(|name, model, [q, v, a, weights], f| {
        let n = v.len();
        let lifted: Vec<Force<Nested>> = f.iter().map(|f| f.lift()).collect();
        let weighted = |q: &[Nested], v: &[Nested], a: &[Nested]| {
            let mut tau = vec![Nested::zero(); n];
            Rnea::new(&model.topology).run(model, q, v, a, Some(&lifted), &mut tau).unwrap();
            tau.iter().zip(weights).fold(Nested::zero(), |sum, (tau, &weight)| tau.mul_add(Nested::from_f64(weight), sum))
        };
        let (still_q, still_v, still_a) = (configuration(model, q, None, None), moving(v, None, None), moving(a, None, None));
        let mut found = IdSecondPartials::new(&model.topology);
        IdHessian::new(&model.topology).run(model, q, v, a, Some(f), weights, &mut found).unwrap();

        let truth = second(n, |j, k| weighted(&configuration(model, q, Some(j), Some(k)), &still_v, &still_a));
        // What issue 14 asks of first derivatives.
        within(&format!("{name}: (q,q)"), relative(&truth, &found.qq.to_dense()), 1e-12);
        let truth = second(n, |j, k| weighted(&still_q, &moving(v, Some(j), Some(k)), &still_a));
        within(&format!("{name}: (v,v)"), relative(&truth, &found.vv.to_dense()), 1e-12);
        let truth = second(n, |j, k| weighted(&configuration(model, q, Some(j), None), &moving(v, None, Some(k)), &still_a));
        within(&format!("{name}: (q,v)"), relative(&truth, &found.qv.to_dense()), 1e-12);
        let truth = second(n, |j, k| weighted(&configuration(model, q, Some(j), None), &still_v, &moving(a, None, Some(k))));
        within(&format!("{name}: (q,a)"), relative(&truth, &found.qa.to_dense()), 1e-12);

        // Symmetric, but within quaternion joints.
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let one_joint = model.topology.joints().iter().any(|joint| (joint.v..joint.v + joint.kind.nv()).contains(&i) && j >= joint.v);
            assert!(one_joint || found.qq.get(i, j) == found.qq.get(j, i), "{name}: ({i}, {j})");
        }
    });
}
