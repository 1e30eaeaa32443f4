//! Derivatives of the dynamics: one file per algorithm.
//!
//! Derivatives by q are on the tangent space of the configurations: dof j moves as the velocity `v = e_j` moves it. So a quaternion joint has
//! three columns, in body axes, and every matrix here is `nv`×`nv`. The numbers in v, a and τ stay as they are while q moves.

mod columns;
mod fd;
mod id;
mod sweep;
mod tree_pair;

pub use fd::{FdDerivatives, FdPartials, fd_derivatives};
pub use id::{IdDerivatives, IdPartials, id_derivatives};
pub use tree_pair::TreePair;
