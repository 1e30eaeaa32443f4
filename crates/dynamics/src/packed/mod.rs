//! The dynamics of one state, several joints at a time.
//!
//! The recursions of [`Rnea`](crate::Rnea) and [`Aba`](crate::Aba) turn every vector from one body's axes to the next. Each turn waits for
//! the one before, and fills one lane of a register. Here every vector is expressed in the axes of the base instead, and refers to the
//! origin of its own joint. Then only the orientation `R_i = R_p L_i` is a recursion. Velocities, accelerations, forces and composite
//! inertias are sums along paths of the tree, and everything else is done for a register of joints at once.
//!
//! - A [`PackedModel`] holds the parameters of consecutive joints in the lanes of registers: eight with AVX-512, otherwise four.
//! - No position of the world appears: displacements are from the parent's origin. So a far base costs no digits. The axes are those of
//!   the world; in a tree whose root is a free joint they are those of its root body.
//! - The formulas of a body are those of the other text, `step.rs`, with registers as scalars.
//!
//! Source: the book, section 5.3 and tables 6.2 and 7.1. Sums along paths: Hillis and Steele, *Data parallel algorithms* (1986).

mod aba;
mod crba;
mod lanes;
mod model;
mod orientation;
mod rnea;
mod rotate;

pub use aba::PackedAba;
pub use crba::PackedCrba;
pub use model::PackedModel;
pub use rnea::PackedRnea;
