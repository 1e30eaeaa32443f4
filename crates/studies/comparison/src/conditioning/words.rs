//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("kappa", "condition number of M"),
        ("kappa_scaled", "condition number of D^-½ M D^-½ with D = diag M"),
        ("kappa_exponent", "log₂ of `kappa` over that of the robot of the family with half the dofs"),
        ("kappa_scaled_exponent", "log₂ of `kappa_scaled` over that of the robot of the family with half the dofs"),
        ("kappa_off_quartic", "how far the exponent of a straight chain is from 4"),
        ("kappa_base", "condition number of the Schur complement of the floating base, median over the states"),
        ("kappa_base_scaled", "the same, scaled to a diagonal of ones"),
        ("kappa_joints", "condition number of the Schur complement of the joints, median over the states"),
        ("kappa_joints_scaled", "the same, scaled to a diagonal of ones"),
        ("complement_over_whole", "the larger condition number of the two Schur complements over that of M: at most 1"),
        ("complement_error", "the smallest relative change of M that explains the error of a Schur complement"),
    ],
    params: &[("configuration", "the configuration at which M is taken"), ("states", "the number of states that were asked")],
};
