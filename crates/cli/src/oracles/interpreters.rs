//! The Python interpreters of which an environment can be made, the newest first.
//!
//! An interpreter is CPython 3.11 or later, a release, with `venv` and `ensurepip`. Programs that may be one:
//!
//! - `python3` and `python3.N` in the folders of the path;
//! - the same among pyenv's versions;
//! - those that uv knows, and where uv is installed also those that it can fetch.
//!
//! Of each minor version there is one: the newest, and of equals the first that is found.

use serde::Deserialize;
use std::cmp::Reverse;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;

/// The oldest minor version of Python 3 for which the oracles are written (`requires-python` in `oracles/pyproject.toml`).
const OLDEST: u32 = 11;

/// What a program is asked: its version, and that it has what an environment is made by.
const ASKED: &str = "import sys, venv, ensurepip; print(*sys.version_info[:4], sys.implementation.name)";

/// An interpreter that environments can be made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interpreter {
    /// Major, minor and micro version.
    pub version: [u32; 3],
    /// Its program; of one that uv is to fetch, its version.
    pub name: OsString,
}

impl Interpreter {
    /// What a program says of itself; none if it is no interpreter of ours, or does not start.
    pub fn of(program: OsString) -> Option<Self> {
        let output = Command::new(&program).args(["-c", ASKED]).output().ok().filter(|output| output.status.success())?;
        let told = String::from_utf8(output.stdout).ok()?;
        let words: Vec<&str> = told.split_whitespace().collect();
        let &[major, minor, micro, "final", "cpython"] = words.as_slice() else { return None };
        Some(Self { version: version([major, minor, micro])?, name: program })
    }

    /// Its version, as it is written.
    pub fn told(&self) -> String {
        self.version.map(|part| part.to_string()).join(".")
    }
}

/// The interpreters of this machine, and with uv those that it can fetch.
pub fn found(uv: bool) -> Vec<Interpreter> {
    let mut found: Vec<Interpreter> = programs().into_iter().filter_map(|program| Interpreter::of(program.into())).collect();
    if uv {
        found.extend(of_uv());
    }
    newest_first(found)
}

/// One of each minor version.
fn newest_first(mut found: Vec<Interpreter>) -> Vec<Interpreter> {
    found.retain(|one| one.version[0] == 3 && one.version[1] >= OLDEST);
    found.sort_by_key(|one| Reverse(one.version));
    found.dedup_by_key(|one| one.version[1]);
    found
}

/// Programs that may be interpreters.
fn programs() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = std::env::var_os("PATH").map(|path| std::env::split_paths(&path).collect()).unwrap_or_default();
    let pyenv = std::env::var_os("PYENV_ROOT").map(PathBuf::from);
    let pyenv = pyenv.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".pyenv")));
    let versions = pyenv.and_then(|pyenv| std::fs::read_dir(pyenv.join("versions")).ok());
    folders.extend(versions.into_iter().flatten().filter_map(Result::ok).map(|version| version.path().join("bin")));
    let entries = folders.into_iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().filter_map(Result::ok);
    entries.map(|entry| entry.path()).filter(|path| path.file_name().is_some_and(may_be_one)).collect()
}

/// Whether a file is called `python3` or `python3.N`, N at least [`OLDEST`].
fn may_be_one(name: &OsStr) -> bool {
    let Some(rest) = name.to_str().and_then(|name| name.strip_prefix("python3")) else { return false };
    rest.is_empty() || rest.strip_prefix('.').and_then(|minor| minor.parse().ok()).is_some_and(|minor: u32| minor >= OLDEST)
}

/// The version of three numbers as they are written.
fn version(parts: [&str; 3]) -> Option<[u32; 3]> {
    let [major, minor, micro] = parts.map(|part| part.parse().ok());
    Some([major?, minor?, micro?])
}

/// A line of uv's list.
#[derive(Deserialize)]
struct Listed {
    version: String,
    path: Option<String>,
    implementation: String,
    variant: Option<String>,
}

/// The interpreters that uv knows, or can fetch; none of a uv that does not tell them.
fn of_uv() -> Vec<Interpreter> {
    let output = Command::new("uv").args(["python", "list", "--output-format", "json"]).output();
    let listed: Vec<Listed> = output.ok().and_then(|output| serde_json::from_slice(&output.stdout).ok()).unwrap_or_default();
    listed.into_iter().filter_map(Listed::interpreter).collect()
}

impl Listed {
    fn interpreter(self) -> Option<Interpreter> {
        if self.implementation != "cpython" || self.variant.is_some_and(|variant| variant != "default") {
            return None;
        }
        let parts: Vec<&str> = self.version.split('.').collect();
        // A version that is no release ends with letters.
        let version = version(parts.try_into().ok()?)?;
        Some(Interpreter { version, name: self.path.unwrap_or(self.version).into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_of_each_minor_version_comes_first() {
        let one = |version, name: &str| Interpreter { version, name: name.into() };
        let found = [
            one([3, 11, 7], "/a"),
            one([3, 9, 1], "/b"),
            one([3, 13, 0], "/c"),
            one([3, 11, 9], "/d"),
            one([3, 13, 0], "/e"),
            one([2, 19, 0], "/f"),
        ];
        assert_eq!(newest_first(found.into()), [one([3, 13, 0], "/c"), one([3, 11, 9], "/d")]);
    }

    #[test]
    fn uv_lists_releases_that_are_there_or_can_be_fetched() {
        let text = r#"[{"version":"3.16.0a2","path":null,"implementation":"cpython","variant":"default"},
            {"version":"3.15.2","path":null,"implementation":"cpython","variant":"freethreaded"},
            {"version":"3.14.1","path":null,"implementation":"cpython","variant":"default"},
            {"version":"3.12.1","path":"/a/python3.12","implementation":"cpython"},
            {"version":"3.11.1","path":"/a/pypy","implementation":"pypy"}]"#;
        let listed: Vec<Listed> = serde_json::from_str(text).unwrap();
        let names: Vec<OsString> = listed.into_iter().filter_map(Listed::interpreter).map(|one| one.name).collect();
        assert_eq!(names, ["3.14.1", "/a/python3.12"]);
    }

    #[test]
    fn programs_are_called_as_an_interpreter_is() {
        for (name, due) in [("python3", true), ("python3.11", true), ("python3.10", false), ("python3-config", false), ("python", false)] {
            assert_eq!(may_be_one(OsStr::new(name)), due, "{name}");
        }
    }
}
