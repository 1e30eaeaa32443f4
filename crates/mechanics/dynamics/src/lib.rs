//! Rigid-body dynamics of trees: one file per algorithm.
//!
//! Each algorithm has a workspace, made from a [`Topology`](featherbench_model::Topology). The workspace's `run` does not allocate. A
//! function beside it makes a workspace for one call.
//!
//! What begins with `Packed` computes one state in `f64`, several joints at a time. [`Batch`] computes many states at once. The other algorithms
//! are generic over two scalars: that of the state and that of the parameters. The same text runs on `f64`, `f32`, dual numbers, and counting and
//! extended-precision scalars. "The book" is R. Featherstone, *Rigid Body Dynamics Algorithms* (2008).
//!
//! ```
//! use featherbench_dynamics::{forward_dynamics, inverse_dynamics, mass_matrix};
//! use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
//!
//! // A pendulum: one kilogramme, half a metre below its axis.
//! let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
//! let bob = BodyDescription { name: "bob".into(), parent: None, mass: 1.0, com: [0.0, 0.0, -0.5], inertia: [0.0; 6], joint };
//! let pendulum = Description { gravity: [0.0, 0.0, -10.0], bodies: vec![bob], ..Description::default() };
//! let model: Model<f64> = Model::build(&pendulum)?;
//!
//! // Held out horizontally it needs m g l = 5 N·m, and let go it falls with g / l = 20 rad/s².
//! let q = [std::f64::consts::FRAC_PI_2];
//! let tau = inverse_dynamics(&model, &q, &[0.0], &[0.0])?;
//! assert!((tau[0] - 5.0).abs() < 1e-12);
//! assert_eq!(mass_matrix(&model, &q)?.get(0, 0), 0.25);
//! let a = forward_dynamics(&model, &q, &[0.0], &[0.0])?;
//! assert!((a[0] + 20.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Cost
//!
//! The hot kernels have a section *Cost*. It counts operations. An *operation* is an instruction that adds, multiplies, multiplies and adds, or
//! divides. It counts once, whether it has one number or a register of them. What was measured and what was tried stands in `docs/kernels/`, a
//! page per kernel.
//!
//! # Robots of a million joints
//!
//! All algorithms but those with a matrix are O(n) in time and memory. None calls itself for each joint, so depth is no limit. Bytes per revolute
//! joint on a chain, which a test counts (`tests/allocation.rs`):
//!
//! | [`Model`](featherbench_model::Model) | [`Rnea`] | [`Aba`] | [`Twisted`] | [`Kinematics`], [`Energy`] | [`Momentum`] | [`Refined`] |
//! |---|---|---|---|---|---|---|
//! | 353 | 144 | 424 | 424 on the tip side, 568 on the base side | 368 | 448 | 984 |
//!
//! So a chain of 10⁶ joints takes 809 MB for model, [`Aba`] and state (q, v, τ, v̇). A tree-sparse matrix has Σ d_k numbers, d_k the depth of
//! dof k: on a chain n (n + 1) / 2, on a binary tree of 2²⁰ − 1 joints 19·2²⁰ + 1.
//!
//! Times of one call: `docs/kernels/parallel.md`.

mod aba;
mod batch;
mod bias;
mod center_of_mass;
mod crba;
mod derivatives;
mod energy;
mod error;
mod floating_base;
mod instances;
pub mod integrate;
mod jacobian;
mod kinematics;
mod ltdl;
mod momentum;
mod packed;
mod parents;
mod refined;
mod rnea;
mod scaling;
mod step;
mod tree_sparse;
mod triangular;

pub use aba::{Aba, forward_dynamics};
pub use batch::{Batch, BatchError, Cause, Element, Failure, NoSuchWidth, Number, Sampled, Shared, Sharing, Width, to_lanes, to_rows};
pub use bias::{Bias, bias_force};
pub use center_of_mass::{CenterOfMass, MassCenter, center_of_mass};
pub use crba::{Crba, mass_matrix};
pub use derivatives::{
    Coriolis, FdDerivatives, FdHessian, FdPartials, FdSecondPartials, IdDerivatives, IdHessian, IdPartials, IdSecondPartials, JacobianRate,
    MomentumMatrix, PARAMETERS, ParameterSensitivity, Regressor, RegressorMatrix, TreePair, coriolis_matrix, fd_derivatives, fd_hessian,
    id_derivatives, id_hessian, inertial_parameters, jacobian_rate, mass_matrix_rate, momentum_matrix, torque_regressor,
};
pub use energy::{Energies, Energy, energy};
pub use error::{DimensionError, Error, NotPositiveDefinite};
pub use floating_base::{BaseBlocks, FloatingBase, NoFloatingBase, PartitionError};
#[doc(hidden)]
pub use instances::instances;
#[cfg(debug_assertions)]
#[doc(hidden)]
pub use instances::instances_of_tests;
pub use jacobian::{Jacobian, jacobian};
pub use kinematics::{BodyMotion, Kinematics, forward_kinematics};
pub use ltdl::Ltdl;
pub use momentum::{CentroidalMomentum, Momentum, centroidal_momentum};
pub use packed::{PackedAba, PackedCenterOfMass, PackedCrba, PackedJacobian, PackedKinematics, PackedModel, PackedMomentum, PackedRnea};
pub use parents::{NotATree, depth_first_order};
pub use refined::{Refined, refined_forward_dynamics};
pub use rnea::{Rnea, inverse_dynamics};
pub use scaling::{Division, ParallelAba, ParallelCrba, ParallelLtdl, ParallelRnea, Twisted};
pub use step::State;
pub use tree_sparse::TreeSparse;
