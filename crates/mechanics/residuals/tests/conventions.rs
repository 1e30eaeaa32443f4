//! The sign, and what no residual must leave as it is.

use crate::support::{apart, arm, draw, lesson, robots, state};
use featherbench_dynamics::{forward_dynamics, inverse_dynamics};
use featherbench_model::Model;
use featherbench_residuals::{Corrected, Linear, Residual, Rigid, State, Sum, Viscous, Zero};
use featherbench_robots::Random;

/// §1, §2 and §7 of the lesson on its arm: the true second rod has 1.2 kg, the nominal one 1.
///
/// r = ID⋆ − ÎD. Then τ = ÎD + r, and the lesson's d of §1 is −r. The lesson's code of §7 has τ = ÎD − r, and is wrong by 2r.
#[test]
fn true_is_nominal_plus_r() {
    let nominal = Model::build(&lesson()).unwrap();
    let truth: Model<f64> = Model::build(&arm([2.0, 1.2], [1.0, 0.5])).unwrap();
    let (q, v, tau) = ([0.3, -0.5], [0.7, 0.4], [1.0, -0.5]);
    let a = forward_dynamics(&truth, &q, &v, &tau).unwrap();
    assert!(apart(&a, &[8.84002504, -42.25566338]) < 1e-9, "{a:?}"); // printed with ten digits
    let known = inverse_dynamics(&nominal, &q, &v, &a).unwrap();
    let r: Vec<f64> = tau.iter().zip(&known).map(|(tau, known)| tau - known).collect();
    assert!(apart(&r, &[-0.3323828, -0.0833333]) < 1e-6, "{r:?}"); // seven digits
    // A constant residual of that size, by the parameters of the regressor's ones.
    let constant = Linear::new(2, 2, [[0.0; 6].as_slice(), &[r[0]], &[0.0; 6], &[r[1]]].concat()).unwrap();
    let mut corrected = Corrected::new(Rigid::new(&nominal), constant).unwrap();
    assert!(apart(&corrected.inverse(&q, &v, &a).unwrap(), &tau) < 1e-14);
    assert!(apart(&corrected.forward(&q, &v, &tau).unwrap(), &a) < 1e-13);
    let wrong: Vec<f64> = known.iter().zip(&r).map(|(known, r)| known - r).collect();
    assert!(apart(&wrong, &[1.6647656, -0.3333333]) < 1e-6, "{wrong:?}");
    // M a + h = τ + d with d = −r.
    let right: Vec<f64> = tau.iter().zip(&r).map(|(tau, r)| tau - r).collect();
    assert!(apart(&known, &right) < 1e-14);
}

/// A residual that is none changes no bit, whether it depends on the acceleration by its kind or not.
#[test]
fn zero_changes_no_bit() {
    let mut cases = 0;
    for description in robots() {
        let model = Model::build(&description).unwrap();
        let (nq, nv) = (model.topology.nq(), model.topology.nv());
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let zeros: Vec<Box<dyn Residual>> = vec![
            Box::new(Zero::new(nv)),
            Box::new(Viscous::new(vec![0.0; nv]).unwrap()),
            Box::new(Linear::new(nq, nv, vec![0.0; Linear::parameters(nq, nv)]).unwrap()),
            Box::new(Sum::new(nv, vec![Box::new(Zero::new(nv)), Box::new(Viscous::new(vec![0.0; nv]).unwrap())]).unwrap()),
        ];
        for zero in zeros {
            let mut corrected = Corrected::new(Rigid::new(&model), zero).unwrap();
            let mut random = Random::named(1, "zero residual");
            for still in [false, true] {
                let [q, mut v, mut x] = state(&mut random, &model);
                if still {
                    // Zeros of both signs: −0 + 0 would be +0.
                    v.fill(-0.0);
                    x.fill(-0.0);
                }
                let tau = inverse_dynamics(&model, &q, &v, &x).unwrap();
                assert_eq!(bits(&corrected.inverse(&q, &v, &x).unwrap()), bits(&tau));
                let a = forward_dynamics(&model, &q, &v, &x).unwrap();
                assert_eq!(bits(&corrected.forward(&q, &v, &x).unwrap()), bits(&a));
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 32);
}

/// Forward undoes inverse dynamics, for sums with and without a part that depends on the acceleration.
#[test]
fn forward_undoes_inverse() {
    for description in robots() {
        let model = Model::build(&description).unwrap();
        let (nq, nv) = (model.topology.nq(), model.topology.nv());
        let mut random = Random::named(2, "forward and inverse");
        let mut theta: Vec<f64> = draw(&mut random, Linear::parameters(nq, nv));
        // A part of the acceleration that is small beside any M of these robots: W stays regular.
        let p = nq + 2 * nv + 1;
        theta.iter_mut().enumerate().filter(|(k, _)| (nq + nv..nq + 2 * nv).contains(&(k % p))).for_each(|(_, x)| *x *= 1e-4);
        let parts: Vec<Box<dyn Residual>> =
            vec![Box::new(Viscous::new(vec![0.3; nv]).unwrap()), Box::new(Linear::new(nq, nv, theta).unwrap())];
        let mut corrected = Corrected::new(Rigid::new(&model), Sum::new(nv, parts).unwrap()).unwrap();
        for _ in 0..5 {
            let [q, v, a] = state(&mut random, &model);
            let posed = corrected.well_posed(&State::new(&q, &v, &a)).unwrap();
            let tau = corrected.inverse(&q, &v, &a).unwrap();
            let again = corrected.forward(&q, &v, &tau).unwrap();
            // Rounding errors grow by the condition, and a₀ = FD(τ) by the size of r beside M.
            let most = 1e-12 / posed.reciprocal_condition;
            assert!(apart(&again, &a) < most, "{}: {} of {most}", description.name, apart(&again, &a));
        }
    }
}

/// The sum is the sum, in values and derivatives.
#[test]
fn sums_add() {
    let model = Model::build(&lesson()).unwrap();
    let mut random = Random::named(3, "sums");
    let theta = [draw(&mut random, 14), draw(&mut random, 14)];
    let of = |theta: &Vec<f64>| Linear::new(2, 2, theta.clone()).unwrap();
    let both = Linear::new(2, 2, theta[0].iter().zip(&theta[1]).map(|(a, b)| a + b).collect()).unwrap();
    let sum = Sum::new(2, vec![Box::new(of(&theta[0])), Box::new(of(&theta[1]))]).unwrap();
    let [q, v, a] = state(&mut random, &model);
    let state = State::new(&q, &v, &a);
    assert!(apart(&sum.value(&state).unwrap(), &both.value(&state).unwrap()) < 1e-14);
    assert!((sum.by_acceleration(&state).unwrap() - both.by_acceleration(&state).unwrap()).amax() < 1e-15);
}
