//! Oracles with faults: each is a few lines of shell that follow the protocol of `oracles/PROTOCOL.md` up to one point.
//!
//! Whatever a program does, the caller gets a [`NoAnswer`] with a reason in time. No answer is taken for that to another question, and the
//! next question goes to a new process.

mod clock;
mod import;
mod script;
mod steps;

use featherbench_bench::{Engine, NoAnswer, Quantity};
use featherbench_engines::{Limits, Oracle};
use featherbench_robots::StateBatch;
use script::{HELLO, PATIENT, READBACK, Script, TWO, Trial, lives, robot, stillborn};
use std::time::Duration;

#[test]
fn an_honest_shell_is_heard() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let oracle = trial.oracle.as_ref().unwrap();
    assert_eq!((oracle.identity().name.as_str(), oracle.identity().build["language"].as_str()), ("shell", "sh"));
    assert_eq!(oracle.methods(Quantity::InverseDynamics), ["x"]);
    assert_eq!((oracle.methods(Quantity::Bias).len(), oracle.methods(Quantity::Readback).len()), (0, 1));
    for _ in 0..3 {
        assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]));
    }
    let pids = trial.pids();
    assert_eq!(pids.len(), 1, "one process answers one thread");
    let states = std::fs::read(trial.folder.path().join("states")).unwrap();
    let q: Vec<u8> = trial.robot.states.q.iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(states[..16], q, "the states arrive to the bit");
    drop(trial);
    assert!(!lives(&pids[0]), "a dropped oracle is gone");
}

/// States are sent once, and again when any of their numbers changes.
#[test]
fn other_states_are_sent() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let sent = || std::fs::read(trial.folder.path().join("states")).unwrap();
    trial.ask().unwrap();
    let first = sent();
    let numbers: [fn(&mut StateBatch) -> &mut Vec<f64>; 5] =
        [|states| &mut states.q, |states| &mut states.v, |states| &mut states.a, |states| &mut states.tau, |states| &mut states.wrench];
    for (k, of) in numbers.into_iter().enumerate() {
        let mut states = trial.robot.states.clone();
        of(&mut states)[1] += 0.5;
        trial.oracle.as_ref().unwrap().prepare(&trial.robot, Quantity::InverseDynamics, "x", &states).unwrap();
        assert_ne!(sent(), first, "array {k}");
        trial.ask().unwrap();
        assert_eq!(sent(), first, "and back again");
    }
}

#[test]
fn threads_have_processes_of_their_own() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..5).for_each(|_| assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]))));
        }
    });
    let pids = trial.pids();
    assert!((1..=4).contains(&pids.len()), "{pids:?}");
    drop(trial);
    assert!(pids.iter().all(|pid| !lives(pid)));
}

#[test]
fn one_that_does_not_start_says_why() {
    let reason = stillborn(&Script::hello("echo 'libengine.so: no such file' >&2; exit 127"));
    assert!(reason.contains("libengine.so: no such file") && reason.contains("exit status: 127"), "{reason}");
    let reason = stillborn(&Script::hello("exit 0"));
    assert!(reason.contains("exit status: 0") && reason.contains("no message"), "{reason}");
    let reason = Oracle::start(vec!["/nowhere/at/all".into()], PATIENT).err().unwrap();
    assert!(reason.contains("/nowhere/at/all"), "{reason}");
    assert!(Oracle::start(Vec::new(), PATIENT).is_err());
}

