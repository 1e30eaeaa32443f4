//! Suites: the contents of a run.
//!
//! A suite file has its own keys, and one table for each study that it asks for. The study reads its table itself, by [`Suite::settings`].

pub(crate) mod draw;
pub(crate) mod entry;

use crate::{Draw, HarnessError, RobotEntry};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue, ValueDeserializer};

/// A suite file, `datasets/suites/NAME.toml`. Unknown keys are errors; a table of an unknown name is one when the studies are made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Suite {
    /// The purpose of the suite, one sentence.
    pub about: String,
    /// Seed of every state.
    pub seed: u64,
    /// States of each robot that does not say otherwise.
    pub states: usize,
    /// The engines beside ours; `None` if the suite asks no engine for answers.
    pub engines: Option<Vec<String>>,
    /// Whether the suite can show every known deviation of its robots, and a sharp bound for each method, joint and base. A complete run
    /// must then show them.
    pub thorough: bool,
    /// The robots.
    pub robots: Vec<RobotEntry>,
    /// The robots that it draws beside these.
    pub draw: Option<Draw>,
    /// The names of its tables in alphabetical order, each that of a study.
    pub studies: Vec<String>,
    text: String,
    path: PathBuf,
}

/// The keys of a suite file that belong to no study.
#[derive(Deserialize)]
struct Keys {
    about: String,
    seed: u64,
    states: Option<usize>,
    engines: Option<Vec<String>>,
    #[serde(default)]
    thorough: bool,
    #[serde(default)]
    robot: Vec<RobotEntry>,
    draw: Option<Draw>,
}

/// Their names.
const KEYS: [&str; 7] = ["about", "seed", "states", "engines", "thorough", "robot", "draw"];

/// The table of a study without settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoSettings {}

impl Suite {
    /// Reads a suite file, with the hash of its text.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read(path: &Path) -> Result<(Self, String), HarnessError> {
        let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
        Ok((Self::parse(&text, path)?, crate::hash::of(text.as_bytes())))
    }

    /// The suite of a text; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let wrong = |message: String| HarnessError::Config { path: path.to_owned(), message };
        let Keys { about, seed, states, engines, thorough, robot: robots, draw } =
            toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let mut studies = Vec::new();
        for (key, value) in document(text, path)?.iter().filter(|(key, _)| !KEYS.contains(&key.get_ref().as_ref())) {
            let name: &str = key.get_ref().as_ref();
            if !value.get_ref().is_table() {
                let line = text[..key.span().start].matches('\n').count() + 1;
                return Err(wrong(format!(
                    "line {line}: unknown key '{name}'; a suite has {}, and a table for each study",
                    KEYS.join(", ")
                )));
            }
            studies.push(name.to_owned());
        }
        if let Some(complaint) = robots.iter().find_map(RobotEntry::complaint) {
            return Err(wrong(complaint));
        }
        if let Some(complaint) = draw.as_ref().and_then(Draw::complaint) {
            return Err(wrong(complaint));
        }
        let states = states.unwrap_or(1);
        Ok(Self { about, seed, states, engines, thorough, robots, draw, studies, text: text.into(), path: path.into() })
    }

    /// The suite's file, as errors name it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The same suite with another number of drawn robots.
    ///
    /// # Errors
    /// [`HarnessError`] when it draws none.
    pub fn with_size(mut self, size: usize) -> Result<Self, HarnessError> {
        match &mut self.draw {
            Some(draw) => draw.size = size,
            None => return Err(self.wrong("--size is for suites with a table [draw], as sweep has it".into())),
        }
        Ok(self)
    }

    /// The engines beside ours.
    pub fn engines(&self) -> &[String] {
        self.engines.as_deref().unwrap_or_default()
    }

    /// The table of a study, if the suite has it.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn settings<T: DeserializeOwned>(&self, study: &str) -> Result<Option<T>, HarnessError> {
        let table = document(&self.text, &self.path)?.into_iter().find(|(key, _)| key.get_ref() == study);
        let read = |value: toml::Spanned<DeValue<'_>>| {
            T::deserialize(ValueDeserializer::from(value)).map_err(|mut error| {
                error.set_input(Some(&self.text));
                self.wrong(format!("[{study}]: {error}"))
            })
        };
        table.map(|(_, value)| read(value)).transpose()
    }

    /// Checks that each of its tables, and each study that a robot names, is one of these studies.
    ///
    /// # Errors
    /// [`HarnessError`], with the names that there are.
    pub fn check_studies(&self, known: &[&str]) -> Result<(), HarnessError> {
        let of_robots = self.robots.iter().flat_map(|robot| robot.studies.iter().flatten());
        match self.studies.iter().chain(of_robots).find(|name| !known.contains(&name.as_str())) {
            Some(name) => {
                let near = crate::did_you_mean(name, known.iter().copied());
                Err(self.wrong(format!("there is no study '{name}'{near}; there are {}", known.join(", "))))
            }
            None => Ok(()),
        }
    }

    fn wrong(&self, message: String) -> HarnessError {
        HarnessError::Config { path: self.path.clone(), message }
    }
}

/// The tables and keys of a suite's text, in alphabetical order.
fn document<'a>(text: &'a str, path: &Path) -> Result<DeTable<'a>, HarnessError> {
    let wrong = |error: toml::de::Error| HarnessError::Config { path: path.to_owned(), message: error.to_string() };
    Ok(DeTable::parse(text).map_err(wrong)?.into_inner())
}
