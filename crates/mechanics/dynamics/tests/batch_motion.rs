//! Motion and the inverse of M in batches against single states: every robot, both orders, both precisions, samples of parameters.

use crate::common;

use common::{ROBOTS, build, distance, largest, robot, within};
use featherbench_dynamics::{
    Batch, BatchError, Number, Sharing, centroidal_momentum, forward_kinematics, jacobian, mass_matrix, to_lanes, to_rows,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;

/// One more than a group of eight, so that the last group has copies.
const COUNT: usize = 9;

const NAMES: [&str; 4] = ["kinematics", "Jacobian", "momentum", "M⁻¹"];

/// Relative to the largest entry of all states: other sines and cosines, and for the inverse of M its condition of up to 1e3.
const DOUBLE: [f64; 4] = [1e-14, 1e-14, 1e-14, 1e-12];

fn last(model: &Model<f64>) -> usize {
    model.topology.bodies() - 1
}

/// Each state, one call per state.
fn one_by_one<'m>(model: impl Fn(usize) -> &'m Model<f64>, states: &StateBatch) -> [Vec<f64>; 4] {
    let mut all: [Vec<f64>; 4] = Default::default();
    for k in 0..states.count() {
        let (model, q, v, a) = (model(k), states.q(k), states.v(k), states.a(k));
        let kinematics = forward_kinematics(model, q, v, a).unwrap();
        for motion in model.described.iter().map(|&body| kinematics.body(body).unwrap()) {
            all[0].extend(motion.placement.rotation.to_array());
            all[0].extend(motion.placement.translation.to_array());
            all[0].extend(motion.velocity.to_array());
            all[0].extend(motion.acceleration.to_array());
        }
        all[1].extend(jacobian(model, q, last(model)).unwrap().iter().flat_map(|column| column.to_array()));
        all[2].extend(centroidal_momentum(model, q, v).unwrap().momentum.to_array());
        let n = model.topology.nv();
        let mut inverse = vec![0.0; n * n];
        mass_matrix(model, q).unwrap().into_ltdl().unwrap().inverse(&mut inverse).unwrap();
        all[3].extend(inverse);
    }
    all
}

/// All four by a batch, in row order.
fn batched<S: Number, M: Sharing>(batch: &mut Batch<'_, S, M>, body: usize, states: [&[S]; 3], like: &[Vec<f64>; 4]) -> [Vec<S>; 4] {
    let [q, v, a] = states;
    let mut found = like.each_ref().map(|numbers| vec![S::from_f64(f64::NAN); numbers.len()]);
    batch.kinematics(q, v, a, &mut found[0]).unwrap();
    batch.body_jacobian(q, body, &mut found[1]).unwrap();
    batch.momentum(q, v, &mut found[2]).unwrap();
    batch.inverse_mass_matrix(q, &mut found[3]).unwrap();
    found
}

fn compare(name: &str, found: &[Vec<f64>; 4], expected: &[Vec<f64>; 4], tolerances: [f64; 4]) {
    for k in 0..4 {
        within(&format!("{name}: {}", NAMES[k]), distance(&found[k], &expected[k]) / largest(&expected[k]), tolerances[k]);
    }
}

#[test]
fn motion_in_lanes_is_that_of_single_states() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, COUNT, 5);
        let expected = one_by_one(|_| &model, &states);
        let found = batched(&mut Batch::<f64>::new(&model), last(&model), [&states.q, &states.v, &states.a], &expected);
        compare(name, &found, &expected, DOUBLE);

        // Lane order on all cores gives the same bits.
        let t = &model.topology;
        let lanes = |rows: &[f64], each| to_lanes(rows, each).unwrap();
        let (q, v, a) = (lanes(&states.q, t.nq()), lanes(&states.v, t.nv()), lanes(&states.a, t.nv()));
        let mut batch = Batch::<f64>::new(&model).on_all_cores();
        let mut out = found.each_ref().map(|rows| lanes(rows, rows.len() / COUNT));
        batch.kinematics(&q, &v, &a, &mut out[0]).unwrap();
        batch.body_jacobian(&q, last(&model), &mut out[1]).unwrap();
        batch.momentum(&q, &v, &mut out[2]).unwrap();
        batch.inverse_mass_matrix(&q, &mut out[3]).unwrap();
        for (k, out) in out.iter().enumerate() {
            assert_eq!(to_rows::<f64>(out, found[k].len() / COUNT, COUNT).unwrap(), found[k], "{name}: {} in lane order", NAMES[k]);
        }
    }
}

#[test]
fn motion_of_singles_is_that_of_doubles() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, COUNT, 5);
        let expected = one_by_one(|_| &model, &states);
        let narrow = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let [q, v, a] = [&states.q, &states.v, &states.a].map(|numbers| narrow(numbers));
        let single = model.lift::<f32>();
        let found = batched(&mut Batch::<f32>::new(&single), last(&model), [&q, &v, &a], &expected);
        let found = found.map(|numbers| numbers.into_iter().map(f64::from).collect());
        // ε is 5e8 times larger.
        compare(name, &found, &expected, DOUBLE.map(|tolerance| tolerance * 5e8));
    }
}

#[test]
fn each_sample_of_the_parameters_has_its_motion() {
    let recipe = &ROBOTS[6].1;
    let samples: Vec<Model<f64>> = (0..COUNT as u64).map(|seed| Model::build(&robot(recipe, seed)).unwrap()).collect();
    let states = StateBatch::random(&samples[0], COUNT, 5);
    let expected = one_by_one(|k| &samples[k], &states);
    let mut batch = Batch::of_samples(&samples).unwrap();
    let found = batched(&mut batch, last(&samples[0]), [&states.q, &states.v, &states.a], &expected);
    compare("samples", &found, &expected, DOUBLE);
}

#[test]
fn what_a_batch_cannot_compute_is_named() {
    let model = build(&ROBOTS[6].1);
    let states = StateBatch::random(&model, 2, 5);
    let mut batch = Batch::<f64>::new(&model);
    let bodies = model.topology.bodies();
    let refused = batch.body_jacobian(&states.q, bodies, &mut vec![0.0; 12 * model.topology.nv()]).unwrap_err();
    assert!(matches!(&refused, BatchError::Dimension(error) if error.what.contains("bodies")), "{refused}");
    // Axes with other names: rotations in described axes are refused.
    let mixed = [common::dyadic_chain(&[[0.0, 1.0, 0.0]], 2), common::dyadic_chain(&[[1.0, 0.0, 0.0]], 2)];
    let mut batch = Batch::of_samples(&mixed).unwrap();
    let zeros = vec![0.0; 4];
    let refused = batch.kinematics(&zeros, &zeros, &zeros, &mut vec![0.0; 96]).unwrap_err();
    assert!(refused.to_string().contains("joint axis"), "{refused}");
    // A configuration that is no number harms no other state.
    let mut q = states.q.clone();
    q[0] = f64::NAN;
    let mut momenta = vec![0.0; 12];
    let failed = Batch::<f64>::new(&model).momentum(&q, &states.v, &mut momenta).unwrap_err();
    assert!(matches!(&failed, BatchError::Failed { failures, .. } if failures.len() == 1 && failures[0].state == 0), "{failed}");
    assert!(momenta[..6].iter().all(|x| x.is_nan()) && momenta[6..].iter().all(|x| x.is_finite()));
}
