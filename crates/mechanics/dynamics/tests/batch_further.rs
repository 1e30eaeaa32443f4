//! Motion, the inverse of M and derivatives in batches against single states: every robot, both orders, both precisions, samples.

use crate::common;

use common::batched::{Asked, Outcome, Quantity::*, States, bits, further, in_lanes, in_rows, one_by_one, relative};
use common::{ROBOTS, build, robot, within};
use featherbench_dynamics::{Batch, BatchError, Number};
use featherbench_model::Model;

/// One more than a group of eight, so that the last group has copies.
const COUNT: usize = 9;

const ASKED: [Asked; 8] = [
    (Motion, false),
    (Jacobian, false),
    (Momentum, false),
    (InverseMassMatrix, false),
    (IdDerivatives, true),
    (FdDerivatives, true),
    (Coriolis, false),
    (Regressor, false),
];

/// Relative to the largest entry of all states: other sines and cosines, and where M is inverted its condition of up to 1e3.
fn are_those_of_single_states<'m, S: Number>(
    name: &str,
    outcome: &Outcome<S>,
    model: impl Fn(usize) -> &'m Model<f64>,
    states: &States<f64>,
    epsilons: f64,
) {
    for (asked, done, found) in outcome {
        assert_eq!(done, &Ok(()), "{name}: {asked:?}");
        let truth = one_by_one(states, &model(0).topology, |k| further(model(k), states, k, *asked));
        let tolerance = if matches!(asked.0, InverseMassMatrix | FdDerivatives) { 1e-12 } else { 1e-14 };
        within(&format!("{name}: {asked:?}"), relative(found.len(), found, &truth), epsilons * tolerance);
    }
}

#[test]
fn lanes_are_as_single_states() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = States::random(&model, COUNT);
        let outcome = in_rows(&mut Batch::<f64>::new(&model), &model, &ASKED, &states);
        are_those_of_single_states(name, &outcome, |_| &model, &states, 1.0);
        let lanes = in_lanes(&mut Batch::<f64>::new(&model).on_all_cores(), &model, &ASKED, &states);
        assert_eq!(bits(&outcome), bits(&lanes), "{name}: lane order on all cores");
    }
}

#[test]
fn singles_are_as_doubles() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let single = model.lift::<f32>();
        let asked = ASKED.map(|(quantity, _)| (quantity, false));
        let outcome = in_rows(&mut Batch::<f32>::new(&single), &single, &asked, &States::random(&model, COUNT));
        // ε is 5e8 times larger.
        are_those_of_single_states(name, &outcome, |_| &model, &States::random(&model, COUNT), 5e8);
    }
}

#[test]
fn each_sample_of_the_parameters_has_its_state() {
    let recipe = &ROBOTS[6].1;
    let samples: Vec<Model<f64>> = (0..COUNT as u64).map(|seed| Model::build(&robot(recipe, seed)).unwrap()).collect();
    let states = States::random(&samples[0], COUNT);
    let outcome = in_rows(&mut Batch::of_samples(&samples).unwrap(), &samples[0], &ASKED, &states);
    are_those_of_single_states("samples", &outcome, |k| &samples[k], &states, 1.0);
}

#[test]
fn what_a_batch_cannot_compute_is_named() {
    let model = build(&ROBOTS[6].1);
    let states = States::<f64>::random(&model, 2);
    let mut batch = Batch::<f64>::new(&model);
    let bodies = model.topology.bodies();
    let refused = batch.body_jacobian(&states.q, bodies, &mut vec![0.0; 12 * model.topology.nv()]).unwrap_err();
    assert!(matches!(&refused, BatchError::Dimension(error) if error.what.contains("bodies")), "{refused}");
    // Axes with other names: rotations and regressors, which are in described axes, are refused.
    let mixed = [common::dyadic_chain(&[[0.0, 1.0, 0.0]], 2), common::dyadic_chain(&[[1.0, 0.0, 0.0]], 2)];
    let mut batch = Batch::of_samples(&mixed).unwrap();
    let zeros = vec![0.0; 4];
    let motion = batch.kinematics(&zeros, &zeros, &zeros, &mut vec![0.0; 96]);
    let regressor = batch.torque_regressor(&zeros, &zeros, &zeros, &mut vec![0.0; 60]);
    for refused in [motion, regressor] {
        assert!(refused.unwrap_err().to_string().contains("joint axis"));
    }
    // A configuration that is no number harms no other state.
    let mut q = states.q.clone();
    q[0] = f64::NAN;
    let mut momenta = vec![0.0; 12];
    let failed = Batch::<f64>::new(&model).momentum(&q, &states.v, &mut momenta).unwrap_err();
    assert!(matches!(&failed, BatchError::Failed { failures, .. } if failures.len() == 1 && failures[0].state == 0), "{failed}");
    assert!(momenta[..6].iter().all(|x| x.is_nan()) && momenta[6..].iter().all(|x| x.is_finite()));
}
