//! The trait [`SceneEngine`]: an engine that simulates scenes of bodies in contact. Oracles offer it by the operations `scene` and
//! `scene_derivative`.

use crate::NoAnswer;
use featherbench_scenes::{Derivative, Motion, Scene, Variant};

/// An engine that simulates scenes.
pub trait SceneEngine {
    /// Its variants: contact models with solvers.
    fn scene_variants(&self) -> Vec<Variant>;

    /// The motion of a scene by `steps` steps of `dt` seconds, with a sample each `every` steps.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the variant or what the scene has, or fails.
    fn simulate(&self, scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Result<Motion, NoAnswer>;

    /// The ways in which it differentiates a motion.
    fn derivative_variants(&self) -> Vec<Variant>;

    /// The derivative of the vertical motion of a scene's one body through its contacts, which are springs of this stiffness in N/m without
    /// damping.
    ///
    /// # Errors
    /// As of [`SceneEngine::simulate`].
    fn differentiate(&self, scene: &Scene, variant: &str, stiffness: f64, dt: f64, steps: usize) -> Result<Derivative, NoAnswer>;
}
