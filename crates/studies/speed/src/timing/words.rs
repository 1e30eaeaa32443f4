//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("machine", "the machine itself")],
    metrics: &[
        ("ns_per_call", "time of a call"),
        ("ratio", "the candidate's time over that of our usual method, paired"),
        ("best_other", "time of the best other engine over ours, paired"),
        ("finding", "1 if the candidate is slower than our usual method, -1 if it is faster, 0 if the interval holds 1"),
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
        ("drift", "how far all times move from run to run"),
        ("fastest", "processes with the core at its fastest"),
    ],
};
