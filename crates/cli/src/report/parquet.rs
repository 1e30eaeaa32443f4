//! Parquet, by a program of its own: `featherbench-parquet`, of `crates/harness/parquet`. It is built when it is first asked for, so that who never asks for
//! Parquet never compiles it.

use crate::fail::Fail;
use crate::oracles::compiled::cargo_build;
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;

/// The program, and its package.
const NAME: &str = "featherbench-parquet";
/// The checkout that this program was built in.
const CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
/// The sources of the program, in the checkout.
const SOURCES: [&str; 2] = ["crates/harness/parquet/src", "crates/harness/results/src"];
/// What the program's errors begin with.
const ERROR: &str = "error: ";
/// How this program was compiled: cargo's name of the folder. The other is compiled alike.
const PROFILE: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

/// Writes the rows of a run as Parquet into a folder, and returns what is to be said: the files, and the number of rows.
pub fn rows(run: &Path, folder: &Path) -> Result<String, Fail> {
    ask(&["rows".as_ref(), run.as_os_str(), folder.as_os_str()])
}

/// The table of a Parquet file as CSV.
pub fn table(file: &Path) -> Result<String, Fail> {
    ask(&["table".as_ref(), file.as_os_str()])
}

/// Runs the program, which is built if need be.
fn ask(arguments: &[&OsStr]) -> Result<String, Fail> {
    let program = program().map_err(missing)?;
    let output = Command::new(&program).args(arguments).stdin(Stdio::null()).output();
    let output = output.map_err(|error| missing(format!("{} cannot be started: {error}", program.display())))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let errors = text(&output.stderr);
    match output.status.code() {
        Some(0) => Ok(text(&output.stdout)),
        Some(2) => Err(Fail::input(errors.strip_prefix(ERROR).unwrap_or(&errors).trim_end().to_owned())),
        _ => Err(Fail::input(format!("{} ended with {}: {}", program.display(), output.status, errors.trim_end()))),
    }
}

fn missing(reason: String) -> Fail {
    let advice = format!(
        "Parquet is read and written by a program of its own, which cargo builds from crates/harness/parquet when it is first asked for; \
         try again with cargo and a network, or put {NAME} beside this program. CSV needs none of it: rows.csv has the same rows, \
         and `identify` takes a log in CSV"
    );
    Fail::Missing { message: format!("{NAME} is missing: {reason}"), advice }
}

/// Finds the program, or has cargo build it.
fn program() -> Result<PathBuf, String> {
    let own = std::env::current_exe().map_err(|error| format!("this program does not know where it is: {error}"))?;
    let places = Places::of(&own, Path::new(CHECKOUT));
    match places.found()? {
        Some(program) => Ok(program),
        None => places.build(),
    }
}

/// Where the program may be.
struct Places {
    /// Beside this program.
    beside: PathBuf,
    /// Where cargo would build it.
    built: PathBuf,
    target: PathBuf,
    checkout: PathBuf,
}

impl Places {
    /// Those of this program, in `TARGET/release` or `TARGET/debug`. If it was copied elsewhere, cargo builds into the checkout's `target`.
    fn of(own: &Path, checkout: &Path) -> Self {
        let folder = own.parent().unwrap_or(Path::new("."));
        let target = match folder.parent() {
            Some(target) if folder.ends_with(PROFILE) => target.to_owned(),
            _ => checkout.join("target"),
        };
        let name = format!("{NAME}{EXE_SUFFIX}");
        Self { beside: folder.join(&name), built: target.join(PROFILE).join(&name), target, checkout: checkout.to_owned() }
    }

    /// The program, if it is there and newer than its sources. Where there are no sources, any is taken.
    fn found(&self) -> Result<Option<PathBuf>, String> {
        let newest = newest(&self.checkout)?;
        let modified =
            |path: &&&PathBuf| path.metadata().and_then(|file| file.modified()).is_ok_and(|at| newest.is_none_or(|newest| newest < at));
        Ok([&self.beside, &self.built].iter().find(modified).map(|path| (*path).clone()))
    }

    fn build(&self) -> Result<PathBuf, String> {
        let arguments = ["--package", NAME, "--bin", NAME];
        let profile: &[&str] = if PROFILE == "release" { &["--release"] } else { &[] };
        cargo_build(NAME, &self.checkout, &self.target, &[&arguments, profile].concat(), &self.built)?;
        Ok(self.built.clone())
    }
}

/// When the sources were last written; none if there are none.
fn newest(checkout: &Path) -> Result<Option<SystemTime>, String> {
    let mut folders: Vec<PathBuf> = SOURCES.iter().map(|folder| checkout.join(folder)).filter(|folder| folder.is_dir()).collect();
    let mut newest = None;
    while let Some(folder) = folders.pop() {
        let error = |error| format!("{}: {error}", folder.display());
        for entry in std::fs::read_dir(&folder).map_err(error)? {
            let entry = entry.map_err(error)?;
            let file = entry.metadata().map_err(error)?;
            if file.is_dir() {
                folders.push(entry.path());
            } else {
                let changed = Some(file.modified().map_err(error)?);
                if changed > newest {
                    newest = changed;
                }
            }
        }
    }
    Ok(newest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::time::Duration;

    /// A file of an age in minutes.
    fn write(path: &Path, age: u64) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(60 * (1_000_000 - age));
        File::create(path).unwrap().set_modified(at).unwrap();
    }

    #[test]
    fn a_program_older_than_its_sources_is_not_taken() {
        let folder = tempfile::tempdir().unwrap();
        let checkout = folder.path().join("checkout");
        let target = folder.path().join("target");
        let places = Places::of(&target.join(PROFILE).join("featherbench"), &checkout);
        assert_eq!((&places.target, &places.beside), (&target, &places.built));
        assert_eq!(places.found(), Ok(None));
        // Without sources nothing is older.
        write(&places.beside, 10);
        assert_eq!(places.found(), Ok(Some(places.beside.clone())));
        write(&checkout.join("crates/harness/parquet/src/lib.rs"), 12);
        write(&checkout.join("crates/harness/results/src/deep/row.rs"), 11);
        write(&checkout.join("crates/harness/bench/src/lib.rs"), 1);
        assert_eq!(places.found(), Ok(Some(places.beside.clone())));
        write(&checkout.join("crates/harness/results/src/deep/row.rs"), 9);
        assert_eq!(places.found(), Ok(None));
    }

    #[test]
    fn a_program_that_was_copied_has_it_built_in_the_checkout() {
        let folder = tempfile::tempdir().unwrap();
        let places = Places::of(&folder.path().join("bin/featherbench"), &folder.path().join("checkout"));
        assert_eq!(places.target, folder.path().join("checkout/target"));
        write(&places.built, 10);
        assert_eq!(places.found(), Ok(Some(places.built.clone())));
        write(&places.beside, 10);
        assert_eq!(places.found(), Ok(Some(places.beside.clone())));
    }

    #[test]
    fn what_cannot_be_built_is_exit_code_three() {
        let folder = tempfile::tempdir().unwrap();
        let places = Places::of(&folder.path().join("bin/featherbench"), &folder.path().join("gone"));
        let reason = places.build().unwrap_err();
        let fail = missing(reason);
        let said = fail.to_string();
        assert!(matches!(fail, Fail::Missing { .. }) && said.contains("gone") && said.contains("crates/harness/parquet"), "{said}");
    }
}
