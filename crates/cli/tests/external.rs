//! External engines, without any Python: programs of a few lines of shell.

use crate::support;

use featherbench_bench::{Engine, Quantity, Robot};
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

/// A shell with a table. It answers about one robot with the contents of files beside it, and does not support any other. MORE runs before
/// each answer.
const TABLE: &str = r#"#!/bin/sh
while read -r line; do
    case "$line" in
        *'"op":"hello"'*) echo '{"status":"ok","protocol":1,"engine":"table","version":"7","build":{},"methods":{"id":["table"]}}';;
        *'"name":"chain-planar-2"'*'"op":"prepare"'*)
            echo '{"status":"ok","nq":2,"nv":2,"blocks":[{"name":"readback","shape":[2,22]}]}'; cat readback.bin;;
        *'"op":"prepare"'*) echo '{"status":"unsupported","reason":"the table has one robot"}';;
        *'"op":"states"'*) head -c STATES > /dev/null; echo '{"status":"ok"}';;
        *) echo '{"status":"ok","blocks":[{"name":"value","shape":[20,2]}]}'; MORE; cat id.bin;;
    esac
done
"#;

fn with_shy() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("shy oracle.sh", SHY);
    sandbox
}

#[test]
fn names_and_programs_are_checked_before_anything_runs() {
    let sandbox = with_shy();
    let refused = [
        ("featherbench=sh 'shy oracle.sh'", 2, "the name 'featherbench' is taken"),
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

/// The table's answers: those of our kernels, each number multiplied by a factor.
fn with_table(more: &str, factor: f64) -> Sandbox {
    let sandbox = Sandbox::new();
    let description = featherbench_formats::neutral::read(support::project().join("datasets/models/chain-planar-2.json")).unwrap();
    let robot = Robot::new(&description, "chain", featherbench_results::ModelOrigin::Generated, 20, 1).unwrap();
    let featherbench = featherbench_engines::Featherbench::new();
    let mut rnea = featherbench.prepare(&robot, Quantity::InverseDynamics, "rnea_packed", &robot.states).unwrap();
    rnea.run(0..20).unwrap();
    let bytes = |values: &[f64]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let scaled = |factor: f64| rnea.read().iter().map(|x| x * factor).collect::<Vec<f64>>();
    std::fs::write(sandbox.path("readback.bin"), bytes(&robot.readback())).unwrap();
    std::fs::write(sandbox.path("id.bin"), bytes(&scaled(factor))).unwrap();
    std::fs::write(sandbox.path("noisy.bin"), bytes(&scaled(1.0 + 8.0 * f64::EPSILON))).unwrap();
    let states = &robot.states;
    let numbers = states.q.len() + states.v.len() + states.a.len() + states.tau.len() + states.wrench.len() + robot.probe().len();
    sandbox.write("table.sh", &TABLE.replace("STATES", &(8 * numbers).to_string()).replace("MORE", more));
    sandbox
}

const TABLE_RUN: [&str; 7] = ["run", "--suite", "smoke", "--no-timing", "--engine", "mine=sh table.sh", "--out"];

/// What is first said of a factor of 1 + 1e-9: not that digits are lost.
const FACTOR: &str = "failed: mine, inverse dynamics: all values are too large by one part in 1e9 against featherbench";

/// Something that it does not offer is not a fault, as in the conformance test. Its answers are judged, in the run and when it is judged
/// again.
#[test]
fn an_external_engine_is_judged_by_what_it_answers() {
    let sandbox = with_table(":", 1.0);
    sandbox.run(&[&TABLE_RUN[..], &["green"]].concat()).expect(0, &["7 not offered"]);
    sandbox.run(&["gate", "green"]).expect(0, &["7 not offered"]);
    let rows = std::fs::read_to_string(sandbox.path("green/rows.csv")).unwrap();
    let of_table = |verdict: &str| rows.lines().filter(|row| row.contains(",mine,7,") && row.contains(&format!(",{verdict},"))).count();
    assert!(of_table("pass") > 3 && of_table("skip") == 5, "{rows}");
    assert!(rows.contains("the table has one robot"));
    let page = std::fs::read_to_string(sandbox.path("green/index.html")).unwrap();
    assert!(page.contains("mine"), "it is in the report");
    let info = std::fs::read_to_string(sandbox.path("green/run.json")).unwrap();
    assert!(info.contains("\"engine\": \"table\"") && info.contains("\"source\": \"live\""), "its own name and source are kept");
    let wrong = with_table(":", 1.0 + 1e-9);
    wrong.run(&[&TABLE_RUN[..], &["red"]].concat()).expect(1, &["rows outside their bound", FACTOR, "new: mine, "]);
    wrong.run(&["gate", "red"]).expect(1, &["rows outside their bound", FACTOR, ": mine, ", "on 1 robot", "--filter"]);
}

/// Numbers that change by a few units in the last place between questions pass every bound, but are not valid answers.
#[test]
fn an_external_engine_that_does_not_repeat_itself_is_red() {
    let noise = "if [ -e odd ]; then rm odd; cat noisy.bin; continue; fi; : > odd";
    let sandbox = with_table(noise, 1.0);
    let ended = sandbox.run(&[&TABLE_RUN[..], &["noisy"]].concat());
    ended.expect(
        1,
        &[
            "failed: mine, repeatability, repeated: 16 ulp where equal to 0 is due, in 1 row on 1 robot",
            "new: mine, ",
            "asked twice for id",
            "units in the last place",
            "rows outside their bound: expected 0, found 1",
        ],
    );
}

/// No method, or no robot: no row would fail, and the run says so.
#[test]
fn an_engine_that_answers_nothing_is_red() {
    let sandbox = with_shy();
    let run = ["run", "--suite", "smoke", "--no-timing", "--engine", "mine=sh 'shy oracle.sh'", "--out"];
    let words = ["engine mine answers something that the suite asks", "it has no number for any robot", "shy has no such robot"];
    sandbox.run(&[&run[..], &["shy"]].concat()).expect(1, &words);
    sandbox.run(&["gate", "shy"]).expect(1, &words);
    sandbox.write("shy oracle.sh", &SHY.replace(r#"{"id":["guess"]}"#, "{}"));
    let words =
        ["engine mine answers something that the suite asks", "its hello names no method for any quantity", "bias, body_acceleration"];
    sandbox.run(&[&run[..], &["mute"]].concat()).expect(1, &words);
    let part = [&run[..], &["part", "--filter", "agreement/panda/"]].concat();
    sandbox.run(&part).expect(1, &words);
    // A quantity that is not in the suite counts for nothing.
    sandbox.write("shy oracle.sh", &SHY.replace("\"id\"", "\"fd_f32\""));
    sandbox.run(&[&run[..], &["other"]].concat()).expect(1, &words);
}

/// A run and the conformance test refuse the same shapes.
#[test]
fn a_run_and_the_conformance_test_ask_for_the_same_shapes() {
    let sandbox = with_table(":", 1.0);
    let table = std::fs::read_to_string(sandbox.path("table.sh")).unwrap();
    for (right, wrong, named) in [
        ("\"shape\":[20,2]", "\"shape\":[40]", "block 'value' has the shape [40]; [20, 2] is due"),
        ("\"shape\":[2,22]", "\"shape\":[44]", "[2, 22] is due"),
    ] {
        assert!(table.contains(right));
        sandbox.write("table.sh", &table.replace(right, wrong));
        let out = format!("shape-{}", named.len());
        sandbox.run(&[&TABLE_RUN[..], &[&out]].concat()).expect(1, &[named, "rows without a value that was due"]);
    }
}

/// A version is only what a program reports: outcomes are stored by the program's hash.
#[test]
fn a_run_is_not_continued_with_another_program_of_an_external_engine() {
    let sandbox = with_shy();
    let run = |more: &[&str]| {
        let common = ["run", "--suite", "smoke", "--no-timing", "--filter", "/mine/", "--out", "out"];
        sandbox.run(&[&common[..], more].concat())
    };
    let engine = ["--engine", "mine=sh 'shy oracle.sh'"];
    let with = |more: &[&'static str]| [&engine[..], more].concat();
    let asked = || std::fs::read(sandbox.path("out/outcomes.bin")).unwrap();
    run(&with(&[])).expect(0, &["7 not offered"]);
    let first = asked();
    run(&with(&["--resume"])).expect(0, &["7 not offered"]);
    assert_eq!(asked(), first, "nothing was asked twice");
    sandbox.write("shy oracle.sh", &SHY.replace("no such robot", "no robot today"));
    run(&with(&["--resume"])).expect(2, &["another program of engine mine", "--allow-mixed"]);
    run(&["--resume"]).expect(2, &["another program of engine mine", "none now"]);
    assert_eq!(asked(), first, "and nothing is lost");
    run(&with(&["--resume", "--allow-mixed"])).expect(0, &["7 not offered"]);
    run(&with(&["--resume"])).expect(0, &["7 not offered"]);
}

#[test]
fn the_conformance_test_ends_with_the_right_code() {
    let sandbox = with_shy();
    sandbox.run(&["oracles", "check", "./nowhere"]).expect(2, &["there is no program ./nowhere"]);
    sandbox.run(&["oracles", "check"]).expect(2, &["PROGRAM"]);
    let mute = sandbox.run(&["oracles", "check", "sh", "-c", "echo 'no licence' >&2; exit 3"]);
    mute.expect(1, &["it answers hello", "no licence", "does not conform"]);
    let chatty = sandbox.run(&["oracles", "check", "sh", "-c", "echo 'Welcome to Engine 3.1!'; cat > /dev/null"]);
    chatty.expect(1, &["not in the protocol", "standard output carries messages only"]);
    let deaf = sandbox.run(&["oracles", "check", "--timeout", "1", "sleep", "1000"]);
    deaf.expect(1, &["no answer within 1 s", "flush"]);
    let shy = sandbox.run(&["oracles", "check", "sh", "shy oracle.sh"]);
    shy.expect(1, &["shy 7", "an op that nobody knows is an error", "it builds some robot", "a free body: shy has no such robot"]);
}
