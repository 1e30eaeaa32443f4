//! What is refused, by name.

use featherbench_scenes::{Body, Geometry, Motion, OwnSolver, Scene, SceneError, Shape, StepProblem, StepSolver, simulate};
use nalgebra::DVector;

fn scene() -> Scene {
    Scene {
        name: "ball".into(),
        gravity: [0.0, 0.0, -9.81],
        friction: 0.5,
        restitution: 0.0,
        bodies: vec![Body::ball("ball", 1.0, 0.1, [0.0, 0.0, 0.1])],
    }
}

#[test]
fn malformed_scenes_are_refused_by_field() {
    type Change = fn(&mut Scene);
    let changes: [(&str, Change); 10] = [
        ("gravity", |scene| scene.gravity[1] = f64::NAN),
        ("friction", |scene| scene.friction = -0.1),
        ("restitution", |scene| scene.restitution = f64::NAN),
        ("bodies", |scene| scene.bodies.clear()),
        ("bodies[0].mass", |scene| scene.bodies[0].mass = 0.0),
        ("bodies[0].inertia", |scene| scene.bodies[0].inertia[2] = f64::INFINITY),
        ("bodies[0].linear", |scene| scene.bodies[0].linear[0] = f64::NAN),
        ("bodies[0].orientation", |scene| scene.bodies[0].orientation = [0.0; 4]),
        ("bodies[0].shapes[0].radius", |scene| scene.bodies[0].shapes[0].geometry = Geometry::Sphere { radius: -1.0 }),
        ("bodies[0].shapes[1].half", |scene| {
            scene.bodies[0].shapes.push(Shape { geometry: Geometry::Box { half: [1.0, 0.0, 1.0] }, at: [0.0; 3] })
        }),
    ];
    for (field, change) in changes {
        let mut wrong = scene();
        change(&mut wrong);
        let error = simulate(&wrong, 1e-3, 10, 1, &mut OwnSolver::sweeps()).unwrap_err();
        assert!(matches!(&error, SceneError::Malformed { field: found, .. } if found == field), "{field}: {error}");
    }
    for (dt, steps, every) in [(0.0, 10, 1), (f64::NAN, 10, 1), (1e-3, 10, 0), (1e-3, 1, 2)] {
        let error = simulate(&scene(), dt, steps, every, &mut OwnSolver::sweeps()).unwrap_err();
        assert!(matches!(error, SceneError::Steps { .. }), "{error}");
    }
}

/// A solver without an answer, or with one that is no number, ends the motion.
#[test]
fn a_step_without_an_answer_is_an_error() {
    struct Wrong(f64);
    impl StepSolver for Wrong {
        fn solve(&mut self, problem: &StepProblem) -> Result<DVector<f64>, String> {
            if self.0.is_nan() { Ok(DVector::repeat(problem.free.len(), self.0)) } else { Err("no".into()) }
        }
    }
    for wrong in [f64::NAN, 0.0] {
        assert!(matches!(simulate(&scene(), 1e-3, 10, 1, &mut Wrong(wrong)), Err(SceneError::Solver { step: 0, .. })));
    }
}

#[test]
fn malformed_motions_are_refused() {
    assert!(Motion::new(1, vec![0.0; 12], &[]).is_err());
    assert!(Motion::new(1, vec![0.0; 13], &[0.0; 7]).is_err());
    assert!(Motion::new(1, vec![0.0; 13], &[1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).is_err());
    assert!(Motion::new(1, vec![0.0; 13], &[0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).is_err());
    let good = Motion::new(1, vec![0.0; 13], &[0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).unwrap();
    assert!(good.is_finite() && good.pushes[0].from.is_none() && good.samples() == 1);
    assert!(good.position(1, 0).x.is_nan() && good.position(0, 1).x.is_nan());
}
