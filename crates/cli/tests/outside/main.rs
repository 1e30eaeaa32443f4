//! Tests that need what a new machine may not have: Python, the reference engines, engines that are installed or built by themselves, a
//! browser.
//!
//! Each is run if it can be, and otherwise listed as skipped. With `FEATHERBENCH_REQUIRE_ALL` set, as in CI, a skip is a failure. The
//! native oracles, and engines whose table says `night`, are required at night only, with `FEATHERBENCH_NIGHTLY` set.
//! The tests do not use libtest: its captured output would hide the skips.

mod adam;
mod added;
mod alone;
mod clarabel;
mod compared;
mod compiled;
mod counted;
mod dynibo;
mod factors;
mod hyperqueue;
mod lesson;
mod library;
mod native;
mod parquet;
mod rapier;
mod reduced;
#[path = "../support/mod.rs"]
mod support;
mod told;
mod usd;
mod written;

use featherbench_bench::{Engine, FileBase, FileContent, FileFormat, RobotFile};
use featherbench_comparison::import::{Cause, Comparison, Difference, Field};
use featherbench_engines::{Limits, Oracle};
use featherbench_lesson::Language;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};
use support::{Ended, Sandbox, project};

type Test = fn() -> Outcome;

/// The result of a test.
type Outcome = Result<(), Unpassed>;

/// Why a test has not passed.
enum Unpassed {
    Failed(String),
    Skipped(String),
    /// Not run and not required here: it takes minutes of compiling, in the nightly run.
    Nightly(String),
}

