//! The programs are run by the engines themselves: on every joint that an engine has, they find the truth.

use super::{interface, of};
use crate::{Failure, Fault, Subject};
use featherbench_bench::{Quantity, Robot};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Engines lose up to some thousand ε on these robots at random states, more on none of them at its first state.
const ROUNDING: f64 = 1e-12;
const KINDS: [&str; 10] =
    ["revolute", "prismatic", "helical", "spherical", "planar", "universal", "translation", "cylindrical", "euler_zyx", "all"];
/// The engines, their methods for id, bias, M and fd, and the kinds of joints without a program.
const ENGINES: [(&str, [&str; 4], &[&str]); 4] = [
    ("pinocchio", ["rnea", "nonlinear_effects", "crba_local", "aba_local"], &[]),
    ("mujoco", ["inverse", "qfrc_bias", "crb", "forward"], &["helical", "all"]),
    ("drake", ["inverse_dynamics", "bias_term", "crba", "aba"], &[]),
    ("dart", ["inverse_dynamics", "coriolis_and_gravity", "mass_matrix", "aba"], &["cylindrical", "all"]),
];
const QUANTITIES: [(Quantity, &str); 4] = [
    (Quantity::InverseDynamics, "scaled"),
    (Quantity::Bias, "scaled"),
    (Quantity::MassMatrix, "scaled"),
    (Quantity::ForwardDynamics, "backward"),
];
/// Runs each of the programs and names it before what it prints.
const RUN: &str = "import sys\nfor path in sys.argv[1:]:\n    print(path, end=' ', flush=True)\n    exec(open(path).read(), {})\n";

/// The engines' Python, if it is installed.
fn python() -> Option<PathBuf> {
    let installed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../target/oracles");
    let python = installed.join("venv/bin/python");
    (python.exists() && installed.join("installed").exists()).then_some(python)
}

fn robot(kind: &str, base: &str, more: &str) -> Robot {
    let description = Family::parse(&format!("joints:kind={kind},base={base}{more}")).unwrap().generate().unwrap();
    let robot = Robot::new(&description, "joints", ModelOrigin::Generated, 1, 7).unwrap();
    Subject::of(&robot, 0).robot().unwrap()
}

fn finding(quantity: Quantity, metric: &str, method: &str) -> Failure {
    Failure { study: "agreement".into(), quantity, method: method.into(), metric: metric.into(), states: None, fault: Fault::Unknown }
}

