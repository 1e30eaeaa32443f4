//! Batches at every width that this build has on this processor: against single states, against each other, and states that fail.
//!
//! A build for the processor at hand has one width. `ci/nightly` builds these tests for plain x86-64, which has the others too.

use crate::common;

use common::batched::{Asked, Outcome, Quantity::*, States, bits, dynamics, in_lanes, in_rows, one_by_one, relative, size};
use common::{ROBOTS, build, dyadic_chain, fused::Fused, robot, within};
use featherbench_dynamics::{Aba, Batch, BatchError, Cause, Failure, NoSuchWidth, NotPositiveDefinite, Number, Width};
use featherbench_model::{JointKind, Model};
use featherbench_spatial::{Lift, Real};

/// States in a batch: fewer than a group, groups of four to sixteen, half a group more, and several.
const COUNTS: [usize; 7] = [0, 1, 4, 8, 13, 21, 40];

/// What a width computes by itself.
const ASKED: [Asked; 6] =
    [(InverseDynamics, true), (Bias, true), (ForwardDynamics, true), (MassMatrix, false), (Factors, false), (Solution, false)];

/// Whether a width has fused multiply-add.
fn is_fused(width: Width) -> bool {
    width != Width::AsBuilt || cfg!(any(target_feature = "fma", target_arch = "aarch64"))
}

/// Asserts that results are those of single states in the scalar that has the arithmetic of the width.
fn are_those_of_single_states<'m, S: Number + Lift<S> + Lift<Fused<S>>>(
    what: &str,
    width: Width,
    outcome: &Outcome<S>,
    model: impl Fn(usize) -> &'m Model<S>,
    states: &States<S>,
    precision: f64,
) where
    Fused<S>: Real,
{
    let t = &model(0).topology;
    let turns = t.joints().iter().any(|joint| matches!(joint.kind, JointKind::Revolute(_) | JointKind::Helical));
    for (asked, done, found) in outcome {
        let what = format!("{what}, {width}, {asked:?}");
        assert_eq!(done, &Ok(()), "{what}");
        let truth = one_by_one(states, t, |k| {
            if is_fused(width) {
                dynamics::<S, Fused<S>>(model(k), states, k, *asked)
            } else {
                dynamics::<S, S>(model(k), states, k, *asked)
            }
        });
        // As in `batch.rs`: sines and cosines of another library, six roundings for each of twenty joints; reciprocals in factors. Without
        // these the operations are the same.
        let other_operations = turns || matches!(asked.0, Factors | Solution);
        let tolerance = if other_operations { 120.0 * precision } else { 0.0 };
        within(&what, relative(size(asked.0, model(0)), found, &truth), tolerance);
    }
}

fn every_width_is_as_single_states<S: Number + Lift<S> + Lift<Fused<S>>>(precision: f64)
where
    f64: Lift<S>,
    Fused<S>: Real,
{
    for (name, recipe) in &ROBOTS {
        let wide = build(recipe);
        let model: Model<S> = wide.lift();
        for count in COUNTS {
            let states = States::random(&wide, count);
            let mut fused: Option<Vec<_>> = None;
            for width in Width::available() {
                let what = format!("{name}, {count} states");
                let mut batch = Batch::new(&model).with_width(width).unwrap();
                let outcome = in_rows(&mut batch, &model, &ASKED, &states);
                are_those_of_single_states(&what, width, &outcome, |_| &model, &states, precision);
                // Orders and cores change nothing. Nor does the width, if the arithmetic is the same.
                assert_eq!(bits(&outcome), bits(&in_lanes(&mut batch, &model, &ASKED, &states)), "{what}, {width}: the order");
                let mut parallel = Batch::new(&model).on_all_cores().with_width(width).unwrap();
                assert_eq!(bits(&outcome), bits(&in_lanes(&mut parallel, &model, &ASKED, &states)), "{what}, {width}: the cores");
                if is_fused(width) {
                    let first = fused.get_or_insert_with(|| bits(&outcome));
                    assert!(*first == bits(&outcome), "{what}: {width} against the narrower width");
                }
            }
        }
    }
}

#[test]
fn doubles_are_as_single_states() {
    every_width_is_as_single_states::<f64>(f64::EPSILON / 2.0);
}

#[test]
fn singles_are_as_single_states() {
    every_width_is_as_single_states::<f32>(f64::from(f32::EPSILON) / 2.0);
}

#[test]
fn each_sample_of_the_parameters_has_its_state() {
    for (name, recipe) in &ROBOTS {
        let samples: Vec<Model<f64>> = (0..11).map(|seed| Model::build(&robot(recipe, 11 + seed)).unwrap()).collect();
        let states = States::random(&samples[0], samples.len());
        for width in Width::available() {
            let mut batch = Batch::of_samples(&samples).unwrap().with_width(width).unwrap();
            let outcome = in_rows(&mut batch, &samples[0], &ASKED, &states);
            are_those_of_single_states(name, width, &outcome, |k| &samples[k], &states, f64::EPSILON / 2.0);
            let mut parallel = batch.on_all_cores();
            assert_eq!(parallel.width(), width);
            assert_eq!(bits(&outcome), bits(&in_lanes(&mut parallel, &samples[0], &ASKED, &states)), "{name}, {width}");
        }
    }
}

