//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words {
    quantities: &[
        ("loop_acceleration", "accelerations of a robot with loops"),
        ("loop_singular", "accelerations beside a singular configuration"),
        ("loop_motion", "a motion of a robot with loops"),
    ],
    metrics: &[
        ("error", "the largest error: of accelerations over |a*| + |v|², of positions at the end of a motion"),
        ("energy_drift", "the largest change of the energy over the motion"),
        ("energy_of_steps", "the largest distance of the energy from that of the same steps of the closed form"),
        ("open", "how far a loop opens over the motion"),
        ("of_steps", "distance of the positions from those of the same steps of the closed form"),
        ("ns_per_state", "time of a state, by the engine's own clock"),
        ("ns_per_step", "time of a step, by the engine's own clock"),
    ],
    params: &[
        ("angle", "the angle of the start, in rad"),
        ("beside", "the angle from the singular configuration, in rad"),
        ("dt", "the step, in s"),
        ("name", "the robot with loops"),
        ("powers", "powers of ten of the angles"),
        ("rate", "the rate of the start, in rad/s"),
        ("settings", "the settings of the engine"),
    ],
};
