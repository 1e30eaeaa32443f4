//! The lesson's arm as a function in Rust, C and Python: all agree with each other and with our kernels.

use super::{Outcome, Unpassed, exists};
use featherbench_lesson::Language;
use featherbench_lesson::arm::{ARGUMENTS, Arm, Links, Symbolic};
use featherbench_robots::Random;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Drawn arms, with the accelerations of the expressions.
fn arms(links: Links, symbolic: &Symbolic) -> Vec<([f64; 13], Vec<f64>)> {
    let of = |draw| {
        let mut random = Random::new(6, draw);
        let mut two = |low: f64, high: f64| [random.uniform(low, high), random.uniform(low, high)];
        let arm = Arm {
            links,
            masses: two(0.5, 4.0),
            lengths: two(0.3, 1.5),
            gravity: 9.81,
            q: two(-3.0, 3.0),
            v: two(-2.0, 2.0),
            tau: two(-5.0, 5.0),
        };
        let arguments = arm.arguments(two(-1.0, 1.0));
        let known = symbolic.algebra.evaluate(&symbolic.accelerations, &ARGUMENTS, &arguments).unwrap();
        // What the kernels say of τ − d.
        if let Some(model) = arm.model().unwrap() {
            let tau = [arguments[4] - arguments[6], arguments[5] - arguments[7]];
            let kernels = featherbench_dynamics::forward_dynamics(&model, &arm.q, &arm.v, &tau).unwrap();
            agrees(&kernels, &known, "our kernels");
        }
        (arguments, known)
    };
    (0..50).map(of).collect()
}

/// To the rounding of M⁻¹, of condition 10³ at most.
fn agrees(found: &[f64], known: &[f64], who: &str) {
    assert_eq!(found.len(), known.len(), "{who}");
    let scale = known.iter().fold(1.0, |most: f64, x| most + x.abs());
    for (found, known) in found.iter().zip(known) {
        assert!((found - known).abs() < 1e-12 * scale, "{who}: {found} {known}");
    }
}

/// A program that calls the function for each arm and prints its results, one per line.
fn program(language: Language, function: &str, calls: &[([f64; 13], Vec<f64>)]) -> String {
    let mut text = match language {
        Language::C => format!("#include <stdio.h>\n{function}\nint main(void) {{\n    double out[2];\n"),
        Language::Rust => format!("{function}\nfn main() {{\n"),
        Language::Python => format!("{function}\n\n"),
    };
    for (arguments, _) in calls {
        let list = arguments.map(|x| format!("{x:?}")).join(", ");
        let _ = match language {
            Language::C => writeln!(text, "    arm({list}, out); printf(\"%.17g\\n%.17g\\n\", out[0], out[1]);"),
            Language::Rust => writeln!(text, "    for x in arm({list}) {{ println!(\"{{x:?}}\"); }}"),
            Language::Python => writeln!(text, "print(*map(repr, arm({list})), sep=\"\\n\")"),
        };
    }
    if language != Language::Python {
        text.push_str("}\n");
    }
    text
}

/// The results of a program, in the folder.
fn ran(language: Language, folder: &Path, text: &str) -> Vec<f64> {
    let (file, program) = (folder.join(format!("arm.{}", language.name())), folder.join(format!("arm-{}", language.name())));
    std::fs::write(&file, text).unwrap();
    let mut compiler = match language {
        Language::C => {
            // Each operation rounds by itself, as in the other languages.
            let mut compiler = Command::new("cc");
            compiler.args(["-x", "c", "-std=c99", "-Wall", "-Werror", "-ffp-contract=off", "-o"]).arg(&program).arg(&file).arg("-lm");
            Some(compiler)
        }
        Language::Rust => {
            let mut compiler = Command::new("rustc");
            compiler.args(["--edition", "2024", "-o"]).arg(&program).arg(&file);
            Some(compiler)
        }
        Language::Python => None,
    };
    if let Some(compiler) = &mut compiler {
        let output = compiler.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let output = if compiler.is_some() { Command::new(&program).output() } else { Command::new("python3").arg(&file).output() };
    let output = output.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

/// The function of one language, for each way to spread the mass.
pub(super) fn agrees_in(language: Language) -> Outcome {
    let compiler = match language {
        Language::C => "cc",
        Language::Rust => "rustc",
        Language::Python => "python3",
    };
    if !exists(compiler) {
        return Err(Unpassed::Skipped(format!("there is no {compiler}")));
    }
    let folder = tempfile::tempdir().unwrap();
    for links in Links::ALL {
        let symbolic = Symbolic::of(links).unwrap();
        let calls = arms(links, &symbolic);
        let function = symbolic.algebra.source(language, "arm", &symbolic.accelerations, &ARGUMENTS).unwrap();
        let found = ran(language, folder.path(), &program(language, &function, &calls));
        assert_eq!(found.len(), 2 * calls.len());
        for (found, (_, known)) in found.chunks(2).zip(&calls) {
            agrees(found, known, language.name());
        }
    }
    Ok(())
}
