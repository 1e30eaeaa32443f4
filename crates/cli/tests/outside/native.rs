//! Native oracles: a small test engine through the C interface, and the large engines against our kernels where they are built.

use super::{Outcome, Unpassed, exists};
use crate::support::{Sandbox, project};
use featherbench_bench::measure::{ForwardScale, ratio, scaled_error, worst};
use featherbench_bench::{DENSE_LIMIT, Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::{Clock, Featherbench, Limits, Oracle, native};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The quantities that are compared. Of those that a native oracle may be asked for, ∂FD is left to the study of derivatives.
const QUANTITIES: [Quantity; 20] = [
    Quantity::Readback,
    Quantity::InverseDynamics,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::MassMatrixSparse,
    Quantity::Factorization,
    Quantity::FactorEntries,
    Quantity::Solve,
    Quantity::ForwardDynamics,
    Quantity::MassMatrixInverse,
    Quantity::BodyPlacement,
    Quantity::BodyVelocity,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::CenterOfMass,
    Quantity::Momentum,
    Quantity::InverseDynamicsDq,
    Quantity::InverseDynamicsDv,
    Quantity::CoriolisMatrix,
    Quantity::TorqueRegressor,
];

/// So long that the load of the machine has no influence: only a test that would hang for ever reaches it.
pub const PATIENT: Limits = Limits { answer: Duration::from_secs(900), memory: 8 << 30 };

/// A clock that stops until it is started; from then on an hour passes between any two queries.
#[derive(Default)]
struct Stopped {
    going: AtomicBool,
    now: AtomicU64,
}

impl Clock for Stopped {
    fn now(&self) -> Duration {
        let step = if self.going.load(Ordering::SeqCst) { 3600 } else { 0 };
        Duration::from_secs(self.now.fetch_add(step, Ordering::SeqCst))
    }

    fn look_again(&self, left: Duration) -> Duration {
        left.min(Duration::from_millis(5))
    }
}

pub fn robot(spec: &str, states: usize) -> Robot {
    let named = project().join(format!("datasets/models/{spec}.json"));
    let description = if named.is_file() {
        featherbench_formats::neutral::read(named).unwrap()
    } else {
        Family::parse(spec).unwrap().generate().unwrap()
    };
    Robot::new(&description, "test", ModelOrigin::Generated, states, 1).unwrap()
}

pub fn start(library: &Path, limits: Limits, core: Option<usize>) -> Result<Oracle, String> {
    Oracle::start(native::command(Path::new(env!("CARGO_BIN_EXE_featherbench")), library, core), limits)
}

fn ask(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let mut prepared = engine.prepare(robot, quantity, method, &robot.states)?;
    prepared.run(0..robot.asked(quantity))?;
    Ok(prepared.read().to_vec())
}

/// The pendulum, compiled with its faults.
fn pendulum(folder: &Path) -> Result<PathBuf, Unpassed> {
    if !exists("cc") {
        return Err(Unpassed::Skipped("there is no C compiler".into()));
    }
    let library = folder.join("pendulum.so");
    let source = project().join("oracles/native/pendulum.c");
    let flags = ["-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-DFB_FAULTS", "-o"];
    let output = Command::new("cc").args(flags).arg(&library).arg(source).arg("-lm").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(library)
}

/// The worst of all states, divided by what rounding may cause.
#[derive(Debug)]
pub struct Found {
    pub quantity: Quantity,
    pub method: String,
    pub share: Result<f64, NoAnswer>,
}

/// Each method of an engine against our kernels, on every state.
pub fn compare(engine: &dyn Engine, robot: &Robot, but: &[&str]) -> Vec<Found> {
    let featherbench = Featherbench::new();
    let (at, depth) = (robot.magnitudes(), robot.depth as f64);
    let forward = ForwardScale::all(robot, &at);
    let usual = |quantity| ask(&featherbench, robot, quantity, &featherbench.methods(quantity)[0]).unwrap();
    let mass = usual(Quantity::MassMatrix);
    let mut found = Vec::new();
    for quantity in QUANTITIES.into_iter().filter(|&quantity| robot.states.nv <= DENSE_LIMIT || quantity != Quantity::MassMatrixInverse) {
        let (reference, size, masses) = (usual(quantity), quantity.size(robot), robot.states.nv * robot.states.nv);
        for method in engine.methods(quantity).into_iter().filter(|method| !but.contains(&method.as_str())) {
            let share = ask(engine, robot, quantity, &method).map(|values| {
                assert_eq!(values.len(), reference.len(), "{} by {method}", quantity.name());
                let share = |k: usize| {
                    let (value, reference) = (&values[k * size..][..size], &reference[k * size..][..size]);
                    let mass = &mass[k * masses..][..masses];
                    match quantity {
                        // As in ci/gates.toml: some ε per level of the tree, for backward errors too; 45 ε up to depth twenty elsewhere.
                        Quantity::ForwardDynamics => forward[k].backward_error(value) / (1e-14 * depth),
                        Quantity::Solve => residual(mass, value, robot.states.tau(k)) / (1e-14 * depth),
                        Quantity::MassMatrixInverse => inverse_residual(mass, value) / (1e-14 * depth),
                        Quantity::InverseDynamicsDq
                        | Quantity::InverseDynamicsDv
                        | Quantity::CoriolisMatrix
                        | Quantity::TorqueRegressor => scaled_error(robot, quantity, &at[k], reference, value) / 1e-12,
                        Quantity::Readback => scaled_error(robot, quantity, &at[k], reference, value) / 3.6e-15,
                        _ => scaled_error(robot, quantity, &at[k], reference, value) / (1e-14 * (depth / 20.0).max(1.0)),
                    }
                };
                (0..values.len() / size).map(share).fold(0.0, worst)
            });
            found.push(Found { quantity, method, share });
        }
    }
    found
}

/// max_i |b − M x|_i / (Σ_j √(M_ii·M_jj)|x_j| + |b_i|): the backward error of a solution.
fn residual(mass: &[f64], x: &[f64], b: &[f64]) -> f64 {
    let n = x.len();
    let root: Vec<f64> = (0..n).map(|i| mass[i * n + i].sqrt()).collect();
    let weight: f64 = root.iter().zip(x).map(|(root, x)| root * x.abs()).sum();
    let rows = mass.chunks_exact(n).zip(b).zip(&root);
    rows.fold(0.0, |error, ((row, b), root)| {
        let product: f64 = row.iter().zip(x).map(|(m, x)| m * x).sum();
        worst(error, ratio(b - product, root * weight + b.abs()))
    })
}

/// max_ik |1 − M N|_ik / Σ_j √(M_ii·M_jj·N_jj·N_kk): what remains if each entry of a symmetric inverse N has an error of ε relative to its
/// own two axes, as the entries of M have.
fn inverse_residual(mass: &[f64], inverse: &[f64]) -> f64 {
    let n = inverse.len().isqrt();
    let root = |matrix: &[f64]| (0..n).map(|i| matrix[i * n + i].sqrt()).collect::<Vec<f64>>();
    let (m, inv) = (root(mass), root(inverse));
    let weight: f64 = m.iter().zip(&inv).map(|(m, inv)| m * inv).sum();
    let entry = |i: usize, k: usize| {
        let product: f64 = (0..n).map(|j| mass[i * n + j] * inverse[j * n + k]).sum();
        ratio(f64::from(u8::from(i == k)) - product, m[i] * weight * inv[k])
    };
    (0..n * n).map(|at| entry(at / n, at % n)).fold(0.0, worst)
}

pub fn pendulum_answers() -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let library = pendulum(folder.path())?;
    let oracle = start(&library, PATIENT, None).unwrap();
    assert_eq!((oracle.identity().name.as_str(), oracle.identity().build["language"].as_str()), ("pendulum", "C"));
    for spec in ["chain:n=1,layout=spatial", "chain:n=1,layout=planar", "tree:n=1,armature=true"] {
        let found = compare(&oracle, &robot(spec, 20), &["abort", "segfault", "hang", "glutton"]);
        assert_eq!(found.len(), 1 + 6 + 3, "what it read back, six honest methods, three odd ones: {found:?}");
        for Found { method, share, .. } in &found {
            let share = share.clone().unwrap();
            assert!(if method == "wrong" { share > 10.0 } else { share <= 1.0 }, "{spec} {method}: {share}");
        }
    }
    let two = ask(&oracle, &robot("chain:n=2", 1), Quantity::InverseDynamics, "pendulum");
    assert!(matches!(&two, Err(NoAnswer::NotOffered(reason)) if reason.contains("2 bodies")), "{two:?}");
    let unknown = ask(&oracle, &robot("chain:n=1", 1), Quantity::Momentum, "pendulum");
    assert!(matches!(&unknown, Err(NoAnswer::NotOffered(reason)) if reason.contains("offers no method")), "{unknown:?}");
    Ok(())
}

