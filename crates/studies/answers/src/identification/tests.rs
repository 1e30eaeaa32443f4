use super::*;
use crate::tests::{but_long, cases_differ, numbers_are_as_known, wrong_numbers_fail};

#[test]
fn known_numbers_are_reproduced() {
    let cases = cases();
    assert!(cases_differ(&cases) > 90);
    let passed = numbers_are_as_known(STUDY, but_long(cases, |case| case.name == "puma560" && case.method == "log_cholesky"));
    assert!(passed > 150, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 300, "{judged}");
}
