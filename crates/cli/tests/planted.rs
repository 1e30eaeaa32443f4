//! Faults that are planted into runs and their data: each ends a command with its exit code and names the culprit first.
//!
//! Faults of answers (a wrong sign, a swapped frame, a skip that is not listed, a deviation that grew) are planted in
//! `crates/studies/comparison/tests/convicted.rs` and `excused.rs`, a slower kernel in `history_diff.rs`, thresholds one by one in `every_gate_fires` here.

use crate::support;

use featherbench_results::{GateKind, Verdict, read_run, write_run};
use serde_json::Value;
use std::path::Path;
use support::{Sandbox, project};

const ROBOTS: [&str; 3] = ["chain-planar-2", "joints-common-free-single", "panda"];

/// A sandbox with the recordings of the smoke suite in a folder of its own.
fn with_recordings() -> Sandbox {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("recorded")).unwrap();
    for robot in ROBOTS {
        let name = format!("recorded/{robot}.recording");
        std::fs::copy(project().join("datasets").join(&name), sandbox.path(&name)).unwrap();
    }
    sandbox
}

fn run(sandbox: &Sandbox, out: &str) -> support::Ended {
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--recorded", "recorded", "--out", out])
}

/// The findings of `gate --json`, those that are new.
fn new(sandbox: &Sandbox, folder: &str) -> Vec<Value> {
    let ended = sandbox.run(&["gate", folder, "--json"]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let json: Value = serde_json::from_str(&ended.output).unwrap();
    assert_eq!(json["status"], "failed");
    json["findings"].as_array().unwrap().iter().filter(|found| found["new"] == true).cloned().collect()
}

/// Changes the rows of a finished run.
fn alter(folder: &Path, change: impl FnOnce(&mut Vec<featherbench_results::Row>)) {
    let (info, mut rows) = read_run(folder).unwrap();
    change(&mut rows);
    write_run(folder, &info, &rows).unwrap();
}

#[test]
fn a_gate_tells_what_fell_short_in_every_form() {
    let sandbox = with_recordings();
    let [ran, gated] = [run(&sandbox, "out"), sandbox.run(&["gate", "out", "--junit", "good.xml"])];
    ran.expect(0, &["passed: ", "report:"]);
    gated.expect(0, &["passed: ", "gates met"]);
    for ended in [&ran, &gated] {
        // What is known is no part of the verdict.
        let first = ended.output.lines().next().unwrap();
        assert!(first.starts_with("passed: ") && first.ends_with(" rows passed, 0 failed"), "{first}");
        assert!(["pinocchio", "mujoco", "drake", "dart", "featherbench", "off by"].iter().all(|words| !first.contains(words)), "{first}");
    }
    assert!(ran.output.lines().last().unwrap().starts_with("report: "), "{ran:?}");
    assert!(std::fs::read_to_string(sandbox.path("good.xml")).unwrap().contains("failures=\"0\""));

    // An answer of MuJoCo that is wrong in the third digit, and one of Drake that is wrong in the fourteenth.
    alter(&sandbox.path("out"), |rows| {
        for (engine, value) in [("mujoco", 2.5e-3), ("drake", 3e-14)] {
            let of = |row: &&mut featherbench_results::Row| {
                row.study == "agreement" && row.engine == engine && row.quantity == "id" && row.verdict == Verdict::Pass
            };
            let row = rows.iter_mut().find(of).unwrap();
            let (relation, bound) = (row.relation.unwrap(), row.bound.unwrap());
            *row = row.clone().gated(value, relation, bound);
        }
    });
    let found = new(&sandbox, "out");
    let culprits: Vec<_> = found.iter().take(2).map(|found| (found["culprit"]["engine"].as_str(), found["level"].as_str())).collect();
    assert_eq!(culprits[0], (Some("mujoco"), Some("physics differs")), "{found:?}");
    assert!(found.iter().any(|found| found["culprit"]["engine"] == "drake" && found["level"] == "rounding"), "{found:?}");
    assert!(found[0]["again"].as_str().unwrap().contains("--filter '^agreement/"), "{found:?}");
    let ended = sandbox.run(&["gate", "out", "--junit", "bad.xml", "--markdown", "bad.md", "--annotations"]);
    ended.expect(
        1,
        &[
            "failed: mujoco, inverse dynamics: off by 0.25 %",
            "1. physics differs: mujoco, inverse dynamics: off by 0.25 %",
            "::error title=physics differs%3A mujoco",
            "first: mujoco",
        ],
    );
    let first = ended.output.lines().position(|line| line.starts_with("  1. physics differs: mujoco")).unwrap();
    assert!(first < ended.output.lines().position(|line| line.contains("rounding: drake")).unwrap(), "{ended:?}");
    let junit = std::fs::read_to_string(sandbox.path("bad.xml")).unwrap();
    assert!(junit.starts_with("<?xml") && junit.contains("type=\"physics differs\"") && junit.contains("name=\"mujoco/"), "{junit}");
    let markdown = std::fs::read_to_string(sandbox.path("bad.md")).unwrap();
    assert!(
        markdown.contains("failed: mujoco, inverse dynamics: off by 0.25 %") && markdown.contains("| physics differs | mujoco |"),
        "{markdown}"
    );
}

#[test]
fn missing_engines_are_named_before_what_is_missing_of_them() {
    let sandbox = with_recordings();
    std::fs::remove_dir_all(sandbox.path("recorded")).unwrap();
    std::fs::create_dir(sandbox.path("recorded")).unwrap();
    run(&sandbox, "out")
        .expect(1, &["failed: not met: engine pinocchio answers: ", "1. not offered, new: pinocchio: engine pinocchio answers"]);
    let found = new(&sandbox, "out");
    let first: Vec<_> = found.iter().take(3).map(|found| (found["gate"].clone(), found["culprit"]["engine"].clone())).collect();
    assert_eq!(first, ["pinocchio", "mujoco", "drake"].map(|name| (GateKind::Engine.as_str().into(), name.into())));
}

/// A recording is of one version of a robot. That of another is not used: its file and its engines are named.
#[test]
fn a_stale_recording_is_named() {
    let sandbox = with_recordings();
    std::fs::copy(sandbox.path("recorded/chain-planar-2.recording"), sandbox.path("recorded/panda.recording")).unwrap();
    run(&sandbox, "out")
        .expect(1, &["failed: ", "panda.recording", "it was recorded for another version of 'panda'", "featherbench record"]);
    let found = new(&sandbox, "out");
    assert_eq!(found[0]["culprit"]["robot"], "panda", "{:?}", found[0]);
    assert!(found[0]["sentence"].as_str().unwrap().contains("panda.recording"), "{:?}", found[0]);
}

/// Half of a file of rows is no run: the file is named, and nothing is judged.
#[test]
fn truncated_rows_are_refused_by_file() {
    let sandbox = with_recordings();
    run(&sandbox, "out").expect(0, &["report:"]);
    let path = sandbox.path("out/rows.csv");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    sandbox.run(&["gate", "out"]).expect(2, &["rows.csv"]);
    // Nor is one whose last rows were cut off with care.
    std::fs::write(&path, &whole).unwrap();
    alter(&sandbox.path("out"), |rows| rows.retain(|row| !(row.engine == "drake" && row.quantity == "com")));
    let found = new(&sandbox, "out");
    assert_eq!((&found[0]["gate"], &found[0]["culprit"]["engine"]), (&"counts".into(), &"drake".into()), "{found:?}");
    assert_eq!(found[0]["culprit"]["quantity"], "com");
}

/// The lock file is about a suite as its file draws it: a smaller draw lacks nothing. Its engines are missing here, and that is all.
#[test]
fn a_smaller_draw_lacks_no_cells() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "sweep", "--size", "2", "--no-timing", "--out", "out"]).expect(1, &["engine drake answers"]);
    let found = new(&sandbox, "out");
    assert!(!found.is_empty() && found.iter().all(|found| found["gate"] == "engine"), "{found:?}");
}

#[test]
fn every_gate_fires() {
    let sandbox = Sandbox::new();
    let ended = sandbox.run(&["list", "--gates"]);
    ended.expect(0, &["0 of them that no planted fault fires"]);
    let gates = ended.output.lines().filter(|line| line.starts_with("fires ")).count();
    let text = std::fs::read_to_string(project().join("ci/gates.toml")).unwrap();
    assert_eq!(gates, text.lines().filter(|line| *line == "[[gate]]").count());
}
