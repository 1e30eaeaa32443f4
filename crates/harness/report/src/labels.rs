//! Names in files, and their text on the page.

use featherbench_results::{Quantity, Verdict};

/// The text of a quantity; a row without one is about the whole robot.
pub fn quantity(name: &str) -> &str {
    if name.is_empty() {
        return "whole robot";
    }
    Quantity::parse(name).map_or(name, |quantity| quantity.title())
}

/// Methods whose names are not words.
const METHODS: [(&str, &str); 16] = [
    ("aba", "articulated bodies"),
    ("aba_packed", "articulated bodies, packed"),
    ("aba_parallel", "articulated bodies, parallel"),
    ("batch", "a state in each lane"),
    ("crba", "composite bodies"),
    ("crba_ldl", "composite bodies, LDLᵀ"),
    ("crba_packed", "composite bodies, packed"),
    ("crba_parallel", "composite bodies, parallel"),
    ("kinematics_packed", "kinematics, packed"),
    ("ltdl", "LᵀDL factors"),
    ("ltdl_parallel", "LᵀDL factors, parallel"),
    ("refined_1", "LᵀDL factors, refined"),
    ("refined_2", "LᵀDL factors, refined twice"),
    ("rnea", "Newton–Euler"),
    ("rnea_packed", "Newton–Euler, packed"),
    ("rnea_parallel", "Newton–Euler, parallel"),
];

/// The text of a method in a figure.
pub fn method(name: &str) -> &str {
    METHODS.iter().find(|(known, _)| *known == name).map_or(name, |(_, words)| words)
}

/// The place of a quantity among the others: those of engines first, then by name.
pub fn quantity_rank(name: &str) -> (usize, &str) {
    (Quantity::parse(name).map_or(Quantity::ALL.len(), |quantity| quantity as usize), name)
}

/// The text of a quantity under a measure: `forward dynamics, backward error`.
pub fn error(quantity_name: &str, metric: &str) -> String {
    let title = quantity(quantity_name);
    match metric {
        "scaled" | "" => title.to_owned(),
        "forward" | "backward" => format!("{title}, {metric} error"),
        other => format!("{title}, {other}"),
    }
}

/// A verdict's sign: it never depends on colour alone.
pub const fn glyph(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "✓",
        Verdict::Fail => "✕",
        Verdict::Error => "!",
        Verdict::Deviation => "≈",
        Verdict::Skip => "–",
        Verdict::Info => "·",
    }
}

/// A verdict in the words of a heading.
pub const fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "passed",
        Verdict::Fail => "failed",
        Verdict::Error => "errors",
        Verdict::Deviation => "known deviations",
        Verdict::Skip => "not offered",
        Verdict::Info => "not judged",
    }
}
