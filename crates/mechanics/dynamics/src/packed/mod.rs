//! The dynamics of one state, several joints at a time.
//!
//! The recursions of [`Rnea`](crate::Rnea), [`Aba`](crate::Aba) and [`Crba`](crate::Crba) turn every vector from one body's axes to the
//! next. Each turn waits for the one before, and fills one lane of a register. Here every vector is expressed in the axes of the base
//! instead, and refers to the origin of its own joint. Then only the orientation `R_i = R_p L_i` is a recursion. Forces and composite
//! inertias are sums along paths of the tree, and everything else is done for a register of joints at once.
//!
//! - A [`PackedModel`] holds the parameters of consecutive joints in the lanes of registers: eight with AVX-512, otherwise four.
//! - No position of the world appears: displacements are from the parent's origin. So a far base costs no digits. The axes are those of
//!   the world; for forward dynamics and the mass matrix of a tree whose root is a free joint they are those of its root body.
//! - The formulas of a body are those of the other text, `step.rs`, with registers as scalars.
//!
//! Motions need less per body: [`PackedKinematics`], [`PackedCenterOfMass`], [`PackedMomentum`], [`PackedJacobian`] and
//! pass 1 of [`PackedRnea`] form the rotations across joints for a register of joints at once. Then they go from body to body in world
//! axes, with a vector in a register. Only the products with inertias are done for a register of bodies again. The motions in [`PackedAba`]
//! are sums along paths, because they are relative to the first joint of a segment.
//!
//! The studies take this text as the usual method of inverse dynamics, the mass matrix, placements, velocities, accelerations, the Jacobian, the
//! centre of mass and momentum. In forward dynamics it is a second method, fast and slightly less accurate. Body axes keep the axis of a thin
//! body exact. In the base's axes its inertia is rounded alike in all directions. Energies go link by link.
//! Errors, times, and what was tried: `docs/kernels/packed.md`.
//!
//! Source: the book, section 5.3 and tables 6.2 and 7.1. Sums along paths: Hillis and Steele, *Data parallel algorithms* (1986).

mod aba;
mod bodies;
mod center_of_mass;
mod crba;
mod jacobian;
mod kinematics;
mod lanes;
mod model;
mod momentum;
mod motions;
mod orientation;
mod rnea;
mod rotate;
mod xyz;

pub use aba::PackedAba;
pub use center_of_mass::PackedCenterOfMass;
pub use crba::PackedCrba;
pub use jacobian::PackedJacobian;
pub use kinematics::PackedKinematics;
pub use model::PackedModel;
pub use momentum::PackedMomentum;
pub use rnea::PackedRnea;
