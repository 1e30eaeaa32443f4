//! Runs the command in a project of its own: a folder with links to the data and its own `target`.

#![allow(dead_code, reason = "two test programs compile this module, each uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The project's root.
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A temporary project: the real data, its own reports and engines.
pub struct Sandbox {
    pub folder: tempfile::TempDir,
}

impl Sandbox {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["datasets", "ci", "oracles"] {
            std::os::unix::fs::symlink(project().join(name), folder.path().join(name)).unwrap();
        }
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// The command, in this project.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
        command.args(arguments).current_dir(self.folder.path()).env("NO_COLOR", "1");
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Ended {
        Ended::new(self.command(arguments).output().unwrap())
    }
}

/// The result of a command.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub output: String,
    pub errors: String,
}

impl Ended {
    pub fn new(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Self { code: output.status.code(), output: text(output.stdout), errors: text(output.stderr) }
    }

    /// Asserts the exit code, words in the message (however its lines are wrapped), and that nothing panicked.
    pub fn expect(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert!(!self.errors.contains("panicked"), "{self:?}");
        assert!(!self.errors.contains('\u{1b}'), "NO_COLOR is honoured: {self:?}");
        let said: String = format!("{}{}", self.output, self.errors).chars().filter(|c| !c.is_whitespace()).collect();
        for word in words {
            let wanted: String = word.chars().filter(|c| !c.is_whitespace()).collect();
            assert!(said.contains(&wanted), "'{word}' is not in {self:?}");
        }
    }
}
