//! Our step reaches the exact answers, by both solvers, with errors that fall with the step.

use featherbench_scenes::{Fit, OwnSolver, Question, SceneError, simulate, systems};

fn values(question: &Question, dt: f64, mut solver: OwnSolver) -> Vec<f64> {
    let steps = question.steps(dt);
    let motion = simulate(&question.scene, dt, steps, (steps / 20).max(1), &mut solver).unwrap();
    question.measures.iter().map(|measure| measure.of(&motion)).collect()
}

/// What of each quantity is left at a step of 1 ms: first order in the step, over the time of each scene.
fn allowed(quantity: &str) -> f64 {
    match quantity {
        // Rigid contacts keep these to the solver's residual.
        "creep" | "lift" | "rolling_speed" | "load_error" | "sinking" | "wrench_error" | "affine_distance" | "pressure_offset"
        | "drift" | "energy_created" | "normal_error" => 1e-6,
        // No law determines it.
        "null_share" => 1.0,
        _ => 0.01,
    }
}

#[test]
fn sweeps_need_more_than_their_cap_under_a_heavy_ball() {
    // The rate is R/(1 + R) with the mass ratio R = 1000: a power of 28 000 is 1e-12.
    let question = systems::all().into_iter().find(|question| question.scene.name == "stack_1000").unwrap();
    let error = simulate(&question.scene, 1e-3, 20, 20, &mut OwnSolver::sweeps()).unwrap_err();
    assert!(matches!(error, SceneError::Solver { step: 0, .. }) && error.to_string().contains("cap_reached"), "{error}");
}

#[test]
fn every_scene_has_its_answer() {
    let mut judged = 0;
    for question in systems::all() {
        for (measure, value) in question.measures.iter().zip(values(&question, question.finest(), OwnSolver::newton())) {
            let error = measure.error(value);
            println!(
                "{:<18} {:<18} {:>14.6e} exact {:>12.6e} error {:.1e}",
                question.scene.name, measure.quantity, value, measure.exact, error
            );
            assert!(
                error <= allowed(measure.quantity),
                "{} {}: {value:e}, exact {:e}",
                question.scene.name,
                measure.quantity,
                measure.exact
            );
            judged += 1;
        }
    }
    assert!(judged >= 20, "{judged}");
}

#[test]
fn errors_fall_with_the_step() {
    let mut fitted = 0;
    for question in systems::all()
        .into_iter()
        .filter(|q| ["incline_0", "sliding_sphere", "bouncing_ball", "box_on_balls"].contains(&q.scene.name.as_str()))
    {
        for (k, measure) in question.measures.iter().enumerate() {
            let points: Vec<(f64, f64)> =
                [4e-3, 2e-3, 1e-3].iter().map(|&dt| (dt, values(&question, dt, OwnSolver::sweeps())[k])).collect();
            let fit = Fit::of(&points).unwrap();
            println!("{} {}: {points:?} {fit:?}", question.scene.name, measure.quantity);
            // A tenth of the error at the largest step: what second order leaves, and the rounding of the impact's time to a step.
            assert!(measure.error(fit.limit) <= 0.1 * measure.error(points[0].1) + 2e-3, "{}: {fit:?}", question.scene.name);
            fitted += 1;
        }
    }
    assert_eq!(fitted, 7);
}

#[test]
fn both_solvers_move_a_scene_alike() {
    for name in ["incline_45", "painleve_rod", "rocking_block"] {
        let question = systems::all().into_iter().find(|question| question.scene.name == name).unwrap();
        for (a, b) in values(&question, 2e-3, OwnSolver::sweeps()).iter().zip(values(&question, 2e-3, OwnSolver::newton())) {
            assert!((a - b).abs() <= 1e-6, "{name}: {a:e} {b:e}");
        }
    }
}