/// The clock is read beside the loop: its time is that of all calls, and nothing else.
pub fn pendulum_is_clocked() -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let library = pendulum(folder.path())?;
    // On a core of its own choice; on a core that does not exist it does not start.
    let reason = start(&library, PATIENT, Some(1 << 20)).err().unwrap();
    assert!(reason.contains("core 1048576"), "{reason}");
    let oracle = start(&library, PATIENT, Some(0)).unwrap();
    let robot = robot("chain:n=1", 5);
    let ready = |method| oracle.prepare(&robot, Quantity::InverseDynamics, method, &robot.states).unwrap();
    let mut slow = ready("slow");
    // Each call sleeps for a millisecond or longer. Its time is less than that of the whole question, whatever else the machine does.
    // States beyond the batch begin again.
    for calls in [1, 5, 50] {
        let whole = Instant::now();
        let clocked = slow.clock(0..calls).unwrap();
        assert!(clocked >= Duration::from_millis(calls as u64) && clocked <= whole.elapsed(), "{calls} calls in {clocked:?}");
    }
    drop(slow);
    // A call takes some nanoseconds, a question to the child some ten thousand: messages are not in the time. The smallest of each is used:
    // a busy machine interrupts some of two hundred calls, but not each within its nanoseconds.
    let mut quick = ready("pendulum");
    let (mut clocked, mut asked) = (Duration::MAX, Duration::MAX);
    for _ in 0..200 {
        let whole = Instant::now();
        clocked = clocked.min(quick.clock(0..1).unwrap());
        asked = asked.min(whole.elapsed());
    }
    assert!(clocked * 2 < asked, "{clocked:?} of {asked:?}");
    quick.run(3..5).unwrap();
    let there = quick.read().to_vec();
    quick.clock(0..5).unwrap();
    assert_eq!(quick.read(), there, "the clock leaves the values of the last run");
    assert!(quick.run(3..6).is_err(), "only the clock goes round");
    assert_eq!(quick.relocate(1), Ok(true));
    quick.run(3..5).unwrap();
    assert_eq!(quick.read(), there, "at another place of the memory the same robot, states and method");
    Ok(())
}

