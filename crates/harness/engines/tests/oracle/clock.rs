//! Which clock measures, and which times are estimates.

use super::script::{HELLO, PATIENT, Script, TWO, Trial};
use featherbench_bench::{Engine, NoAnswer, Quantity};
use featherbench_engines::Clock;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A clock that shows the milliseconds that the script has written into the file `now` of its folder, or zero.
struct Told(PathBuf);

impl Clock for Told {
    fn now(&self) -> Duration {
        let text = std::fs::read_to_string(&self.0).unwrap_or_default();
        Duration::from_millis(text.trim().parse().unwrap_or(0))
    }
}

/// An oracle that has a clock is asked for the time. For any other oracle the whole request and answer are timed.
#[test]
fn the_clock_is_the_oracles_where_it_has_one() {
    let hello = HELLO.replace(r#""protocol":1"#, r#""protocol":1,"clock":true"#);
    let answering = |nanoseconds: &str| Script {
        hello: hello.clone(),
        evaluate: format!(r#"case "$line" in *'"op":"clock"'*) echo '{{"status":"ok"{nanoseconds}}}';; *) {TWO};; esac"#),
        ..Script::honest()
    };
    let clock = |script: &Script| {
        let folder = tempfile::tempdir().unwrap();
        let told = Arc::new(Told(folder.path().join("now")));
        let trial = Trial::by(script, PATIENT, folder, told);
        let oracle = trial.oracle.as_ref().unwrap();
        let mut prepared = oracle.prepare(&trial.robot, Quantity::InverseDynamics, "x", &trial.robot.states)?;
        let clocked = prepared.clock(0..2)?;
        Ok((clocked, prepared.read().to_vec()))
    };
    assert_eq!(clock(&answering(r#","nanoseconds":1500"#)), Ok((Duration::from_nanos(1500), Vec::new())));
    for broken in ["", r#","nanoseconds":"soon""#, r#","nanoseconds":-1"#] {
        assert!(matches!(clock(&answering(broken)), Err(NoAnswer::Failed(reason)) if reason.contains("nanoseconds")), "{broken}");
    }
    let asked = Script::evaluate(&format!("echo 50 > \"$1/now\"; {TWO}"));
    assert_eq!(clock(&asked), Ok((Duration::from_millis(50), vec![2.0, 2.0])), "from the question to the answer");
}

/// An oracle whose clock estimates lists the methods that it times and what it subtracted, and its identity says so.
#[test]
fn an_estimating_clock_is_known_as_one() {
    let hello = |clock: &str| HELLO.replace(r#""methods":{"id":["x"]}"#, &format!(r#""methods":{{"id":["x","y"]}}{clock}"#));
    let answering = |times: &str| Script {
        hello: hello(r#","clock":"estimate","timed":{"id":["y"]}"#),
        evaluate: format!(r#"echo '{{"status":"ok"{times}}}'"#),
        ..Script::honest()
    };
    let clock = |times: &str| {
        let trial = Trial::new(&answering(times), PATIENT);
        let oracle = trial.oracle.as_ref().unwrap();
        assert!(oracle.estimates());
        assert_eq!((oracle.methods(Quantity::InverseDynamics).len(), oracle.timed(Quantity::InverseDynamics)), (2, vec!["y".to_owned()]));
        assert!(oracle.timed(Quantity::Bias).is_empty());
        assert!(oracle.identity().build["clock"].starts_with("estimate: "), "{:?}", oracle.identity().build);
        let mut prepared = oracle.prepare(&trial.robot, Quantity::InverseDynamics, "y", &trial.robot.states)?;
        assert_eq!(prepared.overhead(), None, "nothing was timed yet");
        let clocked = prepared.clock(0..2)?;
        Ok((clocked, prepared.overhead()))
    };
    let told = (Duration::from_nanos(1500), Some(Duration::from_nanos(900)));
    assert_eq!(clock(r#","nanoseconds":1500,"overhead":900"#), Ok(told));
    assert!(matches!(clock(r#","nanoseconds":1500"#), Err(NoAnswer::Failed(reason)) if reason.contains("overhead")));
    assert!(matches!(clock(r#","overhead":900"#), Err(NoAnswer::Failed(reason)) if reason.contains("nanoseconds")));
    for clock in ["", r#","clock":true"#, r#","clock":false"#] {
        let trial = Trial::new(&Script::hello(&hello(clock)), PATIENT);
        let oracle = trial.oracle.as_ref().unwrap();
        assert!(!oracle.estimates() && !oracle.identity().build.contains_key("clock"), "{clock}");
        assert_eq!(oracle.timed(Quantity::InverseDynamics).len(), 2);
    }
    let malformed = Trial::new(&Script::hello(&hello(r#","clock":"estimate","timed":7"#)), PATIENT);
    assert!(malformed.oracle.is_err_and(|reason| reason.starts_with("hello: timed")));
}
