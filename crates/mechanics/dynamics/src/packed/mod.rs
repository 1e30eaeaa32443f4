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
//! **Accuracy**, against the truth, as a multiple of the best engine's error (67 robots of the suite `default`, geometric mean and largest):
//!
//! | | link by link | packed |
//! |---|---|---|
//! | inverse dynamics | 0.96, 2.0 | 0.83, 1.4 |
//! | mass matrix | 0.81, 1.6 | 1.01, 2.2 |
//!
//! On the heavy tips, long chains and far bases of the suite `accuracy` the mass matrix has 1.06, 4.3 link by link and 0.84, 1.7 packed.
//! Forward dynamics has 0.58 of the floor of its conditioning link by link, and 0.74 packed; the largest are 2.3 and 7.7, and 8.6 times the
//! best engine's error on g1 with hands. So inverse dynamics and the mass matrix are the usual methods of the studies in this text, and
//! forward dynamics is a second method, fast and slightly less accurate. The loss is with bodies that are thin about their axis. In body axes
//! that axis is exact. In the base's axes an inertia is rounded alike in all directions.
//!
//! | | link by link | packed |
//! |---|---|---|
//! | placements | 0.97, 2.0 | 0.98, 2.3 |
//! | velocities | 1.04, 1.6 | 1.01, 1.6 |
//! | accelerations | 1.09, 2.0 | 1.08, 2.0 |
//! | Jacobian | 1.02, 2.0 | 1.03, 1.8 |
//! | centre of mass | 1.02, 2.0 | 1.07, 2.0 |
//! | momentum | 1.03, 2.9 | 1.01, 1.6 |
//!
//! These are the usual methods of the studies in this text. Energies go link by link. A packed text took a third of the time. But on six robots
//! its kinetic energy had more than twice the best engine's error, 2.6 times at most. So it was removed. The left columns of the tables of
//! accuracy are of link by link before joints along coordinate axes had a text of their own.
//!
//! **Speed.** Time link by link over time packed, on a Zen 5 with AVX-512 (4.1 GHz), eight random states in turn, smallest of thousands:
//!
//! | | inverse dynamics | forward dynamics | mass matrix | kinematics | Jacobian | centre of mass | momentum |
//! |---|---|---|---|---|---|---|---|
//! | chain of 36 | 2.3 | 1.5 | 2.0 | 4.1 | 3.0 | 4.6 | 4.4 |
//! | humanoid | 2.0 | 1.4 | 1.7 | 3.6 | 1.7 | 4.2 | 3.7 |
//! | chain of 7 | 1.9 | 1.3 | 1.6 | 3.0 | 2.7 | 3.6 | 2.9 |
//!
//! The humanoid's Jacobian has a short path: there rotations across joints off the path fill lanes.
//! In inverse dynamics the recursion of R has the largest share. Trees of short branches leave lanes of sums unused. Forward dynamics is
//! bound by pass 2, which goes joint by joint.
//!
//! **Tried:**
//! - What did not pay in one kernel stands on the pages of [`PackedRnea`], [`PackedCrba`], [`PackedAba`] and
//!   [`PackedKinematics`].
//! - Kinetic energy from velocities in world axes and Rᵀ alone: 1.65 times the best engine's error in the mean, and 4.9 at most.
//! - Rotations of lanes as loops: see `rotate.rs`. Gathers of columns are slower than transposing four joints at a
//!   time.
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
