//! Scenes, simulated by the engine behind an oracle: the operations `scene` and `scene_derivative`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, SceneEngine};
use featherbench_protocol::Message;
use featherbench_scenes::{Derivative, Motion, Scene, Variant};
use serde_json::{Map, Value, json};

/// The part of `hello` about scenes.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Scenes {
    pub(crate) variants: Vec<Variant>,
    pub(crate) derivatives: Vec<Variant>,
}

impl Scenes {
    /// What the header of a `hello` offers.
    ///
    /// # Errors
    /// A sentence, when it is not what the protocol says.
    pub(crate) fn offered(hello: &Map<String, Value>) -> Result<Self, String> {
        let read = |key: &str| -> Result<Vec<Variant>, String> {
            let Some(value) = hello.get(key) else { return Ok(Vec::new()) };
            let wrong = || format!("`{key}` is no object: variant → object of settings");
            let object = value.as_object().ok_or_else(wrong)?;
            let variant = |(name, settings): (&String, &Value)| {
                let settings = settings.as_object().filter(|_| !name.is_empty()).ok_or_else(wrong)?;
                Ok(Variant { name: name.clone(), settings: settings.clone() })
            };
            object.iter().map(variant).collect()
        };
        Ok(Self { variants: read("scenes")?, derivatives: read("scene_derivatives")? })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.variants.is_empty() && self.derivatives.is_empty()
    }
}

impl Oracle {
    fn about_scene(&self, scene: &Scene, question: Value) -> Result<Message, NoAnswer> {
        scene.check().map_err(|error| NoAnswer::Failed(error.to_string()))?;
        let mut session = self.session()?;
        let answer = session.ask(question, Vec::new());
        self.give_back(session);
        answer
    }
}

impl SceneEngine for Oracle {
    fn scene_variants(&self) -> Vec<Variant> {
        self.scenes.variants.clone()
    }

    fn simulate(&self, scene: &Scene, variant: &str, dt: f64, steps: usize, every: usize) -> Result<Motion, NoAnswer> {
        motion(&self.about_scene(scene, question(scene, variant, dt, steps, every))?, scene.bodies.len(), steps / every.max(1))
    }

    fn derivative_variants(&self) -> Vec<Variant> {
        self.scenes.derivatives.clone()
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
