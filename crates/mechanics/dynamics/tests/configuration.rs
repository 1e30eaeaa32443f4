//! Configuration spaces of whole robots: group laws, differences, and Jacobians against dual numbers.

use crate::common;

use common::{ROBOTS, build, distance, larger, largest, lifted, with_rate, within};
use featherbench_model::{Model, TangentMap, Topology, d_difference, d_integrate, difference, integrate, interpolate, neutral};
use featherbench_robots::{Random, StateBatch, random_configuration};
use featherbench_spatial::{DoubleDouble, Dual, Quaternion, Real};

/// A dozen roundings of numbers up to ten: positions, angles and what rotations make of them.
const FEW_ROUNDINGS: f64 = 128.0 * f64::EPSILON;

/// Two configurations and a velocity of each robot, in each state.
fn each(mut check: impl FnMut(&str, &Topology, &[f64], &[f64], &[f64], &[f64])) {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 6, 5);
        for k in 0..5 {
            check(&format!("{name}, state {k}"), &model.topology, states.q(k), states.q(k + 1), states.v(k), states.a(k));
        }
    }
}

/// The largest difference of two configurations: numbers, and rotations in place of quaternions.
fn apart(topology: &Topology, a: &[f64], b: &[f64]) -> f64 {
    let quaternions: Vec<usize> = topology.quaternions().collect();
    let mut gap = 0.0;
    let mut plain = vec![true; a.len()];
    for &at in &quaternions {
        let rotation = |q: &[f64]| Quaternion::from_array([q[at], q[at + 1], q[at + 2], q[at + 3]]).to_rotation().to_array();
        gap = larger(gap, distance(&rotation(a), &rotation(b)));
        plain[at..at + 4].fill(false);
    }
    (0..a.len()).filter(|k| plain[*k]).fold(gap, |gap, k| larger(gap, (a[k] - b[k]).abs()))
}

#[test]
fn difference_leads_from_one_to_the_other() {
    each(|name, t, q, p, v, _| {
        let way = difference(t, q, p).unwrap();
        within(&format!("{name}: q ⊕ (p ⊖ q)"), apart(t, &integrate(t, q, &way).unwrap(), p), FEW_ROUNDINGS);
        // |v| < √3 < π: the way itself.
        let back = difference(t, q, &integrate(t, q, v).unwrap()).unwrap();
        within(&format!("{name}: (q ⊕ v) ⊖ q"), distance(&back, v), FEW_ROUNDINGS);
        within(&format!("{name}: p ⊖ p"), largest(&difference(t, p, p).unwrap()), FEW_ROUNDINGS);
        // −q is the same rotation.
        let mut minus = p.to_vec();
        t.quaternions().for_each(|at| minus[at..at + 4].iter_mut().for_each(|x| *x = -*x));
        within(&format!("{name}: −p ⊖ q"), distance(&difference(t, q, &minus).unwrap(), &way), FEW_ROUNDINGS);
        let backward = difference(t, p, q).unwrap();
        within(&format!("{name}: q ⊖ p = −(p ⊖ q)"), distance(&backward, &way.iter().map(|x| -x).collect::<Vec<_>>()), FEW_ROUNDINGS);
        let length = t.distance(q, p).unwrap();
        within(&format!("{name}: distance"), (length - way.iter().map(|x| x * x).sum::<f64>().sqrt()).abs(), FEW_ROUNDINGS);
    });
}

#[test]
fn steps_along_one_velocity_add() {
    each(|name, t, q, p, v, _| {
        let times = |s: f64| v.iter().map(|v| v * s).collect::<Vec<_>>();
        let twice = integrate(t, &integrate(t, q, &times(0.3)).unwrap(), &times(0.7)).unwrap();
        within(&format!("{name}: two steps"), apart(t, &twice, &integrate(t, q, v).unwrap()), FEW_ROUNDINGS);
        let back = integrate(t, &integrate(t, q, v).unwrap(), &times(-1.0)).unwrap();
        within(&format!("{name}: there and back"), apart(t, &back, q), FEW_ROUNDINGS);
        for (part, expected) in [(0.0, q), (1.0, p)] {
            within(&format!("{name}: interpolation at {part}"), apart(t, &interpolate(t, q, p, part).unwrap(), expected), FEW_ROUNDINGS);
        }
        let middle = interpolate(t, q, p, 0.5).unwrap();
        let (first, second) = (difference(t, q, &middle).unwrap(), difference(t, &middle, p).unwrap());
        within(&format!("{name}: half-way"), distance(&first, &second), FEW_ROUNDINGS);
    });
}

