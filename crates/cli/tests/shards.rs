//! Shards merge into what one process would have written, and one that does not fit is refused by name.

use crate::support;

use featherbench_bench::shard::{SHARD_NAME, ShardFile};
use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;
use std::process::Command;
use support::Sandbox;

/// The suite of these tests: every row of it is exact.
const SUITE: [&str; 4] = ["run", "--suite", "smoke", "--no-timing"];

/// Evaluates a shard into a folder of the sandbox.
fn shard(sandbox: &Sandbox, shard: &str, more: &[&str], folder: &str) {
    sandbox.run(&[&SUITE[..], more, &["--shard", shard, "--out", folder]].concat()).expect(0, &[&format!("shard {shard}:")]);
}

fn rows(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("rows.csv")).unwrap()
}

/// Rewrites a shard's `shard.json`, with a valid seal.
fn forge(folder: &Path, change: impl FnOnce(&mut ShardFile)) {
    let path = folder.join(SHARD_NAME);
    let mut file = ShardFile::parse(&std::fs::read(&path).unwrap(), &path).unwrap();
    change(&mut file);
    file.write(folder).unwrap();
}

#[test]
fn any_number_of_shards_merges_to_the_bytes_of_one_process() {
    let sandbox = Sandbox::new();
    // The run's name is in each row and is its folder's: so all runs have the same.
    sandbox.run(&[&SUITE[..], &["--out", "one/run"]].concat()).expect(0, &["report:"]);
    let expected = rows(&sandbox.path("one/run"));
    assert!(expected.lines().count() > 500 && !expected.contains(",measured,"));
    let drawings = |folder: &Path| std::fs::read_to_string(folder.join("drawings.json")).unwrap();
    let drawn = drawings(&sandbox.path("one/run"));
    assert!(drawn.contains("\n\"panda\":[{\"name\":"), "{}", &drawn[..200]);
    for of in [1, 2, 7] {
        // Evaluated and merged in another order than they are numbered in.
        let numbers: Vec<usize> = (1..=of).rev().collect();
        let folders: Vec<String> = numbers.iter().map(|number| format!("shard-{number}-of-{of}")).collect();
        for (number, folder) in numbers.iter().zip(&folders) {
            shard(&sandbox, &format!("{number}/{of}"), &[], folder);
            assert!(!sandbox.path(folder).join("rows.csv").exists(), "a shard has no rows");
        }
        let out = format!("merged-{of}/run");
        let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
        sandbox.run(&[&["merge"][..], &folders, &["--out", &out]].concat()).expect(0, &["report:"]);
        assert!(rows(&sandbox.path(&out)) == expected, "{of} shards");
        assert!(drawings(&sandbox.path(&out)) == drawn, "{of} shards");
        let run: Value = serde_json::from_slice(&std::fs::read(sandbox.path(&out).join("run.json")).unwrap()).unwrap();
        assert_eq!(run["shards"].as_array().unwrap().len(), of);
        assert_eq!(run["command"], "cargo run --release -- run --suite smoke --no-timing");
    }
}

