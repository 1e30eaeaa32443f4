use super::*;
use crate::tests::{but_long, cases_differ, numbers_are_as_known, wrong_numbers_fail};

#[test]
fn cases_have_names_of_their_own() {
    assert!(cases_differ(&cases()) > 80);
}

#[test]
fn known_numbers_are_reproduced() {
    let passed = numbers_are_as_known(STUDY, but_long(cases(), |case| case.quantity == "momentum" && case.method != "links_middle"));
    assert!(passed > 90, "{passed}");
}

#[test]
fn wrong_numbers_are_seen() {
    let judged = wrong_numbers_fail(STUDY, &cases());
    assert!(judged > 180, "{judged}");
}

/// The committed files are what the code describes: `cargo run -p featherbench-registry --example soft_robots` writes them.
#[test]
fn files_of_soft_robots_are_those_of_the_code() {
    let models = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/models");
    for robot in [featherbench_continua::examples::gripper(), featherbench_continua::examples::cable_arm()] {
        let path = models.join("soft").join(format!("{}.json", robot.name));
        assert_eq!(featherbench_formats::neutral::read(&path).unwrap(), robot);
    }
}