/// The matrix whose columns are these derivatives, row after row.
fn by_columns(n: usize, column: impl Fn(usize) -> Vec<f64>) -> Vec<f64> {
    let columns: Vec<_> = (0..n).map(column).collect();
    (0..n * n).map(|k| columns[k % n][k / n]).collect()
}

fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|j| if j == k { 1.0 } else { 0.0 }).collect()
}

fn derivative(duals: &[Dual<f64>]) -> Vec<f64> {
    duals.iter().map(|x| x.derivative).collect()
}

#[test]
fn jacobians_are_those_of_duals() {
    each(|name, t, q, p, v, a| {
        let n = t.nv();
        let still = |x: &[f64]| with_rate(x, &vec![0.0; x.len()]);
        let along = |x: &[f64], k: usize| with_rate(x, &unit(n, k));
        let moved = |q: &[f64], k: usize| integrate(t, &still(q), &along(&vec![0.0; n], k)).unwrap();

        // As seen from the result.
        let end = integrate(t, q, v).unwrap();
        let seen = |moving: Vec<Dual<f64>>| derivative(&difference(t, &still(&end), &moving).unwrap());
        let [by_q, by_v] = d_integrate(t, v).unwrap();
        let expected = by_columns(n, |k| seen(integrate(t, &moved(q, k), &still(v)).unwrap()));
        within(&format!("{name}: ∂(q ⊕ v)/∂q"), distance(&by_q.to_dense(), &expected), 1e-13);
        let expected = by_columns(n, |k| seen(integrate(t, &still(q), &along(v, k)).unwrap()));
        within(&format!("{name}: ∂(q ⊕ v)/∂v"), distance(&by_v.to_dense(), &expected), 1e-13);

        // Jacobians of the difference grow like 1/(2π − θ), here up to one.
        let [by_from, by_to] = d_difference(t, q, p).unwrap();
        let expected = by_columns(n, |k| derivative(&difference(t, &moved(q, k), &still(p)).unwrap()));
        within(&format!("{name}: ∂(p ⊖ q)/∂q"), distance(&by_from.to_dense(), &expected), 1e-13);
        let expected = by_columns(n, |k| derivative(&difference(t, &still(q), &moved(p, k)).unwrap()));
        within(&format!("{name}: ∂(p ⊖ q)/∂p"), distance(&by_to.to_dense(), &expected), 1e-13);

        // The rate of a step, and its derivative.
        let mut rate = vec![0.0; n];
        t.step_rate(v, a, &mut rate).unwrap();
        let moving = integrate(t, &still(q), &with_rate(v, &rate)).unwrap();
        within(&format!("{name}: q ⊕ ξ moves with v"), distance(&seen(moving), a), 1e-13);
        let mut map = TangentMap::new(t);
        map.d_step_rate(v, a).unwrap();
        let expected = by_columns(n, |k| {
            let mut rate = still(&rate);
            t.step_rate(&along(v, k), &still(a), &mut rate).unwrap();
            derivative(&rate)
        });
        within(&format!("{name}: derivative of the rate"), distance(&map.to_dense(), &expected), 1e-13);
    });
}

#[test]
fn tangent_maps_are_each_others_inverses_and_adjoints() {
    each(|name, t, q, p, v, a| {
        let n = t.nv();
        let product = |map: &TangentMap<f64>, x: &[f64]| {
            let mut result = vec![0.0; n];
            map.mul(x, &mut result).unwrap();
            result
        };
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let way = difference(t, q, p).unwrap();
        let ([by_q, by_v], [by_from, by_to]) = (d_integrate(t, &way).unwrap(), d_difference(t, q, p).unwrap());
        within(&format!("{name}: J⁻¹ J"), distance(&product(&by_to, &product(&by_v, v)), v), 1e-13);
        // q ⊕ (p ⊖ q) = p, whatever q: the two ways in which it depends on q cancel.
        let sum: Vec<f64> = product(&by_v, &product(&by_from, v)).iter().zip(product(&by_q, v)).map(|(a, b)| a + b).collect();
        within(&format!("{name}: ∂p/∂q = 0"), largest(&sum), 1e-13);
        for map in [&by_q, &by_v, &by_from, &by_to] {
            let mut back = vec![0.0; n];
            map.transpose_mul(a, &mut back).unwrap();
            within(&format!("{name}: x·Jᵀy = Jx·y"), (dot(&back, v) - dot(&product(map, v), a)).abs() / n as f64, FEW_ROUNDINGS);
        }
        // Transport there and back.
        let minus: Vec<f64> = way.iter().map(|x| -x).collect();
        let [back, _] = d_integrate(t, &minus).unwrap();
        within(&format!("{name}: transport back"), distance(&product(&back, &product(&by_q, a)), a), FEW_ROUNDINGS);
        let dense = by_q.to_dense();
        let blocks: usize = (0..t.bodies()).map(|joint| by_q.block(joint).len()).sum();
        assert!(dense.iter().filter(|x| **x != 0.0).count() <= blocks, "{name}: block-diagonal");
    });
}

