//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("true", "the largest error over the states of a case, by the measure of the quantity, against dual numbers over double-double"),
        ("error_median", "median of the errors over the states"),
        ("error_over_floor", "median over the states of the error over the conditioning bound"),
        ("difference_worst", "the largest error over the states of a method by finite differences"),
        ("difference_median", "median of the errors of a method by finite differences"),
    ],
    params: &[
        ("base", "how the first body is attached: fixed or free"),
        ("joints", "the kinds of the robot's joints, sorted"),
        ("states", "the number of states that were asked"),
        ("eps", "the step of the finite differences"),
    ],
};
