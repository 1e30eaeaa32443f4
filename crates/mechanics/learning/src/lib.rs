//! Models learned from motions: two that keep the structure of mechanics, and a black box beside them.
//!
//! | model | what is learned | fitted by | conserves an energy |
//! |---|---|---|---|
//! | [`Lagrangian`] | a net of one hidden layer: L(q) and V(q), with M = LLᵀ + εI | Levenberg–Marquardt | by its form, with M ≻ 0 everywhere |
//! | [`PortHamiltonian`] | polynomials M(q), V(q), and a damping D | ridge regression, D by projection | by its form |
//! | [`BlackBox`] | polynomials τ(q, v, a) and a(q, v, τ) | ridge regression | no |
//!
//! All learn from the same [`Sample`]s: a state, its acceleration and joint forces. [`Motion`] makes such samples from a known model along Fourier
//! trajectories, with noise. [`held_out`] and [`Rollout`] score them: torques of motions that were not learned from, and the energy over a long
//! motion without forces. [`Learned`] makes of each a residual beside a nominal model.
//!
//! ```
//! use featherbench_learning::{Arm, Degrees, Motion, PortHamiltonian, Truth, held_out};
//! use featherbench_model::Model;
//! let arm = Arm { masses: vec![2.0, 1.0], lengths: vec![1.0, 0.5], gravity: 9.81 };
//! let truth = Truth::new(Model::build(&arm.describe())?)?;
//! let motion = Motion { amplitude: 0.8, frequency: 0.8, harmonics: 5, trajectories: 2, samples: 50, noise: 0.0 };
//! let model = PortHamiltonian::fit(&motion.samples(&truth, 1, "learn")?, Degrees { total: 5, damping: false }, 1e-12)?;
//! assert!(held_out(&model, &motion.samples(&truth, 1, "held out")?)? < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Robots have one number of q per dof here (nq = nv). Units: SI. Torques are those of `τ = M a + h`, without friction unless D has it.

mod arm;
mod black_box;
mod chebyshev;
mod lagrangian;
mod learned;
mod motion;
mod port_hamiltonian;
mod ridge;
mod score;

pub use arm::Arm;
pub use black_box::BlackBox;
pub use chebyshev::{Chebyshev, Range};
pub use lagrangian::{Fit, Lagrangian, Net};
pub use learned::{Dynamics, Learned, Truth};
pub use motion::{Motion, Sample};
pub use port_hamiltonian::{Degrees, PortHamiltonian};
pub use score::{Escape, Rollout, held_out};

pub use featherbench_residuals::ResidualError;
