//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("relaxed_velocity", "velocities of the convex relaxation of a contact problem")],
    metrics: &[("difference", "the largest distance of the solver's velocities from ours"), ("problems", "the number of problems")],
    params: &[("tolerance", "the tolerance of the solver")],
};
