//! Bad input: each mistake ends with its exit code and a message that names file, line or field and says what to do. Nothing panics, and no
//! finished work is lost.

use crate::support;

use std::process::Stdio;
use support::{Sandbox, project};

/// A URDF with the given middle part between two good links.
fn urdf(inside: &str) -> String {
    let inertial = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;
    format!("<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">{inertial}</link>\n{inside}\n</robot>\n")
}

const JOINT: &str = r#"<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>"#;

#[test]
fn broken_urdf_is_refused_by_file_line_and_name() {
    let sandbox = Sandbox::new();
    let inertia = r#"<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>"#;
    let cases: [(&str, String, &[&str]); 10] = [
        ("malformed", "<robot name=\"r\"><link name=\"base\"></robot>".into(), &[":1:"]),
        ("unknown joint type", urdf(&JOINT.replace("revolute", "wobbly")), &[":4:", "wobbly", "'j'"]),
        (
            "cycle",
            urdf(&format!(
                "{JOINT}{}",
                JOINT.replace("\"j\"", "\"k\"").replace("\"base\"", "\"x\"").replace("\"arm\"", "\"base\"").replace("\"x\"", "\"arm\"")
            )),
            &["arm"],
        ),
        ("two roots", urdf(&format!("{JOINT}\n<link name=\"other\"/>")), &["other"]),
        ("orphan link", urdf(""), &["arm"]),
        (
            "missing inertial",
            urdf(&format!(
                "{JOINT}<link name=\"hand\"/>{}",
                JOINT.replace("\"j\"", "\"k\"").replace("\"base\"", "\"arm\"").replacen("child link=\"arm\"", "child link=\"hand\"", 1)
            )),
            &["hand", "--allow-massless"],
        ),
        (
            "stranger's mimic",
            urdf(&JOINT.replace("<axis", "<mimic joint=\"other\"/><axis")),
            &["joint 'j' mimics joint 'other'", "--independent-mimics"],
        ),
        ("negative mass", urdf(JOINT).replace("mass value=\"1\"", "mass value=\"-1\""), &[":3:", "arm", "-1"]),
        ("not a number", urdf(JOINT).replace(inertia, &inertia.replace("ixx=\"1\"", "ixx=\"nan\"")), &[":3:", "ixx"]),
        ("decimal comma", urdf(JOINT).replace("mass value=\"1\"", "mass value=\"1,5\""), &[":3:", "1,5"]),
    ];
    for (name, text, words) in cases {
        let file = sandbox.write(&format!("{}.urdf", name.replace(' ', "_")), &text);
        let ended = sandbox.run(&["gen", "urdf", "--file", file.to_str().unwrap()]);
        let named = [words, &[file.file_name().unwrap().to_str().unwrap()]].concat();
        ended.expect(2, &named);
    }
    let good = sandbox.write("good.urdf", &urdf(JOINT));
    sandbox.run(&["gen", "urdf", "--file", good.to_str().unwrap()]).expect(0, &["\"arm\""]);
    sandbox.run(&["gen", "urdf", "--file", "nowhere.urdf"]).expect(2, &["nowhere.urdf"]);
}

/// Something that a format cannot hold is named, and left out only on request.
#[test]
fn formats_refuse_what_they_cannot_hold() {
    let sandbox = Sandbox::new();
    sandbox.run(&["gen", "humanoid", "--out", "h.urdf"]).expect(2, &["URDF cannot hold", "armature", "'left_shin_joint'", "--lossy"]);
    assert!(!sandbox.path("h.urdf").exists());
    sandbox.run(&["gen", "humanoid", "--lossy", "--out", "h.urdf"]).expect(0, &["left out: joint 'left_shin_joint': armature"]);
    sandbox.run(&["gen", "urdf", "--file", "h.urdf", "--out", "h.json"]).expect(0, &["36 dofs"]);
    sandbox.run(&["gen", "neutral", "--file", "h.json", "--format", "urdf"]).expect(0, &["<robot name=\"humanoid\">"]);
    sandbox.run(&["gen", "neutral", "--file", "h.json", "--out", "h.xml"]).expect(2, &["MJCF cannot hold", "velocity"]);
    sandbox.run(&["gen", "joints:kind=helical", "--lossy", "--format", "mjcf"]).expect(2, &["helical", "neutral format"]);
    sandbox.run(&["gen", "neutral"]).expect(2, &["--file"]);
}

#[test]
fn broken_suites_are_refused_by_file_and_key() {
    let sandbox = Sandbox::new();
    let good = std::fs::read_to_string(project().join("datasets/suites/smoke.toml")).unwrap();
    let cases: [(&str, String, &[&str]); 10] = [
        ("unknown study", good.replace("[operations]", "[operashuns]"), &["no study 'operashuns'", "operations"]),
        ("unknown engine", good.replace("\"mujoco\"", "\"mujoko\""), &["there is no engine 'mujoko'", "pinocchio, mujoco, drake"]),
        (
            "engine without a clock",
            good.replace("[timing]", "[timing]\nengines = [\"mujoco\"]"),
            &["mujoco cannot be timed", "drake, dart"],
        ),
        (
            "best of an engine that is not timed",
            good.replace("[timing]", "[timing]\nbest_of = [\"drake\"]"),
            &["'drake' is in best_of, but not in engines"],
        ),
        ("unknown key", good.replace("states = 20", "stades = 20"), &["stades", "line 4"]),
        ("unknown model", good.replace("\"panda\"", "\"pander\""), &["pander.json"]),
        (
            "two sources",
            good.replace("model = \"panda\"", "model = \"panda\"\ngenerate = \"hand\""),
            &["exactly one of model, generate, urdf and mjcf"],
        ),
        ("unknown family", good.replace("model = \"panda\"", "generate = \"spider\""), &["spider", "chain"]),
        ("not TOML", good.replace("seed = 1", "seed 1"), &["line"]),
        ("twice", good.replace("\"panda\"", "\"chain-planar-2\""), &["two robots are named 'chain-planar-2'"]),
    ];
    for (name, text, words) in cases {
        let file = sandbox.write(&format!("{}.toml", name.replace(' ', "_")), &text);
        sandbox.run(&["run", "--suite", file.to_str().unwrap()]).expect(2, words);
    }
    sandbox.run(&["run", "--suite", "nowhere"]).expect(2, &["there is no suite 'nowhere'"]);
    sandbox.run(&["run", "--suite", "smok"]).expect(2, &["there is no suite 'smok'; did you mean 'smoke'?", "default, "]);
    sandbox.run(&["oracles", "install", "pinochio"]).expect(2, &["did you mean 'pinocchio'?"]);
    sandbox.run(&["uncertainty", "pandda"]).expect(2, &["did you mean 'panda'?"]);
    // The file of a live robot: a suite leaves it out by name, or it is an error.
    let robots = "[[robot]]\nmodel = \"panda\"\nfamily = \"robot\"\n[[robot]]\nurdf = \"a.urdf\"\nfamily = \"robot\"\n";
    let suite = |more: &str| sandbox.write("live.toml", &format!("about = \"x\"\nseed = 1\n[operations]\n{robots}{more}"));
    let run = |file: &std::path::Path| sandbox.run(&["run", "--suite", file.to_str().unwrap(), "--out", "live"]);
    run(&suite("")).expect(3, &["a.urdf", "which only live runs have"]);
    run(&suite("only_live = true\n")).expect(0, &["report:"]);
    sandbox.run(&["run", "--filter", "("]).expect(2, &["--filter"]);
}

/// A filter that matches nothing is an error.
#[test]
fn a_filter_without_a_match_is_told_what_there_is() {
    let sandbox = Sandbox::new();
    let run = |only: &str| sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "out", "--filter", only]);
    run("pandas/.*/fdd").expect(2, &["no cell of the suite smoke matches", "'pandas': nearest are panda", "'fdd': nearest are fd"]);
    run("pinocchio/panda")
        .expect(2, &["a path is study/robot/engine/quantity/method", "the engines drake, featherbench, mujoco, pinocchio"]);
    assert!(!sandbox.path("out").exists(), "nothing was begun");
    run("panda/featherbench/fd/aba$").expect(0, &["report:"]);
}

