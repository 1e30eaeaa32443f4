//! No fold loses a NaN. `NaN.max(x)` is x: so the largest of some errors, one of which is NaN, would be a number.
//!
//! The test searches the sources for folds with `max` or `min` of floats. The right functions are `larger` and `smaller` of
//! `featherbench_spatial`, and `featherbench_bench::measure::worst` for errors.

use crate::direction::sources;
use std::path::Path;

/// Folds that cannot meet a NaN, by file and a part of the line, and why.
const HARMLESS: [(&str, &str, &str); 29] = [
    ("crates/harness/bench/src/robot/recognised.rs", "deepest.max(depth", "a count"),
    ("crates/cli/tests/outside/native.rs", "clocked.min(", "durations"),
    ("crates/cli/tests/outside/native.rs", "asked.min(", "durations"),
    ("crates/mechanics/dynamics/src/tree_sparse.rs", "rows[parent].end.max(", "indices"),
    ("crates/mechanics/formats/src/export/order.rs", "first_frame[parent].min(", "indices"),
    ("crates/harness/bench/src/gates/mod.rs", "known.min(bound)", "a row's bound is finite"),
    ("crates/mechanics/reference/examples/golden.rs", "disagreement.max(", "the multi-precision numbers know no NaN"),
    ("crates/mechanics/reference/src/decimal.rs", "digits.max(1)", "a count"),
    ("crates/mechanics/reference/tests/closed.rs", "gap.max(", "the multi-precision numbers know no NaN"),
    ("crates/mechanics/reference/tests/support/golden.rs", "scale.max(", "the multi-precision numbers know no NaN"),
    ("crates/mechanics/reference/tests/support/mod.rs", "largest.max(", "the multi-precision numbers know no NaN"),
    ("crates/studies/speed/src/timing/section/tradeoff.rs", "least.1.min(", "a row's value is finite"),
    ("crates/studies/comparison/src/accuracy/mod.rs", "least.min(*error)", "an engine's best method is not one whose error is no number"),
    (
        "crates/studies/comparison/src/accuracy/mod.rs",
        "fold(f64::INFINITY, f64::min)",
        "an engine's best method is not one whose error is no number",
    ),
    ("crates/studies/comparison/src/repeatability/mod.rs", "largest.max(distance)", "distances in ulps, which are integers"),
    ("crates/studies/comparison/src/reproductions/mod.rs", "fold(f64::min)", "the closure that calls it keeps what is no number"),
    ("crates/mechanics/spatial/src/contention.rs", "wide.min(", "durations"),
    ("crates/mechanics/spatial/src/contention.rs", "waiting.min(", "durations"),
    ("crates/studies/speed/src/timing/machine.rs", "least.min(", "durations"),
    ("crates/studies/speed/src/timing/protocol.rs", "least.min(", "durations"),
    ("crates/studies/speed/src/timing/protocol.rs", "moves[which].min(", "durations"),
    ("crates/mechanics/dynamics/examples/scale.rs", "smallest[place].min(", "durations"),
    ("crates/mechanics/dynamics/examples/scale.rs", "fold(f64::INFINITY, f64::min)", "durations"),
    ("crates/mechanics/dynamics/src/scaling/ltdl.rs", "numbers.max(", "counts, which are integers"),
    ("crates/mechanics/dynamics/src/scaling/mod.rs", "end[parent].max(", "bodies, which are integers"),
    ("crates/studies/comparison/src/derivatives/section/mod.rs", "entry.2.max(", "counts, which are integers"),
    ("crates/mechanics/uncertainty/src/quadrature.rs", "points.min(self.centre.len())", "a count"),
    ("crates/mechanics/hybrid/src/simulate.rs", "fold(f64::INFINITY, f64::min)", "places that a search found within a step"),
    ("crates/studies/comparison/src/reproductions/mod.rs", "fold(f64::max)", "the closure that calls it keeps what is no number"),
];

/// The expression that ends before this place: names, fields, calls and indices without spaces.
fn expression_before(text: &str) -> &str {
    let start = text.rfind(|c: char| !(c.is_alphanumeric() || "_.*[]:+".contains(c))).map_or(0, |at| at + 1);
    text[start..].trim_start_matches('*')
}

/// Whether a line folds with a `max` or `min` that loses a NaN.
fn loses(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    // As a function, or called with two arguments.
    if ["f64::max)", "f64::min)", "f64::max(", "f64::min("].iter().any(|form| code.contains(form)) {
        return true;
    }
    [".max(", ".min("].iter().any(|method| {
        code.match_indices(method).any(|(at, _)| {
            let before = &code[..at];
            // In the closure of a fold, or a variable that is replaced by the larger.
            let folded = before.rfind("fold(").is_some_and(|fold| before[fold..].contains('|'));
            let variable = expression_before(before);
            let replaced = before[..before.len() - variable.len()].trim_end_matches('*').trim_end();
            let replaced = replaced.strip_suffix('=').is_some_and(|left| expression_before(left.trim_end()) == variable);
            folded || replaced && !variable.is_empty()
        })
    })
}

#[test]
fn no_fold_loses_a_nan() {
    let (mut searched, mut found, mut harmless) = (0, Vec::new(), [0; HARMLESS.len()]);
    for path in sources(Path::new("..")) {
        // This file contains the forbidden forms.
        if path.ends_with("cli/tests/folds.rs") {
            continue;
        }
        searched += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let path = path.strip_prefix("..").map(|path| Path::new("crates").join(path)).unwrap();
        for (number, line) in text.lines().enumerate().filter(|(_, line)| loses(line)) {
            let mut known =
                HARMLESS.iter().zip(&mut harmless).filter(|((file, part, _), _)| path == Path::new(file) && line.contains(part)).peekable();
            if known.peek().is_none() {
                found.push(format!("{}:{}: {}", path.display(), number + 1, line.trim()));
            }
            known.for_each(|(_, count)| *count += 1);
        }
    }
    assert!(searched > 200, "{searched} sources");
    assert!(found.is_empty(), "these lose a NaN; fold with larger or smaller of featherbench_spatial:\n{}", found.join("\n"));
    for ((file, part, why), count) in HARMLESS.iter().zip(harmless) {
        assert!(count > 0, "{file} has no `{part}` any more ({why}): take it from the list");
    }
}

#[test]
fn what_loses_a_nan_is_seen() {
    for line in [
        "errors.fold(0.0, f64::max)",
        "values.reduce(f64::min)",
        "f64::max(worst, error)",
        ".fold(0.0, |worst, x| worst.max(x))",
        "a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));",
        "worst = worst.max(error);",
        "*worst = worst.max(error);",
        "entry.1 = entry.1.max(account.largest);",
        "sizes[parent] = sizes[parent].max(length);",
        "let least = least.min(x); least = least.min(y);",
    ] {
        assert!(loses(line), "{line}");
    }
    for line in [
        "let scale = a.abs().max(b.abs());",
        "errors.fold(0.0, worst)",
        "// worst = worst.max(error)",
        "let largest = f64::MAX.max(x);",
        "let bound = ours.max(theirs);",
        "let x = y.max(0.0);",
    ] {
        assert!(!loses(line), "{line}");
    }
}
