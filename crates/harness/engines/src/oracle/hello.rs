//! The answer to `hello`: what an oracle is, and what it offers. `oracles/PROTOCOL.md` describes the fields.

use super::loops::Loops;
use super::residual::Offered;
use super::steps::Steps;
use featherbench_bench::StepMethod;
use featherbench_scenes::Variant;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Methods by quantity.
pub(crate) type Methods = BTreeMap<String, Vec<String>>;

/// The fields; what an oracle does not offer is empty.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Hello {
    pub(crate) engine: String,
    pub(crate) version: String,
    pub(crate) build: BTreeMap<String, String>,
    pub(crate) methods: Methods,
    /// `true` of an oracle that reads the clock beside its loop, "estimate" of one that subtracts its language's overhead too.
    clock: Value,
    /// The methods that an estimating clock times.
    pub(crate) timed: Methods,
    /// Whether it can relocate its data in memory.
    pub(crate) relocate: bool,
    /// Whether it writes files again.
    pub(crate) writes: bool,
    pub(crate) steps: Option<Steps>,
    pub(crate) loops: Option<Loops>,
    pub(crate) contact_solvers: Vec<String>,
    pub(crate) contact_relaxations: Vec<String>,
    /// Settings by method.
    contact_steps: BTreeMap<String, Value>,
    pub(crate) semidefinite_least_squares: Vec<String>,
    /// Elements of elastic rods.
    pub(crate) rods: Vec<String>,
    scenes: Variants,
    scene_derivatives: Variants,
    pub(crate) residual: Option<Offered>,
}

/// Settings by variant of the simulation of scenes.
type Variants = BTreeMap<String, Map<String, Value>>;

impl Hello {
    /// Reads the header of an answer.
    ///
    /// # Errors
    /// A sentence that names the field which is not what the protocol says.
    pub(crate) fn read(header: &Map<String, Value>) -> Result<Self, String> {
        let read: Result<Self, _> = serde_path_to_error::deserialize(Value::Object(header.clone()));
        read.map_err(|error| format!("{}: {}", error.path(), error.inner()))
    }

    /// What in it is not what the protocol says, though it can be read.
    ///
    /// # Errors
    /// A sentence that names the field.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.engine.is_empty() || self.version.is_empty() {
            return Err("engine and version must not be empty".into());
        }
        if let Some(steps) = &self.steps {
            if steps.methods.is_empty() || steps.methods.iter().any(String::is_empty) {
                return Err("`steps` have no method, or one without a name".into());
            }
            if steps.guard.is_some_and(|guard| guard.is_nan() || guard <= 0.0) {
                return Err("the guard of `steps` must be positive".into());
            }
        }
        if let Some(Loops { accelerations, motions }) = &self.loops {
            let mut methods = accelerations.iter().chain(motions).peekable();
            if methods.peek().is_none() || methods.any(String::is_empty) {
                return Err("`loops` have no method, or one without a name".into());
            }
        }
        let is_method = |name: &Value| name.as_str().is_some_and(|name| self.contact_steps.contains_key(name));
        if self.contact_steps.iter().any(|(name, step)| name.is_empty() || !step["time"].is_string() || !is_method(&step["limit"])) {
            return Err("`contact_steps` is no object: method → object of settings with `time` and `limit`, one of the methods".into());
        }
        for (key, variants) in [("scenes", &self.scenes), ("scene_derivatives", &self.scene_derivatives)] {
            if variants.contains_key("") {
                return Err(format!("`{key}` has a variant without a name"));
            }
        }
        Ok(())
    }

    /// The rounding of its arithmetic, over that of double precision.
    pub(crate) fn rounding(&self) -> f64 {
        let single = self.build.get("precision").is_some_and(|precision| precision == "single");
        if single { f64::from(f32::EPSILON) / f64::EPSILON } else { 1.0 }
    }

    /// Whether its times are estimates.
    pub(crate) fn estimates(&self) -> bool {
        self.clock == "estimate"
    }

    /// Whether it measures times itself; otherwise they are those of the whole request and answer.
    pub(crate) fn has_clock(&self) -> bool {
        self.clock == true || self.estimates()
    }

    /// Methods for steps of a robot on its contacts.
    pub(crate) fn contact_steps(&self) -> Vec<StepMethod> {
        self.contact_steps.iter().map(|(name, settings)| StepMethod { name: name.clone(), settings: settings.clone() }).collect()
    }

    /// Whether it solves problems that need no robot, or has a residual.
    pub(crate) fn solves_problems(&self) -> bool {
        let lists = [&self.contact_solvers, &self.contact_relaxations, &self.semidefinite_least_squares, &self.rods];
        lists.iter().any(|names| !names.is_empty()) || self.has_scenes() || self.residual.is_some()
    }

    /// Whether it solves contact problems.
    pub(crate) fn solves_contacts(&self) -> bool {
        !(self.contact_solvers.is_empty() && self.contact_relaxations.is_empty() && self.contact_steps.is_empty())
    }

    /// Variants of the simulation of scenes.
    pub(crate) fn scenes(&self) -> Vec<Variant> {
        variants(&self.scenes)
    }

    /// Variants of their derivatives.
    pub(crate) fn scene_derivatives(&self) -> Vec<Variant> {
        variants(&self.scene_derivatives)
    }

    /// Whether it moves scenes.
    pub(crate) fn has_scenes(&self) -> bool {
        !(self.scenes.is_empty() && self.scene_derivatives.is_empty())
    }
}

fn variants(variants: &Variants) -> Vec<Variant> {
    variants.iter().map(|(name, settings)| Variant { name: name.clone(), settings: settings.clone() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn an_offer_names_its_time_and_its_limit() {
        let read = |steps: &Value| {
            let header = json!({"engine": "e", "version": "1", "contact_steps": steps});
            Hello::read(header.as_object().unwrap()).and_then(|hello| hello.check().map(|()| hello))
        };
        let good = json!({"newton": {"time": "all", "limit": "newton"}, "sweeps": {"time": "all", "limit": "newton", "impedance": 0.9}});
        let offered = read(&good).unwrap().contact_steps();
        assert_eq!(offered.iter().map(|method| method.name.as_str()).collect::<Vec<_>>(), ["newton", "sweeps"]);
        assert_eq!(offered[1].settings["impedance"], 0.9);
        for wrong in [
            json!(["newton"]),
            json!({"newton": 1}),
            json!({"newton": {"limit": "newton"}}),
            json!({"newton": {"time": "all"}}),
            json!({"newton": {"time": "all", "limit": "other"}}),
            json!({"": {"time": "all", "limit": ""}}),
        ] {
            assert!(read(&wrong).unwrap_err().contains("contact_steps"), "{wrong}");
        }
    }
}
