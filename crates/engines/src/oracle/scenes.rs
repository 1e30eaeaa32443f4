//! Scenes, simulated by the engine behind an oracle: the operation `scene`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, SceneEngine};
use featherbench_protocol::Message;
use featherbench_scenes::{Motion, Scene};
use serde_json::{Value, json};

impl SceneEngine for Oracle {
    fn scene_variants(&self) -> Vec<String> {
        self.scenes.clone()
    }

    fn simulate(&self, scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Result<Motion, NoAnswer> {
        scene.check().map_err(|error| NoAnswer::Failed(error.to_string()))?;
        let mut session = self.session()?;
        let answer = session.ask(question(scene, variant, dt, steps, every), Vec::new());
        self.give_back(session);
        motion(&answer?, scene.bodies.len(), steps / every.max(1))
    }
}

/// The question.
pub(crate) fn question(scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Value {
    json!({"op": "scene", "scene": scene, "variant": variant, "dt": dt, "steps": steps, "every": every})
}

/// The motion of an answer.
pub(crate) fn motion(answer: &Message, bodies: usize, samples: usize) -> Result<Motion, NoAnswer> {
    let numbers = shaped(answer, "motion", &[samples, bodies, 13])?;
    let contacts = answer.block("contacts").map_or(0, |block| block.shape.first().copied().unwrap_or(0));
    let pushes = shaped(answer, "contacts", &[contacts, 8])?;
    let settings = answer.header.get("settings").and_then(Value::as_object).cloned().unwrap_or_default();
    Motion::new(bodies, numbers, &pushes, settings).map_err(|error| NoAnswer::Failed(format!("the oracle's answer: {error}")))
}
