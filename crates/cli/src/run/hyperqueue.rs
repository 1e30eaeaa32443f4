//! HyperQueue: its environment, installed on first use, and the process that gives it tasks.

use crate::fail::Fail;
use crate::message::tell;
use crate::oracles::environment::{Environment, pins};
use crate::progress::spinner;
use crate::root::Root;
use featherbench_bench::hash;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Its folder among the oracles, and among what is installed.
const NAME: &str = "hyperqueue";
const REQUIREMENTS: &str = "requirements.txt";
const DRIVER: &str = "drive.py";
const ADVICE: &str = "sweeps need Python 3.11 or later with venv on Linux x86-64, and once a reachable package index; `featherbench plan --slurm` needs neither";

/// The Python in which HyperQueue is installed; it is installed if need be. The stamp is written last: an installation that broke off is not taken.
pub fn install(root: &Root) -> Result<PathBuf, Fail> {
    let (folder, requirements) = (root.built(NAME), root.oracles().join(NAME).join(REQUIREMENTS));
    let stamp = hash::of(pins(&requirements)?.join("\n").as_bytes());
    let (python, installed) = (folder.join("venv/bin/python"), folder.join("installed"));
    if python.exists() && std::fs::read_to_string(&installed).is_ok_and(|there| there == stamp) {
        return Ok(python);
    }
    let bar = spinner("installing HyperQueue (10 MB) …");
    let packages: [OsString; 4] = ["--no-deps".into(), "--require-hashes".into(), "-r".into(), requirements.into_os_string()];
    let environment = Environment::install(&bar, &folder.join("venv"), ADVICE, &packages)?;
    bar.finish_and_clear();
    ::featherbench_results::atomic_write(&installed, stamp.as_bytes())?;
    Ok(environment.python)
}

/// A task: a program with its arguments.
#[derive(Debug, Serialize)]
pub struct Task {
    /// The name by which its failure is told.
    pub name: String,
    /// The program and its arguments.
    pub args: Vec<String>,
    /// The folder that it starts in.
    pub cwd: String,
    /// The file of its standard error.
    pub stderr: String,
    /// Whether it runs after all others, one at a time, with all cores of its worker.
    pub alone: bool,
}

/// What HyperQueue is asked.
#[derive(Debug, Serialize)]
pub struct Wanted<'a> {
    /// The folder of a running server, or none: then one is started.
    pub server: Option<&'a Path>,
    /// Workers of the server that is started.
    pub workers: usize,
    /// How many workers may end under a task before it is given up.
    pub crashes: usize,
    /// The tasks.
    pub tasks: Vec<Task>,
}

/// A line of the driver.
#[derive(Deserialize)]
#[serde(untagged)]
enum Told {
    Progress { finished: u64, failed: u64 },
    End { tasks: BTreeMap<String, String> },
}

/// The process that gives HyperQueue its tasks; a server of its own lives in it. When it is dropped, the process ends.
pub struct Driver(Child);

impl Driver {
    /// Starts it.
    pub fn start(root: &Root, python: &Path) -> Result<Self, Fail> {
        let driver = root.oracles().join(NAME).join(DRIVER);
        let arguments: [OsString; 2] = ["-u".into(), driver.into_os_string()];
        let child = Command::new(python).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn();
        Ok(Self(child.map_err(|error| Fail::input(format!("{} cannot be started: {error}", python.display())))?))
    }

    /// Its process.
    pub fn id(&self) -> u32 {
        self.0.id()
    }

    /// Has the tasks done, and returns those that failed, each with its reason. An error in words means that the process ended before its end.
    pub fn drive(mut self, wanted: &Wanted) -> Result<BTreeMap<String, String>, String> {
        let mut line = serde_json::to_vec(wanted).map_err(|error| error.to_string())?;
        line.push(b'\n');
        let (Some(mut input), Some(output)) = (self.0.stdin.take(), self.0.stdout.take()) else { return Err("it has no pipes".into()) };
        input.write_all(&line).and_then(|()| input.flush()).map_err(|error| format!("it takes no tasks: {error}"))?;
        let bar = bar(wanted.tasks.len());
        let mut failed = None;
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            match serde_json::from_str::<Told>(&line) {
                Ok(Told::Progress { finished, failed }) => {
                    bar.set_position(finished + failed);
                    bar.set_message(if failed > 0 { format!("{failed} failed") } else { String::new() });
                }
                Ok(Told::End { tasks }) => failed = Some(tasks),
                // HyperQueue's own lines, such as the table of its server.
                Err(_) => {}
            }
        }
        bar.finish_and_clear();
        // Its standard input is open until here: the process ends when that closes.
        drop(input);
        let status = self.0.wait().map_err(|error| error.to_string())?;
        failed.ok_or_else(|| format!("it ended before its tasks ({status})"))
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // It has ended in every case but that of an error.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Progress by tasks; without a terminal, one line.
fn bar(tasks: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        tell!("{tasks} tasks");
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(tasks as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("tasks {bar:30} {pos}/{len} {eta:>4} {wide_msg}") {
        bar.set_style(style);
    }
    bar
}
