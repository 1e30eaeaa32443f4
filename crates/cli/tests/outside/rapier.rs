//! Rapier, if it is built: its answers against our own kernels on robots with every joint that it has, its errors, and its steps. And the
//! message if it cannot be built.

use super::{Outcome, Unpassed, checked};
use crate::support::{Ended, Sandbox, project};
use featherbench_bench::measure::{ForwardScale, scaled_error, worst};
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::{Featherbench, Limits, Oracle};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Case, Family};
use std::path::PathBuf;
use std::process::Command;
use std::sync::LazyLock;

/// The program, if it was compiled from the present sources.
static PROGRAM: LazyLock<Option<PathBuf>> = LazyLock::new(|| {
    let sandbox = sources();
    std::fs::create_dir_all(sandbox.path("target/oracles")).unwrap();
    std::os::unix::fs::symlink(project().join("target/oracles/rapier"), sandbox.path("target/oracles/rapier")).unwrap();
    // The other engines are missing, so that they are not started.
    let status = sandbox.run(&["oracles", "status"]).output;
    let line = status.lines().find(|line| line.starts_with("rapier")).unwrap_or_else(|| panic!("rapier is not in {status}"));
    let program = PathBuf::from(line.rsplit(' ').next().unwrap());
    let there = program.is_file().then(|| project().join("target/oracles/rapier/release").join(program.file_name().unwrap()));
    there.filter(|program| program.is_file())
});

/// A project with the sources of rapier's oracle, and nothing built.
fn sources() -> Sandbox {
    let sandbox = Sandbox::new();
    for name in ["Cargo.toml", ".cargo", "crates"] {
        std::os::unix::fs::symlink(project().join(name), sandbox.path(name)).unwrap();
    }
    sandbox
}

fn program() -> Result<PathBuf, Unpassed> {
    PROGRAM.clone().ok_or_else(|| Unpassed::Skipped("rapier is not built (`featherbench oracles install rapier`)".into()))
}

/// A test that asks rapier.
pub fn with_rapier(test: fn(&Oracle)) -> Outcome {
    let program = program()?;
    test(&Oracle::start(vec![program.into_os_string()], Limits::default()).unwrap());
    Ok(())
}

/// It conforms to the whole protocol, with steps.
pub fn conforms() -> Outcome {
    let program = program()?;
    let command = &mut Command::new(env!("CARGO_BIN_EXE_featherbench"));
    let ended = Ended::new(command.current_dir(project()).args(["oracles", "check"]).arg(program).output().unwrap());
    ended.expect(0, &["conforms", "offers  steps by step, step_default", "step by step: 19 robots", "fall by step: 7 robots"]);
    Ok(())
}

/// The suite of engines that are not recorded, of rapier alone, judged by the gates: the others are installed at night.
pub fn suite() -> Outcome {
    program()?;
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(project().join("datasets/suites/engines.toml")).unwrap();
    let asked = text.lines().find(|line| line.starts_with("engines = ")).unwrap();
    let suite = folder.path().join("rapier.toml");
    std::fs::write(&suite, text.replacen(asked, "engines = [\"rapier\"]", 1)).unwrap();
    let command = &mut Command::new(env!("CARGO_BIN_EXE_featherbench"));
    checked(command.current_dir(project()).args(["run", "--suite"]).arg(suite).arg("--out").arg(folder.path().join("out")))?;
    let rows = std::fs::read_to_string(folder.path().join("out/rows.csv")).unwrap();
    for told in ["agreement", "explicit", "implicit"] {
        assert!(rows.lines().any(|row| row.contains(",rapier,") && row.contains(told)), "no row of rapier is {told}");
    }
    Ok(())
}

/// Without cargo, and without a registry, an engine of the suite is missing; the message says what to do.
pub fn not_to_be_built() -> Outcome {
    let sandbox = sources();
    let empty = sandbox.path("nothing");
    std::fs::create_dir(&empty).unwrap();
    let advice = ["rapier cannot be built", "oracles install rapier"];
    for arguments in [&["run", "--suite", "engines", "--out", "out"][..], &["oracles", "install", "rapier"]] {
        let without_cargo = Ended::new(sandbox.command(arguments).env("PATH", &empty).output().unwrap());
        without_cargo.expect(3, &[&advice[..], &["cargo cannot be started"]].concat());
        let offline = sandbox.command(arguments).env("CARGO_HOME", &empty).env("CARGO_NET_OFFLINE", "true").output().unwrap();
        Ended::new(offline).expect(3, &[&advice[..], &["cargo build", "failed (exit status: 101): error"]].concat());
    }
    assert!(!sandbox.path("out").exists(), "no folder is made for a run that cannot be");
    let status = sandbox.run(&["oracles", "status"]).output;
    assert!(status.contains("rapier           is not built: run `featherbench oracles install rapier`"), "{status}");
    Ok(())
}

