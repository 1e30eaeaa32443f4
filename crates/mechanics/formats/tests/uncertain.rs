//! Uncertain parameters in files: exact round trips, errors that name the place, and exports that say what they leave out.

use crate::support::{Change, assert_named, assert_round_trip, chain, placed, refused};
use featherbench_formats::{OnLoss, Reason, mjcf, neutral, urdf};
use featherbench_model::{Acts, Correlation, Description, Distribution, Target, TargetField, Uncertain, UncertainVariable};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn variable(k: usize, distribution: Distribution, acts: Acts, field: TargetField) -> UncertainVariable {
    UncertainVariable { name: format!("a \"{k}\""), distribution, acts, on: vec![Target { body: k % 4, field }] }
}

/// A variable of every distribution and every field.
fn every() -> Uncertain {
    let uniform = Distribution::Uniform { low: 0.1 + 0.2, high: 1.0 / 3.0 };
    let variables = vec![
        variable(0, uniform, Acts::Value, TargetField::Mass),
        variable(1, Distribution::Lognormal { mean: 1.0, deviation: 0.1 }, Acts::Factor, TargetField::Density),
        variable(2, Distribution::Gamma { mean: 1.0, deviation: 0.3 }, Acts::Value, TargetField::Inertia(3)),
        variable(3, Distribution::Normal { mean: -0.0, deviation: 1e-300 }, Acts::Value, TargetField::Com(2)),
        variable(
            4,
            Distribution::TruncatedNormal { mean: 0.5, deviation: 0.1, low: 0.0, high: 1.0 },
            Acts::Value,
            TargetField::Armature(0),
        ),
        variable(5, uniform, Acts::Value, TargetField::Damping(0)),
        variable(6, uniform, Acts::Value, TargetField::Friction(0)),
    ];
    let correlations = vec![Correlation { first: 0, second: 1, value: 1.0 / 3.0 }, Correlation { first: 3, second: 1, value: -0.25 }];
    Uncertain { variables, correlations }
}

#[test]
fn every_field_and_distribution_round_trips() {
    assert_round_trip(&Description { uncertain: every(), ..chain(4) });
}

/// Oracles compute with the nominal robot, whose content hash does not change.
#[test]
fn the_line_for_oracles_is_that_of_the_nominal_robot() {
    let uncertain = Description { uncertain: every(), ..chain(4) };
    assert_eq!(neutral::to_line(&uncertain), neutral::to_line(&chain(4)));
    assert!(!neutral::to_string(&chain(4)).unwrap().contains("uncertain"));
}

const GOOD: &str = r#"{"format":1,"name":"r","gravity":[0,0,-9.81],
 "bodies":[
  {"name":"base","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":-1,"joint":{"name":"f","type":"fixed","placement":P}},
  {"name":"a","mass":1,"com":[0.5,0,0],"inertia":[1,0,0,1,0,1],"parent":0,"joint":{"name":"h","type":"revolute","axis":[0,1,0],"placement":P}}
 ],
 "uncertain":{"variables":[
  {"name":"m","distribution":{"type":"uniform","low":0.8,"high":1.2},"acts":"factor","on":[{"body":1,"field":"mass"}]},
  {"name":"c","distribution":{"type":"normal","mean":0.5,"deviation":0.01},"acts":"value","on":[{"body":1,"field":"com","index":0}]}
 ],"correlations":[{"first":0,"second":1,"value":0.5}]}}"#;

