//! The truth names the engine that is wrong, whatever the majority says; and a wrong reference is itself suspected.

use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_comparison::Accuracy;
use featherbench_doubles::{Answer, Double, gates, robot, whole};
use featherbench_engines::Featherbench;
use featherbench_results::{Row, Verdict};
use std::collections::BTreeSet;

/// The engines with rows that fail.
fn convicted(records: &[Row]) -> BTreeSet<&str> {
    records.iter().filter(|row| row.verdict == Verdict::Fail).map(|row| row.engine.as_str()).collect()
}

/// Two engines that share a mistake, a right one, and our kernels.
fn records_of_a_wrong_majority(robot: &Robot, twist: featherbench_doubles::Twist) -> Vec<Row> {
    let wrong = |name: &str| Box::new(Double::twisting(robot, twist).named(name)) as Box<dyn Engine>;
    let engines = [Box::new(Featherbench::new()) as Box<dyn Engine>, wrong("a"), wrong("b"), Box::new(Double::of(robot).named("c"))];
    whole(&Accuracy::STATES, robot, &gates(""), &engines)
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
        let robot = robot(spec);
        assert_eq!(convicted(&records_of_a_wrong_majority(&robot, |_| ())), BTreeSet::new(), "{spec}");
        assert_eq!(convicted(&records_of_a_wrong_majority(&robot, |answer| scaled(answer, Quantity::InverseDynamics))), guilty, "{spec}");
        assert_eq!(convicted(&records_of_a_wrong_majority(&robot, |answer| scaled(answer, Quantity::MassMatrix))), guilty, "{spec}");
    }
    // Forward dynamics, where the error without the mistake is far below 1e-12: the bound is sharp there.
    for spec in ["joints:kind=common,base=fixed,shape=single", "joints:kind=common,base=free,shape=single", "chain:n=2", "star:n=10"] {
        let robot = robot(spec);
        assert_eq!(convicted(&records_of_a_wrong_majority(&robot, |answer| scaled(answer, Quantity::ForwardDynamics))), guilty, "{spec}");
    }
}

#[test]
fn one_wrong_entry_of_m_or_of_the_torques_is_enough() {
    let robot = robot("humanoid");
    let spoil_one = |answer: Answer| match answer.quantity {
        Quantity::InverseDynamics | Quantity::MassMatrix => {
            // The last entry: the lightest body's.
            if let Some(last) = answer.values.last_mut() {
                *last *= 1.0 + 1e-11;
            }
        }
        _ => (),
    };
    assert_eq!(convicted(&records_of_a_wrong_majority(&robot, spoil_one)), BTreeSet::from(["a", "b"]));
}

#[test]
fn engines_that_stop_at_one_error_make_the_reference_the_suspect() {
    let robot = robot("chain:n=10,layout=spatial");
    // If all engines agree on another mass, the truth seems to be limited to 1e-9.
    let other = |name: &str| {
        let heavier = Double::altered(&robot, |description| description.bodies[4].mass *= 1.0 + 1e-9);
        Box::new(heavier.named(name)) as Box<dyn Engine>
    };
    let limited = |engines: &[Box<dyn Engine>]| -> Vec<f64> {
        let records = whole(&Accuracy::STATES, &robot, &gates(""), engines);
        records.iter().filter(|row| row.metric == "limited_by_the_reference").filter_map(|row| row.value).collect()
    };
    assert_eq!(limited(&[other("a"), other("b"), other("c")]), [3.0]);
    assert_eq!(
        limited(&[Box::new(Featherbench::new()), other("a"), other("b"), other("c")]),
        [0.0; 0],
        "one that is nearer shows that the reference does not limit"
    );
}