/// A shard that is refused, how it comes to that, and the words of the error.
type Bad<'a> = (&'a str, &'a dyn Fn(&Path), &'a [&'a str]);

#[test]
fn a_shard_that_does_not_fit_is_refused_by_name_and_the_rest_is_kept() {
    let sandbox = Sandbox::new();
    sandbox.run(&[&SUITE[..], &["--out", "one/run"]].concat()).expect(0, &["report:"]);
    for (number, name) in ["a", "b", "c"].iter().enumerate() {
        shard(&sandbox, &format!("{}/3", number + 1), &[], name);
    }
    let copy = |name: &str| {
        std::fs::create_dir_all(sandbox.path(name)).unwrap();
        for entry in std::fs::read_dir(sandbox.path("b")).unwrap() {
            let entry = entry.unwrap();
            std::fs::copy(entry.path(), sandbox.path(name).join(entry.file_name())).unwrap();
        }
    };
    let edit = |folder: &Path, name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let path = folder.join(name);
        let mut bytes = std::fs::read(&path).unwrap();
        change(&mut bytes);
        std::fs::write(path, bytes).unwrap();
    };
    let refusals: [Bad; 12] = [
        ("corrupted", &|at| edit(at, "outcomes.bin", &|bytes| *bytes.last_mut().unwrap() ^= 1), &["corrupted/outcomes.bin", "damaged"]),
        ("truncated", &|at| edit(at, "outcomes.bin", &|bytes| bytes.truncate(bytes.len() - 9)), &["truncated/outcomes.bin", "damaged"]),
        ("printed", &|at| edit(at, "fingerprint.json", &|bytes| bytes[30] ^= 1), &["printed/fingerprint.json", "damaged"]),
        ("logged", &|at| edit(at, "journal.jsonl", &|bytes| bytes[3] ^= 1), &["logged/journal.jsonl", "line 1", "damaged"]),
        ("forgotten", &|at| std::fs::remove_file(at.join("journal.jsonl")).unwrap(), &["forgotten/journal.jsonl", "damaged"]),
        ("altered", &|at| edit(at, "shard.json", &|bytes| bytes[100] ^= 1), &["altered/shard.json", "checksum"]),
        ("older", &|at| forge(at, |file| file.format = 0), &["older/shard.json", "format 0", "format 2"]),
        ("unfinished", &|at| std::fs::remove_file(at.join(SHARD_NAME)).unwrap(), &["unfinished: shard 2/3 is not finished", "--resume"]),
        (
            "foreign",
            &|at| std::fs::read_dir(at).unwrap().for_each(|entry| std::fs::remove_file(entry.unwrap().path()).unwrap()),
            &["foreign: is no shard"],
        ),
        (
            "mixed",
            &|at| forge(at, |file| drop(file.fingerprint.insert("libm".into(), "0".into()))),
            &["mixed", "another libm", "--allow-mixed"],
        ),
        ("stranger", &|at| forge(at, |file| drop(file.fingerprint.insert("suite".into(), "0".into()))), &["stranger", "another suite"]),
        ("absent", &|at| std::fs::remove_dir_all(at).unwrap(), &["absent: is no shard", "no such folder"]),
    ];
    for (name, spoil, words) in refusals {
        copy(name);
        spoil(&sandbox.path(name));
        let out = format!("out-{name}");
        sandbox.run(&["merge", "a", name, "c", "--out", &out]).expect(2, &[words, &["--keep-good"]].concat());
        assert!(!sandbox.path(&out).exists(), "{name}: nothing is written");
    }
    sandbox.run(&["merge", "a", "c", "--out", "gap"]).expect(2, &["no good shard 2/3", "cells are in no shard", "agreement/"]);
    sandbox.run(&["merge", "a", "b", "b", "c", "--out", "twice"]).expect(2, &["b: ", "are in b too"]);
    sandbox.run(&["merge", "one/run", "--out", "whole"]).expect(2, &["one/run: is no shard: it is a whole run"]);
    // Mixed knowingly.
    sandbox.run(&["merge", "a", "mixed", "c", "--out", "known/run", "--allow-mixed"]).expect(0, &["report:"]);
    assert!(rows(&sandbox.path("known/run")) == rows(&sandbox.path("one/run")));
    // The rest is kept: what no shard has are rows that say so, the gates fail, and the run goes on from there.
    let kept = sandbox.run(&["merge", "a", "corrupted", "c", "--out", "kept/run", "--keep-good"]);
    kept.expect(1, &["left out: corrupted/outcomes.bin", "no good shard 2/3", "cells that a shard has"]);
    let text = rows(&sandbox.path("kept/run"));
    assert!(text.contains("its shard is missing") && text != rows(&sandbox.path("one/run")));
    sandbox.run(&[&SUITE[..], &["--out", "kept/run", "--resume"]].concat()).expect(0, &["report:"]);
    assert!(rows(&sandbox.path("kept/run")) == rows(&sandbox.path("one/run")));
}

#[test]
fn a_shard_goes_on_only_as_itself() {
    let sandbox = Sandbox::new();
    let only = ["--filter", "operations"];
    shard(&sandbox, "1/2", &only, "a");
    let again = |number: &str| sandbox.run(&[&SUITE[..], &only, &["--shard", number, "--out", "a", "--resume"]].concat());
    again("2/2").expect(2, &["another", "--allow-mixed"]);
    again("1/2").expect(0, &["shard 1/2"]);
    sandbox.run(&[&SUITE[..], &["--shard", "1/2"]].concat()).expect(2, &["--out"]);
    sandbox.run(&[&SUITE[..], &["--shard", "3/2", "--out", "x"]].concat()).expect(2, &["3/2", "2/7"]);
}

