//! Oracles that misbehave: each is a few lines of shell that speak the protocol of `oracles/PROTOCOL.md` until they do not.
//!
//! Whatever a program does, the harness gets a [`Refusal`] with a reason in time, no answer is taken for that to another question, and the
//! next question goes to a process that is well.

use featherbench_engines::{Limits, Oracle};
use harness::{FileBase, FileFormat, Problem, Quantity, Reading, Refusal, RobotFile, Subject};
use model::StateBatch;
use model::generate::Family;
use record::ModelOrigin;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The answer of an honest shell: the number two at each of two states.
const TWO: &str = r#"value '\0\0\0\0\0\0\0\100\0\0\0\0\0\0\0\100'"#;
const READBACK: &str = r#"echo '{"status":"ok","nq":1,"nv":1,"blocks":[{"name":"readback","shape":[1,22]}]}'; head -c 176 /dev/zero"#;
const HELLO: &str =
    r#"echo '{"status":"ok","protocol":1,"engine":"shell","version":"1","build":{"language":"sh"},"methods":{"id":["x"]}}'"#;

/// A reading of one pendulum.
const READING: &str = r#"echo '{"status":"ok","nq":1,"nv":1,"notes":[{"cause":"mass_edited","subject":"rod","text":"0 kg became 1 kg"}],"model":{"format":1,"name":"p","gravity":[0.0,0.0,-9.81],"bodies":[{"name":"rod","mass":1.0,"com":[0.5,0.0,0.0],"inertia":[0.01,0.0,0.0,0.08,0.0,0.08],"parent":-1,"joint":{"name":"hinge","type":"revolute","axis":[0.0,1.0,0.0],"placement":{"rotation":[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0],"translation":[0.0,0.0,0.0]}}}]}}'"#;

/// How a shell oracle answers; `$1` is a folder of its own.
struct Script {
    hello: String,
    prepare: String,
    read: String,
    evaluate: String,
}

impl Script {
    fn honest() -> Self {
        Self { hello: HELLO.into(), prepare: READBACK.into(), read: READING.into(), evaluate: TWO.into() }
    }

    fn hello(hello: &str) -> Self {
        Self { hello: hello.into(), ..Self::honest() }
    }

    fn prepare(prepare: &str) -> Self {
        Self { prepare: prepare.into(), ..Self::honest() }
    }

    fn reading(read: &str) -> Self {
        Self { read: read.into(), ..Self::honest() }
    }

    fn evaluate(evaluate: &str) -> Self {
        Self { evaluate: evaluate.into(), ..Self::honest() }
    }

    fn command(&self, folder: &Path) -> Vec<OsString> {
        let Self { hello, prepare, read, evaluate } = self;
        // Two states of one dof and one body: q, v, a, τ, a wrench each, and four probes.
        let states = 8 * (2 * (4 + 6) + 4);
        let script = format!(
            r#"
            value() {{ echo '{{"status":"ok","blocks":[{{"name":"value","shape":[2]}}]}}'; printf "$1"; }}
            echo $$ >> "$1/pids"
            while read -r line; do
                case "$line" in
                    *'"op":"hello"'*) {hello};;
                    *'"op":"prepare"'*) {prepare};;
                    *'"op":"read"'*) echo "$line" >> "$1/read"; {read};;
                    *'"op":"states"'*) head -c {states} > "$1/states"; echo '{{"status":"ok"}}';;
                    *) {evaluate};;
                esac
            done"#
        );
        ["sh".into(), "-c".into(), script.into(), "oracle".into(), folder.into()].into()
    }
}

/// A shell oracle with its folder.
struct Trial {
    folder: TempDir,
    oracle: Result<Oracle, String>,
    problem: Problem,
}

/// Long enough that an honest shell is never late on a busy machine.
const PATIENT: Limits = Limits { answer: Duration::from_secs(20), memory: 1 << 30 };
/// Short enough for a test.
const HASTY: Limits = Limits { answer: Duration::from_millis(500), memory: 1 << 30 };
/// What a refusal may take beyond the limit of an answer: the grace for a dying process, and a busy machine.
const SOON: Duration = Duration::from_secs(4);

fn robot(spec: &str) -> Problem {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    Problem::new(&description, "chain", ModelOrigin::Generated, 2, 1).unwrap()
}

