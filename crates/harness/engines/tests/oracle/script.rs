//! Shell oracles: what they answer, and how they are asked.

use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::{Clock, Limits, Oracle, SystemClock};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tempfile::TempDir;

/// The answer of a right shell oracle: the number two at each of two states.
pub(crate) const TWO: &str = r#"value '\0\0\0\0\0\0\0\100\0\0\0\0\0\0\0\100'"#;
pub(crate) const READBACK: &str =
    r#"echo '{"status":"ok","nq":1,"nv":1,"blocks":[{"name":"readback","shape":[1,22]}]}'; head -c 176 /dev/zero"#;
pub(crate) const HELLO: &str =
    r#"echo '{"status":"ok","protocol":1,"engine":"shell","version":"1","build":{"language":"sh"},"methods":{"id":["x"]}}'"#;

/// An import result of a pendulum.
pub(crate) const READING: &str = r#"echo '{"status":"ok","nq":1,"nv":1,"notes":[{"cause":"mass_edited","about":"rod","text":"0 kg became 1 kg"}],"model":{"format":1,"name":"p","gravity":[0.0,0.0,-9.81],"bodies":[{"name":"rod","mass":1.0,"com":[0.5,0.0,0.0],"inertia":[0.01,0.0,0.0,0.08,0.0,0.08],"parent":-1,"joint":{"name":"hinge","type":"revolute","axis":[0.0,1.0,0.0],"placement":{"rotation":[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0],"translation":[0.0,0.0,0.0]}}}]}}'"#;

/// How a shell oracle answers; `$1` is a folder of its own.
pub(crate) struct Script {
    pub(crate) hello: String,
    pub(crate) prepare: String,
    pub(crate) read: String,
    pub(crate) evaluate: String,
}

impl Script {
    pub(crate) fn honest() -> Self {
        Self { hello: HELLO.into(), prepare: READBACK.into(), read: READING.into(), evaluate: TWO.into() }
    }

    pub(crate) fn hello(hello: &str) -> Self {
        Self { hello: hello.into(), ..Self::honest() }
    }

    pub(crate) fn prepare(prepare: &str) -> Self {
        Self { prepare: prepare.into(), ..Self::honest() }
    }

    pub(crate) fn reading(read: &str) -> Self {
        Self { read: read.into(), ..Self::honest() }
    }

    pub(crate) fn evaluate(evaluate: &str) -> Self {
        Self { evaluate: evaluate.into(), ..Self::honest() }
    }

    pub(crate) fn command(&self, folder: &Path) -> Vec<OsString> {
        let Self { hello, prepare, read, evaluate } = self;
        // Two states of one dof and one body: q, v, a, τ, a wrench each, and four probes.
        let states = 8 * (2 * (4 + 6) + 4);
        let script = format!(
            r#"
            value() {{ echo '{{"status":"ok","blocks":[{{"name":"value","shape":[2,1]}}]}}'; printf "$1"; }}
            echo $$ >> "$1/pids"
            while read -r line; do
                case "$line" in
                    *'"op":"hello"'*) {hello};;
                    *'"op":"prepare"'*) {prepare};;
                    *'"op":"import"'*) echo "$line" >> "$1/read"; {read};;
                    *'"op":"states"'*) head -c {states} > "$1/states"; echo '{{"status":"ok"}}';;
                    *) {evaluate};;
                esac
            done"#
        );
        ["sh".into(), "-c".into(), script.into(), "oracle".into(), folder.into()].into()
    }
}

/// A shell oracle with its folder.
pub(crate) struct Trial {
    pub(crate) folder: TempDir,
    pub(crate) oracle: Result<Oracle, String>,
    pub(crate) robot: Robot,
}

/// So long that a right shell oracle is never late, however busy the machine is. Only a test that would hang for ever reaches it.
pub(crate) const PATIENT: Limits = Limits { answer: Duration::from_secs(900), memory: 1 << 30 };

/// A clock that stops until the test starts it and the script says that it is late, by a file `late` in its folder. From then on an hour
/// passes between any two queries.
pub(crate) struct Stopped {
    late: PathBuf,
    going: AtomicBool,
    now: Mutex<Duration>,
}

impl Stopped {
    pub(crate) fn set_going(&self, going: bool) {
        self.going.store(going, Ordering::SeqCst);
    }
}

impl Clock for Stopped {
    fn now(&self) -> Duration {
        let mut now = self.now.lock().unwrap();
        if self.going.load(Ordering::SeqCst) && self.late.exists() {
            *now += Duration::from_secs(3600);
        }
        *now
    }

    fn look_again(&self, left: Duration) -> Duration {
        left.min(Duration::from_millis(5))
    }
}

pub(crate) fn robot(spec: &str) -> Robot {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    Robot::new(&description, "chain", ModelOrigin::Generated, 2, 1).unwrap()
}

impl Trial {
    pub(crate) fn new(script: &Script, limits: Limits) -> Self {
        Self::by(script, limits, tempfile::tempdir().unwrap(), Arc::new(SystemClock::default()))
    }

    /// An oracle whose limits pass when its script says so.
    pub(crate) fn stopped(script: &Script) -> (Self, Arc<Stopped>) {
        let folder = tempfile::tempdir().unwrap();
        let clock = Arc::new(Stopped { late: folder.path().join("late"), going: AtomicBool::new(false), now: Mutex::default() });
        (Self::by(script, PATIENT, folder, Arc::clone(&clock) as Arc<dyn Clock>), clock)
    }

    /// An oracle whose limits and times are measured by this clock.
    pub(crate) fn by(script: &Script, limits: Limits, folder: TempDir, clock: Arc<dyn Clock>) -> Self {
        let oracle = Oracle::start_by(script.command(folder.path()), limits, clock);
        Self { folder, oracle, robot: robot("chain:n=1") }
    }

    /// Asks for the inverse dynamics at both states.
    pub(crate) fn ask(&self) -> Result<Vec<f64>, NoAnswer> {
        self.ask_about(&self.robot)
    }

    pub(crate) fn ask_about(&self, robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
        let oracle = self.oracle.as_ref().unwrap();
        let mut prepared = oracle.prepare(robot, Quantity::InverseDynamics, "x", &robot.states)?;
        prepared.run(0..2)?;
        Ok(prepared.read().to_vec())
    }

    /// The reason of a failure.
    #[track_caller]
    pub(crate) fn failure(&self) -> String {
        match self.ask() {
            Err(NoAnswer::Failed(reason)) => reason,
            other => panic!("{other:?}"),
        }
    }

    /// The processes that were started.
    pub(crate) fn pids(&self) -> Vec<String> {
        let text = std::fs::read_to_string(self.folder.path().join("pids")).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

pub(crate) fn lives(pid: &str) -> bool {
    let status = Command::new("sh").args(["-c", "kill -0 \"$1\" 2> /dev/null", "kill", pid]).status().unwrap();
    status.success()
}

/// The reason why an oracle does not start.
#[track_caller]
pub(crate) fn stillborn(script: &Script) -> String {
    Trial::new(script, PATIENT).oracle.err().unwrap()
}
