//! Batches against single states: every robot, both orders, both precisions, one core and all; and states that fail.

use crate::common;

use common::batched::{Asked, Quantity::*, States, bits, dynamics, in_lanes, in_rows, one_by_one, refined, relative, size};
use common::{ROBOTS, Recipe, build, dyadic_chain, robot, within};
use featherbench_dynamics::{
    Batch, BatchError, Cause, DimensionError, Failure, NotPositiveDefinite, Number, Sampled, forward_dynamics, refined_forward_dynamics,
    to_lanes, to_rows,
};
use featherbench_model::{JointKind, Model};
use featherbench_spatial::{Lift, RigidBodyInertia};

/// States in a batch: fewer than a group, one group, one more, and several.
const COUNTS: [usize; 6] = [0, 1, 7, 8, 9, 17];

/// The roundings in which lanes may differ from single states; [`lanes_are_as_single_states`] says why.
const ROUNDINGS: f64 = 120.0;

const ASKED: [Asked; 11] = [
    (InverseDynamics, false),
    (InverseDynamics, true),
    (Bias, false),
    (Bias, true),
    (ForwardDynamics, false),
    (ForwardDynamics, true),
    (MassMatrix, false),
    (Factors, false),
    (Solution, false),
    (Refined, false),
    (Refined, true),
];

/// The kernels state by state; state k has model `model(k)`.
fn truth<'m, S: Number>(model: impl Fn(usize) -> &'m Model<S>, states: &States<S>, asked: Asked) -> Vec<f64> {
    one_by_one(states, &model(0).topology, |k| match asked {
        (Refined, forced) => refined(model(k), states, k, forced),
        _ => dynamics::<S, S>(model(k), states, k, asked),
    })
}

fn lanes_are_as_single_states<S: Number>(precision: f64)
where
    f64: Lift<S>,
{
    let skew = ROBOTS.iter().map(|(name, recipe)| (*name, build(recipe)));
    let aligned = Model::build(&crate::aligned::aligned()).unwrap();
    for (name, wide) in skew.chain([("aligned axes", aligned)]) {
        let model: Model<S> = wide.lift();
        let turns = model.topology.joints().iter().any(|joint| matches!(joint.kind, JointKind::Revolute(_) | JointKind::Helical));
        let (mut batch, mut parallel) = (Batch::<S>::new(&model), Batch::<S>::new(&model).on_all_cores());
        for count in COUNTS {
            let states = States::random(&wide, count);
            let outcome = in_rows(&mut batch, &model, &ASKED, &states);
            assert_eq!(bits(&outcome), bits(&in_lanes(&mut batch, &model, &ASKED, &states)), "{name}, {count}: the order of the arrays");
            assert_eq!(bits(&outcome), bits(&in_rows(&mut parallel, &model, &ASKED, &states)), "{name}, {count}: the cores");
            assert_eq!(bits(&outcome), bits(&in_lanes(&mut parallel, &model, &ASKED, &states)), "{name}, {count}: cores and order");
            for (asked, done, found) in &outcome {
                let what = format!("{name}, {asked:?}, {count} states");
                assert_eq!(done, &Ok(()), "{what}");
                // Without a sine or cosine the operations are the same. The sines and cosines of the two libraries differ by at most 3
                // units in the last place: six roundings for each joint. There are 20 joints at most. Rarely do all add up: the worst of
                // these robots is half of that. A single matrix in doubles is factored with reciprocals in registers: one unit in the last
                // place per entry of L, which is two roundings for each joint.
                let tolerance = match asked.0 {
                    // Both are the exact numbers rounded, except where these are nearly in the middle: a unit in the last place.
                    Refined => 2.0 * precision,
                    Factors | Solution => ROUNDINGS * precision,
                    _ if turns => ROUNDINGS * precision,
                    _ => 0.0,
                };
                within(&what, relative(size(asked.0, &model), found, &truth(|_| &model, &states, *asked)), tolerance);
            }
        }
    }
}

#[test]
fn doubles_are_as_single_states() {
    lanes_are_as_single_states::<f64>(f64::EPSILON / 2.0);
}

#[test]
fn singles_are_as_single_states() {
    lanes_are_as_single_states::<f32>(f64::from(f32::EPSILON) / 2.0);
}

