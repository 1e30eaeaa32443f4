//! A sweep by HyperQueue, if that is installed: what a task, a server and the client that are killed leave behind is gone on with, to the byte.

use crate::support::{Ended, Sandbox, project};
use crate::{Outcome, Unpassed};
use featherbench_protocol::Message;
use serde_json::Value;
use std::collections::HashSet;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Nineteen tasks of some cells each; the last runs alone.
const SWEEP: [&str; 10] =
    ["sweep", "smoke", "--no-timing", "--workers", "2", "--task-seconds", "0.015", "--out", "swept/made", "--retries"];

/// A project that has HyperQueue, and where it is installed.
fn with_hyperqueue() -> Result<(Sandbox, PathBuf), Unpassed> {
    let installed = project().join("target/oracles/hyperqueue");
    if !installed.join("installed").exists() {
        return Err(Unpassed::Skipped("HyperQueue is not installed (`featherbench sweep` installs it)".into()));
    }
    let sandbox = Sandbox::new();
    std::fs::create_dir_all(sandbox.path("target/oracles")).unwrap();
    std::os::unix::fs::symlink(&installed, sandbox.path("target/oracles/hyperqueue")).unwrap();
    Ok((sandbox, installed))
}

/// The journal of a folder: what has been started in it.
fn journal(folder: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join("journal.jsonl")).unwrap_or_default();
    // The last line may be half written.
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// The folders of tasks.
fn shards(sweep: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(sweep).into_iter().flatten().map(|entry| entry.unwrap().path());
    entries.filter(|path| path.is_dir() && path.file_name().unwrap().to_string_lossy().starts_with("shard-")).collect()
}

/// A task that is begun and not finished, with its process.
fn begun(sweep: &Path) -> Option<(PathBuf, u64)> {
    let process = |shard: &Path| journal(shard).last()?["process"].as_u64();
    shards(sweep).into_iter().filter(|shard| !shard.join("shard.json").exists()).find_map(|shard| Some((shard.clone(), process(&shard)?)))
}

fn kill(process: u64) -> bool {
    Command::new("kill").args(["-9", &process.to_string()]).stderr(Stdio::null()).status().unwrap().success()
}