/// The same robot with 32 digits: the laws hold to 1e-29, and doubles are right to a dozen roundings.
#[test]
fn doubles_are_right_to_a_few_roundings() {
    each(|name, t, q, p, v, _| {
        let (wide_q, wide_p): (Vec<DoubleDouble>, Vec<DoubleDouble>) = (lifted(q), lifted(p));
        let truth = difference(t, &wide_q, &wide_p).unwrap();
        let found = difference(t, q, p).unwrap();
        let gap = found.iter().zip(&truth).fold(0.0, |gap, (found, truth)| larger(gap, (found - truth.to_f64()).abs()));
        within(&format!("{name}: p ⊖ q"), gap, FEW_ROUNDINGS);
        let end = integrate(t, &wide_q, &lifted(v)).unwrap();
        let rounded: Vec<f64> = end.iter().map(|x| x.to_f64()).collect();
        within(&format!("{name}: q ⊕ v"), distance(&integrate(t, q, v).unwrap(), &rounded), FEW_ROUNDINGS);
        let again = integrate(t, &wide_q, &truth).unwrap();
        let back = difference(t, &again, &wide_p).unwrap();
        within(&format!("{name}: 32 digits"), back.iter().fold(0.0, |gap, x| larger(gap, x.to_f64().abs())), 1e-28);
    });
}

#[test]
fn neutral_normal_and_random_configurations() {
    for (name, recipe) in &ROBOTS {
        let model: Model<f64> = build(recipe);
        let t = &model.topology;
        let origin: Vec<f64> = neutral(t);
        let mut again = vec![7.0; t.nq()];
        t.neutral(&mut again).unwrap();
        assert_eq!(origin, again);
        let q = random_configuration(&model, &mut Random::new(3, 1));
        let mut unit = q.clone();
        t.normalise(&mut unit).unwrap();
        within(&format!("{name}: length one"), distance(&unit, &q), 2.0 * f64::EPSILON);
        let long: Vec<f64> = q.iter().map(|x| 3.0 * x).collect();
        t.normalise(&mut unit).unwrap();
        let mut shortened = long.clone();
        t.normalise(&mut shortened).unwrap();
        for at in t.quaternions() {
            within(&format!("{name}: normalised"), distance(&shortened[at..at + 4], &q[at..at + 4]), 4.0 * f64::EPSILON);
        }
    }
}

#[test]
fn slices_of_another_size_are_errors() {
    let model = build(&ROBOTS[7].1);
    let t = &model.topology;
    let (q, v) = (neutral::<f64>(t), vec![0.0; t.nv()]);
    assert!(integrate(t, &q[1..], &v).is_err() && integrate(t, &q, &v[1..]).is_err());
    assert!(difference(t, &q[1..], &q).is_err() && difference(t, &q, &q[1..]).is_err());
    assert!(t.integrate(&q, &v, &mut [0.0]).is_err() && t.difference(&q, &q, &mut [0.0]).is_err());
    assert!(t.neutral::<f64>(&mut [0.0]).is_err() && t.normalise(&mut [f64::one()]).is_err());
    assert!(t.distance(&q, &q[1..]).is_err() && interpolate(t, &q, &q[1..], 0.5).is_err());
    let mut map = TangentMap::new(t);
    assert!(map.d_integrate_q(&v[1..]).is_err() && map.d_step_rate(&v, &v[1..]).is_err());
    assert!(map.mul(&v[1..], &mut v.clone()).is_err() && map.transpose_mul(&v, &mut [0.0]).is_err());
}
