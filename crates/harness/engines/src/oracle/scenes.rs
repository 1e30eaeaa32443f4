//! Scenes, simulated by the engine behind an oracle: the operations `scene` and `scene_derivative`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, SceneEngine};
use featherbench_protocol::Message;
use featherbench_scenes::{Derivative, Motion, Scene, Variant};
use serde_json::{Value, json};

impl Oracle {
    fn about_scene(&self, scene: &Scene, question: Value) -> Result<Message, NoAnswer> {
        scene.check().map_err(|error| NoAnswer::Failed(error.to_string()))?;
        self.session()?.ask(question, Vec::new())
    }
}

impl SceneEngine for Oracle {
    fn scene_variants(&self) -> Vec<Variant> {
        self.hello.scenes()
    }

    fn simulate(&self, scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Result<Motion, NoAnswer> {
        motion(&self.about_scene(scene, question(scene, variant, dt, steps, every))?, scene.bodies.len(), steps / every.max(1))
    }

    fn derivative_variants(&self) -> Vec<Variant> {
        self.hello.scene_derivatives()
    }

    fn differentiate(&self, scene: &Scene, variant: &str, stiffness: f64, dt: f64, steps: usize) -> Result<Derivative, NoAnswer> {
        let question =
            json!({"op": "scene_derivative", "scene": scene, "variant": variant, "stiffness": stiffness, "dt": dt, "steps": steps});
        let answer = self.about_scene(scene, question)?;
        let [z, v] = numbers(&shaped(&answer, "state", &[2])?)?;
        let [a, b, c, d] = numbers(&shaped(&answer, "derivative", &[2, 2])?)?;
        Ok(Derivative { state: [z, v], matrix: [[a, b], [c, d]] })
    }
}

fn numbers<const N: usize>(found: &[f64]) -> Result<[f64; N], NoAnswer> {
    found.try_into().map_err(|_| NoAnswer::Failed(format!("{} numbers came, {N} are due", found.len())))
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
    Motion::new(bodies, numbers, &pushes).map_err(|error| NoAnswer::Failed(format!("the oracle's answer: {error}")))
}