/// Whatever a library does to its process becomes a reason, and the next question is answered.
pub fn pendulum_dies_alone() -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let library = pendulum(folder.path())?;
    let robot = robot("chain:n=1", 3);
    let clock = Arc::new(Stopped::default());
    let command = native::command(Path::new(env!("CARGO_BIN_EXE_featherbench")), &library, None);
    let oracle = Oracle::start_by(command, Limits { memory: 512 << 20, ..PATIENT }, Arc::clone(&clock) as Arc<dyn Clock>).unwrap();
    let faults: [(&str, &[&str]); 4] = [
        ("abort", &["signal: 6", "the pendulum broke off"]),
        ("segfault", &["signal: 11"]),
        ("hang", &["no answer within 900 s"]),
        ("glutton", &["memory limit 512 MiB", "no more memory for the pendulum"]),
    ];
    for (method, words) in faults {
        for clocked in [false, true] {
            let mut prepared = oracle.prepare(&robot, Quantity::InverseDynamics, method, &robot.states).unwrap();
            clock.going.store(method == "hang", Ordering::SeqCst);
            let end = if clocked { prepared.clock(0..3).map(|_| ()) } else { prepared.run(0..3) };
            clock.going.store(false, Ordering::SeqCst);
            let Err(NoAnswer::Failed(reason)) = end else { panic!("{method} lived: {end:?}") };
            assert!(words.iter().all(|word| reason.contains(word)), "{method}: {reason}");
        }
        assert!(ask(&oracle, &robot, Quantity::InverseDynamics, "pendulum").is_ok(), "after {method}");
    }
    let reason = start(Path::new("/nowhere/at/all.so"), PATIENT, None).err().unwrap();
    assert!(reason.contains("/nowhere/at/all.so"), "{reason}");
    let other = project().join("Cargo.toml");
    assert!(start(&other, PATIENT, None).is_err_and(|reason| reason.contains("Cargo.toml")));
    Ok(())
}

