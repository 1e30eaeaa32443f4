//! Questions whose answer is known: by a closed form, or by a second route in other arithmetic.
//!
//! - [`contact`]: what do solvers, laws and integrators answer where the answer is known?
//! - [`continuum`]: what do discretised rods and strings answer where the answer is known?
//! - [`scenes`]: what do engines make of bodies in contact whose motion is known?
//! - [`relaxation`]: does another solver find the velocities of our convex relaxation?
//! - [`identification`]: what do logs tell of a robot's parameters, and do estimators find them?
//! - [`residuals`]: are residuals what their formulas say, does any engine take them, and what is structure worth in learning?
//! - [`lesson`]: which statements of a course's lesson hold, and by how much do the others miss?
//! - [`uncertainty`]: what do uncertain parameters do to the dynamics, where the answer is known?
//! - [`loops`]: how right are engines' accelerations and motions of robots with loops, and what do they cost?

pub mod contact;
pub mod continuum;
pub mod identification;
pub mod lesson;
pub mod loops;
pub mod relaxation;
pub mod residuals;
pub mod scenes;
#[cfg(test)]
#[path = "../../../mechanics/robots/tests/share.rs"]
mod share;
#[cfg(test)]
mod tests;
pub mod uncertainty;
