//! Derivatives in batches against those of single states: every robot, both orders, both precisions, samples of parameters.

use crate::common;

use common::{ROBOTS, build, distance, largest, robot, within};
use featherbench_dynamics::{
    Batch, FdDerivatives, FdPartials, IdDerivatives, IdPartials, coriolis_matrix, to_lanes, to_rows, torque_regressor,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::Force;

/// One more than a group of eight, so that the last group has copies.
const COUNT: usize = 9;

/// Derivatives of each state, one call per state: of ID and FD with wrenches, Coriolis matrix, regressor.
fn one_by_one<'m>(model: impl Fn(usize) -> &'m Model<f64>, states: &StateBatch, f: &[Vec<Force<f64>>]) -> [Vec<f64>; 4] {
    let mut all: [Vec<f64>; 4] = Default::default();
    for k in 0..states.count() {
        let (model, q, v, a, tau, f) = (model(k), states.q(k), states.v(k), states.a(k), states.tau(k), Some(&f[k][..]));
        let (mut id, mut fd) = (IdPartials::new(&model.topology), FdPartials::new(&model.topology));
        IdDerivatives::new(&model.topology).run(model, q, v, a, f, &mut id).unwrap();
        FdDerivatives::new(&model.topology).run(model, q, v, tau, f, &mut fd).unwrap();
        let c = coriolis_matrix(model, q, v).unwrap();
        all[0].extend([id.q.lower(), id.q.upper(), id.v.lower(), id.v.upper(), id.a.values()].concat());
        all[1].extend([&fd.acceleration[..], &fd.q, &fd.v, &fd.tau].concat());
        all[2].extend([c.lower(), c.upper()].concat());
        all[3].extend(torque_regressor(model, q, v, a).unwrap().values());
    }
    all
}

fn wrenches(model: &Model<f64>) -> (Vec<Vec<Force<f64>>>, Vec<f64>) {
    let each: Vec<_> = (0..COUNT as u64).map(|seed| common::wrenches(model, seed)).collect();
    let numbers = each.iter().flatten().flat_map(|f| f.to_array()).collect();
    (each, numbers)
}

const NAMES: [&str; 4] = ["∂ID", "∂FD", "C", "Y"];

/// Relative to the largest entry of all states: other sines and cosines, in matrices of which that of forward dynamics has κ of 1e3.
fn compare(name: &str, found: &[Vec<f64>; 4], expected: &[Vec<f64>; 4], tolerances: [f64; 4]) {
    for k in 0..4 {
        within(&format!("{name}: {}", NAMES[k]), distance(&found[k], &expected[k]) / largest(&expected[k]), tolerances[k]);
    }
}

const DOUBLE: [f64; 4] = [1e-14, 1e-12, 1e-14, 1e-14];

#[test]
fn derivatives_in_lanes_are_those_of_single_states() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, COUNT, 5);
        let (each, numbers) = wrenches(&model);
        let expected = one_by_one(|_| &model, &states, &each);
        let (q, v, a, tau, f) = (&states.q, &states.v, &states.a, &states.tau, Some(&numbers[..]));

        let mut found = expected.each_ref().map(|numbers| vec![f64::NAN; numbers.len()]);
        let mut batch = Batch::<f64>::new(&model);
        batch.id_derivatives(q, v, a, f, &mut found[0]).unwrap();
        batch.fd_derivatives(q, v, tau, f, &mut found[1]).unwrap();
        batch.coriolis_matrix(q, v, &mut found[2]).unwrap();
        batch.torque_regressor(q, v, a, &mut found[3]).unwrap();
        compare(name, &found, &expected, DOUBLE);

        // Lane order on all cores gives the same bits.
        let t = &model.topology;
        let lanes = |rows: &[f64], each| to_lanes(rows, each).unwrap();
        let (q, v, a, tau, f) = (lanes(q, t.nq()), lanes(v, t.nv()), lanes(a, t.nv()), lanes(tau, t.nv()), lanes(&numbers, 6 * t.bodies()));
        let mut batch = Batch::<f64>::new(&model).on_all_cores();
        let mut out = found.each_ref().map(|rows| lanes(rows, rows.len() / COUNT));
        batch.id_derivatives(&q, &v, &a, Some(&f), &mut out[0]).unwrap();
        batch.fd_derivatives(&q, &v, &tau, Some(&f), &mut out[1]).unwrap();
        batch.coriolis_matrix(&q, &v, &mut out[2]).unwrap();
        batch.torque_regressor(&q, &v, &a, &mut out[3]).unwrap();
        for (k, out) in out.iter().enumerate() {
            assert_eq!(to_rows::<f64>(out, found[k].len() / COUNT, COUNT).unwrap(), found[k], "{name}: {} in lane order", NAMES[k]);
        }
    }
}

#[test]
fn singles_are_as_doubles() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, COUNT, 5);
        let each = vec![vec![Force::zero(); model.topology.bodies()]; COUNT];
        let expected = one_by_one(|_| &model, &states, &each);
        let single = model.lift::<f32>();
        let narrow = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let (q, v, a, tau) = (narrow(&states.q), narrow(&states.v), narrow(&states.a), narrow(&states.tau));
        let mut found = expected.each_ref().map(|numbers| vec![f32::NAN; numbers.len()]);
        let mut batch = Batch::<f32>::new(&single);
        batch.id_derivatives(&q, &v, &a, None, &mut found[0]).unwrap();
        batch.fd_derivatives(&q, &v, &tau, None, &mut found[1]).unwrap();
        batch.coriolis_matrix(&q, &v, &mut found[2]).unwrap();
        batch.torque_regressor(&q, &v, &a, &mut found[3]).unwrap();
        let found = found.map(|numbers| numbers.into_iter().map(f64::from).collect());
        // ε is 5e8 times larger.
        compare(name, &found, &expected, DOUBLE.map(|tolerance| tolerance * 5e8));
    }
}

#[test]
fn each_sample_of_the_parameters_has_its_derivatives() {
    let recipe = &ROBOTS[6].1;
    let samples: Vec<Model<f64>> = (0..COUNT as u64).map(|seed| Model::build(&robot(recipe, seed)).unwrap()).collect();
    let states = StateBatch::random(&samples[0], COUNT, 5);
    let (each, numbers) = wrenches(&samples[0]);
    let expected = one_by_one(|k| &samples[k], &states, &each);
    let mut found = expected.each_ref().map(|numbers| vec![f64::NAN; numbers.len()]);
    let (q, v, a, tau, f) = (&states.q, &states.v, &states.a, &states.tau, Some(&numbers[..]));
    let mut batch = Batch::of_samples(&samples).unwrap();
    batch.id_derivatives(q, v, a, f, &mut found[0]).unwrap();
    batch.fd_derivatives(q, v, tau, f, &mut found[1]).unwrap();
    batch.coriolis_matrix(q, v, &mut found[2]).unwrap();
    batch.torque_regressor(q, v, a, &mut found[3]).unwrap();
    compare("samples", &found, &expected, DOUBLE);

    // Axes with other names: the regressor, which is in described axes, is refused.
    let chain = common::dyadic_chain(&[[0.0, 1.0, 0.0]], 2);
    let other = common::dyadic_chain(&[[1.0, 0.0, 0.0]], 2);
    let mixed = [chain, other];
    let mut batch = Batch::of_samples(&mixed).unwrap();
    let zeros = vec![0.0; 4];
    let refused = batch.torque_regressor(&zeros, &zeros, &zeros, &mut vec![0.0; 60]).unwrap_err();
    assert!(refused.to_string().contains("joint axis"), "{refused}");
}
