//! The Delassus matrix `G = J M⁻¹ Jᵀ`: what accelerations multipliers cause, by three routes that share only J or nothing.
//!
//! | route | needs | cost for m rows, n dofs, depth d |
//! |---|---|---|
//! | [`dense`] | J and M | n³/6 + m n²/2 + m² n/2 multiply-adds |
//! | [`by_factors`] | J and the factors of M | m·D1 + m² n/2, D1 = Σ (d_k − 1) |
//! | [`Articulated`] | the wrenches of the rows | O(n) per row, and O(m) per pair of rows |
//!
//! In [`DoubleDouble`](featherbench_spatial::DoubleDouble) the dense route is the truth for the others. Shapes: G is m×m. Units: the row's
//! unit per s² and unit of multiplier.

mod dense;
mod factors;
mod propagation;

pub use dense::dense;
pub(crate) use dense::{cholesky, forward};
pub use factors::{by_factors, half_solved};
pub use propagation::{Articulated, by_propagation};