impl Trial {
    fn new(script: &Script, limits: Limits) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let oracle = Oracle::start(script.command(folder.path()), limits);
        Self { folder, oracle, problem: robot("chain:n=1") }
    }

    /// Asks for the inverse dynamics at both states.
    fn ask(&self) -> Result<Vec<f64>, Refusal> {
        self.ask_about(&self.problem)
    }

    fn ask_about(&self, problem: &Problem) -> Result<Vec<f64>, Refusal> {
        let oracle = self.oracle.as_ref().unwrap();
        let mut prepared = oracle.prepare(problem, Quantity::InverseDynamics, "x", &problem.states)?;
        prepared.run(0..2)?;
        Ok(prepared.read().to_vec())
    }

    /// The reason of a failure.
    #[track_caller]
    fn failure(&self) -> String {
        match self.ask() {
            Err(Refusal::Failed(reason)) => reason,
            other => panic!("{other:?}"),
        }
    }

    /// The processes that were started.
    fn pids(&self) -> Vec<String> {
        let text = std::fs::read_to_string(self.folder.path().join("pids")).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

fn lives(pid: &str) -> bool {
    let status = Command::new("sh").args(["-c", "kill -0 \"$1\" 2> /dev/null", "kill", pid]).status().unwrap();
    status.success()
}

/// The reason why an oracle does not start.
#[track_caller]
fn stillborn(script: &Script) -> String {
    Trial::new(script, PATIENT).oracle.err().unwrap()
}

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
    let q: Vec<u8> = trial.problem.states.q.iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(states[..16], q, "the states arrive to the bit");
    drop(trial);
    assert!(!lives(&pids[0]), "a dropped oracle is gone");
}

/// States are sent once, and again when any number of them is another.
#[test]
fn other_states_are_sent() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let sent = || std::fs::read(trial.folder.path().join("states")).unwrap();
    trial.ask().unwrap();
    let first = sent();
    let numbers: [fn(&mut StateBatch) -> &mut Vec<f64>; 5] =
        [|states| &mut states.q, |states| &mut states.v, |states| &mut states.a, |states| &mut states.tau, |states| &mut states.wrench];
    for (k, of) in numbers.into_iter().enumerate() {
        let mut states = trial.problem.states.clone();
        of(&mut states)[1] += 0.5;
        trial.oracle.as_ref().unwrap().prepare(&trial.problem, Quantity::InverseDynamics, "x", &states).unwrap();
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
            r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[2]}]}'; printf '12345678'; echo 'Segmentation fault, as they say' >&2; exit 3"#,
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

#[test]
fn a_hanging_one_is_ended_in_time() {
    for script in [Script::prepare("exec sleep 1000"), Script::evaluate("exec sleep 1000"), Script::evaluate("exec sleep 1000 >&-")] {
        let trial = Trial::new(&script, HASTY);
        let start = Instant::now();
        let reason = trial.failure();
        assert!(start.elapsed() < HASTY.answer + SOON, "{:?}: {reason}", start.elapsed());
        assert!(reason.contains("no answer within 0.5 s") || reason.contains("did not end"), "{reason}");
        assert!(!lives(&trial.pids()[0]), "it was ended");
    }
}

/// A description of a thousand bodies does not fit a pipe: who never reads it must not stop us writing.
#[test]
fn a_deaf_one_is_ended_in_time() {
    let trial = Trial::new(&Script::hello(&format!("{HELLO}; exec sleep 1000")), HASTY);
    let start = Instant::now();
    let refusal = trial.ask_about(&robot("chain:n=1000")).unwrap_err();
    assert_eq!(refusal, Refusal::Failed("no answer within 0.5 s".into()));
    assert!(start.elapsed() < HASTY.answer + SOON);
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
    // Without an end of line there is no header to refuse.
    let start = Instant::now();
    let trial = Trial::new(&Script::prepare("exec cat /dev/zero"), HASTY);
    trial.failure();
    assert!(start.elapsed() < HASTY.answer + SOON);
    assert!(!lives(&trial.pids()[0]));
    // On standard error it is free to talk, with and without lines.
    let talk = format!("yes 'all is well' | head -n 200000 >&2; head -c 3000000 /dev/zero >&2; {TWO}");
    assert_eq!(Trial::new(&Script::evaluate(&talk), PATIENT).ask(), Ok(vec![2.0, 2.0]));
}

