//! The commands `featherbench diff` and `featherbench history`.

use crate::support;

use support::Sandbox;

/// A finished run's folder with these rows of times: (quantity, metric, value, why it does not count).
fn run(sandbox: &Sandbox, name: &str, rows: &[(&str, &str, f64, &str)]) {
    let records: Vec<featherbench_results::Row> = rows
        .iter()
        .map(|(quantity, metric, value, reason)| {
            let row = featherbench_results::Row {
                study: "timing".into(),
                engine: "featherbench".into(),
                robot: "humanoid".into(),
                method: "x".into(),
                quantity: (*quantity).into(),
                cache: "stream".into(),
                metric: (*metric).into(),
                unit: "ns".into(),
                kind: featherbench_results::Kind::Measured,
                ..featherbench_results::Row::default()
            };
            let row = row.measured(*value, 0.99 * value, 1.01 * value);
            if reason.is_empty() { row } else { row.invalid(*reason) }
        })
        .collect();
    let host = featherbench_results::Host { cpu: "An Example CPU".into(), cores: 4, ..featherbench_results::Host::default() };
    let git = featherbench_results::GitInfo { revision: "0123456789abcdef".into(), dirty: false };
    let info = featherbench_results::RunInfo {
        run: name.into(),
        started: "2026-03-04T05:06:07Z".into(),
        host,
        git,
        ..featherbench_results::RunInfo::default()
    };
    featherbench_results::write_run(&sandbox.path(name), &info, &records).unwrap();
}

fn times(ns: f64) -> Vec<(&'static str, &'static str, f64, &'static str)> {
    vec![("id", "ns_per_call", ns, "")]
}

#[test]
fn two_runs_are_compared_as_a_table_and_as_markdown() {
    let sandbox = Sandbox::new();
    run(&sandbox, "a", &times(100.0));
    run(&sandbox, "b", &times(101.0));
    run(&sandbox, "c", &times(130.0));
    sandbox.run(&["diff", "a", "a"]).expect(0, &["1 rows compared, nothing changed beyond noise"]);
    sandbox.run(&["diff", "a", "b"]).expect(0, &["nothing changed"]);
    sandbox.run(&["diff", "a", "c"]).expect(1, &["time", "humanoid", "featherbench x", "100.0 ns", "130.0 ns", "1.300", "1 of 1 rows"]);
    sandbox
        .run(&["diff", "a", "c", "--markdown"])
        .expect(1, &["| change | robot |", "| time | humanoid | featherbench x | id | ns_per_call stream | 100.0 ns | 130.0 ns | 1.300 |"]);
    // A kernel at half its speed is named before one that is a little slower.
    let both = |id: f64, fd: f64| [("id", "ns_per_call", id, ""), ("fd", "ns_per_call", fd, "")];
    run(&sandbox, "fast", &both(100.0, 100.0));
    run(&sandbox, "slow", &both(110.0, 200.0));
    let ended = sandbox.run(&["diff", "fast", "slow"]);
    ended.expect(1, &["2 of 2 rows"]);
    let first = ended.output.lines().nth(1).unwrap();
    assert!(["time", "humanoid", "featherbench x", "fd", "2.000"].iter().all(|word| first.contains(word)), "{first}");
    sandbox.run(&["diff", "a", "c", "--html", "pages/changes.html"]).expect(1, &["page: pages/changes.html", "130.0 ns"]);
    let page = std::fs::read_to_string(sandbox.path("pages/changes.html")).unwrap();
    assert!(["1 row changed beyond noise", "featherbench x", ">1.3<"].iter().all(|words| page.contains(words)), "{page}");
    sandbox.run(&["diff", "a", "nowhere"]).expect(2, &["nowhere"]);
    sandbox.run(&["diff", "--help"]).expect(0, &["Exit codes: 0 nothing changed"]);
}

