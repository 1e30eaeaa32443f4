//! The reference engines, as `oracles/engines.toml` describes them: package, version, licence, and how each is started.

use crate::{FileFormat, HarnessError, Lack};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// The engines of `oracles/engines.toml`, in the order of the file, which is the order of reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Engines(Vec<DescribedEngine>);

/// One engine. Unknown keys are errors.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DescribedEngine {
    /// The name in suites, rows and commands: the name of its table.
    #[serde(skip)]
    pub name: String,
    /// The name as its authors write it.
    pub title: String,
    /// What is installed. A native oracle has `of` instead.
    package: Option<Package>,
    /// The engine of whose installed package a native oracle is built.
    of: Option<String>,
    /// How its oracle is started.
    pub start: Start,
    /// What its build needs, in words.
    #[serde(default)]
    pub needs: Vec<String>,
    /// The formats that its own parser reads.
    #[serde(default)]
    pub reads: Vec<FileFormat>,
    /// Whether it writes files again.
    #[serde(default)]
    pub writes: bool,
    /// Whether tests ask it at night alone.
    #[serde(default)]
    pub night: bool,
    /// Whether its answers are kept in `datasets/recorded`.
    #[serde(default)]
    pub recorded: bool,
    /// How its own calls are timed. An engine without it is not timed.
    pub clock: Option<ClockKind>,
    /// What it does not offer.
    #[serde(default)]
    pub lacks: Vec<Lack>,
}

/// A package of an index: PyPI, or crates.io for an engine that cargo builds.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    /// The name on the index.
    pub name: String,
    /// The exact version.
    pub version: String,
    /// The day on which the index got that version, as `2026-01-31`.
    pub released: String,
    /// SPDX expression of the engine's licence.
    pub licence: String,
    /// The engine's home page.
    pub home: String,
}

/// How an engine's oracle is started.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Start {
    /// A module of the package `featherbench_oracles`, run by the engines' Python.
    Python {
        /// The module's name within the package.
        module: String,
    },
    /// A module of the package `featherbench_oracles`, run by a Python of its own with the packages of the file `requirements.txt` beside it.
    PythonAlone {
        /// The module's name within the package.
        module: String,
    },
    /// A program that cargo builds, in a workspace of its own.
    Cargo {
        /// The workspace: a folder in `oracles/`.
        folder: String,
        /// The name of the program.
        program: String,
    },
    /// A library that cargo builds, in a workspace of its own. It has the C interface of native oracles and is loaded in a child process.
    CargoLibrary {
        /// The workspace: a folder in `oracles/`.
        folder: String,
        /// The name of the library, without the system's prefix and suffix.
        library: String,
    },
    /// A library that CMake builds. It is loaded in a child process.
    Native(Library),
}

/// A native oracle's library.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Library {
    /// Its sources: a folder in `oracles/native/`.
    pub folder: String,
    /// CMake's name of the language: `C` or `CXX`.
    pub language: Language,
    /// Compilers, in the order in which they are looked for.
    pub compilers: Vec<String>,
    /// The installed distributions that it is compiled with, as their folders in `site-packages` begin.
    pub packages: Vec<String>,
    /// The folder of `site-packages` that it is linked from, if it is linked with an engine's library.
    pub linked: Option<String>,
}

/// The language of a native oracle, by CMake's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Language {
    /// C.
    C,
    /// C++.
    #[serde(rename = "CXX")]
    Cxx,
}

impl Language {
    /// CMake's name.
    pub fn cmake(self) -> &'static str {
        match self {
            Self::C => "C",
            Self::Cxx => "CXX",
        }
    }
}

/// How an engine's own calls are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockKind {
    /// The clock is read next to the engine's loop.
    Measures,
    /// The overhead of an interpreter is subtracted: the times are estimates.
    Estimates,
}

impl DescribedEngine {
    /// Whether its oracle is a Python module, in the environment that such engines share.
    pub fn is_python(&self) -> bool {
        matches!(self.start, Start::Python { .. })
    }

    /// Whether cargo builds it.
    pub fn is_compiled(&self) -> bool {
        matches!(self.start, Start::Cargo { .. } | Start::CargoLibrary { .. })
    }

    /// Whether it is a native oracle.
    pub fn is_native(&self) -> bool {
        matches!(self.start, Start::Native { .. })
    }
}

