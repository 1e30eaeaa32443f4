//! Dry friction: intervals at rest, and forward dynamics by enumeration of all cases.

use crate::support::{apart, cart, draw, lesson, robots, state};
use featherbench_dynamics::inverse_dynamics;
use featherbench_model::Model;
use featherbench_residuals::{Corrected, DryFriction, Nominal, Residual, ResidualError, Rigid, State, Viscous};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

/// A box on a plane: it sticks up to F, and beyond that the rest accelerates it.
#[test]
fn a_box_sticks_and_slides() {
    let model = cart(2.0);
    let friction = DryFriction::new(vec![3.0]).unwrap();
    let mut rigid = Rigid::new(&model);
    let mut answer = |v: f64, tau: f64| friction.forward(&mut rigid, &[0.0], &[v], &[tau]).unwrap();
    for (v, tau, a, r, sticks) in [
        (0.0, 2.0, 0.0, 2.0, true),
        (0.0, -3.0, 0.0, -3.0, true),
        (0.0, 5.0, 1.0, 3.0, false),
        (0.0, -7.0, -2.0, -3.0, false),
        (0.1, 5.0, 1.0, 3.0, false),
        (-0.1, 5.0, 4.0, -3.0, false),
        (-0.0, 2.0, 0.0, 2.0, true),
    ] {
        let found = answer(v, tau);
        assert_eq!(found.stuck.len(), usize::from(sticks), "{v} {tau}");
        // Exactly zero where it sticks; elsewhere a factor of M and its solution round.
        assert!((found.a[0] - a).abs() <= 4.0 * f64::EPSILON * a.abs(), "{v} {tau}");
        assert!((found.friction[0] - r).abs() < 4.0 * f64::EPSILON * r.abs(), "{v} {tau}");
    }
}

/// Inverse dynamics at rest is an interval; where it moves or sets off, a number.
#[test]
fn at_rest_inverse_dynamics_is_an_interval() {
    let model = Model::build(&lesson()).unwrap();
    let friction = DryFriction::new(vec![3.0, 0.5]).unwrap();
    let (q, a) = ([0.3, -0.5], [0.0, -2.0]);
    let tau = inverse_dynamics(&model, &q, &[0.0, 0.0], &a).unwrap();
    let bounds = friction.inverse(&mut Rigid::new(&model), &q, &[0.0, 0.0], &a).unwrap();
    assert_eq!(bounds, vec![[tau[0] - 3.0, tau[0] + 3.0], [tau[1] - 0.5; 2]]);
    assert_eq!(friction.interval(&[1.0, -1.0], &a).unwrap(), vec![[3.0; 2], [-0.5; 2]]);
    // As a plain residual it refuses a state without one value, and forward dynamics at rest.
    let error = friction.value(&State::new(&q, &[0.0, 0.0], &a)).unwrap_err();
    assert_eq!(error, ResidualError::Interval { dof: 0, limit: 3.0 });
    let mut corrected = Corrected::new(Rigid::new(&model), friction).unwrap();
    assert!(matches!(corrected.forward(&q, &[0.0, 0.0], &tau), Err(ResidualError::Interval { .. })));
}

/// All 3ⁿ cases, each solved, and the one that contradicts nothing.
fn enumerated(mass: &DMatrix<f64>, forces: &DVector<f64>, limits: &[f64]) -> Option<DVector<f64>> {
    let n = limits.len();
    (0..3_usize.pow(n as u32)).find_map(|number| {
        let sign = |k: usize| [0.0, 1.0, -1.0][number / 3_usize.pow(k as u32) % 3];
        let moving: Vec<usize> = (0..n).filter(|&k| sign(k) != 0.0).collect();
        let block = DMatrix::from_fn(moving.len(), moving.len(), |i, j| mass[(moving[i], moving[j])]);
        let right = DVector::from_fn(moving.len(), |i, _| forces[moving[i]] - sign(moving[i]) * limits[moving[i]]);
        let some = block.cholesky()?.solve(&right);
        let mut a = DVector::zeros(n);
        moving.iter().zip(&some).for_each(|(&k, &x)| a[k] = x);
        let r = forces - mass * &a;
        let holds = (0..n).all(|k| if sign(k) == 0.0 { r[k].abs() <= limits[k] } else { a[k] * sign(k) > 0.0 });
        holds.then_some(a)
    })
}

