//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("seconds", "median time of a call"),
        ("build_seconds", "time from the description to a model with its workspace"),
        ("peak", "the most memory that the process ever had resident"),
        ("resident", "memory resident after the last call"),
        ("resident_per_dof", "resident memory over the dofs"),
        ("error", "‖a − truth‖₂ / ‖truth‖₂ of forward dynamics"),
        ("time_exponent", "p of time ~ nᵖ over the last two decades"),
        ("memory_exponent", "p of (resident − resident at the smallest size) ~ nᵖ over the last two decades"),
        ("memory_per_dof", "growth of the resident memory per dof between the last two sizes"),
        ("largest", "dofs of the largest tree that was answered"),
        ("time_ratio", "time of the method over that of the serial one"),
        ("crossover_measured", "dofs at which both take the same time"),
        ("different_answers", "different answers over all numbers of threads"),
    ],
    params: &[("line", "the family along which the robot grows"), ("threads", "the number of threads")],
};
