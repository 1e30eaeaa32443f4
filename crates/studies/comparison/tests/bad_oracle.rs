//! A run with a broken engine goes on, whether the engine's process crashes or hangs. There are error rows for that engine alone, and
//! everything else is judged as if it were not there.

use featherbench_bench::Engine;
use featherbench_doubles::{agreement, gates, red, robot, suite};
use featherbench_engines::{Clock, Featherbench, Limits, Oracle};
use featherbench_results::{Row, Verdict};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The longest wait for an answer, by a clock of the test: so the load of the machine has no influence.
const LIMITS: Limits = Limits { answer: Duration::from_secs(1000), memory: 1 << 30 };

/// A clock on which this number of seconds passes between any two queries.
#[derive(Default)]
struct Scripted {
    step: AtomicU64,
    now: AtomicU64,
}

impl Clock for Scripted {
    fn now(&self) -> Duration {
        let step = self.step.load(Ordering::SeqCst);
        Duration::from_secs(self.now.fetch_add(step, Ordering::SeqCst))
    }

    fn look_again(&self, left: Duration) -> Duration {
        left.min(Duration::from_millis(5))
    }
}

/// A process that answers `hello` and then does this, while this number of seconds passes between any two queries of the clock.
fn broken(fault: &str, step: u64) -> Box<dyn Engine> {
    let hello =
        r#"{"status":"ok","protocol":1,"engine":"broken","version":"1","methods":{"id":["a","b"],"fd":["a"],"body_jacobian":["a"]}}"#;
    let script = format!("while read -r line; do case \"$line\" in *'\"op\":\"hello\"'*) echo '{hello}';; *) {fault};; esac; done");
    let command = vec!["sh".into(), "-c".into(), script.into()];
    let clock = Arc::new(Scripted::default());
    let oracle = Oracle::start_by(command, LIMITS, Arc::clone(&clock) as Arc<dyn Clock>).unwrap();
    clock.step.store(step, Ordering::SeqCst);
    Box::new(oracle)
}

#[track_caller]
fn goes_on(fault: &str, step: u64, reason: &str) {
    let robot = robot("joints:kind=revolute,base=fixed");
    let gates = gates("");
    let alone = agreement(&robot, &gates, &[Box::new(Featherbench::new())]);
    let records = agreement(&robot, &gates, &[Box::new(Featherbench::new()), broken(fault, step)]);
    let (errors, rest): (Vec<Row>, Vec<Row>) = records.into_iter().partition(|row| row.engine == "broken");
    assert_eq!(rest, alone);
    let quantities: Vec<&str> = errors.iter().map(|row| row.quantity.as_str()).collect();
    assert_eq!(quantities, ["readback", "id", "id", "fd", "body_jacobian", "body_jacobians"], "one row for each question");
    for row in &errors {
        assert_eq!((row.verdict, row.value), (Verdict::Error, None));
        assert!(row.reason.contains(reason), "{}", row.reason);
    }
    let all: Vec<Row> = rest.into_iter().chain(errors).collect();
    assert_eq!(red(&suite(&all).conditions(&gates, &all, true)), ["rows without a value that was due"]);
}

#[test]
fn when_an_engine_crashes() {
    goes_on("echo 'out of luck' >&2; exit 1", 0, "out of luck");
}

#[test]
fn when_an_engine_babbles() {
    goes_on("echo hm", 0, "not in the protocol");
}

#[test]
fn when_an_engine_hangs() {
    goes_on("exec sleep 1000", 600, "no answer within 1000 s");
}
