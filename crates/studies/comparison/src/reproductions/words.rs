//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("deviation", "the size of a known deviation, by the engine's own interface")],
    metrics: &[("smallest", "the smallest size over the draws"), ("largest", "the largest size over the draws")],
    params: &[
        ("condition", "when the deviation exists"),
        ("measure", "what the size is"),
        ("range", "the known range of the size"),
        ("seeds", "the draws"),
        ("upstream", "the issue of the engine"),
    ],
};
