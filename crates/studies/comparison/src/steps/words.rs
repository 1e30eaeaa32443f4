//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("step_error", "‖Δa‖_M over ‖a‖_M of the acceleration of a step against forward dynamics"),
        ("energy_drift", "the largest change of the energy over a motion, relative"),
        ("order", "the fitted order in the step"),
        ("order_off_one", "its distance from one"),
    ],
    params: &[("dt", "the step, in s"), ("regime", "whether the step was implicit or explicit")],
};