/// Angles beyond those that the lanes' own sine takes do not change the neighbours.
#[test]
fn states_do_not_depend_on_their_neighbours() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let nq = model.topology.nq();
        let mut states = States::random(&model, 11);
        let mut batch = Batch::<f64>::new(&model);
        let alone = in_rows(&mut batch, &model, &ASKED, &states);
        for x in &mut states.q[5 * nq..6 * nq] {
            *x *= 1e6;
        }
        for ((quantity, done, found), (.., before)) in in_rows(&mut batch, &model, &ASKED, &states).iter().zip(&alone) {
            assert_eq!(done, &Ok(()), "{name}, {quantity:?}");
            let each = found.len() / 11;
            let others = |out: &[f64]| [&out[..5 * each], &out[6 * each..]].concat();
            assert_eq!(others(found), others(before), "{name}, {quantity:?}");
        }
    }
}

/// NaN and infinity in any input of any lane are reported, and no other state's results change by a bit.
#[test]
fn a_state_with_a_bad_number_is_reported_and_harms_no_other() {
    let model = build(&ROBOTS[7].1);
    let (count, nq, nv) = (19, model.topology.nq(), model.topology.nv());
    let clean = States::random(&model, count);
    let before =
        [Batch::<f64>::new(&model), Batch::new(&model).on_all_cores()].map(|mut batch| in_rows(&mut batch, &model, &ASKED, &clean));
    for (bad, value) in [(0, f64::NAN), (6, f64::INFINITY), (8, f64::NEG_INFINITY), (18, f64::NAN)] {
        let six = 6 * model.topology.bodies();
        let places =
            [("configurations q", nq, 0), ("configurations q", nq, nq - 1), ("velocities v", nv, 3), ("external wrenches", six, six - 1)];
        for (array, each, entry) in places {
            let mut states = clean.clone();
            let numbers = match array {
                "velocities v" => &mut states.v,
                "configurations q" => &mut states.q,
                _ => &mut states.wrenches,
            };
            numbers[bad * each + entry] = value;
            for parallel in [false, true] {
                let new = || if parallel { Batch::<f64>::new(&model).on_all_cores() } else { Batch::new(&model) };
                let before = &before[usize::from(parallel)];
                for after in [in_rows(&mut new(), &model, &ASKED, &states), in_lanes(&mut new(), &model, &ASKED, &states)] {
                    for (((quantity, forced), done, found), (.., before)) in after.iter().zip(before) {
                        let independent = match array {
                            "velocities v" => matches!(quantity, MassMatrix | Factors | Solution),
                            "external wrenches" => !forced,
                            _ => false,
                        };
                        if independent {
                            assert_eq!((done, found), (&Ok(()), before), "{quantity:?} does not depend on {array}");
                            continue;
                        }
                        let Err(BatchError::Failed { failures, .. }) = done else { panic!("{quantity:?}, state {bad}: {done:?}") };
                        // In lane order the copies that fill the last group are states too.
                        let failures: Vec<Failure> = failures.iter().copied().filter(|failure| failure.state < count).collect();
                        let [Failure { state, cause: Cause::Input { array: named, entry: at, value: reported } }] = failures[..] else {
                            panic!("{quantity:?}: {failures:?}")
                        };
                        assert_eq!((state, named, at, reported.to_bits()), (bad, array, entry, value.to_bits()), "{quantity:?}");
                        let each = found.len() / count;
                        for (k, (found, before)) in found.chunks(each).zip(before.chunks(each)).enumerate() {
                            let good = if k == bad { found.iter().all(|x| x.is_nan()) } else { found == before };
                            assert!(good, "{quantity:?}, state {k} beside the bad state {bad}");
                        }
                    }
                }
            }
        }
    }
}