#[test]
fn bad_variables_are_named_by_file_line_and_field() {
    let good = placed(GOOD);
    assert_eq!(neutral::parse(&good, "good.json").unwrap().uncertain.variables.len(), 2);
    let uniform = r#"{"type":"uniform","low":0.8,"high":1.2}"#;
    let changes: &[Change<'_>] = &[
        (
            uniform,
            r#"{"type":"normal","mean":1,"deviation":0.1}"#,
            &["f.json:7:11: uncertain.variables[0] 'm': a normal variable cannot be the mass of body 1", "no mean", "truncated_normal"],
        ),
        (uniform, r#"{"type":"cauchy"}"#, &["uncertain.variables[0].distribution", "unknown variant `cauchy`, expected one of `uniform`"]),
        (uniform, r#"{"type":"uniform","low":0.8}"#, &["missing field `high`"]),
        (uniform, r#"{"type":"uniform","low":0.8,"high":1.2,"mean":1}"#, &["unknown field `mean`, expected `low` or `high`"]),
        (uniform, r#"{"type":"uniform","low":0.8,"high":1.2,"shape":1}"#, &["unknown field `shape`"]),
        (uniform, r#"{"type":"uniform","low":1.8,"high":1.2}"#, &["the lower bound 1.8 is not below"]),
        (uniform, r#"{"type":"uniform","low":0,"high":1.2}"#, &["the mass of body 1 must stay above zero"]),
        (uniform, r#"{"type":"gamma","mean":1,"deviation":0.8}"#, &["1/x of a gamma variable has a variance only if"]),
        (uniform, r#"{"type":"lognormal","mean":-1,"deviation":0.8}"#, &["mean is -1; it must be positive"]),
        (r#""field":"mass""#, r#""field":"length""#, &["variables[0].on[0]", "'length' is no number of a body"]),
        (r#""field":"mass""#, r#""field":"mass","index":0"#, &["'mass' has an 'index'"]),
        (r#""index":0"#, r#""index":3"#, &["body 1 has no com 3; there are 3"]),
        (r#","index":0"#, "", &["'com' needs an 'index'"]),
        (r#"{"body":1,"field":"mass"}"#, "", &["nothing follows the variable"]),
        (r#"{"body":1,"field":"mass"}"#, r#"{"body":0,"field":"mass"}"#, &["body 0 is fixed to its parent"]),
        (r#"{"body":1,"field":"mass"}"#, r#"{"body":7,"field":"mass"}"#, &["body 7 does not exist"]),
        (r#"{"body":1,"field":"mass"}"#, r#"{"body":1,"field":"damping","index":0}"#, &["the damping of body 1 is zero"]),
        (
            r#"{"body":1,"field":"mass"}"#,
            r#"{"body":1,"field":"mass"},{"body":1,"field":"density"}"#,
            &["the density of body 1 follows another variable too"],
        ),
        (r#""acts":"factor""#, r#""acts":"offset""#, &["unknown variant `offset`"]),
        (r#""name":"c""#, r#""name":"m""#, &["variables[1] 'm': another variable has the same name"]),
        (r#""value":0.5"#, r#""value":1.0"#, &["correlations[0]: the value is 1; it is between -1 and 1"]),
        (r#""second":1"#, r#""second":0"#, &["'m' is correlated with itself"]),
        (r#""second":1"#, r#""second":5"#, &["there are 2 variables"]),
    ];
    assert_named(&good, changes, refused);
}

/// Three pairs that no variables have: 1 − 3·0.81 + 2·(−0.729) is negative.
#[test]
fn correlations_that_cannot_be_are_refused() {
    let mut uncertain = every();
    uncertain.correlations = vec![
        Correlation { first: 0, second: 1, value: 0.9 },
        Correlation { first: 1, second: 2, value: 0.9 },
        Correlation { first: 0, second: 2, value: -0.9 },
    ];
    let error = Description { uncertain, ..chain(4) }.validate().unwrap_err().to_string();
    assert!(error.contains("not positive definite"), "{error}");
}

#[test]
fn exports_say_that_distributions_are_left_out() {
    let robot = Description { uncertain: every(), ..chain(4) };
    let (_, of_urdf) = urdf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    let (_, of_mjcf) = mjcf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    for losses in [of_urdf, of_mjcf] {
        assert_eq!(losses.iter().filter(|loss| loss.reason == Reason::Uncertain).count(), 7);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() })]

    /// What is valid is written and read back to the same bits; what is not is refused by `validate`, without a panic.
    #[test]
    fn any_numbers_round_trip_or_are_refused(
        kind in 0_usize..5, a in any::<f64>(), b in any::<f64>(), c in -3.0..3.0, d in 0.0..3.0, value in -1.5..1.5, body in 0_usize..6, place in 0_usize..8,
    ) {
        let distribution = match kind {
            0 => Distribution::Uniform { low: c, high: c + d },
            1 => Distribution::Lognormal { mean: d, deviation: b },
            2 => Distribution::Gamma { mean: d, deviation: c },
            3 => Distribution::Normal { mean: a, deviation: b },
            _ => Distribution::TruncatedNormal { mean: c, deviation: d, low: a, high: b },
        };
        let field = [TargetField::Mass, TargetField::Com(place), TargetField::Inertia(place), TargetField::Armature(place / 4)][place % 4];
        let mut uncertain = every();
        uncertain.variables.push(variable(body, distribution, Acts::Value, field));
        uncertain.variables[7].name = "last".into();
        uncertain.correlations.push(Correlation { first: body, second: 7, value });
        let robot = Description { uncertain, ..chain(4) };
        if robot.validate().is_ok() {
            assert_round_trip(&robot);
        } else {
            prop_assert!(neutral::to_string(&robot).is_err());
        }
    }
}
