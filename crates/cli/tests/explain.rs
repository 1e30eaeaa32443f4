//! `featherbench explain`: the command that it prints gives the rows of the cell again.

use crate::support;

use std::path::Path;
use std::process::Command;
use support::{Ended, Sandbox};

/// The rows of a cell, without the run's own name in the first column.
fn rows(folder: &Path, cell: &str) -> Vec<String> {
    let csv = std::fs::read_to_string(folder.join("rows.csv")).unwrap();
    let rows = csv.lines().filter_map(|line| line.split_once(',')).filter(|(_, rest)| rest.trim_start_matches('"').starts_with(cell));
    rows.map(|(_, rest)| rest.to_owned()).collect()
}

/// The printed command with this program instead of `cargo run`.
fn again(ended: &Ended) -> String {
    let line = ended.output.lines().find_map(|line| line.strip_prefix("again")).unwrap_or_else(|| panic!("{ended:?}"));
    let arguments = line.trim().strip_prefix("cargo run --release -- ").unwrap_or_else(|| panic!("{line}"));
    format!("'{}' {arguments}", env!("CARGO_BIN_EXE_featherbench"))
}

#[test]
fn the_printed_command_makes_the_rows_again() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "out"]).expect(0, &["report:"]);
    let (_, records) = featherbench_results::read_run(&sandbox.path("out")).unwrap();
    // A value against ours, one against another engine, one without a number, a count, and a cell that belongs to no robot.
    let find = |what: &dyn Fn(&featherbench_results::Row) -> bool| records.iter().find(|row| what(row)).unwrap().cell.clone();
    let chosen = [
        find(&|row| row.engine == "pinocchio" && row.quantity == "fd" && row.metric == "forward" && row.robot == "chain-planar-2"),
        find(&|row| row.engine == "drake" && row.metric == "pairwise" && row.reference == "mujoco" && row.robot == "panda"),
        find(&|row| row.engine == "mujoco" && row.metric == "scaled_on_readback" && row.robot == "joints-common-free-single"),
        find(&|row| row.study == "operations" && row.engine == "featherbench"),
        find(&|row| row.study == "repeatability" && row.engine == "featherbench"),
    ];
    for (k, cell) in chosen.iter().enumerate() {
        let explained = sandbox.run(&["explain", cell, "out"]);
        explained.expect(0, &["again"]);
        let out = format!("again-{k}");
        let line = format!("{} --out {out}", again(&explained));
        let ended = Ended::new(Command::new("sh").args(["-c", &line]).current_dir(sandbox.folder.path()).output().unwrap());
        ended.expect(0, &["report:"]);
        let before = rows(&sandbox.path("out"), cell);
        assert!(!before.is_empty());
        assert_eq!(rows(&sandbox.path(&out), cell), before, "{line}");
    }
}

/// The command of a live run asks the engines themselves again, with the same seed and the same engines.
#[test]
fn the_command_of_a_live_run_stays_live() {
    let sandbox = Sandbox::new();
    let row = featherbench_results::Row {
        cell: "abcd".into(),
        study: "agreement".into(),
        robot: "panda".into(),
        ..featherbench_results::Row::default()
    };
    let info = featherbench_results::RunInfo {
        suite: "smoke".into(),
        command: "cargo run --release -- run --suite smoke --live --seed 7 --engine 'mine=sh a.sh' --filter panda --out out".into(),
        live: true,
        ..featherbench_results::RunInfo::default()
    };
    featherbench_results::write_run(&sandbox.path("out"), &info, &[row]).unwrap();
    let command = again(&sandbox.run(&["explain", "ab", "out"]));
    assert!(command.ends_with("run --suite smoke --live --seed 7 --engine 'mine=sh a.sh' --filter '^agreement/panda/'"), "{command}");
}
