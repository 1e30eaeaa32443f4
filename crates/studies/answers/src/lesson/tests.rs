use super::*;
use crate::tests::{cases_differ, numbers_are_as_known, wrong_numbers_fail};

#[test]
fn every_claim_has_a_case() {
    let cases = cases();
    assert!(cases_differ(&cases) > 150);
    for claim in claims::all() {
        assert!(cases.iter().any(|case| case.quantity == claim.id && case.name != "all"), "{}", claim.id);
    }
}

#[test]
fn numbers_are_right_and_the_lesson_misses_by_as_much_as_known() {
    let passed = numbers_are_as_known(STUDY, cases());
    assert!(passed > 150, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 300, "{judged}");
}
