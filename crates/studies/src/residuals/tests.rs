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
