//! The program in another folder than the checkout in which it was built: the data that it uses, and where it writes.

use crate::support;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use support::{Ended, Sandbox, project};

const VARIABLE: &str = "FEATHERBENCH_ROOT";

/// Runs the program in a folder that is not a project, with this in the environment.
fn run(here: &Path, root: Option<&Path>, arguments: &[&str]) -> Ended {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_featherbench"));
    command.args(arguments).current_dir(here).env("NO_COLOR", "1").env_remove(VARIABLE);
    if let Some(root) = root {
        command.env(VARIABLE, root);
    }
    Ended::new(command.output().unwrap())
}

fn entries(folder: PathBuf) -> BTreeSet<PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()).collect()
}

/// A copy of the project is used as the checkout: its own data are read and written, and the checkout of the build is not changed.
#[test]
fn a_project_that_is_named_is_the_one_that_is_used() {
    let (copy, here) = (Sandbox::new(), tempfile::tempdir().unwrap());
    // A suite that only the copy has.
    std::fs::remove_file(copy.path("datasets")).unwrap();
    std::fs::create_dir_all(copy.path("datasets/suites")).unwrap();
    std::os::unix::fs::symlink(project().join("datasets/models"), copy.path("datasets/models")).unwrap();
    let suite = "about = \"one\"\nseed = 1\n[operations]\n[[robot]]\nmodel = \"chain-planar-2\"\nfamily = \"chain\"\n";
    copy.write("datasets/suites/own.toml", suite);
    let before = entries(project().join("reports"));
    run(here.path(), Some(copy.folder.path()), &["run", "--suite", "own"]).expect(0, &["report:"]);
    let folder = copy.folder.path().to_str().unwrap();
    run(here.path(), None, &["--root", folder, "run", "--suite", "own", "--out", "mine"]).expect(0, &["report:"]);
    run(here.path(), None, &["list", "--suite", "own", "--root", folder]).expect(0, &["chain-planar-2"]);
    assert_eq!(entries(copy.path("reports")).len(), 1, "a run without --out lands in the project's reports");
    assert!(here.path().join("mine/rows.csv").is_file(), "and one with it where it says");
    // A named project comes before the current folder.
    run(copy.folder.path(), Some(&project()), &["list", "--suite", "own"]).expect(2, &["there is no suite 'own'"]);
    assert_eq!(entries(project().join("reports")), before);
}

#[test]
fn a_folder_that_is_no_project_is_named_with_what_it_lacks() {
    let here = tempfile::tempdir().unwrap();
    run(here.path(), Some(here.path()), &["list"]).expect(2, &[VARIABLE, "no project's folder", "datasets/suites"]);
    run(here.path(), None, &["list", "--root", "nowhere"]).expect(2, &["--root", "nowhere", "ci/gates.toml"]);
}

/// What a run prints to make a finding again works in any folder, also where files were named from the folder in which it was typed.
#[test]
fn a_finding_is_made_again_in_any_folder() {
    let here = tempfile::tempdir().unwrap();
    let engine = "#!/bin/sh\nread -r line\necho '{\"status\":\"ok\",\"protocol\":1,\"engine\":\"mute\",\"version\":\"7\",\"build\":{},\"methods\":{\"id\":[\"guess\"]}}'\n\
                  while read -r line; do echo '{\"status\":\"error\",\"reason\":\"mute\"}'; done\n";
    std::fs::write(here.path().join("mute oracle.sh"), engine).unwrap();
    let arguments =
        ["run", "--suite", "smoke", "--no-timing", "--filter", "^agreement/chain-planar-2/mine/", "--engine", "mine=sh './mute oracle.sh'"];
    let ended = run(here.path(), Some(&project()), &[&arguments[..], &["--out", "first"]].concat());
    ended.expect(1, &["again: "]);
    let again = ended.output.lines().find_map(|line| line.trim_start().strip_prefix("again: ")).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let shell = |line: &str| {
        let mut command = std::process::Command::new("sh");
        command.args(["-c", line]).current_dir(elsewhere.path()).env(VARIABLE, project()).env("NO_COLOR", "1");
        Ended::new(command.output().unwrap())
    };
    let ended = shell(&format!("{again} --out second"));
    ended.expect(1, &["mine", "mute"]);
    assert!(elsewhere.path().join("second/rows.csv").is_file(), "{again}");
}

/// Commands on a run's folder need no project.
#[test]
fn what_needs_no_project_asks_for_none() {
    let here = tempfile::tempdir().unwrap();
    let row =
        featherbench_results::Row { cell: "abcd".into(), study: "operations".into(), ..featherbench_results::Row::default() }.informed(1.0);
    featherbench_results::write_run(&here.path().join("run"), &featherbench_results::RunInfo::default(), &[row]).unwrap();
    let nowhere = here.path().join("nowhere");
    for (arguments, words) in
        [(&["report", "run"][..], "report:"), (&["diff", "run", "run"], "nothing changed"), (&["explain", "ab", "run"], "again")]
    {
        run(here.path(), Some(&nowhere), arguments).expect(0, &[words]);
    }
    run(here.path(), Some(&nowhere), &["gate", "run"]).expect(2, &[VARIABLE]);
    run(here.path(), Some(&nowhere), &["oracles", "check", "./nothing"]).expect(2, &["there is no program ./nothing"]);
}
