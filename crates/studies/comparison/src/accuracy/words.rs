//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("true", "the largest error over the states, by the measure of the quantity, against double-double arithmetic"),
        ("true_forward", "‖a − truth‖_M over ‖truth‖_M: the largest over the states"),
        ("error_q1", "lower quartile over the states of ‖a − truth‖₂ / ‖truth‖₂"),
        ("error_median", "median over the states of ‖a − truth‖₂ / ‖truth‖₂"),
        ("error_q3", "upper quartile over the states of ‖a − truth‖₂ / ‖truth‖₂"),
        ("error_worst", "largest over the states of ‖a − truth‖₂ / ‖truth‖₂"),
        ("error_over_floor", "the error over the conditioning bound, which is what ½ ulp in the inputs can do"),
        ("residual_median", "median over the states of the residual of the equations of motion"),
        (
            "limited_by_the_reference",
            "the number of engines whose best answers all have the same error: there the reference may be the limit",
        ),
    ],
    params: &[
        ("base", "how the first body is attached: fixed or free"),
        ("states", "the number of states that were asked"),
        ("axes", "the level of each axis at which the suite drew the robot (study sweep)"),
    ],
};