/// Forward dynamics at rest is the case that enumeration finds; the drawn forces make dofs stick and set off.
#[test]
fn sticking_is_as_enumerated() {
    let (mut stuck, mut free, mut cases) = (0, 0, 0);
    for description in robots().into_iter().filter(|robot| robot.nv() <= 6).chain([lesson()]) {
        let model = Model::build(&description).unwrap();
        let nv = model.topology.nv();
        let mut random = Random::named(6, "sticking");
        for _ in 0..12 {
            let [q, _, _] = state(&mut random, &model);
            let limits: Vec<f64> = (0..nv).map(|_| random.uniform(0.1, 4.0)).collect();
            let push: Vec<f64> = draw(&mut random, nv).iter().map(|x| 3.0 * x).collect();
            let still = vec![0.0; nv];
            let held = inverse_dynamics(&model, &q, &still, &still).unwrap();
            let tau: Vec<f64> = held.iter().zip(&push).map(|(held, push)| held + push).collect();
            let mut rigid = Rigid::new(&model);
            let mass = rigid.mass_matrix(&q).unwrap();
            let due = enumerated(&mass, &DVector::from_column_slice(&push), &limits).unwrap();
            let found = DryFriction::new(limits.clone()).unwrap().forward(&mut rigid, &q, &still, &tau).unwrap();
            // The drawn forces and M lose κ(M) ≤ 1e4 of these small robots.
            assert!(apart(&found.a, due.as_slice()) < 1e-10, "{}: {:?} {due}", description.name, found.a);
            assert!(found.stuck.iter().all(|&k| due[k] == 0.0) && found.stuck.len() == due.iter().filter(|x| **x == 0.0).count());
            assert!(found.friction.iter().zip(&limits).all(|(r, limit)| r.abs() <= *limit));
            (stuck, free, cases) = (stuck + found.stuck.len(), free + nv - found.stuck.len(), cases + 1);
        }
    }
    assert!(cases == 24 && stuck > 20 && free > 20, "{cases} {stuck} {free}");
}

/// A robot of many dofs: the answer obeys the laws, where enumeration would have 3¹⁸ cases.
#[test]
fn many_dofs_obey_the_laws() {
    let description = robots().into_iter().find(|robot| robot.nv() == 18).unwrap();
    let model = Model::build(&description).unwrap();
    let mut random = Random::named(7, "many dofs");
    for _ in 0..10 {
        let [q, mut v, _] = state(&mut random, &model);
        v.iter_mut().step_by(3).for_each(|v| *v = 0.0);
        let tau: Vec<f64> = draw(&mut random, 18).iter().map(|x| 20.0 * x).collect();
        let limits: Vec<f64> = (0..18).map(|_| random.uniform(0.0, 9.0)).collect();
        let viscous = Corrected::new(Rigid::new(&model), Viscous::new(vec![0.2; 18]).unwrap()).unwrap();
        let mut nominal = viscous.clone();
        let found = DryFriction::new(limits.clone()).unwrap().forward(&mut nominal, &q, &v, &tau).unwrap();
        let mut known = vec![0.0; 18];
        nominal.inverse(&q, &v, &found.a).map(|tau| known = tau).unwrap();
        for k in 0..18 {
            let r = tau[k] - known[k];
            let moves = if v[k] == 0.0 { found.a[k] } else { v[k] };
            let due = if moves == 0.0 { r.clamp(-limits[k], limits[k]) } else { limits[k] * moves.signum() };
            assert!((r - due).abs() < 1e-11 * 20.0 * 50.0, "dof {k}: {r} {due}"); // forces reach some 50 times the drawn ones
        }
    }
}
