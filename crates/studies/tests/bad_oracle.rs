//! A run with a broken engine goes on: error rows for that engine alone, whether its process crashes or hangs, and everything else judged as
//! if it were not there.

mod support;

use engines::{Limits, Native, Oracle};
use harness::Subject;
use record::{Record, Verdict};
use std::time::Duration;
use support::{agreement, gates, red, robot, suite};

/// A process that says hello, and then does this.
fn broken(fault: &str, answer: Duration) -> Box<dyn Subject> {
    let hello =
        r#"{"status":"ok","protocol":1,"engine":"broken","version":"1","methods":{"id":["a","b"],"fd":["a"],"body_jacobian":["a"]}}"#;
    let script = format!("while read -r line; do case \"$line\" in *'\"op\":\"hello\"'*) echo '{hello}';; *) {fault};; esac; done");
    let command = vec!["sh".into(), "-c".into(), script.into()];
    Box::new(Oracle::start(command, Limits { answer, memory: 1 << 30 }).unwrap())
}

#[track_caller]
fn goes_on(fault: &str, answer: Duration, reason: &str) {
    let problem = robot("joints:kind=revolute,base=fixed");
    let gates = gates("");
    let alone = agreement(&problem, &gates, &[Box::new(Native::new())]);
    let records = agreement(&problem, &gates, &[Box::new(Native::new()), broken(fault, answer)]);
    let (errors, rest): (Vec<Record>, Vec<Record>) = records.into_iter().partition(|row| row.engine == "broken");
    assert_eq!(rest, alone);
    let quantities: Vec<&str> = errors.iter().map(|row| row.quantity.as_str()).collect();
    assert_eq!(quantities, ["readback", "id", "id", "fd", "body_jacobian"], "one row for each question");
    for row in &errors {
        assert_eq!((row.verdict, row.value), (Verdict::Error, None));
        assert!(row.reason.contains(reason), "{}", row.reason);
    }
    let all: Vec<Record> = rest.into_iter().chain(errors).collect();
    assert_eq!(red(&gates.conditions(&suite(&all), &all, true)), ["rows without a value that was due"]);
}

#[test]
fn when_an_engine_crashes() {
    goes_on("echo 'out of luck' >&2; exit 1", Duration::from_secs(20), "out of luck");
}

#[test]
fn when_an_engine_babbles() {
    goes_on("echo hm", Duration::from_secs(20), "not in the protocol");
}

#[test]
fn when_an_engine_hangs() {
    goes_on("exec sleep 1000", Duration::from_millis(500), "no answer within 0.5 s");
}
