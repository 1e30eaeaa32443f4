//! The trait [`SceneEngine`]: an engine that simulates scenes of bodies in contact. Oracles offer it by the operation `scene`.

use crate::NoAnswer;
use featherbench_scenes::{Motion, Scene};

/// An engine that simulates scenes.
pub trait SceneEngine {
    /// Its variants, the usual one first: a contact model with a solver.
    fn scene_variants(&self) -> Vec<String>;

    /// The motion of a scene by `steps` steps of `dt` seconds, with a sample each `every` steps.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the variant or what the scene has, or fails.
    fn simulate(&self, scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Result<Motion, NoAnswer>;
}
