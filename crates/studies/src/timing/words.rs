//! The words of the study: its names in rows, and what they mean.

use crate::dictionary::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("machine", "the machine itself")],
    metrics: &[
        ("ns_per_call", "time of a call"),
        ("ratio", "the candidate's time over ours, paired"),
        ("best_other", "our time over that of the best other engine"),
        ("finding", "the candidate's ratio, with what the controls say"),
        ("control", "ratio of a candidate to its own copy: the A/A control"),
        ("worst_error", "the largest error of the timed answers"),
        ("overhead_ns", "the cost of calling the engine, which was subtracted"),
        ("clock_ns", "resolution of the clock"),
        ("empty_call_ns", "time of an empty call"),
        ("fma_per_ns", "multiply-adds of the machine per nanosecond"),
        ("fma_per_ns_per_lane", "the same, per lane of a register"),
        ("fma_per_ns_scalar", "the same, without lanes"),
    ],
    params: &[
        ("what", "what the cell is about"),
        ("states", "the number of states in turn"),
        ("others", "the engines of which the best is taken"),
        ("p10", "lower decile of the times"),
        ("p90", "upper decile of the times"),
    ],
};
