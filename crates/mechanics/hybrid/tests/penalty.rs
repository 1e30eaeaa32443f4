//! The penalty limit law: slope −½ in the stiffness, and the prefactor.

use featherbench_hybrid::library::BouncingBall;
use featherbench_hybrid::penalty::{Drop, PenaltyBall};
use featherbench_hybrid::{Settings, Start, Status, sensitivity, simulate};

/// The state and ∂x/∂x₀ of the penalty ball at T.
fn exit(drop: &Drop, stiffness: f64) -> ([f64; 2], [f64; 2]) {
    let theta = drop.parameters(stiffness);
    let start = Start { mode: 0, time: 0.0, state: vec![drop.height, 0.0] };
    let run = simulate(&PenaltyBall, &theta, &start, drop.time, &Settings::default()).unwrap();
    assert!(run.status == Status::Finished && run.events.len() == 2, "one contact: {:?}", run.status);
    let columns = sensitivity(&PenaltyBall, &theta, &run).unwrap().columns;
    ([run.state[0], run.state[1]], [columns[0][0], columns[0][1]])
}

/// The slope of log|error| in log k, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(k, error)| (k.ln(), error.abs().ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn slope_and_prefactor() {
    let elastic = Drop { mass: 1.0, gravity: 9.81, height: 1.0, damping: 0.0, time: 0.7 };
    let drops = [
        elastic,
        Drop { damping: 0.1, ..elastic },
        Drop { damping: 0.3, time: 0.6, ..elastic },
        Drop { mass: 3.0, gravity: 1.6, height: 0.4, damping: 0.05, time: 1.0 },
    ];
    for drop in drops {
        let law = drop.law().unwrap();
        let errors: Vec<(f64, [f64; 2])> = (0..5)
            .map(|decade| {
                // From 10⁷ N/m the next term of the law, of relative size 1/ω, is below 1 %.
                let stiffness = drop.mass * 1e7 * 10.0_f64.powi(decade);
                let (state, _) = exit(&drop, stiffness);
                (stiffness, [state[0] - law.limit[0], state[1] - law.limit[1]])
            })
            .collect();
        for k in 0..2 {
            let found = slope(&errors.iter().map(|(stiffness, error)| (*stiffness, error[k])).collect::<Vec<_>>());
            let (stiffness, error) = errors[errors.len() - 1];
            let prefactor = error[k] * stiffness.sqrt();
            println!("ζ = {}: slope {found}, prefactor {prefactor} against {}", drop.damping, law.prefactor[k]);
            assert!((found + 0.5).abs() <= 0.02, "{drop:?} {k}: slope {found}");
            assert!((prefactor / law.prefactor[k] - 1.0).abs() <= 0.02, "{drop:?} {k}: {prefactor} {}", law.prefactor[k]);
        }
    }
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
            let (_, derivative) = exit(&drop, stiffness);
            (stiffness, derivative[0] - rigid[0][0])
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
