//! The harness convicts by truth: who errs is named, whatever the majority says, and a reference that errs is suspected itself.

mod support;

use featherbench_bench::{Problem, Quantity, Subject};
use featherbench_engines::Native;
use featherbench_results::{Record, Verdict};
use featherbench_studies::Digits;
use std::collections::BTreeSet;
use support::{Answer, Double, gates, robot, whole};

/// The engines with rows that fail.
fn convicted(records: &[Record]) -> BTreeSet<&str> {
    records.iter().filter(|row| row.verdict == Verdict::Fail).map(|row| row.engine.as_str()).collect()
}

/// Two engines that share a mistake, an honest one, and our kernels.
fn records_of_a_wrong_majority(problem: &Problem, twist: support::Twist) -> Vec<Record> {
    let wrong = |name: &str| Box::new(Double::twisting(problem, twist).named(name)) as Box<dyn Subject>;
    let subjects = [Box::new(Native::new()) as Box<dyn Subject>, wrong("a"), wrong("b"), Box::new(Double::of(problem).named("c"))];
    whole(&Digits, problem, &gates(""), &subjects)
}

/// A relative error of 1e-11 in one quantity.
fn scaled(answer: Answer, quantity: Quantity) {
    if answer.quantity == quantity {
        answer.values.iter_mut().for_each(|value| *value *= 1.0 + 1e-11);
    }
}

#[test]
fn a_wrong_majority_is_convicted_and_the_honest_minority_is_not() {
    let guilty = BTreeSet::from(["a", "b"]);
    for spec in ["humanoid", "chain:n=10,layout=spatial", "joints:kind=common,base=free"] {
        let problem = robot(spec);
        assert_eq!(convicted(&records_of_a_wrong_majority(&problem, |_| ())), BTreeSet::new(), "{spec}");
        assert_eq!(convicted(&records_of_a_wrong_majority(&problem, |answer| scaled(answer, Quantity::InverseDynamics))), guilty, "{spec}");
        assert_eq!(convicted(&records_of_a_wrong_majority(&problem, |answer| scaled(answer, Quantity::MassMatrix))), guilty, "{spec}");
    }
    // Forward dynamics, where the clean error is far below 1e-12: the bound is sharp there.
    for spec in ["joints:kind=common,base=fixed,shape=single", "joints:kind=common,base=free,shape=single", "chain:n=2", "star:n=10"] {
        let problem = robot(spec);
        assert_eq!(convicted(&records_of_a_wrong_majority(&problem, |answer| scaled(answer, Quantity::ForwardDynamics))), guilty, "{spec}");
    }
}

#[test]
fn one_wrong_entry_of_m_or_of_the_torques_is_enough() {
    let problem = robot("humanoid");
    let spoil_one = |answer: Answer| match answer.quantity {
        Quantity::InverseDynamics | Quantity::MassMatrix => {
            // The last entry: the lightest body's.
            if let Some(last) = answer.values.last_mut() {
                *last *= 1.0 + 1e-11;
            }
        }
        _ => (),
    };
    assert_eq!(convicted(&records_of_a_wrong_majority(&problem, spoil_one)), BTreeSet::from(["a", "b"]));
}

#[test]
fn engines_that_stop_at_one_error_make_the_reference_the_suspect() {
    let problem = robot("chain:n=10,layout=spatial");
    // To engines that all agree on another mass, the truth looks as if it ended at 1e-9.
    let other = |name: &str| {
        let heavier = Double::altered(&problem, |description| description.bodies[4].mass *= 1.0 + 1e-9);
        Box::new(heavier.named(name)) as Box<dyn Subject>
    };
    let walls = |subjects: &[Box<dyn Subject>]| -> Vec<f64> {
        let records = whole(&Digits, &problem, &gates(""), subjects);
        records.iter().filter(|row| row.metric == "engines_at_the_wall").filter_map(|row| row.value).collect()
    };
    assert_eq!(walls(&[other("a"), other("b"), other("c")]), [3.0]);
    assert_eq!(
        walls(&[Box::new(Native::new()), other("a"), other("b"), other("c")]),
        [0.0; 0],
        "one that is nearer shows that there is no wall"
    );
}
