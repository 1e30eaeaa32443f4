//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[
        ("import", "what the engine's own parser makes of the file"),
        ("*", "a field of the description, by its name in the neutral format: the import differs in it"),
    ],
    metrics: &[
        ("difference", "the size of one difference of the import from the reference import, in the scale of its field"),
        ("differences", "the number of differences that affect a simulation"),
        ("as_read", "the largest error of the engine's answer about the robot as it read it, against our kernels on the reference import"),
        ("replayed", "the same, against our kernels on the description that the engine reports"),
        ("unexplained", "the number of smallest sub-trees whose answers the reported description does not explain"),
    ],
    params: &[
        ("format", "the format of the file"),
        ("base", "how the first body is attached: fixed or free"),
        ("states", "the number of states that were asked"),
        ("cause", "the named cause of a difference"),
        ("class", "whether a difference changes the physics, is rounding, or is only not read"),
        ("joint", "the joint that moves the body"),
        ("ours", "the value of the reference import"),
        ("theirs", "the value of the engine's import"),
        ("weight", "what a field is worth: dynamics, carried or information"),
        ("account", "how the difference was accounted for by another one"),
        ("note", "what the parser said about it"),
        ("notes", "everything that the parser said"),
        ("id", "what the difference alone does to inverse dynamics, by its measure"),
        ("mass_matrix", "what the difference alone does to M, by its measure"),
        ("dynamics", "the number of differences in fields that change the dynamics"),
        ("carried", "the number of differences in fields that are carried along"),
        ("information", "the number of differences in fields that only inform"),
        ("physics", "the number of differences that change the physics"),
        ("rounding", "the number of differences that are rounding"),
        ("not_read", "the number of differences in what an engine does not read"),
        ("unexplained", "the sub-trees that are not explained: quantity, error, bodies"),
        ("gate", "the error above which a sub-tree counts"),
    ],
};