/// Another seed needs engines that answer only where answers are recorded.
#[test]
fn a_seed_needs_live_engines_only_where_answers_are_recorded() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--seed", "3", "--out", "out"]).expect(2, &["recorded to the suite's own seed", "--live"]);
    assert!(!sandbox.path("out").exists(), "nothing was begun");
    for suite in ["uncertainty", "identification", "contact", "lesson"] {
        let cell = if suite == "uncertainty" { "refusal" } else { "nothing" };
        let expected = if suite == "uncertainty" { (0, "report:") } else { (2, "no cell of the suite") };
        let found = sandbox.run(&["run", "--suite", suite, "--seed", "3", "--out", suite, "--filter", cell]);
        found.expect(expected.0, &[expected.1]);
    }
}

#[test]
fn wrong_usage_is_exit_code_two() {
    let sandbox = Sandbox::new();
    for arguments in
        [&["fly"][..], &["run", "--resume"], &["gen"], &["gen", "chain", "--set", "n"], &["gen", "chain", "--n", "0"], &["explain", "x"]]
    {
        assert_eq!(sandbox.run(arguments).code, Some(2), "{arguments:?}");
    }
    sandbox.run(&["gen", "chain", "--set", "m=3"]).expect(2, &["no parameter 'm'", "layout"]);
}

