//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[],
    metrics: &[
        ("fill_in", "numbers of the factor beyond those of M"),
        ("multiply_subtracts", "multiply-subtracts of the factorization in this order of elimination"),
        ("factor_error_per_dof", "the largest relative error of LᵀDL against M, over the dofs"),
        ("solution_error_per_dof", "the backward error of a solution, over the dofs"),
        ("floor", "the conditioning bound of forward dynamics: what ½ ulp in the inputs can do"),
        ("error", "‖a − truth‖₂ / ‖truth‖₂ of forward dynamics"),
        ("error_over_floor", "that error over the conditioning bound"),
        ("work_ratio", "operations of forward dynamics by the mass matrix over those of the articulated-body algorithm"),
        ("crossover_predicted", "dofs at which both ways take the same time, if time is operations"),
        ("parallel_work", "operations of a method on several cores over the serial ones"),
        ("parallel_span", "the longest chain of operations that must wait for each other, over the serial ones"),
    ],
    params: &[
        ("what", "what the cell is about: counts, fill_in, factors, dynamics, floor, work, crossover or parallel"),
        ("route", "whether operations were counted in a run or on the pattern"),
        ("aba", "operations of the articulated-body algorithm"),
        ("ltdl", "operations by the mass matrix"),
        ("lanes", "numbers to a register"),
        ("serial", "operations of the serial method"),
        ("span", "operations that must wait for each other"),
        ("work", "operations of all cores"),
        ("line", "the family along which the robot grows"),
        ("order", "the order of elimination"),
        ("tree", "the robot, as text of the generator"),
    ],
};