#[test]
fn a_program_reads_what_changed() {
    let sandbox = Sandbox::new();
    run(&sandbox, "a", &times(100.0));
    run(&sandbox, "b", &times(130.0));
    let parsed = |ended: &crate::support::Ended| -> serde_json::Value { serde_json::from_str(&ended.output).unwrap() };
    let ended = sandbox.run(&["diff", "a", "a", "--json"]);
    ended.expect(0, &[]);
    let same = parsed(&ended);
    assert_eq!((&same["status"], &same["compared"], &same["changes"]), (&"same".into(), &1.into(), &serde_json::json!([])));
    let ended = sandbox.run(&["diff", "a", "b", "--json"]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let found = parsed(&ended);
    assert_eq!((&found["status"], &found["same_suite"]), (&"changed".into(), &true.into()));
    let change = &found["changes"][0];
    assert_eq!((&change["change"], &change["robot"], &change["quantity"]), (&"time".into(), &"humanoid".into(), &"id".into()));
    assert_eq!((&change["before"]["value"], &change["after"]["value"]), (&100.0.into(), &130.0.into()));
    assert_eq!(change["factor"], 1.3);
}

#[test]
fn two_suites_are_told_in_a_sentence() {
    let sandbox = Sandbox::new();
    let names: Vec<String> = (0..100).map(|index| format!("quantity{index}")).collect();
    let many: Vec<_> = names.iter().map(|name| (&**name, "ns_per_call", 5.0, "")).collect();
    run(&sandbox, "small", &times(100.0));
    let (mut info, rows) = featherbench_results::read_run(&sandbox.path("small")).unwrap();
    info.suite = "small".into();
    featherbench_results::write_run(&sandbox.path("small"), &info, &rows).unwrap();
    run(&sandbox, "large", &many);
    let ended = sandbox.run(&["diff", "small", "large"]);
    ended.expect(1, &["two suites, 'small' and ''", "1 rows are in the first run only and 100 in the second only"]);
    assert!(ended.output.lines().count() < 5 && !ended.output.contains("quantity7"), "{}", ended.output);
    let ended = sandbox.run(&["diff", "small", "large", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&ended.output).unwrap();
    assert_eq!((&found["same_suite"], &found["only_before"], &found["only_after"]), (&false.into(), &1.into(), &100.into()));
}

#[test]
fn a_folder_of_runs_has_a_page() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("runs")).unwrap();
    sandbox.run(&["history", "runs"]).expect(2, &["runs", "no folder in it is one"]);
    run(&sandbox, "runs/a", &times(100.0));
    run(&sandbox, "runs/b", &times(200.0));
    sandbox.run(&["history", "runs"]).expect(0, &["history of 2 runs", "runs/index.html"]);
    let page = std::fs::read_to_string(sandbox.path("runs/index.html")).unwrap();
    for words in ["2 runs", "href=\"a/index.html\"", "nothing to compare with", "1 time, of 1 row compared", "featherbench x", ">2<"] {
        assert!(page.contains(words), "{words}: {page}");
    }
}

#[test]
fn a_night_is_kept_once_with_its_instructions() {
    let sandbox = Sandbox::new();
    // A project with data of its own.
    std::fs::remove_file(sandbox.path("datasets")).unwrap();
    std::fs::create_dir_all(sandbox.path("datasets/suites")).unwrap();
    std::fs::create_dir(sandbox.path("datasets/history")).unwrap();
    let mut rows = times(123.4);
    rows.push(("fd", "ns_per_call", 200.0, "the machine was not quiet"));
    run(&sandbox, "a", &rows);
    sandbox.write("counts.csv", "rustc,kernel,model,instructions\n1.0 (a, b),id/x,humanoid,4567\n");
    for _ in 0..2 {
        sandbox.run(&["history", "a", "--instructions", "counts.csv"]).expect(0, &["1 kernels", "1 times that do not count left out"]);
    }
    let files = |folder: &str| -> Vec<_> { std::fs::read_dir(sandbox.path(folder)).unwrap().map(|entry| entry.unwrap().path()).collect() };
    assert_eq!(files("datasets/history").len(), 0, "data are written where they are asked for");
    sandbox.run(&["history", "a", "--to", "datasets/history"]).expect(0, &["1 kernels", "datasets/history"]);
    assert_eq!(files("datasets/history").len(), 1);
    let files = files("reports/history");
    assert_eq!(files.len(), 1);
    assert!(files[0].file_name().unwrap().to_str().unwrap().starts_with("an-example-cpu-4-"), "{files:?}");
    let text = std::fs::read_to_string(&files[0]).unwrap();
    assert_eq!(
        text,
        "date,revision,kernel,model,ns,ns_low,ns_high,instructions\n2026-03-04,0123456789,id/x,humanoid,123.4,122.2,124.6,4567\n"
    );
    sandbox.run(&["history", "a", "--model", "panda"]).expect(2, &["no valid times", "panda"]);
    sandbox.write("bad.csv", "rustc,kernel,model,instructions\n1.0,id/x,humanoid,many\n");
    sandbox.run(&["history", "a", "--instructions", "bad.csv"]).expect(2, &["bad.csv", "line 2", "many"]);
}
