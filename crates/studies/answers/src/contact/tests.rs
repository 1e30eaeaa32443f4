use super::*;
use crate::tests::{but_long, cases_differ, numbers_are_as_known, wrong_numbers_fail};

/// No case twice, and every problem of the crate has one.
#[test]
fn every_problem_has_a_case() {
    let cases = cases();
    assert!(cases_differ(&cases) > 250);
    let problems = featherbench_contact::systems::all().unwrap();
    assert_eq!(problems.len(), 18);
    for problem in problems {
        assert!(cases.iter().any(|case| case.name == problem.name()), "{}", problem.name());
    }
}

#[test]
fn known_numbers_are_reproduced() {
    // The motions of the squeezer are tested where they are computed, too.
    let long = |case: &Case| case.name.ends_with(", 64 contacts") || case.name.starts_with("Andrews' squeezer at");
    let passed = numbers_are_as_known(STUDY, but_long(cases(), long));
    assert!(passed > 300, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 600, "{judged}");
}

/// The same seed gives the same bits.
#[test]
fn draws_repeat() {
    let case = cases().into_iter().find(|case| case.quantity == "contact_draws").unwrap();
    assert_eq!((case.evaluate)(7).unwrap(), (case.evaluate)(7).unwrap());
}
