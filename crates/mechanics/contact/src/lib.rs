//! Contact problems as data, their solvers, and impact laws by name.
//!
//! - [`Problem`] is a contact problem: a Delassus matrix or a mechanism, the free velocity, and a law per contact. [`mod@file`] reads and
//!   writes it as JSON.
//! - [`Solver`] is one trait for all solvers. Each [`Solution`] says what is known: converged, a cap was reached, no solution exists (with a
//!   proof), several exist (with them), or undecided.
//! - [`Residuals`] measure how far any impulses are from the governing equations.
//! - [`impact`] has the impact laws of Newton, Poisson, Stronge and Moreau, and sequences of simultaneous impacts.
//! - [`Grounded`] is a robot over level ground: its contact problem at a state, and one step in time.
//! - [`systems`] has problems with known answers; [`rate`] predicts and fits how fast first-order methods converge.
//!
//! Conventions: SI units. Each contact has its own frame; its rows are the normal first, then one or two tangents. A positive normal
//! velocity separates, a positive normal impulse pushes. Impulses act on the body whose velocity counts positive.
//!
//! ```
//! use featherbench_contact::{Contact, Level, Problem, Solver, solver};
//! use nalgebra::{DMatrix, DVector};
//! let contacts = vec![Contact::planar("tip", 0.5)];
//! let problem = Problem::from_delassus("point", Level::Impulse, contacts, DMatrix::from_row_slice(2, 2, &[0.5, 0.0, 0.0, 0.5]), DVector::from_vec(vec![-3.0, 4.0]))?;
//! for solver in solver::all() {
//!     let solution = solver.solve(&problem)?;
//!     println!("{}: {} after {}", solver.name(), solution.status(), solution.iterations);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ball;
mod cones;
mod extended;
mod farkas;
pub mod file;
mod grounded;
pub mod impact;
mod malformed;
mod problem;
pub mod rate;
mod residual;
mod solution;
pub mod solver;
pub mod systems;

pub use grounded::{Grounded, GroundedError, Stepped, Touch};
pub use malformed::{Defect, Malformed};
pub use problem::{Contact, Friction, Level, Mechanism, Problem, Scales};
pub use residual::Residuals;
pub use solution::{Certificate, Outcome, Point, Solution};
pub use solver::{Admm, BlockGaussSeidel, Convex, Enumeration, GaussSeidel, Lcp, Lemke, Newton, Penalty, Solver, Unsupported};
