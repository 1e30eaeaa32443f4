//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[(
        "moved",
        "how far an answer moves when the robot is described otherwise: torques over the terms that are added to form them, accelerations over the largest of their kind",
    )],
    params: &[("change", "what is described otherwise: names, order, units, mirror or frames")],
};
