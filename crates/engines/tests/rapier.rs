//! Rapier beside the native kernels, on robots of every joint that it has, and what it refuses.

use featherbench_engines::{Native, Rapier};
use harness::measure::{ForwardScale, scaled_error, worst};
use harness::{Problem, Quantity, Refusal, Subject};
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
