//! Names in files, and their text on the page.

use featherbench_results::{Quantity, Verdict};

/// The text of a quantity; a row without one is about the whole robot.
pub fn quantity(name: &str) -> &str {
    if name.is_empty() {
        return "whole robot";
    }
    Quantity::parse(name).map_or(name, |quantity| quantity.title())
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