/// Waits until something can be told, as long as the sweep goes on.
fn wait<T>(sweep: &mut Child, what: &str, look: impl Fn() -> Option<T>) -> T {
    loop {
        let ended = sweep.try_wait().unwrap();
        if let Some(seen) = look() {
            return seen;
        }
        assert!(ended.is_none(), "the sweep ended before {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Entries of a file of outcomes, also those of one cell.
fn entries(shard: &Path) -> Vec<String> {
    let mut reader = BufReader::new(std::fs::File::open(shard.join("outcomes.bin")).unwrap());
    let mut ids = Vec::new();
    while let Some(entry) = Message::read(&mut reader).unwrap() {
        ids.push(entry.header["cell"].as_str().unwrap().to_owned());
    }
    ids
}

/// A task, the server and the client are killed.
pub fn goes_on() -> Outcome {
    let (sandbox, _) = with_hyperqueue()?;
    // The run's name is in each row and is its folder's: so both have the same.
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "one/made"]).expect(0, &["report:"]);

    let sweep = sandbox.path("swept/made");
    let command = |more: &[&str]| sandbox.command(&[&SWEEP[..], &["9"], more].concat());
    let mut client = command(&[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    // A task: the first that is still unfinished when its process has ended.
    let killed = wait(&mut client, "a task was killed", || {
        let (shard, process) = begun(&sweep)?;
        let was = kill(process);
        // A process that has ended has no program, even before its parent knows.
        while std::fs::read_link(format!("/proc/{process}/exe")).is_ok() {
            std::thread::sleep(Duration::from_millis(1));
        }
        (was && !shard.join("shard.json").exists()).then_some(shard)
    });
    // The server, with its workers, while a task is begun. The client starts another.
    let server = wait(&mut client, "the server was killed", || {
        begun(&sweep).filter(|(shard, _)| *shard != killed)?;
        journal(&sweep).last()?["driver"].as_u64().filter(|&driver| kill(driver))
    });
    // The client, while the second server has begun a task.
    wait(&mut client, "the second server began a task", || {
        let rounds = journal(&sweep);
        let second = rounds.len() > 1 && rounds.last()?["driver"].as_u64()? != server;
        begun(&sweep).filter(|_| second)
    });
    client.kill().unwrap();
    client.wait().unwrap();
    let other = ["sweep", "default", "--out", "swept/made", "--resume"];
    sandbox.run(&other).expect(2, &["the sweep in it is another"]);
    Ended::new(command(&["--resume"]).output().unwrap()).expect(0, &["report:"]);

    let rows = |folder: &str| std::fs::read_to_string(sandbox.path(folder).join("rows.csv")).unwrap();
    assert!(rows("one/made").lines().count() > 500);
    assert!(rows("swept/made/made") == rows("one/made"), "exact rows are those of one process");

    // Each cell has one entry: none that was finished was evaluated again.
    let (mut cells, mut count, mut again) = (HashSet::new(), 0, 0);
    for shard in shards(&sweep) {
        let (ids, starts) = (entries(&shard), journal(&shard));
        count += ids.len();
        cells.extend(ids.iter().cloned());
        let number = |line: &Value, key: &str| line[key].as_u64().unwrap();
        assert!(starts.iter().all(|line| number(line, "cells") == ids.len() as u64), "{starts:?}");
        // What a start keeps is at least what the one before it kept.
        assert!(number(&starts[0], "kept") == 0 && starts.is_sorted_by_key(|line| number(line, "kept")), "{starts:?}");
        again += starts.len() - 1;
    }
    assert!(count == cells.len() && count > 200, "{count} entries of {} cells", cells.len());
    // The killed task, and those of two workers when the server ended and when the client did.
    assert!((1..=5).contains(&again), "{again} tasks were started again");
    // A finished task whose outcomes are damaged is done again as far as they are.
    let damaged = shards(&sweep).into_iter().find(|shard| !entries(shard).is_empty()).unwrap();
    let outcomes = damaged.join("outcomes.bin");
    let mut bytes = std::fs::read(&outcomes).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&outcomes, bytes).unwrap();
    Ended::new(command(&["--resume"]).output().unwrap()).expect(0, &["report:"]);
    assert!(rows("swept/made/made") == rows("one/made"), "exact rows are those of one process");
    let last = journal(&damaged).pop().unwrap();
    assert_eq!(last["kept"].as_u64().unwrap() + 1, last["cells"].as_u64().unwrap(), "one cell was evaluated again");

    assert!(journal(&sweep).len() >= 3, "the rounds: {:?}", journal(&sweep));
    Ok(())
}

/// A server with two workers, in a process of its own: HyperQueue's Python package has no other. It ends when its standard input closes.
const SERVER: &str = "import sys
from hyperqueue import LocalCluster
from hyperqueue.cluster import WorkerConfig
with LocalCluster(sys.argv[1]) as cluster:
    for _ in range(2):
        cluster.start_worker(WorkerConfig(cores=1))
    print('ready', flush=True)
    sys.stdin.read()
";

/// A sweep gives its tasks to a server that another process runs, and leaves it running.
pub fn uses_a_server() -> Outcome {
    let (sandbox, installed) = with_hyperqueue()?;
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "one/made"]).expect(0, &["report:"]);

    let folder = sandbox.path("server");
    let mut server = Command::new(installed.join("venv/bin/python"));
    let mut server = server.args(["-c", SERVER]).arg(&folder).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(server.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(lines.into_iter().any(|line| line == "ready"), "the server started");
    let server_dir = folder.to_str().unwrap();
    for out in ["first/made", "second/made"] {
        let tasks = ["sweep", "smoke", "--no-timing", "--task-seconds", "0.015", "--server-dir", server_dir, "--out", out];
        sandbox.run(&tasks).expect(0, &["report:"]);
        let rows = |folder: &str| std::fs::read_to_string(sandbox.path(folder).join("rows.csv")).unwrap();
        assert!(rows(&format!("{out}/made")) == rows("one/made"), "exact rows are those of one process");
        assert!(shards(&sandbox.path(out)).len() > 2, "the work is cut into tasks");
    }
    assert!(server.try_wait().unwrap().is_none(), "the server goes on");
    drop(server.stdin.take());
    server.wait().unwrap();
    // Without a server there is a message, and no sweep.
    let none = ["sweep", "smoke", "--no-timing", "--server-dir", server_dir, "--retries", "0", "--out", "third/made"];
    sandbox.run(&none).expect(2, &[]);
    Ok(())
}