#[test]
fn a_lying_header_is_refused() {
    let cases = [
        (r#"echo '{"status":"ok"}'"#, "no block 'value'"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[3]}]}'; head -c 24 /dev/zero"#, "has 3 numbers, 2 are due"),
        (r#"echo '{"status":"ok","blocks":[{"name":"value","shape":[0]}]}'"#, "has 0 numbers, 2 are due"),
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
            assert_eq!(trial.ask(), Err(Refusal::Unsupported("no such joint".into())));
        }
        assert_eq!(trial.pids().len(), 1, "an answer is no reason to start again");
    }
}

/// An oracle that has a clock is asked for it; of any other the whole conversation is timed.
#[test]
fn the_clock_is_the_oracles_where_it_has_one() {
    let hello = HELLO.replace(r#""protocol":1"#, r#""protocol":1,"clock":true"#);
    let answering = |nanoseconds: &str| Script {
        hello: hello.clone(),
        evaluate: format!(r#"case "$line" in *'"op":"clock"'*) echo '{{"status":"ok"{nanoseconds}}}';; *) {TWO};; esac"#),
        ..Script::honest()
    };
    let clock = |script: &Script| {
        let trial = Trial::new(script, PATIENT);
        let oracle = trial.oracle.as_ref().unwrap();
        let mut prepared = oracle.prepare(&trial.problem, Quantity::InverseDynamics, "x", &trial.problem.states)?;
        let clocked = prepared.clock(0..2)?;
        Ok((clocked, prepared.read().to_vec()))
    };
    assert_eq!(clock(&answering(r#","nanoseconds":1500"#)), Ok((Duration::from_nanos(1500), Vec::new())));
    for broken in ["", r#","nanoseconds":"soon""#, r#","nanoseconds":-1"#] {
        assert!(matches!(clock(&answering(broken)), Err(Refusal::Failed(reason)) if reason.contains("nanoseconds")), "{broken}");
    }
    let (clocked, values) = clock(&Script::evaluate(&format!("sleep 0.05; {TWO}"))).unwrap();
    assert!(clocked >= Duration::from_millis(50) && values == [2.0, 2.0], "{clocked:?} {values:?}");
}

/// An oracle whose clock estimates names what it times, tells what it subtracted, and its identity says so.
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
        let mut prepared = oracle.prepare(&trial.problem, Quantity::InverseDynamics, "y", &trial.problem.states)?;
        assert_eq!(prepared.overhead(), None, "nothing was timed yet");
        let clocked = prepared.clock(0..2)?;
        Ok((clocked, prepared.overhead()))
    };
    let told = (Duration::from_nanos(1500), Some(Duration::from_nanos(900)));
    assert_eq!(clock(r#","nanoseconds":1500,"overhead":900"#), Ok(told));
    assert!(matches!(clock(r#","nanoseconds":1500"#), Err(Refusal::Failed(reason)) if reason.contains("overhead")));
    assert!(matches!(clock(r#","overhead":900"#), Err(Refusal::Failed(reason)) if reason.contains("nanoseconds")));
    for clock in ["", r#","clock":true"#, r#","clock":false"#] {
        let trial = Trial::new(&Script::hello(&hello(clock)), PATIENT);
        let oracle = trial.oracle.as_ref().unwrap();
        assert!(!oracle.estimates() && !oracle.identity().build.contains_key("clock"), "{clock}");
        assert_eq!(oracle.timed(Quantity::InverseDynamics).len(), 2);
    }
    let malformed = Trial::new(&Script::hello(&hello(r#","clock":"estimate","timed":7"#)), PATIENT);
    assert!(malformed.oracle.is_err_and(|reason| reason.starts_with("hello: timed")));
}

#[test]
fn numbers_that_are_none_come_through() {
    let trial = Trial::new(&Script::evaluate(r"value '\0\0\0\0\0\0\370\177\0\0\0\0\0\0\360\377'"), PATIENT);
    let values = trial.ask().unwrap();
    assert!(values[0].is_nan() && values[1] == f64::NEG_INFINITY, "{values:?}");
}

/// The first process answers one, too late; the second answers two.
#[test]
fn a_late_answer_belongs_to_no_later_question() {
    let one = TWO.replace(r"\0\100", r"\360\77");
    let script = Script::evaluate(&format!("if mkdir \"$1/first\" 2> /dev/null; then sleep 2; {one}; else {TWO}; fi"));
    let trial = Trial::new(&script, Limits { answer: Duration::from_secs(1), ..HASTY });
    assert_eq!(trial.failure(), "no answer within 1 s");
    for _ in 0..3 {
        assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]));
    }
    assert_eq!(trial.pids().len(), 2, "the late one was ended, another one started");
}

/// Requests are numbered; an answer that bears another number is not taken.
#[test]
fn an_answer_to_another_request_is_noticed() {
    let numbered = |id: u64| TWO.replace("value ", &format!("value{id} "));
    let value = |id: u64| {
        format!(r#"value{id}() {{ echo '{{"status":"ok","id":{id},"blocks":[{{"name":"value","shape":[2]}}]}}'; printf "$1"; }}"#)
    };
    // The fourth request of the process: hello, prepare, states, evaluate.
    let right = Script::evaluate(&format!("{}; {}", value(4), numbered(4)));
    assert_eq!(Trial::new(&right, PATIENT).ask(), Ok(vec![2.0, 2.0]));
    let reason = Trial::new(&Script::evaluate(&format!("{}; {}", value(3), numbered(3))), PATIENT).failure();
    assert_eq!(reason, "the oracle's answer is to request 3, not to 4");
}

/// Whatever breaks the first process, the next question is answered by another.
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

/// One answer too many stands before the answer to the next question.
#[test]
fn an_answer_without_a_question_is_noticed() {
    let script = Script::evaluate(&format!("{TWO}; {}", TWO.replace(r"\0\100", r"\360\77")));
    // It can be noticed only once it has arrived: give it more time with each attempt.
    let noticed = (0..50).any(|attempt| {
        let trial = Trial::new(&script, PATIENT);
        assert_eq!(trial.ask(), Ok(vec![2.0, 2.0]));
        std::thread::sleep(Duration::from_millis(attempt));
        matches!(trial.ask(), Err(Refusal::Failed(reason)) if reason.contains("before the question"))
    });
    assert!(noticed);
}

impl Trial {
    fn file(&self) -> RobotFile {
        RobotFile { path: "/robots/p.urdf".into(), format: FileFormat::Urdf, base: FileBase::Free, hash: "0".into() }
    }

    fn read(&self) -> Result<Reading, Refusal> {
        self.oracle.as_ref().unwrap().read(&self.file())
    }

    /// How often the engine was told to read.
    fn reads(&self) -> Vec<String> {
        let text = std::fs::read_to_string(self.folder.path().join("read")).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }
}

#[test]
fn a_file_is_read_once_and_computed_with_as_it_was_read() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let reading = trial.read().unwrap();
    assert_eq!((reading.description.bodies.len(), reading.description.bodies[0].name.as_str()), (1, "rod"));
    assert_eq!((reading.notes[0].cause.as_str(), reading.notes[0].subject.as_deref()), ("mass_edited", Some("rod")));
    let problem = robot("chain:n=1").from_file(trial.file());
    let as_read = problem.as_read(&reading, |model| StateBatch::agreement(model, 2, 1)).unwrap();
    assert_ne!(as_read.hash, problem.hash, "the route is part of what is asked");
    assert_eq!(trial.ask_about(&as_read).unwrap(), [2.0, 2.0]);
    assert_eq!(trial.reads().len(), 1, "the session still holds what it has read");
    assert!(
        trial.reads()[0].contains(r#""base":"free""#) && trial.reads()[0].contains(r#""file":"/robots/p.urdf""#),
        "{:?}",
        trial.reads()
    );
    // Something else in between: the file must be read again.
    assert_eq!(trial.ask().unwrap(), [2.0, 2.0]);
    assert_eq!(trial.ask_about(&as_read).unwrap(), [2.0, 2.0]);
    assert_eq!(trial.reads().len(), 2);
}

#[test]
fn a_reading_that_is_no_robot_is_a_failure() {
    let cases = [
        (r#"echo '{"status":"ok","nq":1,"nv":1}'"#.to_owned(), "there is no model"),
        (READING.replace("\"nv\":1", "\"nv\":2"), "nv is 2"),
        (READING.replace("\"mass\":1.0", "\"mass\":-1.0"), "negative"),
        (READING.replace("revolute", "fixed").replace("\"axis\":[0.0,1.0,0.0],", ""), "no moving body"),
        (r#"echo '{"status":"error","reason":"line 3: what is this?"}'"#.to_owned(), "line 3"),
    ];
    for (read, words) in cases {
        match Trial::new(&Script::reading(&read), PATIENT).read() {
            Err(Refusal::Failed(reason)) => assert!(reason.contains(words), "{words}: {reason}"),
            other => panic!("{words}: {other:?}"),
        }
    }
}

#[test]
fn an_engine_that_reads_another_robot_the_second_time_is_not_believed() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let mut reading = trial.read().unwrap();
    reading.description.bodies[0].mass = 2.0;
    let problem = robot("chain:n=1").from_file(trial.file());
    let as_read = problem.as_read(&reading, |model| StateBatch::agreement(model, 2, 1)).unwrap();
    match trial.ask_about(&as_read) {
        Err(Refusal::Failed(reason)) => assert!(reason.contains("does not read the same robot twice"), "{reason}"),
        other => panic!("{other:?}"),
    }
}
