use super::*;
use crate::tests::{cases_differ, numbers_are_as_known, wrong_numbers_fail};

#[test]
fn no_case_is_there_twice() {
    assert!(cases_differ(&cases()) > 50);
}

#[test]
fn known_numbers_are_reproduced() {
    let passed = numbers_are_as_known(STUDY, cases());
    assert!(passed > 90, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 180, "{judged}");
}

/// The same seed gives the same bits.
#[test]
fn samples_repeat() {
    let case = cases().into_iter().find(|case| case.quantity == "arm").unwrap();
    assert_eq!((case.evaluate)(7).unwrap(), (case.evaluate)(7).unwrap());
}
