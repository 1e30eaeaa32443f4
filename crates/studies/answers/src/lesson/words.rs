//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("pipeline", "problem 5, the modelling pipeline, stage by stage")],
    metrics: &[
        ("value", "the number"),
        ("error", "distance of the right value from a second route, relative"),
        ("off_by", "how far the lesson's value is from the right one"),
        ("separation_error", "distance of `off_by` from a second route, relative"),
        ("held_out", "error of torques on a motion that none has seen, over their size"),
        ("logged", "the same, on the motion that was logged"),
        ("held_out_over_before", "`held_out` of this stage over that of the stage before"),
        ("held_out_exact", "`held_out` of a stage whose model has the form of the truth"),
    ],
    params: &[],
};