fn robot(words: &str) -> Robot {
    let description = Family::parse(words).unwrap().generate().unwrap();
    Robot::new(&description, "test", ModelOrigin::Generated, 12, 3).unwrap()
}

fn values(engine: &dyn Engine, robot: &Robot, quantity: Quantity) -> Result<Vec<f64>, NoAnswer> {
    let method = engine.methods(quantity)[0].clone();
    let mut ready = engine.prepare(robot, quantity, &method, &robot.states)?;
    ready.run(0..robot.asked(quantity))?;
    Ok(ready.read().to_vec())
}

/// The gate of the agreement study.
const TOLERANCE: f64 = 1e-14;

/// It agrees on every joint that it has.
pub fn agrees(rapier: &Oracle) {
    let featherbench = Featherbench::new();
    let mut compared = 0;
    for kind in ["revolute", "prismatic", "spherical", "planar", "translation", "cylindrical"] {
        for base in ["fixed", "free"] {
            let robot = robot(&format!("joints:kind={kind},base={base}"));
            let at = robot.magnitudes();
            let forward = ForwardScale::all(&robot, &at);
            for quantity in Quantity::ALL.into_iter().filter(|&quantity| !rapier.methods(quantity).is_empty()) {
                let size = quantity.size(&robot);
                let (ours, theirs) = (values(&featherbench, &robot, quantity).unwrap(), values(rapier, &robot, quantity).unwrap());
                assert_eq!(theirs.len(), ours.len(), "{kind} {base} {}", quantity.name());
                let states = ours.chunks_exact(size).zip(theirs.chunks_exact(size)).enumerate();
                let error = states.fold(0.0, |error, (k, (ours, theirs))| {
                    let off = match quantity {
                        Quantity::ForwardDynamics => forward[k].backward_error(theirs),
                        _ => scaled_error(&robot, quantity, &at[k], ours, theirs),
                    };
                    worst(error, off)
                });
                assert!(error <= TOLERANCE, "{kind} {base} {}: {error:e}", quantity.name());
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 12 * 9);
}

/// It has armature, except in its energy.
pub fn has_armature(rapier: &Oracle) {
    for words in ["quadruped", "joints:kind=cylindrical,base=free,armature=true"] {
        let robot = robot(words);
        assert!(robot.description.bodies.iter().any(|body| body.joint.armature.iter().any(|&armature| armature > 0.0)), "{words}");
        let [ours, theirs] =
            [&Featherbench::new() as &dyn Engine, rapier].map(|engine| values(engine, &robot, Quantity::MassMatrix).unwrap());
        let (at, size) = (robot.magnitudes(), Quantity::MassMatrix.size(&robot));
        let error = scaled_error(&robot, Quantity::MassMatrix, &at[0], &ours[..size], &theirs[..size]);
        assert!(error <= TOLERANCE, "{words}: {error:e}");
        assert!(matches!(values(rapier, &robot, Quantity::KineticEnergy), Err(NoAnswer::NotOffered(_))), "its energy has none");
    }
}

/// It gives an error where it would panic.
pub fn refuses(rapier: &Oracle) {
    let refused = |robot: &Robot, word: &str| match values(rapier, robot, Quantity::MassMatrix) {
        Err(NoAnswer::NotOffered(reason)) => assert!(reason.contains(word), "{reason}"),
        other => panic!("{word}: {other:?}"),
    };
    refused(&robot("joints:kind=universal,base=fixed"), "universal");
    refused(&robot("joints:kind=helical,base=fixed"), "helical");
    refused(&robot("joints:kind=euler_zyx,base=fixed"), "euler_zyx");
    let mut description = Family::parse("chain:n=3").unwrap().generate().unwrap();
    (description.bodies[2].mass, description.bodies[2].inertia) = (0.0, [0.0; 6]);
    // With armature, so that M is regular and only rapier's inverse of the mass is singular.
    description.bodies[2].joint.armature = vec![0.1];
    refused(&Robot::new(&description, "test", ModelOrigin::Generated, 2, 3).unwrap(), "positive");
}

/// Its steps approach the limit of short steps.
pub fn steps_approach_a_limit(rapier: &Oracle) {
    let robot = robot("joints:kind=spherical,base=free");
    let stepper = rapier.stepper().unwrap();
    let at = robot.magnitudes();
    let scale = &ForwardScale::all(&robot, &at)[0];
    let step = |dt| stepper.step_acceleration(&robot, "step", &robot.states, 0, dt).unwrap();
    let limit = step(1e-30);
    let [far, near] = [1e-4, 1e-5].map(|dt| scale.forward_error(&limit, &step(dt)));
    // First order: a tenth of the step has a tenth of the error, except for the second order's share.
    assert!((far / near - 10.0).abs() < 0.1, "{far:e} {near:e}");
}

/// Up to this, the error of a step against rapier's own limit is rounding.
const ROUNDING: f64 = 1e-15;

/// The errors of steps at a state against the limit of short steps.
fn step_errors<const N: usize>(rapier: &Oracle, robot: &Robot, k: usize, steps: [f64; N]) -> [f64; N] {
    let stepper = rapier.stepper().unwrap();
    let scale = &ForwardScale::all(robot, &robot.magnitudes())[k];
    let step = |dt| stepper.step_acceleration(robot, "step", &robot.states, k, dt).unwrap();
    let limit = step(1e-30);
    steps.map(|dt| scale.forward_error(&limit, &step(dt)))
}

/// At a fast state a step of 1e-2 or 1e-3 s is explicit, and has no error. One of 1e-4 s is implicit, and has an error of first order.
pub fn a_fast_state_has_two_regimes(rapier: &Oracle) {
    let robot = robot("joints:kind=spherical,base=free");
    assert_eq!(robot.states.cases[7], Case::Fast);
    let [hundredth, thousandth, implicit @ ..] = step_errors(rapier, &robot, 7, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7]);
    assert!(hundredth <= ROUNDING && thousandth <= ROUNDING, "{hundredth:e} {thousandth:e}");
    assert!((3e-2..4e-2).contains(&implicit[0]), "{implicit:?}");
    assert!(implicit.windows(2).all(|pair| (pair[0] / pair[1] - 10.0).abs() < 0.5), "{implicit:?}");
}

/// Every explicit step is beyond the guard, at every state. The error of an implicit one is proportional to its length. Beyond the guard
/// both occur.
pub fn no_step_is_explicit_below_the_guard(rapier: &Oracle) {
    const STEPS: [f64; 9] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
    let guard = rapier.stepper().unwrap().guard().unwrap();
    let (mut explicit, mut implicit_beyond, mut implicit_below) = (0, 0, 0);
    for words in ["chain:n=2,layout=spatial", "chain:n=3,layout=spatial", "joints:kind=spherical,base=free"] {
        let robot = robot(words);
        for k in 0..robot.states.count() {
            let errors = step_errors(rapier, &robot, k, STEPS);
            // At rest, or where no force depends on velocity, a step of any length is exact.
            let Some(shortest) = errors.last().filter(|&&error| error > ROUNDING) else { continue };
            // No joint's velocity is larger in any axes.
            let speed = robot.states.v(k).iter().map(|v| v * v).sum::<f64>().sqrt();
            for (dt, error) in STEPS.into_iter().zip(errors) {
                if error <= ROUNDING {
                    assert!(dt * speed >= guard, "{words}, state {k}, dt = {dt}");
                    explicit += 1;
                    continue;
                }
                let beyond = dt * speed >= guard;
                *if beyond { &mut implicit_beyond } else { &mut implicit_below } += 1;
                // If the second order is small, error/dt is the same at every length.
                let share = error / dt / (shortest / STEPS[STEPS.len() - 1]);
                assert!(dt * speed > 0.15 || (share - 1.0).abs() < 0.5, "{words}, state {k}, dt = {dt}: {error:e}");
            }
        }
    }
    assert!(explicit > 10 && implicit_beyond > 10 && implicit_below > 10, "{explicit} {implicit_beyond} {implicit_below}");
}
