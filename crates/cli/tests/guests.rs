//! Engines that a user brings along, without any Python: programs of a few lines of shell.

mod support;

use support::Sandbox;

/// A shell that builds no robot.
const SHY: &str = r#"#!/bin/sh
while read -r line; do
    case "$line" in
        *'"op":"hello"'*) echo '{"status":"ok","protocol":1,"engine":"shy","version":"7","build":{},"methods":{"id":["guess"]}}';;
        *) echo '{"status":"unsupported","reason":"shy has no such robot"}';;
    esac
done
"#;
const NO_ROBOT: &str = "\n[[not_offered]]\nengine = \"mine\"\nversion = \"7\"\nmodels = [\"*\"]\nreason = \"a shell has no robots\"\n";

fn with_shy() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("shy oracle.sh", SHY);
    sandbox
}

#[test]
fn names_and_programs_are_checked_before_anything_runs() {
    let sandbox = with_shy();
    let refused = [
        ("native=sh 'shy oracle.sh'", 2, "the name 'native' is taken"),
        ("mujoco=sh 'shy oracle.sh'", 2, "the name 'mujoco' is taken"),
        ("mine=./nowhere", 2, "there is no program ./nowhere"),
        ("mine=no-such-program-anywhere", 2, "there is no program"),
        ("mine", 2, "NAME=PROGRAM"),
        ("my engine=sh", 2, "is no name"),
        ("mine=sh 'shy oracle.sh", 2, "is not closed"),
        ("mine=sh -c 'echo hello; exit 4'", 3, "engine mine does not answer"),
    ];
    for (engine, code, words) in refused {
        sandbox.run(&["run", "--suite", "smoke", "--out", "out", "--engine", engine]).expect(code, &[words]);
        assert!(!sandbox.path("out").exists(), "{engine}: nothing was begun");
    }
    let twice = ["run", "--suite", "smoke", "--engine", "mine=sh 'shy oracle.sh'", "--engine", "mine=sh 'shy oracle.sh'"];
    sandbox.run(&twice).expect(2, &["the name 'mine' is taken"]);
}

/// Its rows are gated like any engine's: what it does not offer is red until `ci/deviations.toml` says why; the suite's own counts stay met.
#[test]
fn a_guest_is_judged_beside_the_recorded_engines() {
    let sandbox = with_shy();
    let run = ["run", "--suite", "smoke", "--no-timing", "--engine", "mine=sh 'shy oracle.sh'", "--out"];
    sandbox.run(&[&run[..], &["red"]].concat()).expect(1, &["rows that a subject does not offer and ci/deviations.toml does not name"]);
    // A `ci` of its own, that knows the shell.
    std::fs::remove_file(sandbox.path("ci")).unwrap();
    std::fs::create_dir(sandbox.path("ci")).unwrap();
    let ci = support::project().join("ci");
    std::fs::copy(ci.join("gates.toml"), sandbox.path("ci/gates.toml")).unwrap();
    let known = std::fs::read_to_string(ci.join("deviations.toml")).unwrap();
    sandbox.write("ci/deviations.toml", &(known + NO_ROBOT));
    std::fs::create_dir(sandbox.path("ci/deviations")).unwrap();
    for file in std::fs::read_dir(ci.join("deviations")).unwrap().map(|entry| entry.unwrap().path()) {
        std::fs::copy(&file, sandbox.path("ci/deviations").join(file.file_name().unwrap())).unwrap();
    }
    sandbox.run(&[&run[..], &["green"]].concat()).expect(0, &["6 skip"]);
    let rows = std::fs::read_to_string(sandbox.path("green/records.csv")).unwrap();
    assert_eq!(rows.lines().filter(|row| row.contains(",mine,7,guess,")).count(), 3, "one row of `id` for each robot");
    assert!(rows.contains("shy has no such robot"));
    let page = std::fs::read_to_string(sandbox.path("green/index.html")).unwrap();
    assert!(page.contains("mine"), "it is in the report");
    let info = std::fs::read_to_string(sandbox.path("green/run.json")).unwrap();
    assert!(info.contains("\"engine\": \"shy\"") && info.contains("\"source\": \"live\""), "its own name and source are kept");
}

/// A version is what a program says of itself: outcomes are kept by what the program is.
#[test]
fn a_run_is_not_continued_with_another_program_of_a_guest() {
    let sandbox = with_shy();
    let run = |more: &[&str]| {
        let common = ["run", "--suite", "smoke", "--no-timing", "--only", "/mine/", "--out", "out"];
        sandbox.run(&[&common[..], more].concat())
    };
    let engine = ["--engine", "mine=sh 'shy oracle.sh'"];
    let with = |more: &[&'static str]| [&engine[..], more].concat();
    let asked = || std::fs::read(sandbox.path("out/outcomes.frames")).unwrap();
    run(&with(&[])).expect(1, &["6 skip"]);
    let first = asked();
    run(&with(&["--resume"])).expect(1, &["6 skip"]);
    assert_eq!(asked(), first, "nothing was asked twice");
    sandbox.write("shy oracle.sh", &SHY.replace("no such robot", "no robot today"));
    run(&with(&["--resume"])).expect(2, &["another program of engine mine", "--mixed"]);
    run(&["--resume"]).expect(2, &["another program of engine mine", "none now"]);
    assert_eq!(asked(), first, "and nothing is lost");
    run(&with(&["--resume", "--mixed"])).expect(1, &["6 skip"]);
    run(&with(&["--resume"])).expect(1, &["6 skip"]);
}

#[test]
fn the_conformance_test_ends_with_the_right_code() {
    let sandbox = with_shy();
    sandbox.run(&["oracles", "check", "./nowhere"]).expect(2, &["there is no program ./nowhere"]);
    sandbox.run(&["oracles", "check"]).expect(2, &["PROGRAM"]);
    let mute = sandbox.run(&["oracles", "check", "sh", "-c", "echo 'no licence' >&2; exit 3"]);
    mute.expect(1, &["it answers hello", "no licence", "does not conform"]);
    let chatty = sandbox.run(&["oracles", "check", "sh", "-c", "echo 'Welcome to Engine 3.1!'; cat > /dev/null"]);
    chatty.expect(1, &["not in the protocol", "standard output carries frames only"]);
    let deaf = sandbox.run(&["oracles", "check", "--answer-within", "1", "sleep", "1000"]);
    deaf.expect(1, &["no answer within 1 s", "flush"]);
    let shy = sandbox.run(&["oracles", "check", "sh", "shy oracle.sh"]);
    shy.expect(1, &["shy 7", "an op that nobody knows is an error", "it builds some robot", "a free body: shy has no such robot"]);
}
