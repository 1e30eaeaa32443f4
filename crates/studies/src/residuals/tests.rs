use super::*;
use crate::known::tests::{cases_differ, numbers_are_as_known, wrong_numbers_fail};

#[test]
fn cases_are_different() {
    assert!(cases_differ(&cases()) >= 30);
}

#[test]
fn known_numbers_are_reproduced() {
    let passed = numbers_are_as_known(STUDY, &cases());
    assert!(passed > 50, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 100, "{judged}");
}

/// Structure is worth something: with noise, the black box has left the true energy where the structured models are near it.
#[test]
fn structure_holds_the_energy() {
    let energy = |method: &str| {
        let case = cases().into_iter().find(|case| case.method == method && case.name.contains("noise 0.01")).unwrap();
        let values = (case.evaluate)(1).unwrap();
        // The last time that it reached.
        if values.len() < case.numbers.len() { f64::INFINITY } else { values[values.len() - 1] }
    };
    let [net, hamiltonian, black] = ["lagrangian net", "port-hamiltonian", "black box"].map(energy);
    assert!(black > 5.0 * net && black > 5.0 * hamiltonian, "{net} {hamiltonian} {black}");
}

/// Degrees and ridges of the noisy fits are those that validation chooses, on draws that are not judged.
#[test]
fn validation_chooses_degree_and_ridge() {
    let (structured, black, ridges) = learning::GRID;
    for (model, degrees) in [("port-hamiltonian", structured.as_slice()), ("black box", black.as_slice())] {
        let choices = degrees.iter().flat_map(|&degree| ridges.map(|ridge| (degree, ridge)));
        let errors: Vec<_> = choices.map(|choice| (choice, learning::validated(model, choice))).collect();
        let best = errors.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(best.1.is_finite());
        assert_eq!(best.0, learning::chosen(model, 1), "{model}: {errors:?}");
    }
    assert!(learning::VALIDATION.iter().all(|&seed| seed > 9000), "suites have small seeds");
}
