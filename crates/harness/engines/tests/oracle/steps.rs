//! Shell oracles that integrate: what is sent, what is returned, and the error for wrong `steps`.

use super::script::{HELLO, PATIENT, Script, Trial, stillborn};
use featherbench_bench::{Engine, NoAnswer, Stepper};

/// One number, two, as the answer about one state.
const STEP: &str = r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[1,1]}]}'; printf '\0\0\0\0\0\0\0\100'"#;
/// Three energies of two.
const FALL: &str =
    r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[1,3]}]}'; for i in 1 2 3; do printf '\0\0\0\0\0\0\0\100'; done"#;

fn hello(steps: &str) -> String {
    HELLO.replace(r#""methods""#, &format!(r#""steps":{steps},"methods""#))
}

/// An oracle that says this about its steps, and answers so.
fn trial(steps: &str, step: &str, fall: &str) -> Trial {
    let evaluate = format!(r#"echo "$line" >> "$1/asked"; case "$line" in *'"op":"step"'*) {step};; *) {fall};; esac"#);
    Trial::new(&Script { hello: hello(steps), evaluate, ..Script::honest() }, PATIENT)
}

fn stepper(trial: &Trial) -> &dyn Stepper {
    trial.oracle.as_ref().unwrap().stepper().unwrap()
}

#[test]
fn steps_are_asked_for_and_heard() {
    let trial = trial(r#"{"methods":["x","y"],"guard":0.25}"#, STEP, FALL);
    let (stepper, robot) = (stepper(&trial), &trial.robot);
    assert_eq!((stepper.step_methods(), stepper.guard()), (vec!["x".to_owned(), "y".to_owned()], Some(0.25)));
    assert_eq!(stepper.step_acceleration(robot, "x", &robot.states, 1, 1e-10), Ok(vec![2.0]));
    assert_eq!(stepper.fall(robot, "y", &robot.states, 0, 0.1, 3), Ok(vec![2.0; 3]));
    let asked = std::fs::read_to_string(trial.folder.path().join("asked")).unwrap();
    let asked: Vec<serde_json::Value> = asked.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (line, words) in asked.iter().zip([
        r#"{"op":"step","method":"x","first":1,"count":1,"dt":1e-10}"#,
        r#"{"op":"fall","method":"y","first":0,"count":1,"dt":0.1,"steps":3}"#,
    ]) {
        let due: serde_json::Map<String, serde_json::Value> = serde_json::from_str(words).unwrap();
        assert!(due.iter().all(|(key, value)| line[key] == *value), "{line} is not {words}");
    }
    assert_eq!((asked.len(), trial.pids().len()), (2, 1));
}

#[test]
fn one_that_does_not_integrate_offers_no_steps() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let oracle = trial.oracle.as_ref().unwrap();
    assert!(oracle.stepper().is_none());
    assert!(oracle.step_methods().is_empty() && oracle.guard().is_none());
}

#[test]
fn an_answer_of_another_shape_is_refused() {
    let trial = trial(r#"{"methods":["x"]}"#, FALL, STEP);
    let (stepper, robot) = (stepper(&trial), &trial.robot);
    assert_eq!(stepper.guard(), None);
    let reason = |answer| match answer {
        Err(NoAnswer::Failed(reason)) => reason,
        other => panic!("{other:?}"),
    };
    let step = reason(stepper.step_acceleration(robot, "x", &robot.states, 0, 0.1));
    let fall = reason(stepper.fall(robot, "x", &robot.states, 0, 0.1, 3));
    assert!(step.contains("[1, 3]") && step.contains("[1, 1] is due"), "{step}");
    assert!(fall.contains("[1, 1]") && fall.contains("[1, 3] is due"), "{fall}");
}

#[test]
fn what_it_does_not_have_is_unsupported_and_the_next_question_answered() {
    let lacking = r#"echo '{"status":"unsupported","reason":"no falls here"}'"#;
    let trial = trial(r#"{"methods":["x"]}"#, STEP, lacking);
    let (stepper, robot) = (stepper(&trial), &trial.robot);
    assert_eq!(stepper.fall(robot, "x", &robot.states, 0, 0.1, 3), Err(NoAnswer::NotOffered("no falls here".into())));
    assert_eq!(stepper.step_acceleration(robot, "x", &robot.states, 0, 0.1), Ok(vec![2.0]));
    assert_eq!(trial.pids().len(), 1);
}

#[test]
fn steps_that_are_none_are_named() {
    for (steps, word) in [
        ("7", "steps"),
        (r#"{"guard":1.0}"#, "methods"),
        (r#"{"methods":[]}"#, "no method"),
        (r#"{"methods":[""]}"#, "without a name"),
        (r#"{"methods":["x"],"guard":0.0}"#, "guard"),
        (r#"{"methods":["x"],"guard":"soon"}"#, "steps"),
    ] {
        let reason = stillborn(&Script::hello(&hello(steps)));
        assert!(reason.contains("hello") && reason.contains(word), "{steps}: {reason}");
    }
}