#[test]
fn a_plan_tells_costs_and_its_job_array_makes_the_run() {
    let sandbox = Sandbox::new();
    let planned = |more: &[&str]| {
        let ended = sandbox.run(&[&["plan", "smoke", "--no-timing", "--json"], more].concat());
        ended.expect(0, &[]);
        serde_json::from_str::<Value>(&ended.output).unwrap()
    };
    let cells = |plan: &Value| plan["cells"].as_array().unwrap().clone();
    let estimated = planned(&[]);
    let ids: HashSet<String> = cells(&estimated).iter().map(|cell| cell["cell"].as_str().unwrap().to_owned()).collect();
    assert!(ids.len() > 100 && ids.len() == cells(&estimated).len(), "{}", ids.len());
    assert!(cells(&estimated).iter().all(|cell| cell["measured"] == false && cell["seconds"].as_f64().unwrap() > 0.0));

    let script = sandbox.run(&["plan", "smoke", "--no-timing", "--shards", "2", "--slurm"]);
    script.expect(0, &["#SBATCH --array=1-2"]);
    // `repeatability` asks one process twice, alone.
    assert!(script.output.contains("#SBATCH --exclusive"), "{}", script.output);
    let shared = sandbox.run(&["plan", "smoke", "--filter", "agreement", "--slurm"]);
    assert!(shared.output.contains("#SBATCH --array=1-1") && !shared.output.contains("--exclusive"), "{}", shared.output);
    let file = sandbox.write("array.sh", &script.output);
    // The second start of a task continues it.
    for task in ["1", "2", "1"] {
        let mut command = Command::new("bash");
        command.arg(&file).current_dir(sandbox.folder.path()).env("SLURM_ARRAY_TASK_ID", task).env("OUT", "jobs");
        let output = command.env("FEATHERBENCH", env!("CARGO_BIN_EXE_featherbench")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    sandbox.run(&["merge", "jobs/shard-1-of-2", "jobs/shard-2-of-2", "--out", "jobs/merged"]).expect(0, &["report:"]);

    // Costs that were measured are taken, of a merged run too.
    let measured = planned(&["--costs", "jobs/merged", "--shards", "2"]);
    assert!(cells(&measured).iter().all(|cell| cell["measured"] == true));
    let shards = measured["shards"].as_array().unwrap();
    assert_eq!(shards.iter().map(|shard| shard["cells"].as_u64().unwrap() as usize).sum::<usize>(), ids.len());
    sandbox.run(&["plan", "smoke", "--costs", "nowhere"]).expect(2, &["nowhere/outcomes.bin"]);
}

/// `export` mixes no runs, and takes no run that was altered.
#[test]
fn rows_are_exported_into_a_new_folder() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--filter", "operations", "--out", "run"]).expect(0, &["report:"]);
    sandbox.run(&["export", "run", "--parquet", "rows"]).expect(0, &["rows/study=operations/part-0.parquet", " rows"]);
    sandbox.run(&["export", "run", "--parquet", "rows"]).expect(2, &["rows is not empty", "--parquet"]);
    // A table in Parquet is read where a log is asked for; these rows are no log.
    sandbox.run(&["gen", "chain", "--n", "2", "--out", "robot.json"]).expect(0, &[]);
    let rows = "rows/study=operations/part-0.parquet";
    sandbox.run(&["identify", "robot.json", rows]).expect(2, &[rows, "no column 'time' (there are run, cell, family, robot,"]);
    sandbox.write("log.parquet", "PAR1 and no more");
    sandbox
        .run(&["identify", "robot.json", "log.parquet"])
        .expect(2, &["error: log.parquet: the Parquet file is not readable: ", "Snappy"]);
    let path = sandbox.path("run/rows.csv");
    std::fs::write(&path, std::fs::read_to_string(&path).unwrap().replace(",pass,", ",info,")).unwrap();
    sandbox.run(&["export", "run", "--parquet", "other"]).expect(2, &["rows.csv", "checksum"]);
}
