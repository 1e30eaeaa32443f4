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
        residual::convention(),
        residual::implicit(),
        skew::claim(),
        contact::existence(),
        contact::levels(),
        continuum::string(),
        continuum::beam(),
        random::sensitivity(),
        random::modes(),
        jump::law(),
        residual::torque(),
        plug_in::regressor(),
        plug_in::zeros(),
        plug_in::bits(),
        graph::claim(),
        samples::claim(),
        arm::body(),
        arm::accelerations(),
        residual::power(),
        residual::proof(),
        residual::contact(),
        random::ratio(),
        random::gaussian(),
        jump::scaled(),
        mode::projection(),
        mode::mean(),
        mode::weight(),
    ]
    .to_vec()
}