/// Derivatives and refinement are computed at the width of the build.
#[test]
fn other_kernels_do_not_depend_on_the_width() {
    let model = build(&ROBOTS[7].1);
    let states = States::<f64>::random(&model, 9);
    let (nv, stored) = (model.topology.nv(), model.topology.stored());
    let answers = |width| {
        let mut batch = Batch::new(&model).with_width(width).unwrap();
        let (mut a, mut pairs) = (vec![0.0; 9 * nv], vec![0.0; 9 * 5 * stored]);
        batch.refined_forward_dynamics(&states.q, &states.v, &states.tau, None, 1, &mut a).unwrap();
        batch.id_derivatives(&states.q, &states.v, &states.a, None, &mut pairs).unwrap();
        (a, pairs)
    };
    let as_built = answers(Width::AsBuilt);
    assert!(Width::available().all(|width| answers(width) == as_built));
}

/// Angles that the registers' own sine does not take, numbers that are not finite, and bad pivots: in each lane of a group, at every width.
#[test]
fn a_state_that_fails_harms_no_other() {
    let model = build(&ROBOTS[7].1);
    let (count, nq, nv) = (19, model.topology.nq(), model.topology.nv());
    let clean = States::<f64>::random(&model, count);
    for width in Width::available() {
        let mut batch = Batch::new(&model).with_width(width).unwrap();
        let before = in_rows(&mut batch, &model, &ASKED, &clean);
        for bad in 0..count {
            for value in [1e6, f64::NAN, f64::NEG_INFINITY] {
                let mut states = clean.clone();
                states.q[bad * nq + nq - 1] = value;
                let rows = in_rows(&mut batch, &model, &ASKED, &states);
                for outcome in [&rows, &in_lanes(&mut batch, &model, &ASKED, &states)] {
                    for ((asked, done, found), (.., before)) in outcome.iter().zip(&before) {
                        let each = size(asked.0, &model);
                        if value.is_finite() {
                            assert_eq!(done, &Ok(()), "{width}, state {bad}");
                        } else {
                            let Err(BatchError::Failed { failures, .. }) = done else { panic!("{width}, state {bad}: {done:?}") };
                            // In lane order the copies that fill the last group are states too.
                            let [Failure { state, cause: Cause::Input { array: "configurations q", entry, .. } }, ..] = failures[..] else {
                                panic!("{width}: {failures:?}")
                            };
                            assert_eq!((state, entry), (bad, nq - 1), "{width}");
                        }
                        for (k, (found, before)) in found.chunks(each).zip(before.chunks(each)).enumerate().filter(|(k, _)| *k != bad) {
                            assert_eq!(found, before, "{width}, state {k} beside state {bad} with {value}");
                        }
                        let own = &found[bad * each..][..each];
                        assert!(own.iter().all(|x| x.is_nan() != value.is_finite()), "{width}, state {bad} with {value}");
                    }
                }
            }
        }
        assert_eq!(before[0].2.len(), count * nv);
    }
}

#[test]
fn bad_pivots_are_those_of_single_states() {
    let mut model = dyadic_chain(&[[0.0, 0.0, 1.0]], 3);
    model.inertias[0].rotational.zz = -0.15;
    let states = States::<f64>::random(&model, 50);
    let single = |k: usize| {
        let part = |array: &[f64]| array[3 * k..][..3].to_vec();
        let mut a = [Fused(0.0); 3];
        let fused = |array: &[f64]| -> Vec<Fused<f64>> { part(array).into_iter().map(Fused).collect() };
        Aba::new(&model.topology).run(&model, &fused(&states.q), &fused(&states.v), &fused(&states.tau), None, &mut a)
    };
    let expected: Vec<(usize, NotPositiveDefinite)> = (0..50)
        .filter_map(|k| match single(k) {
            Err(featherbench_dynamics::Error::NotPositiveDefinite(pivot)) => Some((k, pivot)),
            _ => None,
        })
        .collect();
    assert!(expected.len() > 5 && expected.len() < 45, "{} bad states", expected.len());
    for width in Width::available() {
        let mut a = vec![0.0; 150];
        let mut batch = Batch::new(&model).with_width(width).unwrap();
        let done = batch.forward_dynamics(&states.q, &states.v, &states.tau, None, &mut a);
        let Err(BatchError::Failed { failures, .. }) = done else { panic!("{width}: {done:?}") };
        assert_eq!(failures.len(), expected.len(), "{width}");
        for (failure, (state, expected)) in failures.iter().zip(&expected) {
            let Cause::NotPositiveDefinite(found) = failure.cause else { panic!("{width}: {failure}") };
            assert_eq!((failure.state, found.dof), (*state, expected.dof), "{width}");
            // six roundings for each of three joints, of numbers below one
            within("pivot", (found.pivot - expected.pivot).abs(), 18.0 * f64::EPSILON / 2.0);
        }
    }
}

#[test]
fn a_width_that_is_not_there_is_named() {
    let model = build(&ROBOTS[0].1);
    let available: Vec<Width> = Width::available().collect();
    assert_eq!((available.first(), available.last().copied()), (Some(&Width::AsBuilt), Some(Width::widest())));
    assert_eq!(Batch::<f64>::new(&model).width(), Width::widest());
    for width in [Width::Avx2, Width::Avx512] {
        match Batch::<f64>::new(&model).with_width(width) {
            Ok(batch) => assert!(available.contains(&width) && batch.width() == width && batch.clone().on_all_cores().width() == width),
            Err(error) => {
                assert!(!available.contains(&width) && error.to_string().contains(&width.to_string()), "{error}");
                let selects = cfg!(all(target_arch = "x86_64", not(target_feature = "fma")));
                assert!(!selects || error == NoSuchWidth::Processor(width), "{error}");
            }
        }
    }
}