/// A chain of three whose first pivot is positive at some states only: its first body has a negative moment of inertia.
#[test]
fn states_with_a_bad_pivot_are_those_of_the_single_states() {
    let mut model = dyadic_chain(&[[0.0, 0.0, 1.0]], 3);
    model.inertias[0].rotational.zz = -0.15;
    let count = 50;
    let states = States::<f64>::random(&model, count);
    let mut a = vec![0.0; 3 * count];
    let done = Batch::<f64>::new(&model).forward_dynamics(&states.q, &states.v, &states.tau, None, &mut a);
    let Err(BatchError::Failed { failures, states: total }) = &done else { panic!("{done:?}") };
    assert_eq!(total, &count);
    let mut failures = failures.iter();
    let (mut good, mut bad) = (0, 0);
    for k in 0..count {
        let part = |array: &[f64]| array[3 * k..][..3].to_vec();
        match forward_dynamics(&model, &part(&states.q), &part(&states.v), &part(&states.tau)) {
            Ok(truth) => {
                good += 1;
                // A pivot is a difference of numbers around 0.1 and may be a hundredth of them: six roundings for each of three joints,
                // ten times larger than in a, which it divides.
                within("acceleration beside bad states", relative(3, &part(&a), &truth), 180.0 * f64::EPSILON / 2.0);
            }
            Err(error) => {
                bad += 1;
                let Some(Failure { state, cause: Cause::NotPositiveDefinite(pivot) }) = failures.next() else {
                    panic!("state {k}: {error}")
                };
                let featherbench_dynamics::Error::NotPositiveDefinite(expected) = error else { panic!("{error}") };
                assert_eq!((*state, pivot.dof), (k, expected.dof));
                // six roundings for each of three joints, of numbers below one
                within("pivot", (pivot.pivot - expected.pivot).abs(), 18.0 * f64::EPSILON / 2.0);
                assert!(part(&a).iter().all(|a| a.is_nan()));
            }
        }
    }
    assert!(good > 5 && bad > 5 && failures.next().is_none(), "{good} good, {bad} bad");
    let text = done.as_ref().unwrap_err().to_string();
    assert!(text.contains(&format!("{bad} of 50 states failed")) && text.contains("not positive definite"), "{text}");

    // Refinement finds the same states, and leaves the others valid.
    let mut refined = vec![0.0; 3 * count];
    let again = Batch::<f64>::new(&model).refined_forward_dynamics(&states.q, &states.v, &states.tau, None, 1, &mut refined);
    assert_eq!(again, done);
    for (k, (refined, a)) in refined.chunks(3).zip(a.chunks(3)).enumerate() {
        match refined_forward_dynamics(&model, &states.q[3 * k..][..3], &states.v[3 * k..][..3], &states.tau[3 * k..][..3], 1) {
            Ok(alone) => within("refined beside bad states", relative(3, refined, &alone), f64::EPSILON),
            Err(_) => assert!(refined.iter().chain(a).all(|a| a.is_nan())),
        }
    }
    // The factorization finds the same states.
    let factored = Batch::<f64>::new(&model).solve(&states.q, &states.tau, &mut a);
    assert!(matches!(factored, Err(BatchError::Failed { failures, .. }) if failures.len() == bad));
}

#[test]
fn results_that_overflow_are_reported() {
    let model = build(&ROBOTS[0].1);
    let mut states = States::<f64>::random(&model, 9);
    let (nv, mut tau) = (model.topology.nv(), vec![0.0; states.v.len()]);
    states.v[8 * nv + 2] = 1e200;
    let Err(BatchError::Failed { failures, states: 9 }) = Batch::<f64>::new(&model).bias_force(&states.q, &states.v, None, &mut tau) else {
        panic!()
    };
    assert!(matches!(failures[..], [Failure { state: 8, cause: Cause::Result { array: "bias forces h", .. } }]), "{failures:?}");
}

#[test]
fn each_sample_of_the_parameters_has_its_state() {
    for (name, recipe) in &ROBOTS {
        let samples: Vec<Model<f64>> = (0..11).map(|seed| sample(recipe, seed)).collect();
        let states = States::random(&samples[0], samples.len());
        let mut batch = Batch::of_samples(&samples).unwrap();
        let outcome = in_rows(&mut batch, &samples[0], &ASKED, &states);
        assert_eq!(bits(&outcome), bits(&in_lanes(&mut batch.clone().on_all_cores(), &samples[0], &ASKED, &states)), "{name}");
        for (asked, done, found) in &outcome {
            let what = format!("{name}, {asked:?}, samples");
            assert_eq!(done, &Ok(()), "{what}");
            let truth = truth(|k| &samples[k], &states, *asked);
            within(&what, relative(size(asked.0, &samples[0]), found, &truth), ROUNDINGS * f64::EPSILON / 2.0);
        }
    }
}

fn sample(recipe: &Recipe, seed: u64) -> Model<f64> {
    Model::build(&robot(recipe, 11 + seed)).unwrap()
}

#[test]
fn a_sample_without_inertia_fails_alone() {
    let mut samples: Vec<Model<f64>> = (0..12).map(|seed| sample(&ROBOTS[0].1, seed)).collect();
    let states = States::random(&samples[0], 12);
    let (mut good, mut a) = (vec![0.0; states.v.len()], vec![0.0; states.v.len()]);
    Batch::of_samples(&samples).unwrap().forward_dynamics(&states.q, &states.v, &states.tau, None, &mut good).unwrap();
    let last = samples[9].inertias.len() - 1;
    samples[9].inertias[last] = RigidBodyInertia::zero();
    let done = Batch::of_samples(&samples).unwrap().forward_dynamics(&states.q, &states.v, &states.tau, None, &mut a);
    let cause = Cause::NotPositiveDefinite(NotPositiveDefinite { dof: last, pivot: 0.0 });
    assert_eq!(done, Err(BatchError::Failed { failures: vec![Failure { state: 9, cause }], states: 12 }));
    let nv = samples[0].topology.nv();
    assert!(a.chunks(nv).zip(good.chunks(nv)).enumerate().all(|(k, (a, good))| k == 9 || a == good));
}

