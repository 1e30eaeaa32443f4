use super::*;
use crate::tests::{Answered, answered, answers_are_as_known, but_long, cases_differ, wrong_numbers_fail};
use std::sync::LazyLock;

/// The answers: several tests ask for them, and motions of a thousand seconds take their time.
static ANSWERED: LazyLock<Vec<Answered>> = LazyLock::new(|| {
    let long = |case: &Case| case.quantity == "learning_draws" || case.method == "lagrangian net" && case.name.ends_with("no noise");
    answered(but_long(cases(), long))
});

#[test]
fn cases_are_different() {
    assert!(cases_differ(&cases()) >= 30);
}

#[test]
fn known_numbers_are_reproduced() {
    let passed = answers_are_as_known(STUDY, &ANSWERED);
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
        let of = |case: &Case| case.method == method && case.name.contains("noise 0.01");
        let (case, values) = ANSWERED.iter().find(|(case, _)| of(case)).unwrap();
        let values = values.as_ref().unwrap();
        // The last time that it reached.
        if values.len() < case.numbers.len() { f64::INFINITY } else { values[values.len() - 1] }
    };
    let [net, hamiltonian, black] = ["lagrangian net", "port-hamiltonian", "black box"].map(energy);
    assert!(black > 5.0 * net && black > 5.0 * hamiltonian, "{net} {hamiltonian} {black}");
}
