//! Batches of states: every case present, reproducible, within its ranges.

use crate::arbitrary::any_description;
use crate::share::one_of;
use featherbench_model::Model;
use featherbench_robots::{BadState, Case, Family, StateBatch};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn model(spec: &str) -> Model<f64> {
    let robot = Family::parse(spec).and_then(|family| family.generate()).unwrap_or_else(|error| panic!("{spec}: {error}"));
    Model::build(&robot).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

#[test]
fn agreement_batches_hold_every_case() {
    let batch = StateBatch::agreement(&model("humanoid"), 20, 1);
    let of = |case| batch.cases.iter().filter(|&&found| found == case).count();
    assert_eq!([Case::Zero, Case::Straight, Case::Fast, Case::Limit, Case::Random].map(of), [1, 2, 3, 2, 12]);
    assert_eq!(batch.count(), 20);
    // A chain has no limits, so no state can be at them.
    let batch = StateBatch::agreement(&model("chain"), 20, 1);
    assert!(!batch.cases.contains(&Case::Limit));
    // The head of a batch shows every case already.
    let head = StateBatch::agreement(&model("humanoid"), StateBatch::HEAD, 1);
    for case in [Case::Random, Case::Zero, Case::Straight, Case::Fast, Case::Limit] {
        assert!(head.cases.contains(&case), "{case:?}");
    }
    assert_eq!(StateBatch::agreement(&model("chain"), 0, 1).count(), 0);
}

#[test]
fn cases_are_what_they_say() {
    let model = model("humanoid");
    let batch = StateBatch::agreement(&model, 20, 1);
    let largest =
        |numbers: &[f64]| numbers.iter().map(|x| x.abs()).fold(0.0, |largest, x| if x > largest || x.is_nan() { x } else { largest });
    let neutral: Vec<f64> = (0..model.topology.nq()).map(|i| if i == 6 { 1.0 } else { 0.0 }).collect();
    for k in 0..batch.count() {
        let (q, v, a, tau, wrench) = (batch.q(k), batch.v(k), batch.a(k), batch.tau(k), batch.wrench(k));
        assert_eq!((q.len(), v.len(), a.len(), tau.len(), wrench.len()), (37, 36, 36, 36, 6 * model.described.len()));
        // One rounding of the square root and one of each quotient.
        assert!((q[3..7].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
        match batch.cases[k] {
            Case::Zero => assert_eq!((q, largest(v), largest(a), largest(tau), largest(wrench)), (&neutral[..], 0.0, 0.0, 0.0, 0.0)),
            Case::Straight => assert!(q == neutral && (0.5..1.0).contains(&largest(v)) && largest(a) > 0.5),
            Case::Fast => assert!((500.0..1000.0).contains(&largest(v)) && largest(a) < 1.0),
            Case::Limit => {
                assert!(q.iter().zip(&model.limits).skip(7).all(|(x, limit)| *x == limit.0 || *x == limit.1));
                let (lower, upper) = (q[7..].iter().zip(&model.limits[7..]))
                    .map(|(x, limit)| (usize::from(*x == limit.0), usize::from(*x == limit.1)))
                    .fold((0, 0), |sum, x| (sum.0 + x.0, sum.1 + x.1));
                assert!(lower > 0 && upper > 0, "both ends occur");
            }
            Case::Keyframe => panic!("state {k}: a keyframe without a file"),
            Case::Random => assert!(
                largest(q) < std::f64::consts::PI && (0.5..1.0).contains(&largest(v)) && largest(tau) > 0.5 && largest(wrench) > 0.5
            ),
        }
    }
}

#[test]
fn a_state_depends_on_the_seed_and_its_number_only() {
    let model = model("tree:n=9,joints=all,base=free");
    let (short, long) = (StateBatch::random(&model, 3, 5), StateBatch::random(&model, 8, 5));
    for k in 0..3 {
        assert_eq!((short.q(k), short.v(k), short.wrench(k)), (long.q(k), long.v(k), long.wrench(k)));
    }
    assert_ne!(short.q(0), StateBatch::random(&model, 1, 6).q(0));
    assert_ne!(long.q(0), long.q(1));
}

/// Keyframes come after the drawn states, which they do not change. Their quaternions have length one.
#[test]
fn keyframes_are_states_of_their_own() {
    let model = Model::build(&Family::parse("joints:kind=spherical,base=free").unwrap().generate().unwrap()).unwrap();
    let drawn = StateBatch::agreement(&model, 6, 5);
    let (nq, count) = (drawn.nq, drawn.count());
    let stretched: Vec<f64> = drawn.q(0).iter().map(|x| 3.0 * x).collect();
    let keyed = drawn.clone().with_keyframes(&model, &[stretched.clone(), vec![0.0; nq]], 5).unwrap();
    assert_eq!((&keyed.cases[..count], &keyed.cases[count..]), (&drawn.cases[..], &[Case::Keyframe; 2][..]));
    assert_eq!((&keyed.q[..count * nq], &keyed.v[..count * drawn.nv]), (&drawn.q[..], &drawn.v[..]));
    assert_eq!(keyed.q(count)[..3], stretched[..3], "a position is as the file has it");
    assert!(keyed.q(count)[3..7].iter().zip(&drawn.q(0)[3..7]).all(|(found, unit)| (found - unit).abs() < 1e-15), "two roundings of 1");
    assert_eq!(keyed.q(count + 1)[..7], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!(keyed.v(count) != keyed.v(count + 1) && keyed.tau(count).iter().all(|x| x.abs() < 1.0));
    assert!(drawn.clone().with_keyframes(&model, &[vec![0.0; nq - 1]], 5).is_err());
    assert!(drawn.with_keyframes(&model, &[vec![f64::NAN; nq]], 5).is_err());
}

#[test]
fn case_names_read_back() {
    for case in [Case::Random, Case::Zero, Case::Straight, Case::Fast, Case::Limit, Case::Keyframe] {
        assert_eq!(Case::parse(case.name()), Some(case));
    }
    assert_eq!(Case::parse("typical"), None);
}

/// A batch that does not belong to a model is an error that names the array, the state and the index.
#[test]
fn batches_that_do_not_belong_to_a_model_are_refused() {
    let description = Family::parse("joints:kind=spherical,base=free").and_then(|family| family.generate()).expect("the family exists");
    let model = Model::build(&description).expect("the robot is sound");
    let good = StateBatch::agreement(&model, 6, 1);
    assert_eq!(good.check(&model), Ok(()));

    let mut short = good.clone();
    short.v.pop();
    assert!(short.check(&model).unwrap_err().to_string().starts_with("v has"));
    let mut broken = good.clone();
    broken.tau[good.nv + 2] = f64::NAN;
    assert_eq!(broken.check(&model).unwrap_err().to_string(), "state 1: tau[2] is NaN; give a finite number");
    let mut long = good.clone();
    long.q[3..7].iter_mut().for_each(|x| *x *= 2.0);
    let refusal = long.check(&model).unwrap_err();
    assert!(matches!(refusal, BadState::NonUnitQuaternion { state: 0, index: 3, .. }), "{refusal}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Whatever is compiled has states: their numbers are finite.
    #[test]
    fn every_model_has_finite_states(robot in any_description()) {
        if let Ok(model) = Model::<f64>::build(&robot) {
            let states = StateBatch::agreement(&model, 10, 1);
            prop_assert!(states.q.iter().chain(&states.v).all(|x| x.is_finite()));
        }
    }
}
