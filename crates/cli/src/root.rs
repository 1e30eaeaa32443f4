//! Where the project's data stands.

use crate::fail::Fail;
use std::path::{Path, PathBuf};

/// The project's folders.
#[derive(Clone, Debug)]
pub struct Root(PathBuf);

impl Root {
    /// The nearest folder from here upwards that holds the suites, or the one that this program was built in.
    pub fn find() -> Result<Self, Fail> {
        let here = std::env::current_dir().map_err(|error| Fail::input(format!("the current folder cannot be read: {error}")))?;
        let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut candidates = here.ancestors().map(Path::to_owned).chain([built]);
        let found = candidates.find(|folder| folder.join("datasets/suites").is_dir() && folder.join("ci/gates.toml").is_file());
        found
            .map(Self)
            .ok_or_else(|| Fail::input("no featherbench project here: run from its folder (the one with datasets/ and ci/)".into()))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn suites(&self) -> PathBuf {
        self.0.join("datasets/suites")
    }

    pub fn models(&self) -> PathBuf {
        self.0.join("datasets/models")
    }

    pub fn recorded(&self) -> PathBuf {
        self.0.join("datasets/recorded")
    }

    /// Times night after night, a file per machine.
    pub fn history(&self) -> PathBuf {
        self.0.join("datasets/history")
    }

    pub fn gates(&self) -> PathBuf {
        self.0.join("ci")
    }

    /// How large the known deviations are on each robot.
    pub fn ranges(&self) -> PathBuf {
        self.gates().join("deviations")
    }

    pub fn reports(&self) -> PathBuf {
        self.0.join("reports")
    }

    pub fn oracles(&self) -> PathBuf {
        self.0.join("oracles")
    }

    /// The ledger of the engines' conventions.
    pub fn conventions(&self) -> PathBuf {
        self.oracles().join("conventions.toml")
    }

    /// Where the engines are installed.
    pub fn engines(&self) -> PathBuf {
        self.0.join("target/oracles")
    }

    /// Where the packages of MJCF robots are unpacked.
    pub fn packages(&self) -> PathBuf {
        self.engines().join("packages")
    }
}
