//! Slow, independent truth for the dynamics of trees of rigid bodies.
//!
//! Four methods for the same numbers. None shares text or formulation with the kernels of `crates/mechanics/dynamics`:
//! - [`Robot`] and [`Motion`]: Newton–Euler equations of every body projected by explicit Jacobians, in multi-precision;
//! - [`maximal`]: bodies and constraints in maximal coordinates, one saddle-point system;
//! - [`lagrange`]: the Lagrangian of positions alone, differentiated by nested dual numbers;
//! - [`closed`]: closed forms of pendulums and tops.
//!
//! A fifth, in Python with 4×4 matrices, is `oracles/featherbench_oracles/truth/`.
//!
//! ```
//! use featherbench_reference::{Precision, Robot, nearest_doubles};
//! use featherbench_robots::Family;
//!
//! let description = Family::parse("chain:n=3,layout=spatial")?.generate()?;
//! let robot = Robot::new(&description, Precision::STANDARD)?;
//! let (q, v, tau) = ([0.1, -0.2, 0.3], [1.0, 2.0, 3.0], [0.5, 0.25, 0.125]);
//! let truth = robot.forward_dynamics(&q, &v, &tau)?;
//! let back = robot.moving(&q, &v)?.inverse_dynamics(&truth)?;
//! assert_eq!(nearest_doubles(&back), tau);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod closed;
mod decimal;
mod error;
pub mod lagrange;
mod linear;
pub mod maximal;
mod motion;
mod newton_euler;
mod number;
mod robot;
mod scalar;
mod space;

pub use error::Error;
pub use linear::{Factors, Matrix};
pub use motion::Motion;
pub use number::{Mp, Precision, nearest_doubles};
pub use robot::Robot;
