//! Rigid-body dynamics of trees: one file per algorithm.

mod aba;
mod bias;
mod center_of_mass;
mod crba;
mod energy;
mod error;
mod jacobian;
mod kinematics;
mod ltdl;
mod momentum;
mod rnea;
mod step;
mod tree_sparse;

pub use aba::{Aba, forward_dynamics};
pub use bias::{Bias, bias_force};
pub use center_of_mass::{CenterOfMass, MassCenter, center_of_mass};
pub use crba::{Crba, mass_matrix};
pub use energy::{Energies, Energy, energy};
pub use error::{DimensionError, Error, NotPositiveDefinite};
pub use jacobian::{Jacobian, jacobian};
pub use kinematics::{BodyMotion, Kinematics, forward_kinematics};
pub use ltdl::Ltdl;
pub use momentum::{CentroidalMomentum, Momentum, centroidal_momentum};
pub use rnea::{Rnea, inverse_dynamics};
pub use tree_sparse::TreeSparse;
