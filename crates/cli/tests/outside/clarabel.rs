//! Clarabel, if it is installed: a solver of convex problems, which knows no robots.

use super::{Outcome, alone};
use crate::support::{Ended, Sandbox, project};
use featherbench_identification::{Arm, Log, Samples, Scenario, Terms};
use serde_json::Value;
use std::process::Command;

/// `identify --method semidefinite` solves its programme with it.
///
/// - Without noise the programme's solution is the truth: the base parameters are those of least squares.
/// - With noise least squares give a body that cannot exist, and the programme does not.
pub fn identifies() -> Outcome {
    alone::command("clarabel")?;
    let scenario = Scenario::of(&Arm::general(3, 4), Terms::NONE, 150).unwrap();
    let sandbox = Sandbox::new();
    let robot = sandbox.path("arm.json");
    featherbench_formats::neutral::write(scenario.linear.description(), &robot).unwrap();
    let identified = |samples: &Samples, method: &str| -> Value {
        let log = sandbox.write("log.csv", &Log { a: Some(samples.a.clone()), ..Log::of_samples(samples) }.to_csv(&scenario.linear));
        let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
        command.current_dir(project()).arg("identify").args([&robot, &log]);
        command.args(["--terms", "none", "--window", "1", "--stride", "1", "--held-out", "0", "--json", "--method", method]);
        let ended = Ended::new(command.output().unwrap());
        assert_eq!(ended.code, Some(0), "{method}: {}", ended.errors);
        serde_json::from_str(&ended.output).unwrap()
    };
    let numbers = |of: &Value| of.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>();
    let base = |of: &Value| {
        let values = of["base_parameters"].as_array().unwrap().iter().map(|one| one["value"].as_f64().unwrap());
        values.collect::<Vec<f64>>()
    };

    let exact = identified(&scenario.fitted, "semidefinite");
    let (found, due) = (base(&exact), base(&identified(&scenario.fitted, "ordinary")));
    let size = due.iter().fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() });
    assert!(found.len() == due.len() && found.len() >= 15, "{} base parameters", found.len());
    // Clarabel ends with a gap of 1e-9 of the norm that is least; the scaled columns have a condition below 1e3.
    let near = found.iter().zip(&due).all(|(found, due)| (found - due).abs() <= 1e-6 * size);
    assert!(near, "{found:?}\n{due:?}");
    assert!(numbers(&exact["smallest_eigenvalues"]).iter().all(|smallest| *smallest > 0.0), "{exact}");

    let noisy = scenario.noisy(0.2, 1);
    let free = numbers(&identified(&noisy, "ordinary")["smallest_eigenvalues"]);
    let held = numbers(&identified(&noisy, "semidefinite")["smallest_eigenvalues"]);
    assert!(free.iter().any(|smallest| *smallest < 0.0), "{free:?}");
    assert!(held.iter().all(|smallest| *smallest >= 0.0), "{held:?}");
    Ok(())
}
