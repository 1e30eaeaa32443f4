//! The arm as source text; that it compiles and computes the same is a test of the command's (`outside`), which needs compilers.

use featherbench_lesson::Language;
use featherbench_lesson::arm::{ARGUMENTS, Links, Symbolic};

/// The same statements in every language, and none but single operations.
#[test]
fn statements_are_single_operations() {
    for links in Links::ALL {
        let symbolic = Symbolic::of(links).unwrap();
        let counts = Language::ALL.map(|language| {
            let text = symbolic.algebra.source(language, "arm", &symbolic.accelerations, &ARGUMENTS).unwrap();
            let statements: Vec<&str> =
                text.lines().filter(|line| line.contains(" = ") && line.trim_start().starts_with(['t', 'l', 'c'])).collect();
            for statement in &statements {
                let operations = [" + ", " - ", " * ", " / ", "sin", "cos"].iter().filter(|sign| statement.contains(**sign)).count();
                assert_eq!(operations, 1, "{statement}");
            }
            statements.len()
        });
        assert!(counts[0] > 40 && counts[0] == counts[1] && counts[1] == counts[2], "{counts:?}");
    }
}

/// Derivation is deterministic: the same text each time.
#[test]
fn the_text_repeats() {
    let text = || {
        let symbolic = Symbolic::of(Links::UniformRods).unwrap();
        symbolic.algebra.source(Language::C, "arm", &symbolic.accelerations, &ARGUMENTS).unwrap()
    };
    assert_eq!(text(), text());
}
