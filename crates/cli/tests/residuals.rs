//! The command `residuals`: friction at rest, the balance M a + h + r = τ, and bad input.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Command::new(env!("CARGO_BIN_EXE_featherbench")).arg("residuals").args(arguments).current_dir(root).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let found = run(&[arguments, &["--json"]].concat());
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    serde_json::from_slice(&found.stdout).unwrap()
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The true torques of the true acceleration are the given ones, and the parts are what nominal torques lack.
#[test]
fn forward_and_inverse_agree() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.json");
    for robot in ["worn-arm", "driven-arm"] {
        let first = json(&[robot, "--seed", "3"]);
        let state =
            json!({"q": first["q"], "v": first["v"], "a": first["true_acceleration"], "tau": first["tau"], "inner": first["inner"]});
        std::fs::write(&file, state.to_string()).unwrap();
        let again = json(&[robot, "--state", file.to_str().unwrap()]);
        let given = numbers(&first["tau"]);
        for (dof, (bounds, given)) in again["true_torque"].as_array().unwrap().iter().zip(&given).enumerate() {
            // κ(M) of a chain of five is some 10³, of torques of some tens.
            let lack: f64 = again["parts"].as_array().unwrap().iter().map(|part| numbers(&part["r"][dof])[0]).sum();
            let nominal = numbers(&again["nominal_torque"])[dof];
            assert!((numbers(bounds)[0] - given).abs() < 1e-9, "{robot} {dof} {bounds} {given}");
            assert!((nominal + lack - given).abs() < 1e-9, "{robot} {dof}");
        }
        assert_ne!(first["true_acceleration"], first["nominal_acceleration"]);
    }
}

/// At rest under the torques that hold it, dry friction holds the joints that have it: inverse dynamics is an interval of ±F.
#[test]
fn dry_friction_holds_a_joint() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.json");
    let none = [0.0; 5];
    let write = |tau: &[f64], inner: &[f64]| {
        let state = json!({"q": none, "v": none, "a": none, "tau": tau, "inner": inner});
        std::fs::write(&file, state.to_string()).unwrap();
    };
    let inner = vec![0.0; json(&["driven-arm"])["inner"].as_array().unwrap().len()];
    write(&none, &inner);
    let held = numbers(&json(&["driven-arm", "--state", file.to_str().unwrap()])["nominal_torque"]);
    // The inner state [θ, θ̇; z; two periods of two dofs] puts out the holding torques: the spring turns by τ/K, the others hold them.
    let inner = [held[0] / 300.0, 0.0, held[1], held[2], held[3], held[2], held[3]];
    write(&held, &inner);
    let found = json(&["driven-arm", "--state", file.to_str().unwrap()]);
    assert_eq!(found["stuck"], json!([0, 1, 2]));
    assert_eq!(numbers(&found["true_acceleration"])[..3], [0.0; 3]);
    for (dof, force) in [2.0, 1.0, 0.5].into_iter().enumerate() {
        let bounds = numbers(&found["true_torque"][dof]);
        assert!((bounds[1] - bounds[0] - 2.0 * force).abs() < 1e-12, "{bounds:?}");
    }
    let text = String::from_utf8(run(&["driven-arm", "--state", file.to_str().unwrap()]).stdout).unwrap();
    assert!(text.contains("held by dry friction") && text.contains(" … "), "{text}");
}

#[test]
fn bad_input_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let short = file("short.json", r#"{"q":[0],"v":[0],"a":[0],"tau":[0]}"#);
    let strange = file("strange.json", r#"{"q":[0],"w":[0]}"#);
    let worn = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../datasets/models/worn-arm.json")).unwrap();
    let negative = file("negative.json", &worn.replace("\"coefficient\":[0.3,", "\"coefficient\":[-0.3,"));
    let cases: &[(&[&str], &str)] = &[
        (&["panda"], "the robot has no residuals; write a section 'residuals'"),
        (&["no_such_robot"], "no family of generated robots"),
        (&["worn-arm", "--state", &short], "short.json: field 'q' has 1 numbers; the robot 'worn-arm' needs 5"),
        (&["worn-arm", "--state", &strange], "unknown field `w`"),
        (&["worn-arm", "--state", "nowhere.json"], "nowhere.json"),
        (&[&negative], "residuals[0] 'grease': law.coefficient[0] is -0.3; it must not be negative"),
    ];
    for (arguments, part) in cases {
        let found = run(arguments);
        let text = String::from_utf8_lossy(&found.stderr);
        assert_eq!(found.status.code(), Some(2), "{arguments:?} {text}");
        assert!(text.contains(part), "{arguments:?}\n{text}");
    }
}
