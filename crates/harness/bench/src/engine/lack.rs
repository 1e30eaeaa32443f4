//! What an engine does not offer: its rows are skips with a known cause, and no deviations.

use crate::RobotClass;
use featherbench_results::{Properties, Row, Verdict};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Something that an engine does not offer: a `[[NAME.lacks]]` of `oracles/engines.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Lack {
    /// The engine: the name of the table.
    #[serde(skip)]
    pub engine: String,
    /// The engine's version; another version may offer it.
    #[serde(skip)]
    pub version: String,
    /// The quantities, or all of them.
    pub quantities: Option<Vec<String>>,
    /// The states, or all of them.
    pub states: Option<Vec<String>>,
    /// The study, or all of them.
    pub study: Option<String>,
    /// Why it is not offered.
    pub reason: String,
    /// The robots.
    #[serde(flatten)]
    pub class: RobotClass,
    /// Keys that nothing above has taken.
    #[serde(flatten)]
    unknown: BTreeMap<String, toml::Value>,
}

impl Lack {
    /// The same of an engine and its version.
    pub fn of(self, engine: &str, version: &str) -> Self {
        Self { engine: engine.to_owned(), version: version.to_owned(), ..self }
    }

    /// What no type says.
    ///
    /// # Errors
    /// A sentence about the key or word that is wrong.
    pub fn check(&self) -> Result<(), String> {
        let lack = || format!("lacks '{}'", self.reason);
        if let Some(key) = self.unknown.keys().next() {
            return Err(format!("{}: unknown key '{key}'", lack()));
        }
        self.class.unknown_joint().map_or(Ok(()), |kind| Err(format!("{}: there is no kind of joint '{kind}'", lack())))
    }

    /// Whether it explains why a row is a skip.
    pub fn explains(&self, row: &Row, properties: Option<&Properties>) -> bool {
        row.verdict == Verdict::Skip && self.version == row.engine_version && self.concerns(row, properties)
    }

    /// Whether it is about the engine, robot, study, quantity and states of this row, for any version.
    pub(crate) fn concerns(&self, row: &Row, properties: Option<&Properties>) -> bool {
        self.engine == row.engine
            && self.study.as_ref().is_none_or(|study| *study == row.study)
            && among(&self.quantities, &row.quantity)
            && among(&self.states, &row.states)
            && self.class.holds(&row.robot, properties)
    }
}

/// Whether a name is in a list; no list stands for all names.
pub(crate) fn among(names: &Option<Vec<String>>, name: &String) -> bool {
    names.as_ref().is_none_or(|names| names.contains(name))
}
