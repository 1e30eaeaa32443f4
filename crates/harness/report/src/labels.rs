//! Names in files, and their text on the page.

use featherbench_results::Verdict;

/// A name with its text.
pub struct Label {
    /// The name in the rows.
    pub name: &'static str,
    /// A column's heading.
    pub title: &'static str,
    /// The measure of error, in words.
    pub measure: &'static str,
}

const fn label(name: &'static str, title: &'static str, measure: &'static str) -> Label {
    Label { name, title, measure }
}

/// Quantities in the order of the page. Others follow in alphabetical order under their own names. A quantity without a measure is only
/// counted or timed.
pub const QUANTITIES: [Label; 29] = [
    label("mass_matrix", "mass matrix M", "max |ΔMᵢⱼ| / √(Mᵢᵢ·Mⱼⱼ): an entry is measured against the inertias of its own two axes"),
    label(
        "mass_matrix_probe",
        "M · probe",
        "asked instead of M where it is large: its products with four vectors x, each entry over Σⱼ √(Mᵢᵢ·Mⱼⱼ)|xⱼ|, and its diagonal and last row as entries of M",
    ),
    label("bias", "bias force h", "per degree of freedom, |Δhᵢ| over the sum of the magnitudes of the terms added to form hᵢ"),
    label("id", "inverse dynamics", "per degree of freedom, |Δτᵢ| over the sum of the magnitudes of the terms added to form τᵢ"),
    label("id_wrench", "ID, ext. wrench", "as inverse dynamics, with external wrenches on the bodies among the terms"),
    label(
        "fd",
        "forward dynamics",
        "forward: ‖Δq̈‖_M / ‖q̈‖_M with ‖x‖_M = √(xᵀMx); backward: maxᵢ |τ − ID(q, q̇, q̈)|ᵢ / wᵢ with wᵢ = Σⱼ √(Mᵢᵢ·Mⱼⱼ)|q̈ⱼ| + ĥᵢ + |τᵢ|, our inverse dynamics evaluating, where ĥᵢ is the sum of the magnitudes of the terms of hᵢ and j runs over the dofs that share a path with i",
    ),
    label("kinetic_energy", "kinetic energy", "|ΔT| / T: every body's term is positive"),
    label(
        "potential_energy",
        "potential energy",
        "|ΔV| over mass · gravity · the mass-weighted mean length of the paths to the bodies' centres of mass",
    ),
    label(
        "com",
        "centre of mass",
        "each coordinate's difference over the mass-weighted mean length of the paths to the bodies' centres of mass",
    ),
    label(
        "momentum",
        "momentum",
        "linear part over Σ(m|v| + |mc||ω|), angular part over Σ(tr Ī|ω| + |mc||v| + path · linear share), with the magnitudes of v and ω added up along the path",
    ),
    label(
        "body_placement",
        "body placements",
        "entries of the rotation over one, of the position over the length of the path from the world's origin",
    ),
    label(
        "body_velocity",
        "body velocities",
        "angular part over the sum of the joints' angular velocities along the path, linear part over that of the linear ones plus angular · the body's size",
    ),
    label(
        "body_acceleration",
        "body accelerations",
        "as body velocities, with the terms of accelerations; gravity and the swing of the body about its origin are among the linear ones",
    ),
    label(
        "body_jacobian",
        "body Jacobian",
        "of the deepest body, column by column: a turn at unit rate carries the body along by no more than the length of its path, a slide by one",
    ),
    label(
        "readback",
        "model read back",
        "what the engine itself holds after loading, against the description: masses and lengths over themselves, rotations over one, inertias over their trace about the body's origin. It separates an error of the model from one of the algorithm",
    ),
    label("mass_matrix_sparse", "M, tree-sparse", ""),
    label("factorization", "factorization", ""),
    label("factor_entries", "numbers of the factor", ""),
    label("solve", "solve", ""),
    label("mass_matrix_inverse", "M⁻¹", ""),
    label("stored_entries", "stored entries", ""),
    label(
        "id_dq",
        "∂ID/∂q",
        "the largest entry of D^-½ Δ D^-½ over that of the true derivative, D = diag M: entries without the units of their row and column",
    ),
    label("id_dv", "∂ID/∂v", "as ∂ID/∂q; where the true derivative is zero, over the rate of the state"),
    label("fd_dq", "∂FD/∂q", "the largest entry of D^½ Δ D^-½ over that of the true derivative, D = diag M"),
    label("fd_dv", "∂FD/∂v", "as ∂FD/∂q; where the true derivative is zero, over the rate of the state"),
    label("coriolis_matrix", "Coriolis matrix", "as ∂ID/∂v"),
    label(
        "torque_regressor",
        "torque regressor",
        "each entry over √Mᵢᵢ of its row, and then over the largest of the same unit: those of all masses, first moments or inertias",
    ),
    label("id_second", "∂²(μ·ID)", "block by block: entries over √(MⱼⱼMₖₖ), and then over the largest of the block"),
    label("fd_second", "∂²(λ·FD)", "as ∂²(μ·ID)"),
];

/// The text of a quantity; a row without one is about the whole robot.
pub fn quantity(name: &str) -> &str {
    if name.is_empty() {
        return "whole robot";
    }
    QUANTITIES.iter().find(|label| label.name == name).map_or(name, |label| label.title)
}

/// The place of a quantity among the others.
pub fn quantity_rank(name: &str) -> (usize, &str) {
    (QUANTITIES.iter().position(|label| label.name == name).unwrap_or(QUANTITIES.len()), name)
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
