//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[("contact_impulses", "the impulses of all contacts of a standing robot")],
    metrics: &[
        ("problems", "the number of problems"),
        ("ns_per_call", "time of a problem"),
        ("ratio", "the candidate's time over that of our usual one, paired"),
        ("own_model_ratio", "the same, of an engine that answers by its own model of contact"),
        ("control", "ratio of a candidate to its own copy: the A/A control"),
        ("tolerance", "the solver's tolerance"),
        ("residual", "the largest residual of the natural map over the problems"),
        ("from_limit", "distance of the velocities from the limit of the engine's own model"),
    ],
    params: &[
        ("contacts", "the number of contacts"),
        ("rank", "the rank of the Jacobian of the contacts"),
        ("own_model", "the engine's own model of contact, and what its time includes"),
    ],
};