impl Engines {
    /// Reads `engines.toml`.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read(path: &Path) -> Result<Self, HarnessError> {
        let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
        Self::parse(&text, path)
    }

    /// The engines of a text; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and key.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let wrong = |message: String| HarnessError::Config { path: path.to_owned(), message };
        let tables: BTreeMap<String, Spanned<DescribedEngine>> = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let mut tables: Vec<_> = tables.into_iter().map(|(name, engine)| (engine.span().start, name, engine.into_inner())).collect();
        tables.sort_by_key(|(place, ..)| *place);
        let engines = Self(tables.into_iter().map(|(_, name, engine)| DescribedEngine { name, ..engine }).collect());
        engines.check().map_err(wrong)?;
        Ok(engines)
    }

    /// What no type says.
    fn check(&self) -> Result<(), String> {
        for engine in &self.0 {
            let wrong = |message: String| Err(format!("[{}]: {message}", engine.name));
            if engine.name == crate::OWN {
                return wrong("this is the name of our own kernels".into());
            }
            match (&engine.package, &engine.of) {
                (Some(_), None) if !engine.is_native() => {}
                (None, Some(of)) if engine.is_native() => {
                    if !self.0.iter().any(|other| other.name == *of && other.is_python()) {
                        return wrong(format!("of: there is no '{of}' whose start is of the kind python"));
                    }
                }
                _ => return wrong("give `of` for a start of the kind native, and `package` for any other".into()),
            }
            if let Some(Package { released, .. }) = &engine.package
                && !is_day(released)
            {
                return wrong(format!("released = \"{released}\" is no day as 2026-01-31"));
            }
            if let Start::Native(library) = &engine.start
                && (library.compilers.is_empty() || library.packages.is_empty())
            {
                return wrong("start: compilers and packages must not be empty".into());
            }
            for lack in &engine.lacks {
                lack.check().or_else(wrong)?;
            }
        }
        Ok(())
    }

    /// The engines, in the order of the file.
    pub fn iter(&self) -> impl Iterator<Item = &DescribedEngine> {
        self.0.iter()
    }

    /// The names of the engines for which `which` holds, in the order of the file.
    pub fn names(&self, which: impl Fn(&DescribedEngine) -> bool) -> Vec<&str> {
        self.0.iter().filter(|engine| which(engine)).map(|engine| engine.name.as_str()).collect()
    }

    /// The engine of a name.
    ///
    /// # Errors
    /// A sentence that names the engines that there are.
    pub fn get(&self, name: &str) -> Result<&DescribedEngine, String> {
        let found = self.0.iter().find(|engine| engine.name == name);
        found.ok_or_else(|| {
            let names = self.names(|_| true);
            let near = crate::did_you_mean(name, names.iter().copied());
            format!("there is no engine '{name}'{near}; oracles/engines.toml has {}", names.join(", "))
        })
    }

    /// The package of an engine; of a native oracle that of the engine which it is built of.
    pub fn package<'a>(&'a self, engine: &'a DescribedEngine) -> Option<&'a Package> {
        let of = || self.0.iter().find(|other| engine.of.as_ref() == Some(&other.name)).and_then(|other| other.package.as_ref());
        engine.package.as_ref().or_else(of)
    }

    /// The day on which a version of an engine was released; none but that of the described version is known.
    pub fn released(&self, name: &str, version: &str) -> Option<&str> {
        let package = self.package(self.0.iter().find(|engine| engine.name == name)?)?;
        (package.version == version).then_some(package.released.as_str())
    }

    /// What the engines do not offer, each with the engine's name and version.
    pub fn lacks(&self) -> Vec<Lack> {
        let of_engine = |engine: &DescribedEngine| -> Vec<Lack> {
            let version = self.package(engine).map_or("", |package| package.version.as_str());
            engine.lacks.iter().map(|lack| lack.clone().of(&engine.name, version)).collect()
        };
        self.0.iter().flat_map(of_engine).collect()
    }

    /// What the engines' Python environment must hold for them, as `NAME==VERSION`.
    pub fn pins(&self) -> Vec<String> {
        let packages = self.0.iter().filter(|engine| engine.is_python()).filter_map(|engine| engine.package.as_ref());
        packages.map(|package| format!("{}=={}", package.name, package.version)).collect()
    }
}

/// Whether a text is a year, a month and a day with all their digits.
fn is_day(text: &str) -> bool {
    let digits = |part: &str, count: usize| part.len() == count && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts: Vec<&str> = text.split('-').collect();
    matches!(parts[..], [year, month, day] if digits(year, 4) && digits(month, 2) && digits(day, 2))
}
