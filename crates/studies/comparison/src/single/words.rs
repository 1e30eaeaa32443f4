//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("drift", "the motion of a second from rest, without forces of the joints")],
    metrics: &[
        ("off", "the largest difference from our answer in double precision, over all states, joints and directions"),
        ("off_share", "the same over the largest number of our answer"),
        ("off_bound", "the error in the 2-norm over the conditioning bound in 2⁻²³: the worst of the states that have one"),
    ],
    params: &[("seconds", "the time that is simulated"), ("step", "the step of the simulation, in seconds")],
};