/// A folder that holds no run, and a number that is none, are told as that.
#[test]
fn what_is_no_run_and_no_seed_is_told() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("empty")).unwrap();
    sandbox.write("file", "");
    for command in [&["gate"][..], &["report"], &["explain", "3f"], &["reduce"], &["export", "--parquet", "out"]] {
        for (folder, words) in [("nowhere", "there is no such folder"), ("empty", "the folder is empty"), ("file", "")] {
            sandbox.run(&[command, &[folder]].concat()).expect(2, &[folder, words]);
        }
    }
    sandbox.run(&["history", "empty"]).expect(2, &["empty: it is no run"]);
    sandbox.run(&["diff", "nowhere", "empty"]).expect(2, &["nowhere: there is no such folder"]);
    for seed in ["abc", "-1", "1.5", "18446744073709551616"] {
        for command in [&["run"][..], &["gen", "random_tree"], &["uncertainty", "chain:n=2"], &["residuals", "chain:n=2"]] {
            sandbox.run(&[command, &["--seed", seed]].concat()).expect(2, &[seed, "a seed is a whole number from 0 to"]);
        }
    }
}

/// Programs that start within one second have a folder each.
#[test]
fn many_at_once_have_folders_of_their_own() {
    let sandbox = Sandbox::new();
    let run = ["run", "--suite", "smoke", "--no-timing", "--filter", "agreement/chain-planar-2/featherbench/id/"];
    let quiet = || sandbox.command(&run).stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let started: Vec<_> = (0..8).map(|_| quiet()).collect();
    for run in started {
        let ended = run.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    }
    let folders: Vec<_> = std::fs::read_dir(sandbox.path("reports")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(folders.iter().filter(|folder| folder.join("checksums.txt").is_file()).count(), 8, "{folders:?}");
}

#[test]
fn runs_share_a_catalogue_only_where_cases_can_name_theirs() {
    let sandbox = Sandbox::new();
    let run = ["run", "--suite", "smoke", "--no-timing", "--filter", "agreement/chain-planar-2/featherbench/id/", "--out"];
    for out in ["a", "b/a"] {
        assert_eq!(sandbox.run(&[&run[..], &[out]].concat()).code, Some(0));
    }
    sandbox.run(&["reduce", "a", "b/a"]).expect(2, &["2 runs have one catalogue", "--out DIR"]);
    sandbox.run(&["reduce", "a", "b/a", "--out", "c"]).expect(2, &["a and b/a are both the run a"]);
    sandbox.run(&["reduce", "a", "--out", "c"]).expect(2, &["a: there is nothing to reduce"]);
    assert!(!sandbox.path("c").exists());
}

#[test]
fn output_folders_are_never_overwritten() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("full")).unwrap();
    sandbox.write("full/precious", "kept");
    let run = |out: &str| sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", out]);
    run("full").expect(2, &["full", "not empty", "--out", "--resume"]);
    assert_eq!(std::fs::read_to_string(sandbox.path("full/precious")).unwrap(), "kept");
    sandbox.run(&["run", "--suite", "smoke", "--resume", "--out", "full"]).expect(2, &["no run to resume"]);
    // A folder in which no user can write, not even root.
    run("/proc/featherbench").expect(2, &["/proc/featherbench"]);
    sandbox.write("file", "");
    run("file/below").expect(2, &["file/below"]);
}

