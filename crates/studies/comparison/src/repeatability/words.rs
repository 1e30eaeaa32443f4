//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("repeatability", "the same question, asked twice")],
    metrics: &[("repeated", "the largest distance of the two answers, in units in the last place")],
    params: &[("draw", "the draw that is asked"), ("quantity", "the quantity that is asked")],
};
