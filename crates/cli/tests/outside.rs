//! Tests that need what a fresh machine may not have: Python, the reference engines, a browser.
//!
//! Each is run where it can be and listed as skipped where it cannot; with `FEATHERBENCH_REQUIRE_ALL` set, as in CI, a skip is a failure.
//! Not libtest: its captured output would hide the skips.

mod support;

use engines::{Limits, Oracle};
use harness::{FileBase, FileFormat, RobotFile, Subject};
use std::process::{Command, ExitCode};
use studies::reading::{Cause, Comparison, Difference, Field};
use support::{Ended, Sandbox, project};

type Test = fn() -> Outcome;

/// What became of a test.
enum Outcome {
    Passed,
    Failed(String),
    Skipped(String),
}

fn main() -> ExitCode {
    let tests: [(&str, Test); 5] = [
        ("a number that one engine's file has alone is named", one_file_is_another),
        ("a missing wheel is exit code three and can be tried again", missing_wheel),
        ("the oracles pass their own tests", oracles_by_themselves),
        ("a live run agrees with the recorded answers", live_run),
        ("a browser clicks through the report", browser),
    ];
    let (mut passed, mut failed, mut skipped) = (0, 0, 0);
    for (name, test) in tests {
        // A failed assertion of a test is that test's failure.
        match std::panic::catch_unwind(test).unwrap_or_else(|_| Outcome::Failed("see above".into())) {
            Outcome::Passed => {
                println!("passed: {name}");
                passed += 1;
            }
            Outcome::Failed(reason) => {
                println!("failed: {name}: {reason}");
                failed += 1;
            }
            Outcome::Skipped(reason) => {
                println!("skipped: {name}: {reason}");
                skipped += 1;
            }
        }
    }
    println!("{passed} passed, {failed} failed, {skipped} skipped");
    let required = std::env::var_os("FEATHERBENCH_REQUIRE_ALL").is_some();
    if failed > 0 || required && skipped > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

fn checked(command: &mut Command) -> Outcome {
    let ended = Ended::new(command.output().unwrap());
    if ended.code == Some(0) { Outcome::Passed } else { Outcome::Failed(format!("{}\n{}", ended.output, ended.errors)) }
}

fn installed_python() -> Result<std::path::PathBuf, Outcome> {
    let python = project().join("target/oracles/venv/bin/python");
    let installed = python.exists() && project().join("target/oracles/installed").exists();
    if installed { Ok(python) } else { Err(Outcome::Skipped("the engines are not installed (`featherbench oracles install`)".into())) }
}

fn missing_wheel() -> Outcome {
    if !exists("python3") {
        return Outcome::Skipped("there is no python3".into());
    }
    let sandbox = Sandbox::new();
    // No index, nothing to find: as on a machine whose index lacks the wheel. Without uv on the path, so that pip is tried.
    let install = |arguments: &[&str]| {
        let mut command = sandbox.command(arguments);
        command.env("PIP_NO_INDEX", "1").env("PIP_FIND_LINKS", sandbox.folder.path()).env("UV_NO_INDEX", "1").env("UV_OFFLINE", "1");
        Ended::new(command.output().unwrap())
    };
    let words = ["pin==4.1.0", "recorded answers"];
    install(&["oracles", "install"]).expect(3, &words);
    install(&["oracles", "install"]).expect(3, &words);
    install(&["run", "--suite", "smoke", "--live"]).expect(3, &words);
    Outcome::Passed
}

fn oracles_by_themselves() -> Outcome {
    match installed_python() {
        Ok(python) => {
            let run = |test: &str| checked(Command::new(&python).arg(project().join("oracles").join(test)));
            match run("test_oracles.py") {
                Outcome::Passed => run("test_reading.py"),
                other => other,
            }
        }
        Err(skipped) => skipped,
    }
}

fn live_run() -> Outcome {
    if let Err(skipped) = installed_python() {
        return skipped;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    let run =
        command.current_dir(project()).args(["run", "--suite", "smoke", "--live", "--no-timing", "--out"]).arg(folder.path().join("live"));
    checked(run)
}

/// A URDF of a pendulum on a slide, with some numbers of its own.
fn pendulum(mass: &str, axis: &str, inertial: &str) -> String {
    format!(
        r#"<robot name="p"><link name="base"/>
        <link name="cart"><inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
        <link name="rod"><inertial><origin xyz="0 0 0.5" rpy="{inertial}"/><mass value="{mass}"/>
        <inertia ixx="0.08" ixy="0" ixz="0" iyy="0.09" iyz="0" izz="0.02"/></inertial></link>
        <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="hinge" type="revolute"><parent link="cart"/><child link="rod"/><origin xyz="0 0 0.1"/><axis xyz="{axis}"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        </robot>"#
    )
}

/// Each engine reads files of its own: one has another number in it, and the others are read alike.
fn one_file_is_another() -> Outcome {
    let python = match installed_python() {
        Ok(python) => python,
        Err(skipped) => return skipped,
    };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        RobotFile::open(&path, FileFormat::Urdf, FileBase::Fixed).unwrap()
    };
    let honest = write("honest.urdf", pendulum("1", "0 1 0", "0.3 0 0"));
    let (ours, _) = formats::urdf::read(&honest.path, &formats::urdf::Options::default()).unwrap();
    let planted = [
        ("mass", pendulum("1.5", "0 1 0", "0.3 0 0"), Field::Mass, Cause::Number),
        ("grams", pendulum("1000", "0 1 0", "0.3 0 0"), Field::Mass, Cause::Unit),
        ("flipped", pendulum("1", "0 -1 0", "0.3 0 0"), Field::Axis, Cause::Flipped),
        ("lost", pendulum("1", "0 1 0", "0 0 0"), Field::Inertia, Cause::InertialRotationLost),
    ]
    .map(|(name, text, field, cause)| (write(&format!("{name}.urdf"), text), field, cause));
    for engine in ["pinocchio", "mujoco", "drake"] {
        let program = project().join(format!("oracles/{engine}.py"));
        let oracle = Oracle::start(vec![python.clone().into(), program.into()], Limits::default()).unwrap();
        let compared = |file: &RobotFile| {
            let reading = oracle.read(file).unwrap();
            Comparison::of(&ours, &reading.description, &reading.notes).differences().cloned().collect::<Vec<Difference>>()
        };
        assert_eq!(compared(&honest), [], "{engine}");
        for (file, field, cause) in &planted {
            let found = compared(file);
            let named: Vec<_> = found.iter().map(|found| (found.body.as_str(), found.field, found.cause)).collect();
            assert_eq!(named, [("rod", *field, *cause)], "{engine}: {}", file.path.display());
        }
    }
    Outcome::Passed
}

fn browser() -> Outcome {
    for program in ["python3", "chromium", "chromedriver"] {
        if !exists(program) {
            return Outcome::Skipped(format!("there is no {program}"));
        }
    }
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--out", "out"]).expect(0, &["report:"]);
    checked(Command::new("python3").arg(project().join("ci/browser_test.py")).arg(sandbox.path("out")))
}
