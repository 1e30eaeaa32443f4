//! Where the project's data stands.

use crate::fail::Fail;
use featherbench_bench::{Engines, Gates, HarnessError};
use std::path::{Path, PathBuf};

/// The environment's name for the project's folder.
pub const VARIABLE: &str = "FEATHERBENCH_ROOT";
/// The folder that this program was built in: the last place that is looked at.
const BUILT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The project's folders.
#[derive(Clone, Debug)]
pub struct Root(PathBuf);

impl Root {
    /// The folder that `--root` names, or the environment does; else the nearest one from here upwards that is a project, or the one that
    /// this program was built in.
    pub fn find(given: Option<&Path>) -> Result<Self, Fail> {
        let variable = std::env::var_os(VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
        let here = std::env::current_dir().map_err(|error| Fail::input(format!("the current folder cannot be read: {error}")))?;
        choose(given, variable.as_deref(), &here, Path::new(BUILT)).map(Self).map_err(Fail::input)
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

    /// Times recorded on several machines.
    pub fn speed(&self) -> PathBuf {
        self.0.join("datasets/speed")
    }

    pub fn gates(&self) -> PathBuf {
        self.0.join("ci")
    }

    /// How many cells and rows a complete run of each suite has.
    pub fn counts(&self) -> PathBuf {
        self.gates().join(featherbench_bench::COUNTS_NAME)
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

    /// What the reference engines are, and what they do not offer.
    pub fn described(&self) -> PathBuf {
        self.oracles().join("engines.toml")
    }

    /// Every threshold, known deviation and lack of an engine.
    pub fn read_gates(&self) -> Result<Gates, HarnessError> {
        Gates::read(&self.gates(), &Engines::read(&self.described())?)
    }

    /// Where the engines are installed.
    pub fn engines(&self) -> PathBuf {
        self.0.join("target/oracles")
    }

    /// Where the engine of a Cargo workspace in `oracles/` is built.
    pub fn built(&self, folder: &str) -> PathBuf {
        self.engines().join(folder)
    }

    /// Where the packages of MJCF robots are unpacked.
    pub fn packages(&self) -> PathBuf {
        self.engines().join("packages")
    }
}

/// Whether a folder holds what every command needs.
fn is_project(folder: &Path) -> bool {
    folder.join("datasets/suites").is_dir() && folder.join("ci/gates.toml").is_file()
}

/// The first of these that is a project's folder; one that was named must be.
fn choose(given: Option<&Path>, variable: Option<&Path>, here: &Path, built: &Path) -> Result<PathBuf, String> {
    if let Some((what, folder)) = given.map(|folder| ("--root", folder)).or_else(|| variable.map(|folder| (VARIABLE, folder))) {
        let folder = here.join(folder);
        let message = || format!("{what}: {} is no project's folder: it lacks datasets/suites or ci/gates.toml", folder.display());
        return if is_project(&folder) { Ok(folder) } else { Err(message()) };
    }
    let found = here.ancestors().find(|folder| is_project(folder)).map(Path::to_owned);
    let built_in = || built.canonicalize().ok().filter(|folder| is_project(folder));
    found.or_else(built_in).ok_or_else(|| {
        format!(
            "no featherbench project was found: {} and the folders above it are none, and the checkout that this program was built in is gone; \
             name one with --root DIR or {VARIABLE}=DIR, or run the command inside of one",
            here.display()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(folder: &Path) -> PathBuf {
        std::fs::create_dir_all(folder.join("datasets/suites")).unwrap();
        std::fs::create_dir_all(folder.join("ci")).unwrap();
        std::fs::write(folder.join("ci/gates.toml"), "").unwrap();
        folder.canonicalize().unwrap()
    }

    #[test]
    fn what_is_named_comes_before_what_is_near_and_that_before_what_was_built() {
        let all = tempfile::tempdir().unwrap();
        let [one, two, here, built] = ["one", "two", "here", "built"].map(|name| project(&all.path().join(name)));
        let inside = here.join("reports/deep");
        std::fs::create_dir_all(&inside).unwrap();
        let outside = all.path().canonicalize().unwrap();
        assert_eq!(choose(Some(&one), Some(&two), &inside, &built), Ok(one.clone()));
        assert_eq!(choose(Some(Path::new("one")), None, &outside, &built), Ok(one));
        assert_eq!(choose(None, Some(&two), &inside, &built), Ok(two));
        assert_eq!(choose(None, None, &inside, &built), Ok(here));
        assert_eq!(choose(None, None, &outside, &built), Ok(built.clone()));
        let wrong = choose(Some(&outside), None, &inside, &built).unwrap_err();
        assert!(wrong.contains("--root") && wrong.contains("ci/gates.toml"), "{wrong}");
        let wrong = choose(None, Some(Path::new("nowhere")), &inside, &built).unwrap_err();
        assert!(wrong.contains(VARIABLE) && wrong.contains("nowhere"), "{wrong}");
        // The build checkout is gone: nothing is guessed.
        std::fs::remove_dir_all(&built).unwrap();
        let gone = choose(None, None, &outside, &built).unwrap_err();
        assert!(gone.contains("--root DIR") && gone.contains(VARIABLE) && gone.contains("is gone"), "{gone}");
    }
}
