//! Scenes of rigid bodies in contact as data, their exact answers, and a step in time of ours.
//!
//! - [`Scene`] is what an engine gets: bodies with spheres and boxes over level ground, one coefficient of friction and of restitution.
//! - [`Motion`] is what it answers: where the bodies are over time, and the forces of the last step's contacts.
//! - [`systems`] has scenes whose answers are known. A [`Measure`] takes a motion to a number that has an exact value in rigid mechanics.
//! - [`simulate`] is a rigid step in time; the contact problem of each step goes to a [`StepSolver`], ours or an engine's.
//! - [`Fit`] tells the error that falls with the step from the bias that does not.
//!
//! Conventions: SI units, world axes, z up. The ground is z ≤ 0. A slope is level ground under gravity that is turned. Quaternions are (x, y,
//! z, w), body to world. A body's origin is its centre of mass and its axes are principal.
//!
//! ```
//! use featherbench_scenes::{OwnSolver, systems::Sliding, simulate};
//! let question = Sliding::default().question();
//! let motion = simulate(&question.scene, 2e-3, question.steps(2e-3), 5, &mut OwnSolver::sweeps())?;
//! for measure in &question.measures {
//!     assert!((measure.of(&motion) - measure.exact).abs() < 0.02 * measure.scale);
//! }
//! # Ok::<(), featherbench_scenes::SceneError>(())
//! ```

mod fit;
mod laws;
mod motion;
mod scene;
mod step;
pub mod systems;
mod touch;
mod variant;

pub use fit::Fit;
pub use laws::{SoftContact, block_step_felt};
pub use motion::{Motion, Push};
pub use scene::{Body, Geometry, Scene, SceneError, Shape};
pub use step::{OwnSolver, StepProblem, StepSolver, simulate};
pub use systems::{Measure, Question};
pub use touch::{Touch, touches};
pub use variant::{Derivative, Variant};
