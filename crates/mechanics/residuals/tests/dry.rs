//! Dry friction: intervals at rest, and the laws of many dofs. The enumeration of all cases is in the study `residuals`.

use crate::support::{cart, draw, lesson, robots, state};
use featherbench_dynamics::inverse_dynamics;
use featherbench_model::Model;
use featherbench_residuals::{Corrected, DryFriction, Residual, ResidualError, Rigid, State, Viscous};
use featherbench_robots::Random;

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