#[test]
fn damaged_recordings_cost_their_robot_and_nothing_else() {
    let sandbox = Sandbox::new();
    let folder = sandbox.path("recorded");
    std::fs::create_dir(&folder).unwrap();
    for model in ["chain-planar-2", "joints-common-free-single", "panda"] {
        let name = format!("{model}.recording");
        std::fs::copy(project().join("datasets/recorded").join(&name), folder.join(&name)).unwrap();
    }
    let panda = folder.join("panda.recording");
    let whole = std::fs::read(&panda).unwrap();
    std::fs::write(&panda, &whole[..whole.len() / 2]).unwrap();
    let ended = sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--recorded", "recorded", "--out", "out"]);
    ended.expect(1, &["panda.recording", "truncated", "featherbench record", "report:"]);
    let csv = std::fs::read_to_string(sandbox.path("out/rows.csv")).unwrap();
    let passing = |model: &str| {
        csv.lines().filter(|line| line.contains(&format!(",{model},")) && line.contains(",pinocchio,") && line.contains(",pass,")).count()
    };
    assert!(passing("chain-planar-2") > 50, "the other robots are compared");
    assert_eq!(passing("panda"), 0);

    // A folder without recordings, and one that is not there.
    std::fs::remove_dir_all(&folder).unwrap();
    std::fs::create_dir(&folder).unwrap();
    let ended = sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--recorded", "recorded", "--out", "none"]);
    ended.expect(1, &["engine pinocchio answers", "engine mujoco answers", "engine drake answers"]);
    sandbox.run(&["run", "--suite", "smoke", "--recorded", "nowhere"]).expect(2, &["--recorded nowhere: there is no such folder"]);
}

#[test]
fn damaged_runs_are_refused_by_file() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--filter", "operations", "--out", "out"]).expect(0, &["report:"]);
    sandbox.run(&["report", "out"]).expect(0, &["out/index.html"]);
    let cell = std::fs::read_to_string(sandbox.path("out/rows.csv"))
        .unwrap()
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .nth(1)
        .unwrap()
        .trim_matches('"')
        .to_owned();
    sandbox.run(&["explain", &cell[..6], "out"]).expect(0, &["operations", "again"]);
    sandbox.run(&["explain", "zz", "out"]).expect(2, &["no cell that begins with 'zz'"]);

    let path = sandbox.path("out/rows.csv");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 40]).unwrap();
    sandbox.run(&["gate", "out"]).expect(2, &["rows.csv"]);
    // One bit, after which the row can still be read.
    let at = whole.iter().rposition(u8::is_ascii_digit).unwrap();
    let mut flipped = whole.clone();
    flipped[at] ^= 1;
    std::fs::write(&path, flipped).unwrap();
    for arguments in [&["report", "out"][..], &["gate", "out"], &["diff", "out", "out"], &["explain", &cell[..6], "out"]] {
        sandbox.run(arguments).expect(2, &["rows.csv", "its checksum is not the one in", "checksums.txt"]);
    }
    sandbox.run(&["report", "nowhere"]).expect(2, &["nowhere"]);
}

#[test]
fn a_missing_python_is_exit_code_three() {
    let sandbox = Sandbox::new();
    let empty = sandbox.path("empty");
    std::fs::create_dir(&empty).unwrap();
    let mut command = sandbox.command(&["oracles", "install"]);
    let ended = support::Ended::new(command.env("PATH", &empty).env("PYENV_ROOT", &empty).output().unwrap());
    ended.expect(3, &["python3", "Python 3.11", "recorded answers"]);
    sandbox.run(&["oracles", "status"]).expect(3, &["not installed", "oracles install"]);
}

