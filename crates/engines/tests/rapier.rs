//! Rapier beside the native kernels, on robots of every joint that it has, and what it refuses.

use featherbench_engines::{Native, Rapier};
use harness::measure::{ForwardScale, scaled_error, worst};
use harness::{Problem, Quantity, Refusal, Subject};
use model::Case;
use model::generate::Family;
use record::ModelOrigin;

fn problem(words: &str) -> Problem {
    let description = Family::parse(words).unwrap().generate().unwrap();
    Problem::new(&description, "test", ModelOrigin::Generated, 12, 3).unwrap()
}

fn values(subject: &dyn Subject, problem: &Problem, quantity: Quantity) -> Result<Vec<f64>, Refusal> {
    let method = subject.methods(quantity)[0].clone();
    let mut ready = subject.prepare(problem, quantity, &method, &problem.states)?;
    ready.run(0..quantity.states(problem.states.count()))?;
    Ok(ready.read().to_vec())
}

/// The gate of the agreement study.
const TOLERANCE: f64 = 1e-14;

#[test]
fn it_agrees_on_every_joint_that_it_has() {
    let (native, rapier) = (Native::new(), Rapier::new());
    let mut compared = 0;
    for kind in ["revolute", "prismatic", "spherical", "planar", "translation", "cylindrical"] {
        for base in ["fixed", "free"] {
            let problem = problem(&format!("joints:kind={kind},base={base}"));
            let at = problem.magnitudes();
            let forward = ForwardScale::all(&problem, &at);
            for quantity in Quantity::ALL.into_iter().filter(|&quantity| !rapier.methods(quantity).is_empty()) {
                let size = quantity.size(&problem);
                let (ours, theirs) = (values(&native, &problem, quantity).unwrap(), values(&rapier, &problem, quantity).unwrap());
                assert_eq!(theirs.len(), ours.len(), "{kind} {base} {}", quantity.name());
                let states = ours.chunks_exact(size).zip(theirs.chunks_exact(size)).enumerate();
                let error = states.fold(0.0, |error, (k, (ours, theirs))| {
                    let off = match quantity {
                        Quantity::ForwardDynamics => forward[k].backward_error(theirs),
                        _ => scaled_error(&problem, quantity, &at[k], ours, theirs),
                    };
                    worst(error, off)
                });
                assert!(error <= TOLERANCE, "{kind} {base} {}: {error:e}", quantity.name());
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 12 * 8);
}

#[test]
fn it_has_armature() {
    for words in ["quadruped", "joints:kind=cylindrical,base=free,armature=true"] {
        let problem = problem(words);
        assert!(problem.description.bodies.iter().any(|body| body.joint.armature.iter().any(|&armature| armature > 0.0)), "{words}");
        let [ours, theirs] =
            [&Native::new() as &dyn Subject, &Rapier::new()].map(|subject| values(subject, &problem, Quantity::MassMatrix).unwrap());
        let (at, size) = (problem.magnitudes(), Quantity::MassMatrix.size(&problem));
        let error = scaled_error(&problem, Quantity::MassMatrix, &at[0], &ours[..size], &theirs[..size]);
        assert!(error <= TOLERANCE, "{words}: {error:e}");
        assert!(matches!(values(&Rapier::new(), &problem, Quantity::KineticEnergy), Err(Refusal::Unsupported(_))), "its energy has none");
    }
}

#[test]
fn it_refuses_what_would_panic() {
    let rapier = Rapier::new();
    let refused = |problem: &Problem, word: &str| match values(&rapier, problem, Quantity::MassMatrix) {
        Err(Refusal::Unsupported(reason)) => assert!(reason.contains(word), "{reason}"),
        other => panic!("{word}: {other:?}"),
    };
    refused(&problem("joints:kind=universal,base=fixed"), "universal");
    refused(&problem("joints:kind=helical,base=fixed"), "helical");
    refused(&problem("joints:kind=euler_zyx,base=fixed"), "euler_zyx");
    let mut description = Family::parse("chain:n=3").unwrap().generate().unwrap();
    (description.bodies[2].mass, description.bodies[2].inertia) = (0.0, [0.0; 6]);
    // With armature, so that M is regular and only rapier's inverse of the mass is not.
    description.bodies[2].joint.armature = vec![0.1];
    refused(&Problem::new(&description, "test", ModelOrigin::Generated, 2, 3).unwrap(), "positive");
}

#[test]
fn its_steps_approach_its_limit() {
    let (problem, rapier) = (problem("joints:kind=spherical,base=free"), Rapier::new());
    let stepper = rapier.stepper().unwrap();
    let at = problem.magnitudes();
    let scale = &ForwardScale::all(&problem, &at)[0];
    let step = |dt| stepper.step_acceleration(&problem, "step", &problem.states, 0, dt).unwrap();
    let limit = step(1e-30);
    let [far, near] = [1e-4, 1e-5].map(|dt| scale.forward_error(&limit, &step(dt)));
    // First order: a tenth of the step, a tenth of the error, up to the second order's share.
    assert!((far / near - 10.0).abs() < 0.1, "{far:e} {near:e}");
}

/// Up to this, the error of a step against rapier's own limit is rounding.
const ROUNDING: f64 = 1e-15;

/// The errors of steps at a state against the limit of short steps.
fn step_errors<const N: usize>(problem: &Problem, k: usize, steps: [f64; N]) -> [f64; N] {
    let rapier = Rapier::new();
    let stepper = rapier.stepper().unwrap();
    let scale = &ForwardScale::all(problem, &problem.magnitudes())[k];
    let step = |dt| stepper.step_acceleration(problem, "step", &problem.states, k, dt).unwrap();
    let limit = step(1e-30);
    steps.map(|dt| scale.forward_error(&limit, &step(dt)))
}

/// At a fast state a step of 1e-2 or 1e-3 s is explicit, and has no error; one of 1e-4 s is implicit, and has one of first order.
#[test]
fn a_fast_state_has_two_regimes() {
    let problem = problem("joints:kind=spherical,base=free");
    assert_eq!(problem.states.cases[7], Case::Fast);
    let [hundredth, thousandth, implicit @ ..] = step_errors(&problem, 7, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7]);
    assert!(hundredth <= ROUNDING && thousandth <= ROUNDING, "{hundredth:e} {thousandth:e}");
    assert!((3e-2..4e-2).contains(&implicit[0]), "{implicit:?}");
    assert!(implicit.windows(2).all(|pair| (pair[0] / pair[1] - 10.0).abs() < 0.5), "{implicit:?}");
}

/// What is explicit is beyond the guard, at every state; what is not has an error in proportion to its length. Beyond the guard both occur.
#[test]
fn no_step_is_explicit_below_the_guard() {
    const STEPS: [f64; 9] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
    let guard = Rapier::new().stepper().unwrap().guard().unwrap();
    let (mut explicit, mut implicit_beyond, mut implicit_below) = (0, 0, 0);
    for words in ["chain:n=2,layout=spatial", "chain:n=3,layout=spatial", "joints:kind=spherical,base=free"] {
        let problem = problem(words);
        for k in 0..problem.states.count() {
            let errors = step_errors(&problem, k, STEPS);
            // At rest, or where no force depends on velocity, a step of any length is exact.
            let Some(shortest) = errors.last().filter(|&&error| error > ROUNDING) else { continue };
            // No joint's velocity is larger in any axes.
            let speed = problem.states.v(k).iter().map(|v| v * v).sum::<f64>().sqrt();
            for (dt, error) in STEPS.into_iter().zip(errors) {
                if error <= ROUNDING {
                    assert!(dt * speed >= guard, "{words}, state {k}, dt = {dt}");
                    explicit += 1;
                    continue;
                }
                let beyond = dt * speed >= guard;
                *if beyond { &mut implicit_beyond } else { &mut implicit_below } += 1;
                // Where the second order is small, the first is the same at every length.
                let share = error / dt / (shortest / STEPS[STEPS.len() - 1]);
                assert!(dt * speed > 0.15 || (share - 1.0).abs() < 0.5, "{words}, state {k}, dt = {dt}: {error:e}");
            }
        }
    }
    assert!(explicit > 10 && implicit_beyond > 10 && implicit_below > 10, "{explicit} {implicit_beyond} {implicit_below}");
}