/// The libraries that `oracles status` names, but for those that cargo builds, by day as well: their tests are in files of their own.
fn built() -> Result<Vec<(String, PathBuf)>, Unpassed> {
    let output = Command::new(env!("CARGO_BIN_EXE_featherbench")).current_dir(project()).args(["oracles", "status"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let library = |line: &str| Some((line.split_whitespace().next()?.to_owned(), PathBuf::from(line.split("  ").last()?)));
    let libraries = text.lines().filter(|line| line.ends_with(".so")).filter_map(library);
    let built: Vec<_> = libraries.filter(|(name, _)| !super::library::NAMES.contains(&name.as_str())).collect();
    let nightly = || Unpassed::Nightly("no native oracle is built (`featherbench oracles install --native`)".into());
    if built.is_empty() { Err(nightly()) } else { Ok(built) }
}

/// The known ratio of an engine's error to what rounding may cause (ci/deviations). It is twice the largest ratio over twenty seeds of
/// states. MuJoCo uses inertias and axes about the robot's centre of mass; computeMinverse works in world axes.
fn slack(oracle: &str, quantity: Quantity, robot: &str) -> f64 {
    let largest = match quantity {
        Quantity::MassMatrix | Quantity::MassMatrixSparse | Quantity::Factorization if oracle == "mujoco-native" => match robot {
            "chain-spatial-100" => 16.5,
            "panda" => 1.51,
            _ => 6.1,
        },
        Quantity::MassMatrixInverse if oracle.starts_with("pinocchio") && robot.starts_with("tree-common-16") => 9.03,
        _ => 0.5,
    };
    2.0 * largest
}

pub fn oracles_agree() -> Outcome {
    let built = built()?;
    let robots =
        ["chain-spatial-10", "chain:n=36,layout=spatial", "chain-spatial-100", "humanoid", "panda", "tree-common-16-spread0.3-seed3"];
    for spec in robots {
        let robot = robot(spec, 20);
        let start =
            |(name, library): &(String, PathBuf)| (name.clone(), Box::new(start(library, PATIENT, None).unwrap()) as Box<dyn Engine>);
        let ours: (String, Box<dyn Engine>) = ("featherbench".into(), Box::new(Featherbench::new()));
        for (name, engine) in built.iter().map(start).chain([ours]) {
            for Found { quantity, method, share } in compare(engine.as_ref(), &robot, &[]) {
                let line = format!("{name} {spec} {} by {method}: {share:.2?}", quantity.name());
                if std::env::var_os("FEATHERBENCH_SHOW").is_some() {
                    println!("{line}");
                }
                // Only MuJoCo has no helical joint.
                let excused = matches!(&share, Err(NoAnswer::NotOffered(why)) if name == "mujoco-native" && why.contains("helical"));
                // Derivatives by configuration-dependent subspaces are those of the oracle in Python, which composes them.
                let excused = excused
                    || matches!(&share, Err(NoAnswer::NotOffered(why)) if name.starts_with("pinocchio") && why.contains("oracle in Python"));
                assert!(excused || share.is_ok_and(|share| share <= slack(&name, quantity, spec)), "{line}");
            }
        }
    }
    Ok(())
}

/// A robot that is too large for a native oracle is an error with a reason, before the machine's memory is requested.
pub fn big_robots_are_refused_or_answered() -> Outcome {
    let built = built()?;
    for (name, library) in &built {
        big_robot_is_refused_or_answered(name, &start(library, PATIENT, None).unwrap());
    }
    Ok(())
}

/// A chain of a thousand links.
pub fn big_robot_is_refused_or_answered(name: &str, oracle: &Oracle) {
    let robot = robot("chain:n=1000,layout=spatial", 2);
    let method = oracle.methods(Quantity::InverseDynamics).remove(0);
    match ask(oracle, &robot, Quantity::InverseDynamics, &method) {
        Ok(values) => assert!((name.starts_with("mujoco") || name == "dynibo") && values.iter().all(|x| x.is_finite()), "{name}"),
        Err(NoAnswer::NotOffered(reason)) => assert!(name.starts_with("pinocchio") && reason.contains("nv³"), "{name}: {reason}"),
        Err(refusal) => panic!("{name}: {refusal}"),
    }
}

/// Without a compiler the message says what is missing.
pub fn no_compiler() -> Outcome {
    let sandbox = Sandbox::new();
    let mut command = sandbox.command(&["oracles", "status"]);
    let output = command.env("XDG_CACHE_HOME", sandbox.path("cache")).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("pinocchio-clang") && text.contains("oracles install"), "{text}");
    Ok(())
}