/// A file that is not a robot's is reported before any engine is installed or started.
#[test]
fn what_cannot_be_compared_gets_advice() {
    let sandbox = Sandbox::new();
    let cases: [(&str, &[u8], &str); 12] = [
        ("part.stl", b"solid part", "a .stl file holds a shape"),
        ("model.bin", b"\x00\x01robot", "binary file"),
        ("renamed.urdf", b"\x00\x01robot", "binary file"),
        ("empty.urdf", b"", "is empty"),
        ("blank.xml", b" \n ", "is empty"),
        ("robot.xacro", b"<robot/>", "xacro FILE > robot.urdf"),
        ("calls.urdf", b"<robot xmlns:xacro='x'><xacro:arm/></robot>", "xacro FILE > robot.urdf"),
        ("part.xml", b"<mujocoinclude/>", "whose root element is <mujoco>"),
        ("page.html", b"<!-- x --><html></html>", "the root element is <html>"),
        ("robot.json", b"{\"format\":1}", "looks like a description file"),
        ("notes.txt", b"a robot", "neither URDF, MJCF, SDF nor USD"),
        ("broken.urdf", b"not XML", "no XML element"),
    ];
    for (name, bytes, words) in cases {
        std::fs::write(sandbox.path(name), bytes).unwrap();
        sandbox.run(&["compare", name]).expect(2, &[name, words]);
        sandbox.run(&["gen", "mjcf", "--file", name]).expect(2, &[name, words]);
    }
    let deep = format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(600), "</body>".repeat(600));
    let utf16: Vec<u8> = "<robot name='r'/>".encode_utf16().flat_map(u16::to_be_bytes).collect();
    let entities = "<?xml version='1.0'?><!DOCTYPE robot [<!ENTITY m '1'>]>\n<robot name='r'/>";
    let limits: [(&str, &[u8], &[&str]); 3] = [
        ("deep.xml", deep.as_bytes(), &["nested 602 deep", "the limit is 500"]),
        ("wide.urdf", &utf16, &["UTF-16BE", "iconv -f UTF-16BE -t UTF-8"]),
        ("entities.urdf", entities.as_bytes(), &["document type with entities", "xmllint --noent"]),
    ];
    for (name, bytes, words) in limits {
        std::fs::write(sandbox.path(name), bytes).unwrap();
        sandbox.run(&["compare", name]).expect(2, &[&[name], words].concat());
    }
    // Every bad file is reported, and the end names them all.
    sandbox
        .run(&["compare", "deep.xml", "wide.urdf"])
        .expect(2, &["not compared: deep.xml", "not compared: wide.urdf", "2 files cannot be compared"]);
    let ended = sandbox.run(&["compare", "nowhere.urdf"]);
    ended.expect(2, &["nowhere.urdf"]);
    assert_eq!(ended.errors.matches("nowhere.urdf").count(), 1, "a refusal is told once: {ended:?}");
    // An overflow is the file's fault, and is told before engines are asked.
    let heavy = sandbox.write("heavy.urdf", &urdf(JOINT).replacen("mass value=\"1\"", "mass value=\"1e300\"", 1));
    sandbox.run(&["compare", heavy.to_str().unwrap()]).expect(2, &["heavy.urdf", "its mass is 1e300 kg", "overflow"]);
    sandbox.run(&["compare", "datasets"]).expect(2, &["this is a folder"]);
    let good = sandbox.write("good.urdf", &urdf(JOINT));
    sandbox.run(&["compare", good.to_str().unwrap(), "--engines", "pinochio"]).expect(2, &["'pinochio'", "pinocchio, mujoco, drake"]);
    sandbox.run(&["compare"]).expect(2, &["FILE"]);
    sandbox.run(&["gen", "mjcf"]).expect(2, &["--file"]);
    sandbox.run(&["gen", "mjcf", "--file", "nowhere.xml"]).expect(2, &["nowhere.xml"]);
    sandbox.run(&["gen", "mjcf", "--file", good.to_str().unwrap()]).expect(2, &["good.urdf", "this is a URDF", "gen urdf"]);
    sandbox.write("good.xml", "<mujoco/>");
    sandbox.run(&["gen", "mjcf", "--file", "good.xml", "--floating"]).expect(2, &["says itself what floats"]);
    sandbox.run(&["gen", "mjcf", "--file", "good.xml"]).expect(3, &["good.xml", "MuJoCo", "not installed", "oracles install"]);
}

/// The reader of standard output leaves at once: nothing panics, and the exit code is that of a reader who stays.
#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let sandbox = Sandbox::new();
    for arguments in [&["gen", "chain:n=20000"][..], &["gen", "chain:n=2000", "--format", "urdf", "--lossy"], &["list", "--cells"]] {
        let mut child = sandbox.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !errors.contains("panic") && !errors.contains("pipe"), "{arguments:?}: {output:?}");
    }
}

/// A full disk: nothing panics, and the command says that its words are lost.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    let sandbox = Sandbox::new();
    for arguments in [&["list"][..], &["gen", "chain:n=3"], &["plan", "smoke"], &["completions", "bash"], &["man"]] {
        let output = sandbox.command(arguments).stdout(full()).output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert!(errors.contains("standard output cannot be written") && !errors.contains("panic"), "{arguments:?}: {errors}");
    }
    // What was found stays the exit code where errors cannot be written.
    let unknown = ["plan", "no-such-suite"];
    let told = sandbox.command(&unknown).output().unwrap().status.code();
    assert_eq!(sandbox.command(&unknown).stderr(full()).output().unwrap().status.code(), told);
}
