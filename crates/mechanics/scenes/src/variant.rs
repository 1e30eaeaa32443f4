//! What engines offer, and the derivative of a bounce.

use serde_json::{Map, Value};

/// A contact model with its solver, as an engine offers it.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// The engine's own parameters, for rows: contact model, integrator, tolerances.
    pub settings: Map<String, Value>,
}

impl Variant {
    /// A variant whose settings are words.
    pub fn new(name: &str, settings: &[(&str, &str)]) -> Self {
        let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), Value::from(*value))).collect();
        Self { name: name.into(), settings }
    }
}

/// The derivative of a body's height and vertical velocity at the end by both at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivative {
    /// z and ż at the end, m and m/s.
    pub state: [f64; 2],
    /// ∂(z, ż)(T)/∂(z, ż)(0): rows are those of the end.
    pub matrix: [[f64; 2]; 2],
}
