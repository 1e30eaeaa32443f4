//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("scaled", "the largest error over the states of a case, by the measure of the quantity"),
        ("forward", "the largest forward error over the states: ‖Δa‖_M over ‖a‖_M"),
        ("backward", "the largest backward error over the states: how far the accelerations are from solving the equations of motion"),
        ("scaled_on_readback", "the same as `scaled`, against our kernels on the inertias that the engine itself holds after loading"),
        ("pairwise", "the largest difference of two engines, by the measure of the quantity"),
        ("kappa_scaled", "condition number of D^-½ M D^-½ with D = diag M: the largest over the states"),
        ("over_best", "our error over that of the best other engine"),
    ],
    params: &[
        ("base", "how the first body is attached: fixed or free"),
        ("joints", "the kinds of the robot's joints, sorted"),
        ("states", "the number of states that were asked"),
        ("excess", "of answers beyond their bound: how much larger all values are, if one factor explains all states; the factor less one"),
        ("ours", "our error"),
        ("best", "the error of the best other engine"),
        ("by", "the method of the best other engine"),
    ],
};