#[test]
fn one_that_speaks_another_language_is_refused() {
    let reason = stillborn(&Script::hello(r#"echo '{"status":"ok","protocol":2,"engine":"shell","version":"1","methods":{}}'"#));
    assert!(reason.contains("protocol") && reason.contains('2'), "{reason}");
    let reason = stillborn(&Script::hello("echo 'Welcome to Engine 3.1!'"));
    assert!(reason.contains("not in the protocol"), "{reason}");
    let reason = stillborn(&Script::hello(r#"echo '{"status":"ok","protocol":1,"engine":"","version":"1"}'"#));
    assert!(reason.contains("engine and version"), "{reason}");
    let reason = stillborn(&Script::hello(r#"echo '{"status":"ok","protocol":1,"engine":"e","version":"1","methods":["id"]}'"#));
    assert!(reason.contains("methods"), "{reason}");
    let reason = stillborn(&Script::hello(r#"echo '{"status":"error","reason":"no licence"}'"#));
    assert_eq!(reason, "no licence");
}

#[test]
fn a_crash_is_told_with_its_last_words() {
    for script in [
        Script::prepare("echo 'Segmentation fault, as they say' >&2; exit 3"),
        Script::evaluate("echo 'Segmentation fault, as they say' >&2; exit 3"),
        // In the middle of a block.
        Script::evaluate(
            r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[2,1]}]}'; printf '12345678'; echo 'Segmentation fault, as they say' >&2; exit 3"#,
        ),
        // In the middle of a header.
        Script::evaluate(r#"printf '{"status":'; echo 'Segmentation fault, as they say' >&2; exit 3"#),
    ] {
        let reason = Trial::new(&script, PATIENT).failure();
        assert!(reason.contains("Segmentation fault, as they say") && reason.contains("exit status: 3"), "{reason}");
    }
    let reason = Trial::new(&Script::evaluate("kill -9 $$"), PATIENT).failure();
    assert!(reason.contains("signal: 9"), "{reason}");
}

/// The clock of the limit stops until the oracle says that it hangs: the load of the machine has no influence.
#[test]
fn a_hanging_one_is_ended_in_time() {
    for script in [Script::prepare("touch \"$1/late\"; exec sleep 1000"), Script::evaluate("touch \"$1/late\"; exec sleep 1000")] {
        let (trial, clock) = Trial::stopped(&script);
        clock.set_going(true);
        assert_eq!(trial.failure(), "no answer within 900 s");
        assert!(!lives(&trial.pids()[0]), "it was ended");
    }
}

/// Its output ends, and the process does not: the whole time-out for its exit passes, on any machine.
#[test]
fn one_that_closes_its_output_and_goes_on_is_ended() {
    let trial = Trial::new(&Script::evaluate("exec sleep 1000 >&-"), PATIENT);
    let reason = trial.failure();
    assert!(reason.contains("it closed its standard output and did not end"), "{reason}");
    assert!(!lives(&trial.pids()[0]), "it was ended");
}

/// A description of a thousand bodies does not fit a pipe. A process that never reads it must not block our writing.
#[test]
fn a_deaf_one_is_ended_in_time() {
    let (trial, clock) = Trial::stopped(&Script::hello(&format!("{HELLO}; touch \"$1/late\"; exec sleep 1000")));
    clock.set_going(true);
    let refusal = trial.ask_about(&robot("chain:n=1000")).unwrap_err();
    assert_eq!(refusal, NoAnswer::Failed("no answer within 900 s".into()));
    assert!(!lives(&trial.pids()[0]));
}

#[test]
fn a_glutton_meets_its_limit() {
    let limits = Limits { memory: 200 << 20, ..PATIENT };
    let trial = Trial::new(&Script::prepare("x=xxxxxxxx; while :; do x=$x$x; done"), limits);
    let reason = trial.failure();
    assert!(reason.contains("memory limit 200 MiB"), "{reason}");
    assert!(!lives(&trial.pids()[0]));
}

#[test]
fn floods_drown_nobody() {
    let reason = Trial::new(&Script::prepare("exec yes garbage"), PATIENT).failure();
    assert!(reason.contains("not in the protocol"), "{reason}");
    // Without an end of line there is no header to check.
    let (trial, clock) = Trial::stopped(&Script::prepare("touch \"$1/late\"; exec cat /dev/zero"));
    clock.set_going(true);
    trial.failure();
    assert!(!lives(&trial.pids()[0]));
    // Standard error may have any output, with and without lines.
    let talk = format!("yes 'all is well' | head -n 200000 >&2; head -c 3000000 /dev/zero >&2; {TWO}");
    assert_eq!(Trial::new(&Script::evaluate(&talk), PATIENT).ask(), Ok(vec![2.0, 2.0]));
}

#[test]
fn a_lying_header_is_refused() {
    let cases = [
        (r#"echo '{"status":"ok"}'"#, "no block 'value'"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[3]}]}'; head -c 24 /dev/zero"#, "has the shape [3]; [2, 1] is due"),
        (
            r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[1,2]}]}'; head -c 16 /dev/zero"#,
            "has the shape [1, 2]; [2, 1] is due",
        ),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[2]}]}'; head -c 16 /dev/zero"#, "has the shape [2]; [2, 1] is due"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[0]}]}'"#, "has the shape [0]; [2, 1] is due"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[1000000000000]}]}'"#, "too long"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[-2]}]}'"#, "a block must be"),
        ("echo '[1, 2]'", "not in the protocol"),
        ("echo", "not in the protocol"),
        (r#"echo '{"status":"maybe"}'"#, "status 'maybe'"),
        ("echo '{}'", "status ''"),
        (r#"echo '{"status":"error","reason":"singular"}'"#, "singular"),
        (r#"echo '{"status":"error"}'"#, "gives no reason"),
    ];
    for (evaluate, expected) in cases {
        let reason = Trial::new(&Script::evaluate(evaluate), PATIENT).failure();
        assert!(reason.contains(expected), "{evaluate}: {reason}");
    }
    let other = READBACK.replace("\"nv\":1", "\"nv\":2");
    let reason = Trial::new(&Script::prepare(&other), PATIENT).failure();
    assert!(reason.contains("nv") && reason.contains('2'), "{reason}");
}

#[test]
fn what_is_not_supported_is_told_apart_and_the_process_kept() {
    let refuse = r#"echo '{"status":"unsupported","reason":"no such joint"}'"#;
    for script in [Script::prepare(refuse), Script::evaluate(refuse)] {
        let trial = Trial::new(&script, PATIENT);
        for _ in 0..3 {
            assert_eq!(trial.ask(), Err(NoAnswer::NotOffered("no such joint".into())));
        }
        assert_eq!(trial.pids().len(), 1, "an answer is no reason to start again");
    }
}

#[test]
fn numbers_that_are_none_come_through() {
    let trial = Trial::new(&Script::evaluate(r"value '\0\0\0\0\0\0\370\177\0\0\0\0\0\0\360\377'"), PATIENT);
    let values = trial.ask().unwrap();
    assert!(values[0].is_nan() && values[1] == f64::NEG_INFINITY, "{values:?}");
}

/// The first process would answer one, and is late; the second answers two.
#[test]
fn a_late_answer_belongs_to_no_later_question() {
    let one = TWO.replace(r"\0\100", r"\360\77");
    let late = format!("touch \"$1/late\"; while [ ! -e \"$1/ended\" ]; do sleep 0.01; done; {one}");
    let script = Script::evaluate(&format!("if mkdir \"$1/first\" 2> /dev/null; then {late}; else {TWO}; fi"));
    let (trial, clock) = Trial::stopped(&script);
    clock.set_going(true);
    assert_eq!(trial.failure(), "no answer within 900 s");
    clock.set_going(false);
    // Now the first process would answer, had it not been ended.
    std::fs::write(trial.folder.path().join("ended"), "").unwrap();
    for _ in 0..3 {
        assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]));
    }
    assert_eq!(trial.pids().len(), 2, "the late one was ended, another one started");
}

/// Requests are numbered. An answer with another number is an error.
#[test]
fn an_answer_to_another_request_is_noticed() {
    let numbered = |id: u64| TWO.replace("value ", &format!("value{id} "));
    let value = |id: u64| {
        format!(r#"value{id}() {{ echo '{{"status":"ok","id":{id},"blocks":[{{"name":"value","shape":[2,1]}}]}}'; printf "$1"; }}"#)
    };
    // The fourth request of the process: hello, prepare, states, evaluate.
    let right = Script::evaluate(&format!("{}; {}", value(4), numbered(4)));
    assert_eq!(Trial::new(&right, PATIENT).ask(), Ok(vec![2.0, 2.0]));
    let reason = Trial::new(&Script::evaluate(&format!("{}; {}", value(3), numbered(3))), PATIENT).failure();
    assert_eq!(reason, "the oracle's answer is to request 3, not to 4");
}

/// After any failure of the first process, another process answers the next question.
#[test]
fn after_a_failure_another_process_answers() {
    for fault in ["exit 1", "echo garbage", "printf '{'; exit 1", "exec cat /dev/zero | tr '\\0' '\\n'"] {
        let script = Script::evaluate(&format!("if mkdir \"$1/first\" 2> /dev/null; then {fault}; else {TWO}; fi"));
        let trial = Trial::new(&script, PATIENT);
        trial.failure();
        assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]), "{fault}");
        assert_eq!(trial.pids().len(), 2, "{fault}");
    }
}

/// An answer without a question comes before the answer to the next question.
///
/// It can be noticed once it has arrived. After it the script writes more than a pipe and the reader's buffer can hold. When that is
/// written, the reader has passed on what came before.
#[test]
fn an_answer_without_a_question_is_noticed() {
    let long = r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[131072]}]}'; head -c 1048576 /dev/zero"#;
    let script = Script::evaluate(&format!("{TWO}; {}; {long}; touch \"$1/written\"", TWO.replace(r"\0\100", r"\360\77")));
    let trial = Trial::new(&script, PATIENT);
    assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]));
    while !trial.folder.path().join("written").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let reason = trial.failure();
    assert!(reason.contains("before the question"), "{reason}");
}
