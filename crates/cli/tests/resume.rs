//! A run that is killed at a random moment continues: no finished evaluation is repeated, and the exact rows are identical to the byte.

use crate::support;

use featherbench_protocol::Message;
use std::collections::HashSet;
use std::io::BufReader;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;
use support::Sandbox;

/// The exact rows of a run, without the run's own name in the first column.
fn exact_rows(folder: &Path) -> Vec<String> {
    let csv = std::fs::read_to_string(folder.join("rows.csv")).unwrap();
    let exact = csv.lines().filter(|line| line.contains(",exact,"));
    exact.map(|line| line.split_once(',').unwrap().1.to_owned()).collect()
}

/// The cells in the outcome file, in the order in which they were finished.
fn finished(folder: &Path) -> Vec<String> {
    let Ok(file) = std::fs::File::open(folder.join("outcomes.bin")) else { return Vec::new() };
    let mut reader = BufReader::new(file);
    let next = || Message::read(&mut reader).ok().flatten();
    std::iter::from_fn(next).map(|frame| frame.text("cell").to_owned()).collect()
}

#[test]
fn a_killed_run_resumes_to_the_same_bytes_and_repeats_nothing() {
    let sandbox = Sandbox::new();
    let suite = ["run", "--suite", "smoke", "--no-timing", "--out"];
    sandbox.run(&[&suite[..], &["whole"]].concat()).expect(0, &["report:"]);
    let expected = exact_rows(&sandbox.path("whole"));
    let cells = finished(&sandbox.path("whole")).len();
    assert!(expected.len() > 500 && cells > 100, "{} rows of {cells} cells", expected.len());

    let mut random = featherbench_robots::Random::new(u64::from(std::process::id()), 0);
    let mut interrupted = 0;
    for attempt in 0..6 {
        let name = format!("killed-{attempt}");
        let folder = sandbox.path(&name);
        let mut child = sandbox.command(&[&suite[..], &[&name]].concat()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Kill when a random number of cells is finished, wherever the program is then.
        let enough = random.below(cells);
        while finished(&folder).len() < enough && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let before = finished(&folder);
        if !folder.join("fingerprint.json").exists() {
            continue;
        }
        interrupted += usize::from(before.len() < cells);

        sandbox.run(&[&suite[..], &[&name, "--resume"]].concat()).expect(0, &["report:"]);
        let after = finished(&folder);
        assert_eq!(after[..before.len()], before, "what was finished stays");
        assert_eq!(after.len(), cells, "every cell is evaluated once");
        assert_eq!(after.iter().collect::<HashSet<_>>().len(), cells, "and none twice");
        assert_eq!(exact_rows(&folder), expected);
    }
    assert!(interrupted > 0, "no run was caught in the middle");
}

#[test]
fn a_run_of_another_program_or_suite_is_not_continued() {
    let sandbox = Sandbox::new();
    let run = |arguments: &[&str]| sandbox.run(&[&["run", "--filter", "operations", "--out", "out"], arguments].concat());
    run(&["--suite", "smoke"]).expect(0, &["report:"]);
    let text = std::fs::read_to_string(support::project().join("datasets/suites/smoke.toml")).unwrap();
    let other = sandbox.write("other.toml", &text.replace("states = 100", "states = 101"));
    run(&["--suite", other.to_str().unwrap(), "--resume"]).expect(2, &["another suite", "--allow-mixed"]);
    run(&["--suite", other.to_str().unwrap(), "--resume", "--allow-mixed"]).expect(0, &["report:"]);
    let path = sandbox.path("out/fingerprint.json");
    let bytes = std::fs::read(&path).unwrap();
    let text = String::from_utf8(featherbench_results::unsealed(&bytes).unwrap().to_vec()).unwrap();
    let altered = text.replace("\"libm\": \"", "\"libm\": \"0");
    std::fs::write(&path, &altered).unwrap();
    run(&["--suite", other.to_str().unwrap(), "--resume"]).expect(2, &["fingerprint.json", "damaged"]);
    let mut sealed = altered.into_bytes();
    featherbench_results::seal(&mut sealed);
    std::fs::write(&path, sealed).unwrap();
    run(&["--suite", other.to_str().unwrap(), "--resume"]).expect(2, &["another libm"]);
}
