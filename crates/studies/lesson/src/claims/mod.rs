//! The claims, one file per lab, problem or section of the lesson.

mod arm;
mod contact;
mod continuum;
mod graph;
mod jump;
mod mode;
mod plug_in;
mod random;
mod residual;
mod samples;
mod skew;

use crate::claim::Claim;

/// Every claim, in the order of the lesson.
///
/// ```
/// // Each number of each claim has two routes.
/// for claim in featherbench_lesson::claims::all() {
///     for number in (claim.numbers)(1)? {
///         assert!(number.error() < 1e-10, "{}: {}", claim.id, number.name);
///     }
/// }
/// # Ok::<(), featherbench_lesson::Failure>(())
/// ```
pub fn all() -> Vec<Claim> {
    [
        residual::CONVENTION,
        residual::IMPLICIT,
        skew::CLAIM,
        contact::EXISTENCE,
        contact::LEVELS,
        continuum::STRING,
        continuum::BEAM,
        random::SENSITIVITY,
        random::MODES,
        jump::LAW,
        residual::TORQUE,
        plug_in::REGRESSOR,
        plug_in::ZEROS,
        plug_in::BITS,
        graph::CLAIM,
        samples::CLAIM,
        arm::BODY,
        arm::ACCELERATIONS,
        residual::POWER,
        residual::PROOF,
        residual::CONTACT,
        random::RATIO,
        random::GAUSSIAN,
        jump::SCALED,
        mode::PROJECTION,
        mode::MEAN,
        mode::WEIGHT,
    ]
    .to_vec()
}
