//! Derivatives of the dynamics: one file per algorithm.
//!
//! Derivatives by q are on the tangent space of the configurations: dof j moves as the velocity `v = e_j` moves it. So a quaternion joint has
//! three columns, in body axes, and every matrix here is `nv`×`nv`. The numbers in v, a and τ stay as they are while q moves.

mod articulated;
mod columns;
mod coriolis;
mod fd;
mod fd_hessian;
mod id;
mod id_hessian;
mod jacobian_rate;
mod momentum_matrix;
mod parameter_sensitivity;
mod parameters;
mod regressor;
mod response;
mod solve;
mod sweep;
mod tree_pair;

pub use coriolis::{Coriolis, coriolis_matrix, mass_matrix_rate};
pub use fd::{FdDerivatives, FdPartials, fd_derivatives};
pub use fd_hessian::{FdHessian, FdSecondPartials, fd_hessian};
pub use id::{IdDerivatives, IdPartials, id_derivatives};
pub use id_hessian::{IdHessian, IdSecondPartials, id_hessian};
pub use jacobian_rate::{JacobianRate, jacobian_rate};
pub use momentum_matrix::{MomentumMatrix, momentum_matrix};
pub use parameter_sensitivity::ParameterSensitivity;
pub use parameters::{PARAMETERS, inertial_parameters};
pub use regressor::{Regressor, RegressorMatrix, torque_regressor};
pub use tree_pair::TreePair;