fn main() -> ExitCode {
    let tests: &[(&str, Test)] = &[
        ("a number that one engine's file has alone is named", one_file_is_another),
        ("a missing wheel is exit code three and can be tried again", missing_wheel),
        ("an engine is added by a folder and a table", added::by_folder_and_table),
        ("the oracles pass their own tests", oracles_by_themselves),
        ("the engines keep the conventions of the ledger", conventions),
        ("the project's own oracles conform", own_oracles),
        ("a residual in Python conforms", python_residual),
        ("an oracle that forgets a conversion is told which", forgetful_oracles),
        ("a small oracle runs beside the recorded engines", small_oracle),
        ("a live run agrees with the recorded answers", live_run),
        ("MuJoCo reads the MJCF that we write", || with_engines(written::mjcf_round_trip)),
        ("MuJoCo's compiler writes a description", || with_engines(compiled::gen_mjcf)),
        ("equality constraints of an MJCF are loops", || with_engines(compiled::loops)),
        ("a file's keyframes are states", || with_engines(compiled::keyframes)),
        ("a file that an engine refuses is compared as written", || with_engines(compared::refused_files)),
        ("armature of a free joint is compared as a number", || with_engines(compared::free_armature)),
        ("classes of differences and bad files among good ones", || with_engines(compared::classes_and_bad_files)),
        ("a robot beyond an engine's limits is told", || with_engines(compared::limits)),
        ("what a file says is compared or told by name", || with_engines(told::by_name)),
        ("an engine that drops a mimic is told", || with_engines(told::mimics)),
        ("a second file of a robot is compared with the first", || with_engines(compared::two_files)),
        ("a round trip names each writer", || with_engines(compared::round_trip)),
        ("a copy is mended and compared again", || with_engines(compared::fixes)),
        ("engines read alike the URDF that we write", || with_engines(written::urdf_read_alike)),
        ("a browser clicks through the report", browser),
        ("a pendulum in C agrees with our kernels", native::pendulum_answers),
        ("a pendulum in C is clocked beside its loop", native::pendulum_is_clocked),
        ("a pendulum in C dies alone", native::pendulum_dies_alone),
        ("the native oracles agree with our kernels", native::oracles_agree),
        ("big robots are refused or answered by the native oracles", native::big_robots_are_refused_or_answered),
        ("native oracles that are not there are named", native::no_compiler),
        ("instructions that were not counted are told", counted::not_counted),
        ("programs of reduced cases print their errors", || with_engines(reduced::programs_print_their_errors)),
        ("polars and DuckDB read rows in Parquet", || with_engines(parquet::figures)),
        ("a sweep goes on after a task, its server and its client", hyperqueue::goes_on),
        ("a sweep uses a running server", hyperqueue::uses_a_server),
        ("dynibo conforms", || library::conforms("dynibo", &["dynibo has no armature"])),
        ("dynibo agrees, with any gravity", || dynibo::with_dynibo(dynibo::agrees)),
        ("dynibo loses digits of M on a straight chain", || dynibo::with_dynibo(dynibo::loses_digits_of_a_straight_chain)),
        ("dynibo answers a big robot", || dynibo::with_dynibo(|dynibo| native::big_robot_is_refused_or_answered("dynibo", dynibo))),
        ("dynibo refuses what it has not", || dynibo::with_dynibo(dynibo::refuses)),
        ("faer conforms", || library::conforms("faer", &["factor_entries by sparse_natural"])),
        ("faer factorizes in every order", || library::with("faer", factors::agrees)),
        ("faer's fill-in is that of the theory", || library::with("faer", factors::fills_as_the_theory_says)),
        ("faer is given our matrix, and says what is too large", || library::with("faer", factors::refuses)),
        ("nalgebra conforms", || library::conforms("nalgebra", &["solve by dense"])),
        ("nalgebra factorizes", || library::with("nalgebra", factors::agrees)),
        ("nalgebra says what is too large", || library::with("nalgebra", factors::refuses)),
        ("adam conforms", || alone::conforms("adam", &["adam has no armature"])),
        ("adam agrees, fixed and floating", || alone::with("adam", adam::agrees)),
        ("adam is clocked beside its loop", || alone::with("adam", adam::is_clocked)),
        ("adam refuses what it has not", || alone::with("adam", adam::refuses)),
        ("iDynTree conforms", alone::idyntree_conforms),
        ("iDynTree agrees, fixed and floating", || alone::with("idyntree", alone::agrees)),
        ("iDynTree has another Coriolis matrix", || alone::with("idyntree", alone::idyntree_has_another_coriolis_matrix)),
        ("MuJoCo Warp conforms, in single precision", || alone::conforms("mujoco_warp", &[])),
        ("MuJoCo Warp agrees, in single precision", || alone::with("mujoco_warp", alone::agrees)),
        ("Newton conforms, in single precision", || alone::conforms("newton", &[])),
        ("Newton agrees, in single precision", || alone::with("newton", alone::agrees)),
        ("MJX conforms, in single precision", || alone::conforms("mjx", &[])),
        ("PyBullet conforms", || alone::conforms("pybullet", &[])),
        ("PyBullet agrees", || alone::with("pybullet", alone::agrees)),
        ("Exudyn conforms", || alone::conforms("exudyn", &[])),
        ("Exudyn agrees", || alone::with("exudyn", alone::agrees)),
        ("Simbody conforms", || alone::conforms("simbody", &[])),
        ("Simbody agrees", || alone::with("simbody", alone::agrees)),
        ("JaxSim conforms", || alone::conforms("jaxsim", &[])),
        ("JaxSim agrees", || alone::with("jaxsim", alone::agrees)),
        ("frax conforms", || alone::conforms("frax", &[])),
        ("frax agrees", || alone::with("frax", alone::agrees)),
        ("SAPIEN conforms, in single precision", || alone::conforms("sapien", &[])),
        ("SAPIEN agrees, in single precision", || alone::with("sapien", alone::agrees)),
        ("OpenUSD conforms", || alone::conforms("openusd", &["OpenUSD has no dynamics"])),
        ("USD that we write is read back", usd::read_back),
        ("Newton reads USD that we write", usd::newton_reads_it),
        ("the lesson's arm in Rust is our kernels' arm", || lesson::agrees_in(Language::Rust)),
        ("the lesson's arm in C is our kernels' arm", || lesson::agrees_in(Language::C)),
        ("the lesson's arm in Python is our kernels' arm", || lesson::agrees_in(Language::Python)),
        ("clarabel conforms", || alone::conforms("clarabel", &[])),
        ("clarabel identifies an arm", clarabel::identifies),
        ("rapier that cannot be built is named", rapier::not_to_be_built),
        ("rapier conforms", rapier::conforms),
        ("rapier agrees on every joint that it has", || rapier::with_rapier(rapier::agrees)),
        ("rapier has armature", || rapier::with_rapier(rapier::has_armature)),
        ("rapier refuses what would panic", || rapier::with_rapier(rapier::refuses)),
        ("rapier's steps approach a limit", || rapier::with_rapier(rapier::steps_approach_a_limit)),
        ("rapier's steps have two regimes at a fast state", || rapier::with_rapier(rapier::a_fast_state_has_two_regimes)),
        ("no step of rapier is explicit below its guard", || rapier::with_rapier(rapier::no_step_is_explicit_below_the_guard)),
        ("the suite of rapier passes its gates", rapier::suite),
    ];
    let (mut passed, mut failed, mut skipped) = (0, 0, 0);
    // Like libtest: words on the command line choose the tests whose names contain one of them.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let chosen = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word));
    for (name, test) in tests.iter().filter(|(name, _)| chosen(name)) {
        // A failed assertion of a test is that test's failure.
        match std::panic::catch_unwind(test).unwrap_or_else(|_| Err(Unpassed::Failed("see above".into()))) {
            Ok(()) => {
                println!("passed: {name}");
                passed += 1;
            }
            Err(Unpassed::Failed(reason)) => {
                println!("failed: {name}: {reason}");
                failed += 1;
            }
            Err(Unpassed::Skipped(reason)) => {
                println!("skipped: {name}: {reason}");
                skipped += 1;
            }
            Err(Unpassed::Nightly(reason)) => {
                println!("left to the night: {name}: {reason}");
                failed += usize::from(std::env::var_os("FEATHERBENCH_NIGHTLY").is_some());
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
    if ended.code == Some(0) { Ok(()) } else { Err(Unpassed::Failed(format!("{}\n{}", ended.output, ended.errors))) }
}

fn installed_python() -> Result<std::path::PathBuf, Unpassed> {
    let python = project().join("target/oracles/venv/bin/python");
    let installed = python.exists() && project().join("target/oracles/installed").exists();
    if installed { Ok(python) } else { Err(Unpassed::Skipped("the engines are not installed (`featherbench oracles install`)".into())) }
}

fn missing_wheel() -> Outcome {
    if !exists("python3") {
        return Err(Unpassed::Skipped("there is no python3".into()));
    }
    let sandbox = Sandbox::new();
    // An empty index: as on a machine whose index does not have the wheel. uv is not on the path, so that pip is used.
    let install = |arguments: &[&str]| {
        let mut command = sandbox.command(arguments);
        command.env("PIP_NO_INDEX", "1").env("PIP_FIND_LINKS", sandbox.folder.path()).env("UV_NO_INDEX", "1").env("UV_OFFLINE", "1");
        Ended::new(command.output().unwrap())
    };
    let words = ["pin==4.1.0", "recorded answers"];
    install(&["oracles", "install"]).expect(3, &words);
    install(&["oracles", "install"]).expect(3, &words);
    install(&["run", "--suite", "smoke", "--live"]).expect(3, &words);
    Ok(())
}

/// A test that needs the engines' Python.
fn with_engines(test: fn(&Path) -> Outcome) -> Outcome {
    test(&installed_python()?)
}

/// The command of a module of the oracles' package.
fn oracle_command(python: &Path, module: &str) -> Vec<OsString> {
    let mut place = OsString::from("PYTHONPATH=");
    place.push(project().join("oracles"));
    vec!["env".into(), place, python.into(), "-P".into(), "-m".into(), format!("featherbench_oracles.{module}").into()]
}

/// Runs tests by pytest in the folder of the oracles. Beside it they need this package.
fn pytest(package: &str, arguments: &[&str]) -> Outcome {
    let python = installed_python()?;
    let there = Command::new(&python).args(["-c", &format!("import pytest, {package}")]).output().unwrap().status.success();
    if !there {
        return Err(Unpassed::Skipped(format!("pytest or {package} is not installed (`ci/python-tools`)")));
    }
    checked(Command::new(&python).current_dir(project().join("oracles")).args(["-m", "pytest", "-q"]).args(arguments))
}

fn oracles_by_themselves() -> Outcome {
    pytest("numpy", &["--ignore", "tests/test_conventions.py"])
}

/// Every row about a convention holds, and its alternative does not.
fn conventions() -> Outcome {
    pytest("numpy", &["tests/test_conventions.py"])
}

/// The output of `featherbench oracles check` about a program, which may import packages from these folders.
fn conformance(program: &[OsString], packages: Option<&Path>) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    command.current_dir(project()).args(["oracles", "check"]).args(program);
    if let Some(packages) = packages {
        command.env("PYTHONPATH", packages);
    }
    Ended::new(command.output().unwrap())
}

/// One of our own oracles as a user starts it: `chain` by its file in `folder`, the others by their modules.
fn by_hand(python: &Path, folder: &Path, name: &str) -> Vec<OsString> {
    match name {
        "chain" => vec![python.into(), folder.join("chain.py").into()],
        _ => vec![python.into(), "-P".into(), "-m".into(), format!("featherbench_oracles.{name}").into()],
    }
}

/// Copies a folder's Python files, and those of the folders within.
fn copy_python(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for path in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let copy = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_python(&path, &copy);
        } else if path.extension().is_some_and(|ending| ending == "py") {
            std::fs::copy(&path, &copy).unwrap();
        }
    }
}

