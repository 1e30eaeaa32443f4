//! Engines that a user brings along: `--engine NAME=PROGRAM`.

use crate::fail::Fail;
use crate::oracles::package;
use crate::root::Root;
use ::featherbench_results::{quoted, words};
use featherbench_bench::{HarnessError, hash};
use featherbench_engines::{Limits, Oracle};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A program to be asked under a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct External {
    pub name: String,
    pub command: Vec<OsString>,
}

impl FromStr for External {
    type Err = String;

    /// Reads `NAME=PROGRAM ARGS…`: words are split at blanks, quotes of either kind keep blanks in a word.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, command) = text.split_once('=').ok_or("write NAME=PROGRAM, as in mine=./my_oracle")?;
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if name.is_empty() || !name.chars().all(plain) {
            return Err(format!("'{name}' is no name: use letters, digits, '_', '-' and '.'"));
        }
        let command: Vec<OsString> = words(command)?.into_iter().map(OsString::from).collect();
        if command.is_empty() {
            return Err(format!("engine {name} has no program"));
        }
        Ok(Self { name: name.to_owned(), command })
    }
}

impl std::fmt::Display for External {
    /// Writes it as it is read.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.name, shown(&self.command))
    }
}

/// The file of a program; one that is not there is refused before anything is started.
pub fn find(command: &[OsString]) -> Result<PathBuf, Fail> {
    let Some(program) = command.first() else { return Err(Fail::input("no program is named".into())) };
    let there = if Path::new(program).components().count() > 1 {
        Some(PathBuf::from(program))
    } else {
        std::env::var_os("PATH")
            .and_then(|path| std::env::split_paths(&path).map(|folder| folder.join(program)).find(|file| file.is_file()))
    };
    let advice = "name a program on the path, or a file with its folder, as in ./my_oracle";
    let absent = || Fail::input(format!("there is no program {}; {advice}", program.to_string_lossy()));
    there.filter(|file| file.is_file()).ok_or_else(absent)
}

impl External {
    /// Starts the program, to be known by the name that the user gave it.
    pub fn start(&self, root: &Root, limits: Limits) -> Result<Oracle, Fail> {
        let program = self.program(root)?;
        let command = package::reachable(root, &self.command).map_err(Fail::input)?;
        let oracle = Oracle::start(command, limits).map_err(|reason| Fail::Missing {
            message: format!("engine {} does not answer: {reason}", self.name),
            advice: format!("look at `featherbench oracles check {}`", shown(&self.command)),
        })?;
        Ok(oracle.named(&self.name).with_program(&program))
    }

    /// The content hash of the command. It covers the program's file, the files that its arguments name, and the other arguments as they
    /// are. A script is the argument of its interpreter; a module of `python -m` is its package. What these files load in their turn is not
    /// in it.
    fn program(&self, root: &Root) -> Result<String, Fail> {
        let read = |path: &Path| std::fs::read(path).map_err(|source| Fail::from(HarnessError::io(path, source)));
        let mut parts = vec![read(&find(&self.command)?)?];
        for pair in self.command.windows(2) {
            let [before, word] = pair else { continue };
            let file = Path::new(word);
            parts.push(if file.is_file() { read(file)? } else { word.as_encoded_bytes().to_vec() });
            if before == "-m" {
                for source in package::sources(root, word) {
                    parts.push(read(&source)?);
                }
            }
        }
        Ok(hash::of_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    }
}

/// Refuses names that are taken, by another external too.
pub fn check_names(externals: &[External], taken: &[&str]) -> Result<(), Fail> {
    for (k, external) in externals.iter().enumerate() {
        if taken.contains(&external.name.as_str()) || externals[..k].iter().any(|other| other.name == external.name) {
            let message = format!("--engine: the name '{}' is taken; taken are {}", external.name, taken.join(", "));
            return Err(Fail::input(message));
        }
    }
    Ok(())
}

fn shown(command: &[OsString]) -> String {
    command.iter().map(|word| quoted(&word.to_string_lossy())).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_split_at_blanks_and_kept_by_quotes() {
        let external: External = "mine=python3  'my oracle.py' --x=\"a 'b'\" ''".parse().unwrap();
        assert_eq!(
            (external.name.as_str(), external.command),
            ("mine", ["python3", "my oracle.py", "--x=a 'b'", ""].map(OsString::from).to_vec())
        );
        for bad in ["mine", "=x", "my engine=x", "a/b=x", "mine=", "mine=  ", "mine='x"] {
            assert!(bad.parse::<External>().is_err(), "{bad}");
        }
    }
    #[test]
    fn a_program_is_its_files_and_its_other_arguments() {
        let folder = tempfile::tempdir().unwrap();
        let (script, copy) = (folder.path().join("a.sh"), folder.path().join("b.sh"));
        let root = Root::find(None).ok().unwrap();
        for file in [&script, &copy] {
            std::fs::write(file, "exit 1").unwrap();
        }
        let program = |file: &Path, rest: &str| {
            let command = ["sh".into(), file.into(), rest.into()].to_vec();
            External { name: "mine".into(), command }.program(&root).ok().unwrap()
        };
        let first = program(&script, "--fast");
        assert_eq!(program(&copy, "--fast"), first, "where it stands does not matter");
        assert_ne!(program(&script, "--slow"), first);
        std::fs::write(&script, "exit 2").unwrap();
        assert_ne!(program(&script, "--fast"), first);
    }

    /// `python -m package.module` runs sources that no argument names as files.
    #[test]
    fn a_module_is_the_sources_of_its_package() {
        let root = Root::find(None).ok().unwrap();
        let sources = package::sources(&root, "featherbench_oracles.mujoco".as_ref());
        for file in ["core/session.py", "mujoco/oracle.py"] {
            assert!(sources.contains(&root.oracles().join("featherbench_oracles").join(file)), "{file}");
        }
        assert_eq!(package::sources(&root, "no_such_package.mujoco".as_ref()), Vec::<PathBuf>::new());
        let program = |words: &[&str]| {
            let command = words.iter().map(OsString::from).collect();
            External { name: "mine".into(), command }.program(&root).ok().unwrap()
        };
        assert_ne!(program(&["sh", "-m", "featherbench_oracles.mujoco"]), program(&["sh", "-x", "featherbench_oracles.mujoco"]));
    }
}
