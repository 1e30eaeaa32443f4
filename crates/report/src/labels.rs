//! Names in files and what they are called on the page.

use record::Verdict;

/// A name with the words for it.
pub struct Label {
    /// The name in the records.
    pub name: &'static str,
    /// A column's heading.
    pub title: &'static str,
    /// The measure of error, in words.
    pub measure: &'static str,
}

const fn label(name: &'static str, title: &'static str, measure: &'static str) -> Label {
    Label { name, title, measure }
}

const FRAME: &str = "largest difference of a component, over the size of the quantity";

/// Quantities in the order of the page. Others follow in alphabetical order under their own names.
pub const QUANTITIES: [Label; 15] = [
    label("mass_matrix", "mass matrix M", "max |ΔMᵢⱼ| / √(Mᵢᵢ·Mⱼⱼ): an entry is measured against the inertias of its own two axes"),
    label("mass_matrix_probe", "M · probe", "the mass matrix seen through products with probe vectors, where forming M would be too large"),
    label("bias", "bias force h", "per degree of freedom, |Δhᵢ| over the sum of the magnitudes of the terms added to form hᵢ"),
    label("id", "inverse dynamics", "per degree of freedom, |Δτᵢ| over the sum of the magnitudes of the terms added to form τᵢ"),
    label("id_wrench", "ID, ext. wrench", "as inverse dynamics, with external wrenches on bodies"),
    label(
        "fd",
        "forward dynamics",
        "forward: ‖Δq̈‖ in the norm of M, over ‖q̈‖; backward: the residual |τ − ID(q, q̇, q̈)|ᵢ over (|M||q̈| + |h| + |τ|)ᵢ",
    ),
    label("kinetic_energy", "kinetic energy", "|ΔT| over the sum of the bodies' energies"),
    label("potential_energy", "potential energy", "|ΔV| over the sum of the magnitudes of the bodies' potentials"),
    label("com", "centre of mass", FRAME),
    label("momentum", "momentum", FRAME),
    label("body_placement", "body placements", FRAME),
    label("body_velocity", "body velocities", FRAME),
    label("body_acceleration", "body accelerations", FRAME),
    label("body_jacobian", "body Jacobians", FRAME),
    label(
        "readback",
        "model read back",
        "inertias that the engine itself reports after loading, against the description: separates model error from algorithm error",
    ),
];

/// What a quantity is called; a row without one is about the whole model.
pub fn quantity(name: &str) -> &str {
    if name.is_empty() {
        return "whole model";
    }
    QUANTITIES.iter().find(|label| label.name == name).map_or(name, |label| label.title)
}

/// Where a quantity stands among the others.
pub fn quantity_rank(name: &str) -> (usize, &str) {
    (QUANTITIES.iter().position(|label| label.name == name).unwrap_or(QUANTITIES.len()), name)
}

/// What a quantity under a measure is called: `forward dynamics, backward error`.
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
        Verdict::Skip => "skipped",
        Verdict::Info => "not judged",
    }
}