fn own_oracles() -> Outcome {
    let python = installed_python()?;
    for (name, code) in [("chain", 0), ("mujoco", 0), ("drake", 0), ("pinocchio", 1)] {
        let ended = conformance(&by_hand(&python, &project().join("oracles"), name), None);
        ended.expect(
            code,
            if code == 0 {
                &["conforms"]
            } else {
                &[
                    "6 of ",
                    "fd_dq by aba_derivatives",
                    "armature of revolute and helical joints is left out where the axis is no coordinate axis",
                ]
            },
        );
    }
    Ok(())
}

/// Friction in ten lines of Python keeps the protocol of a residual.
fn python_residual() -> Outcome {
    let python = installed_python()?;
    let mut check = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    check.current_dir(project()).args(["oracles", "check", "--all"]).arg(python).arg(project().join("oracles/friction.py"));
    Ended::new(check.output().unwrap()).expect(0, &["residual: 27 robots, the same for any acceleration", "conforms"]);
    Ok(())
}

/// Our own oracles with one conversion removed: the conformance test names it.
fn forgetful_oracles() -> Outcome {
    let python = installed_python()?;
    let cases = [
        ("chain", " + rotor for", " for", "armature is left out"),
        ("chain", "-gravity * np.array", "gravity * np.array", "gravity has the wrong sign"),
        ("chain", ", (xx, xy, xz, yy, yz, zz) =", ", (xx, yy, zz, xy, xz, yz) =", "inertias are read as xx, yy, zz, xy, xz, yz"),
        ("mujoco/coordinates", "blocks.append((linear, r))", "r = np.eye(3)", "linear velocity is taken in world axes: T = diag(R, 1)"),
        ("mujoco/coordinates", "bias[linear] = r @", "bias[linear] = 0 * r @", "the term b is missing"),
        (
            "mujoco/building",
            "child.mass, child.ipos = body.mass, body.com",
            "child.mass, child.ipos = body.mass, 0 * body.com",
            "com of body",
        ),
        ("drake/building", "2 * pi * joint.pitch", "joint.pitch", "pitch of a helical joint is taken per revolution"),
        (
            "drake/coordinates",
            "blocks.append((joint.v, rotation(q[joint.q])))",
            "pass",
            "spherical joint's velocity is taken in joint-frame axes",
        ),
        (
            "pinocchio/coordinates",
            "blocks.append((joint.v, t))",
            "bias[joint.v] = 0",
            "planar joint's linear velocity is taken in body axes",
        ),
        (
            "pinocchio/coordinates",
            "np.concatenate([motion.angular, motion.linear])",
            "np.concatenate([motion.linear, motion.angular])",
            "6-vectors are sent as [linear; angular]",
        ),
    ];
    let copy = tempfile::tempdir().unwrap();
    copy_python(&project().join("oracles/featherbench_oracles"), &copy.path().join("featherbench_oracles"));
    std::fs::copy(project().join("oracles/chain.py"), copy.path().join("chain.py")).unwrap();
    for (file, right, wrong, named) in cases {
        let (name, path) = match file.split_once('/') {
            None => (file, copy.path().join(format!("{file}.py"))),
            Some((engine, _)) => (engine, copy.path().join(format!("featherbench_oracles/{file}.py"))),
        };
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(right), "{file}.py has no '{right}' any more");
        std::fs::write(&path, text.replace(right, wrong)).unwrap();
        conformance(&by_hand(&python, copy.path(), name), Some(copy.path())).expect(1, &[named]);
        std::fs::write(&path, text).unwrap();
    }
    Ok(())
}

