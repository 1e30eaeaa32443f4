//! The command `uncertainty`: what it says, the same digits for any threads, and bad input.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Command::new(env!("CARGO_BIN_EXE_featherbench")).arg("uncertainty").args(arguments).current_dir(root).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let found = run(&[arguments, &["--json"]].concat());
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    serde_json::from_slice(&found.stdout).unwrap()
}

/// Means of sampling and of quadrature agree within four standard errors, for each dof.
#[test]
fn methods_agree() {
    let robot = "chain:n=3,layout=spatial";
    let exact = json(&[robot, "--method", "chaos"]);
    for method in ["random", "sobol"] {
        let found = json(&[robot, "--method", method, "--samples", "20000", "--indices"]);
        for dof in 0..3 {
            let number = |of: &Value, name: &str| of["dofs"][dof][name].as_f64().unwrap();
            let apart = (number(&found, "mean") - number(&exact, "mean")).abs();
            assert!(apart < 4.0 * number(&found, "mean_error"), "{method} {dof} {apart}");
            assert!(number(&found, "mean_half_width") > 1.9 * number(&found, "mean_error"));
            let apart = (number(&found, "deviation") - number(&exact, "deviation")).abs();
            assert!(apart < 4.0 * number(&found, "deviation_error"), "{method} {dof} {apart}");
        }
        assert_eq!(found["indices"].as_array().map(Vec::len), Some(3));
    }
    for method in ["first-order", "unscented"] {
        let spread = json(&[robot, "--method", method])["dofs"][0]["deviation"].as_f64().unwrap();
        let due = exact["dofs"][0]["deviation"].as_f64().unwrap();
        assert!((spread / due - 1.0).abs() < 0.15, "{method} {spread} {due}");
    }
}

#[test]
fn threads_change_nothing_but_the_time() {
    let of = |threads: &str| run(&["panda", "--threads", threads, "--samples", "9000", "--torque"]).stdout;
    assert_eq!(of("1"), of("2"));
    let text = String::from_utf8(of("1")).unwrap();
    assert!(text.contains("torques deviate by up to"), "{text}");
}

#[test]
fn bad_input_is_named() {
    let cases: &[(&[&str], &str)] = &[
        (&["nowhere.json"], "nowhere.json"),
        (&["no_such_robot"], "no family of generated robots"),
        (&["panda", "--spread", "1.5"], "raise its lower bound"),
        (&["panda", "--threads", "0"], "threads is 0"),
        (&["panda", "--samples", "3"], "samples is 3"),
        (&["panda", "--method", "chaos", "--order", "30"], "make 31^9 nodes, and 262144 are allowed; take order 3 or a lower one"),
        (&["chain:n=1", "--method", "chaos", "--order", "40"], "order 40 is above 38"),
        (&["panda", "--state", "nowhere.json"], "nowhere.json"),
    ];
    for (arguments, part) in cases {
        let found = run(arguments);
        let text = String::from_utf8_lossy(&found.stderr);
        assert_eq!(found.status.code(), Some(2), "{arguments:?} {text}");
        assert!(text.contains(part), "{arguments:?}\n{text}");
    }
}