/// Runs programs, each of which finds the truth.
fn run(python: &Path, engine: &str, written: &[PathBuf]) {
    let output = Command::new(python).args(["-c", RUN]).args(written).output().unwrap();
    let (told, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{engine}: {told}\n{errors}");
    let lines: Vec<&str> = told.lines().filter(|line| line.contains(".py ")).collect();
    assert_eq!(lines.len(), written.len(), "{engine}: {told}");
    for line in lines {
        let error: f64 = line.rsplit(' ').next().unwrap().parse().unwrap();
        assert!(error < ROUNDING, "{line}");
    }
}

/// The engines' Python, or a note that they are missing where they need not be there.
fn needed() -> Option<PathBuf> {
    let python = python();
    if python.is_none() {
        // Written to standard error directly: a passing test hides the output of print macros.
        std::io::stderr().write_all(b"skipped: programs of reduced cases: the engines are not installed\n").unwrap();
        assert!(std::env::var_os("FEATHERBENCH_REQUIRE_ALL").is_none(), "the engines are missing");
    }
    python
}

#[test]
fn every_method_of_a_program_answers_the_truth() {
    let Some(python) = needed() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (engine, ..) in ENGINES {
        let mut written = Vec::new();
        for (quantity, method, _) in interface(engine).unwrap().answers {
            let metric = if *quantity == "fd" { "backward" } else { "scaled" };
            let text = of(engine, "1", &finding(Quantity::parse(quantity).unwrap(), metric, method), &robot("revolute", "free", ""));
            let path = folder.path().join(format!("{engine}-{quantity}-{method}.py"));
            std::fs::write(&path, text.unwrap()).unwrap();
            written.push(path);
        }
        assert!(written.len() >= 6, "{engine}");
        run(&python, engine, &written);
    }
}

#[test]
fn every_joint_of_an_engine_is_written_and_answers_the_truth() {
    let Some(python) = needed() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (engine, methods, lacks) in ENGINES {
        let mut written = Vec::new();
        for (kind, base) in KINDS.into_iter().flat_map(|kind| [(kind, "fixed"), (kind, "free")]) {
            for ((quantity, metric), method) in QUANTITIES.into_iter().zip(methods) {
                let text = of(engine, "1", &finding(quantity, metric, method), &robot(kind, base, ""));
                assert_eq!(text.is_none(), lacks.contains(&kind), "{engine} {kind} {base}: {}", quantity.name());
                let Some(text) = text else { continue };
                let path = folder.path().join(format!("{engine}-{kind}-{base}-{}.py", quantity.name()));
                std::fs::write(&path, text).unwrap();
                written.push(path);
            }
        }
        run(&python, engine, &written);
    }
}

/// A massless body that is only a joint is folded into its child.
#[test]
fn massless_bodies_are_joints_of_mujoco() {
    let mut robot = robot("revolute", "fixed", "");
    let bodies = &mut robot.description.bodies;
    let at = (0..bodies.len() - 1).find(|&at| bodies.iter().filter(|body| body.parent == Some(at)).count() == 1).unwrap();
    (bodies[at].mass, bodies[at].com, bodies[at].inertia) = (0.0, [0.0; 3], [0.0; 6]);
    bodies[at + 1].joint.placement.rotation = featherbench_model::Placement::default().rotation;
    let robot = Robot::new(&robot.description, "joints", ModelOrigin::Generated, 1, 7).unwrap();
    let text = of("mujoco", "1", &finding(Quantity::Bias, "scaled", "qfrc_bias"), &robot).unwrap();
    assert!(text.contains("bodies.append(None)\n") && text.contains("), (HINGE, "), "{text}");
    let Some(python) = needed() else { return };
    let output = Command::new(&python).args(["-c", &text]).output().unwrap();
    let error: f64 = String::from_utf8_lossy(&output.stdout).trim().parse().unwrap();
    assert!(error < ROUNDING, "{error:e}");
}

#[test]
fn armature_is_set_or_there_is_no_program() {
    let text = |engine: &str, method: &str, kind: &str| {
        of(engine, "1", &finding(Quantity::MassMatrix, "scaled", method), &robot(kind, "fixed", ",armature=true"))
    };
    assert!(text("pinocchio", "crba_local", "revolute").unwrap().contains("model.armature = np.array([0."));
    assert!(text("mujoco", "crb", "universal").unwrap().contains("model.dof_armature = [0."));
    assert!(text("drake", "crba", "revolute").unwrap().contains(", [0."));
    for (engine, method, kind) in
        [("drake", "crba", "universal"), ("dart", "mass_matrix", "revolute"), ("pinocchio", "crba_local", "planar")]
    {
        assert_eq!(text(engine, method, kind), None, "{engine} has no such armature");
    }
    assert_eq!(of("rapier", "1", &finding(Quantity::MassMatrix, "scaled", "lu"), &robot("revolute", "fixed", "")), None);
}

#[test]
fn without_a_true_answer_the_answer_is_printed() {
    let mut robot = robot("revolute", "fixed", ",shape=single");
    let finding = Failure { metric: String::new(), ..finding(Quantity::ForwardDynamics, "", "aba_local") };
    assert!(of("pinocchio", "1", &finding, &robot).unwrap().ends_with("print(answer)\n"));
    // At rest without gravity the true acceleration is zero.
    robot.description.gravity = [0.0; 3];
    for numbers in [&mut robot.states.v, &mut robot.states.tau] {
        numbers.fill(0.0);
    }
    let relative = Failure { metric: "true_forward".into(), ..finding.clone() };
    assert!(of("pinocchio", "1", &relative, &robot).unwrap().ends_with("print(answer)\n"));
    // The backward error is relative to its terms.
    let backward = Failure { metric: "backward".into(), ..finding };
    assert!(of("pinocchio", "1", &backward, &robot).unwrap().ends_with("terms).max())\n"));
}