fn small_oracle() -> Outcome {
    let python = installed_python()?;
    let sandbox = Sandbox::new();
    let engine = format!("small='{}' oracles/chain.py", python.display());
    let only = "agreement/chain-planar-2/.*/(readback|id|mass_matrix)/.*";
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--engine", &engine, "--filter", only, "--out", "out"]).expect(0, &["report:"]);
    let rows = std::fs::read_to_string(sandbox.path("out/rows.csv")).unwrap();
    for quantity in ["readback", "id", "mass_matrix"] {
        let judged = rows
            .lines()
            .filter(|row| row.contains(",small,1,") && row.contains(&format!(",{quantity},")) && row.contains(",pass,"))
            .count();
        assert!(judged > 0, "no row of {quantity} passes");
    }
    Ok(())
}

fn live_run() -> Outcome {
    installed_python()?;
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    let run =
        command.current_dir(project()).args(["run", "--suite", "smoke", "--live", "--no-timing", "--out"]).arg(folder.path().join("live"));
    checked(run)
}

/// A URDF of a pendulum on a slide, with given numbers.
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

/// Each engine imports its own file. One file has another number, and the imports of all others agree.
fn one_file_is_another() -> Outcome {
    let python = installed_python()?;
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        FileContent::read(&path, FileFormat::Urdf).unwrap().file(FileBase::Fixed).unwrap()
    };
    let honest = write("honest.urdf", pendulum("1", "0 1 0", "0.3 0 0"));
    let (ours, _) = featherbench_formats::urdf::read(&honest.path, &featherbench_formats::urdf::Options::default()).unwrap();
    let planted = [
        ("mass", pendulum("1.5", "0 1 0", "0.3 0 0"), Field::Mass, Cause::Number),
        ("grams", pendulum("1000", "0 1 0", "0.3 0 0"), Field::Mass, Cause::Unit),
        ("flipped", pendulum("1", "0 -1 0", "0.3 0 0"), Field::Axis, Cause::Flipped),
        ("lost", pendulum("1", "0 1 0", "0 0 0"), Field::Inertia, Cause::InertialRotationLost),
    ]
    .map(|(name, text, field, cause)| (write(&format!("{name}.urdf"), text), field, cause));
    for engine in ["pinocchio", "mujoco", "drake"] {
        let oracle = Oracle::start(oracle_command(&python, engine), Limits::default()).unwrap();
        let compared = |file: &RobotFile| {
            let reading = oracle.read(file).unwrap();
            Comparison::of(&ours, &reading.description, &[], &reading.notes).differences().cloned().collect::<Vec<Difference>>()
        };
        assert_eq!(compared(&honest), [], "{engine}");
        for (file, field, cause) in &planted {
            let found = compared(file);
            let named: Vec<_> = found.iter().map(|found| (found.body.as_str(), found.field, found.cause)).collect();
            assert_eq!(named, [("rod", *field, *cause)], "{engine}: {}", file.path.display());
        }
    }
    Ok(())
}

fn browser() -> Outcome {
    for program in ["chromium", "chromedriver"] {
        if !exists(program) {
            return Err(Unpassed::Skipped(format!("there is no {program}")));
        }
    }
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--out", "out"]).expect(0, &["report:"]);
    pytest("selenium", &["-c", "pyproject.toml", "../ci/browser_test.py", "--report", &sandbox.path("out").to_string_lossy()])
}
