//! The penalty limit law of gradients. That of states is a quantity of the study `contact`.

use featherbench_hybrid::penalty::{Drop, PenaltyBall};
use featherbench_hybrid::systems::BouncingBall;
use featherbench_hybrid::{Settings, Start, Status, sensitivity, simulate};

/// ∂y/∂y₀ of the penalty ball at T.
fn exit(drop: &Drop, stiffness: f64) -> f64 {
    let theta = drop.parameters(stiffness);
    let start = Start { mode: 0, time: 0.0, state: vec![drop.height, 0.0] };
    let run = simulate(&PenaltyBall, &theta, &start, drop.time, &Settings::default()).unwrap();
    assert!(run.status == Status::Finished && run.events.len() == 2, "one contact: {:?}", run.status);
    sensitivity(&PenaltyBall, &theta, &run).unwrap().columns[0][0]
}

/// The slope of log|error| in log k, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(k, error)| (k.ln(), error.abs().ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// The gradient obeys the same law: Δ(∂(x, v)/∂x₀) of the elastic ball is (−∂v/∂x₀, 0)·π√(m/k), as g does not depend on x₀.
#[test]
fn gradients_approach_those_of_the_rigid_ball() {
    let drop = Drop { mass: 1.0, gravity: 9.81, height: 1.0, damping: 0.0, time: 0.7 };
    let start = Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] };
    let theta = [9.81, 1.0];
    let rigid = simulate(&BouncingBall, &theta, &start, drop.time, &Settings::default()).unwrap();
    let rigid = sensitivity(&BouncingBall, &theta, &rigid).unwrap().columns;
    let errors: Vec<(f64, f64)> = (0..4)
        .map(|decade| {
            let stiffness = 1e7 * 10.0_f64.powi(decade);
            (stiffness, exit(&drop, stiffness) - rigid[0][0])
        })
        .collect();
    assert!((slope(&errors) + 0.5).abs() <= 0.02, "{errors:?}");
    let (stiffness, error) = errors[errors.len() - 1];
    let known = -rigid[0][1] * std::f64::consts::PI;
    assert!((error * stiffness.sqrt() / known - 1.0).abs() <= 0.02, "{} {known}", error * stiffness.sqrt());
}

/// A drop without a law is refused by name.
#[test]
fn bad_drops() {
    let drop = Drop { mass: 1.0, gravity: 9.81, height: 1.0, damping: 0.0, time: 0.7 };
    let bad = [
        (Drop { mass: 0.0, ..drop }, "mass"),
        (Drop { gravity: f64::NAN, ..drop }, "gravity"),
        (Drop { height: -1.0, ..drop }, "height"),
        (Drop { damping: 1.0, ..drop }, "damping"),
        (Drop { time: 0.1, ..drop }, "time"),
        (Drop { time: f64::INFINITY, ..drop }, "time"),
    ];
    for (drop, name) in bad {
        let error = drop.law().unwrap_err();
        assert!(error.to_string().contains(&format!("'{name}'")), "{error}");
    }
}