#[test]
fn arrays_of_the_wrong_length_are_named() {
    let model = build(&ROBOTS[7].1);
    let t = &model.topology;
    let (nq, nv) = (t.nq(), t.nv());
    let count = 10;
    let states = States::<f64>::random(&model, count);
    let (q, v) = (&states.q[..], &states.v[..]);
    let (few, mut short, mut out) = (&v[1..], vec![0.0; count * nv - 1], vec![0.0; count * nv]);
    let mut batch = Batch::<f64>::new(&model);
    let refusal = |done| match done {
        Err(BatchError::Dimension(DimensionError { what, expected, found })) => (what, expected, found),
        other => panic!("{other:?}"),
    };
    let (all, less) = (count * nv, count * nv - 1);
    assert_eq!(refusal(batch.inverse_dynamics(&q[1..], v, v, None, &mut out)), ("configurations q", count * nq, count * nq - 1));
    assert_eq!(refusal(batch.inverse_dynamics(q, few, v, None, &mut out)), ("velocities v", all, less));
    assert_eq!(refusal(batch.inverse_dynamics(q, v, few, None, &mut out)), ("accelerations a", all, less));
    assert_eq!(refusal(batch.inverse_dynamics(q, v, v, None, &mut short)), ("joint forces tau", all, less));
    assert_eq!(refusal(batch.bias_force(q, v, None, &mut short)), ("bias forces h", all, less));
    assert_eq!(refusal(batch.forward_dynamics(q, v, few, None, &mut out)), ("joint forces tau", all, less));
    assert_eq!(refusal(batch.forward_dynamics(q, v, v, None, &mut short)), ("accelerations a", all, less));
    assert_eq!(refusal(batch.refined_forward_dynamics(q, v, few, None, 1, &mut out)), ("joint forces tau", all, less));
    assert_eq!(refusal(batch.refined_forward_dynamics(q, v, v, None, 1, &mut short)), ("accelerations a", all, less));
    let f = Some(&states.wrenches[1..]);
    let wrenches = ("external wrenches", count * 6 * t.bodies(), count * 6 * t.bodies() - 1);
    assert_eq!(refusal(batch.inverse_dynamics(q, v, v, f, &mut out)), wrenches);
    assert_eq!(refusal(batch.bias_force(q, v, f, &mut out)), wrenches);
    assert_eq!(refusal(batch.forward_dynamics(q, v, v, f, &mut out)), wrenches);
    assert_eq!(refusal(batch.refined_forward_dynamics(q, v, v, f, 1, &mut out)), wrenches);
    assert_eq!(refusal(batch.mass_matrix(q, &mut short)), ("matrices", count * t.stored(), less));
    assert_eq!(refusal(batch.factors(q, &mut short)), ("factors", count * t.stored(), less));
    assert_eq!(refusal(batch.solve(q, few, &mut out)), ("right-hand sides b", all, less));
    assert_eq!(refusal(batch.solve(q, v, &mut short)), ("solutions x", all, less));
    let text = batch.solve(q, v, &mut short).unwrap_err().to_string();
    assert!(text.contains("solutions x: expected") && text.contains("one vector per state"), "{text}");

    assert!(to_lanes(&q[1..], nq).is_err() && to_rows::<f64>(&to_lanes(q, nq).unwrap(), nq, count + 2 * f64::LANES).is_err());

    // a broken model, and samples that do not fit
    let mut broken = model.clone();
    broken.armature.pop();
    assert_eq!(refusal(Batch::<f64>::new(&broken).bias_force(q, v, None, &mut out)), ("armature of the model", nv, nv - 1));
    let samples = [model.clone(), build(&ROBOTS[6].1)];
    assert_eq!(Batch::<f64, Sampled>::of_samples(&[]).unwrap_err().what, "samples of the model");
    assert_eq!(Batch::of_samples(&samples).unwrap_err().what, "bodies of the workspace");
    let samples = vec![model.clone(); count + 1];
    let done = Batch::of_samples(&samples).unwrap().bias_force(q, v, None, &mut out);
    assert_eq!(refusal(done), ("configurations q", (count + 1) * nq, count * nq));
}
