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
const METHODS: [(&str, &str); 48] = [
    ("aba", "articulated bodies"),
    ("aba_local", "articulated bodies, local frames"),
    ("aba_packed", "articulated bodies, packed"),
    ("aba_parallel", "articulated bodies, parallel"),
    ("aba_world", "articulated bodies, world frame"),
    ("batch", "a state in each lane"),
    ("bias_term", "bias"),
    ("body_poses", "poses of bodies"),
    ("body_velocities", "velocities of bodies"),
    ("center_of_mass", "centre of mass"),
    ("centroidal_momentum", "momentum about the centre of mass"),
    ("crb", "composite bodies"),
    ("crba", "composite bodies"),
    ("crba_cholesky", "composite bodies, Cholesky"),
    ("crba_ldl", "composite bodies, LDLᵀ"),
    ("crba_local", "composite bodies, local frames"),
    ("crba_packed", "composite bodies, packed"),
    ("crba_parallel", "composite bodies, parallel"),
    ("crba_world", "composite bodies, world frame"),
    ("energy_pos", "potential energy"),
    ("energy_vel", "kinetic energy"),
    ("forward", "forward pass"),
    ("forward_kinematics", "kinematics"),
    ("inverse", "inverse pass"),
    ("inverse_dynamics", "Newton–Euler"),
    ("jac_body", "Jacobian of a body"),
    ("jacobian_spatial_velocity", "Jacobian of a body"),
    ("joint_jacobian", "Jacobian of a joint"),
    ("kinematics_packed", "kinematics, packed"),
    ("kinetic_energy", "kinetic energy"),
    ("ltdl", "LᵀDL factors"),
    ("ltdl_parallel", "LᵀDL factors, parallel"),
    ("minverse", "inverse of M"),
    ("nonlinear_effects", "bias"),
    ("object_acceleration", "accelerations of bodies"),
    ("object_velocity", "velocities of bodies"),
    ("potential_energy", "potential energy"),
    ("qfrc_bias", "bias"),
    ("refined_1", "LᵀDL factors, refined"),
    ("refined_2", "LᵀDL factors, refined twice"),
    ("rne", "Newton–Euler"),
    ("rnea", "Newton–Euler"),
    ("rnea_packed", "Newton–Euler, packed"),
    ("rnea_parallel", "Newton–Euler, parallel"),
    ("spatial_accelerations", "accelerations of bodies"),
    ("spatial_momentum", "momentum"),
    ("subtree_com", "centre of mass"),
    ("subtree_vel", "momentum"),
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
