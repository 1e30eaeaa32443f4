//! Rapier: the oracle of `oracles/rapier`, a Cargo workspace of its own, built when it is asked for.
//!
//! Beside the program stands the hash of everything of the project's that it is made of; where that is another now, it is built again.

use crate::fail::Fail;
use crate::oracles::spinner;
use crate::root::Root;
use featherbench_bench::{Engine, hash};
use featherbench_engines::{Limits, Oracle};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Its name in suites.
pub const NAME: &str = "rapier";
/// Its package, and so its program.
const PACKAGE: &str = "featherbench-rapier";
/// The project's crates that it is compiled with: a test holds them to its lock file.
const CRATES: [&str; 4] = ["formats", "model", "protocol", "spatial"];
/// How it is compiled, beside its own manifest: what the crates' manifests inherit, and the compiler's flags.
const SETTINGS: [&str; 2] = ["Cargo.toml", ".cargo/config.toml"];
/// What is said where it is not built.
const ADVICE: &str = "rapier is compiled from oracles/rapier by cargo, which needs Rust (https://rustup.rs) and, the first time, a reachable \
                      crate registry; try again with `featherbench oracles install --rapier`. Suites that do not ask for rapier need none of it";

/// The program, if it is there and made of the present sources.
fn built(root: &Root) -> Result<Option<PathBuf>, String> {
    let (folder, program) = (root.rapier(), program(root));
    let made_of = std::fs::read_to_string(folder.join("built")).unwrap_or_default();
    Ok((made_of == sources(root.path())? && program.is_file()).then_some(program))
}

fn program(root: &Root) -> PathBuf {
    root.rapier().join("release").join(PACKAGE)
}

/// Builds the program unless it is there.
pub fn install(root: &Root) -> Result<PathBuf, Fail> {
    let missing = |reason: String| Fail::Missing { message: format!("{NAME} cannot be built: {reason}"), advice: ADVICE.into() };
    match built(root).map_err(missing)? {
        Some(program) => Ok(program),
        None => build(root).map_err(missing),
    }
}

/// Builds the program if need be, and starts it. What it is made of is its identity, for runs that are resumed.
pub fn start(root: &Root, limits: Limits) -> Result<Oracle, Fail> {
    let program = install(root)?;
    let made_of = sources(root.path()).map_err(Fail::input)?;
    let silent = |reason| Fail::Missing { message: format!("{NAME} does not answer: {reason}"), advice: ADVICE.into() };
    Ok(Oracle::start(vec![program.into_os_string()], limits).map_err(silent)?.with_sources(&made_of))
}

/// Prints whether it answers, and where it is.
pub fn status(root: &Root) {
    match built(root) {
        Ok(Some(program)) => match Oracle::start(vec![program.clone().into_os_string()], Limits::default()) {
            Ok(oracle) => println!("{NAME:<16} {:<8} {}", oracle.identity().version, program.display()),
            Err(reason) => println!("{NAME:<16} does not answer: {reason}"),
        },
        Ok(None) => println!("{NAME:<16} is not built: run `featherbench oracles install --rapier`, or a suite that asks for it"),
        Err(reason) => println!("{NAME:<16} {reason}"),
    }
}

/// Has cargo build the program. The hash is written last: what a build that breaks off leaves behind is not taken.
fn build(root: &Root) -> Result<PathBuf, String> {
    let (start, made_of, folder) = (Instant::now(), sources(root.path())?, root.rapier());
    let stamp = folder.join("built");
    let named = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(&folder).map_err(|error| named(&folder, error))?;
    let _ = std::fs::remove_file(&stamp);
    // The workspace's own folder, not a link to it: the crates beside it are found from there, and so are the compiler's flags.
    let workspace = root.oracles().join(NAME);
    let workspace = workspace.canonicalize().map_err(|error| named(&workspace, error))?;
    let bar = spinner("building rapier (a minute or two, once) …");
    let mut cargo = Command::new("cargo");
    let spawned = cargo
        .current_dir(&workspace)
        .args(["build", "--release", "--locked", "--color", "never", "--target-dir"])
        .arg(std::path::absolute(&folder).map_err(|error| named(&folder, error))?)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = spawned.map_err(|error| format!("cargo cannot be started: {error}"))?;
    let mut lines = Vec::new();
    for line in child.stderr.take().into_iter().flat_map(|errors| BufReader::new(errors).lines().map_while(Result::ok)) {
        bar.set_message(format!("building rapier: {}", line.trim()));
        lines.push(line);
    }
    let status = child.wait().map_err(|error| format!("cargo: {error}"))?;
    bar.finish_and_clear();
    if !status.success() {
        return Err(format!("`cargo build` in {} failed ({status}): {}", workspace.display(), complaint(&lines)));
    }
    let program = program(root);
    if !program.is_file() {
        return Err(format!("cargo built something, but not {}; a CARGO_BUILD_TARGET would be why", program.display()));
    }
    ::featherbench_results::atomic_write(&stamp, made_of.as_bytes()).map_err(|error| error.to_string())?;
    eprintln!("built rapier in {:.0} s: {}", start.elapsed().as_secs_f64(), program.display());
    Ok(program)
}

/// Cargo's first error, and the innermost cause that it gives.
fn complaint(lines: &[String]) -> String {
    let words = |line: &String| line.trim().to_owned();
    let first = lines.iter().find(|line| line.starts_with("error")).or(lines.last()).map(words).unwrap_or_default();
    let cause = lines.iter().rposition(|line| line.starts_with("Caused by")).and_then(|at| lines.get(at + 1)).map(words);
    cause.map_or_else(|| first.clone(), |cause| format!("{first}: {cause}"))
}

/// The hash of the sources and the lock file.
fn sources(project: &Path) -> Result<String, String> {
    let mut files: Vec<PathBuf> = SETTINGS.map(PathBuf::from).into();
    let own = PathBuf::from("oracles").join(NAME);
    files.push(own.join("Cargo.lock"));
    for folder in CRATES.iter().map(|name| PathBuf::from("crates").join(name)).chain([own]) {
        files.push(folder.join("Cargo.toml"));
        files.push(folder.join("build.rs"));
        let mut folders = vec![folder.join("src")];
        while let Some(folder) = folders.pop() {
            let error = |error| format!("{}: {error}", project.join(&folder).display());
            for entry in std::fs::read_dir(project.join(&folder)).map_err(error)? {
                let path = folder.join(entry.map_err(error)?.file_name());
                if project.join(&path).is_dir() { &mut folders } else { &mut files }.push(path);
            }
        }
    }
    files.sort();
    // Names as well: a file that moves is another module. What is not there (few crates have a build script) is a fact like another.
    let read = |path: &PathBuf| [path.as_os_str().as_encoded_bytes().to_vec(), std::fs::read(project.join(path)).unwrap_or_default()];
    let parts: Vec<Vec<u8>> = files.iter().flat_map(read).collect();
    Ok(hash::of_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
    }

    #[test]
    fn all_of_the_project_that_it_is_made_of_is_hashed() {
        let lock = std::fs::read_to_string(project().join("oracles/rapier/Cargo.lock")).unwrap();
        let names = lock.lines().filter_map(|line| line.strip_prefix("name = \"featherbench-")?.strip_suffix('"'));
        let ours: Vec<&str> = names.filter(|name| *name != NAME).collect();
        assert_eq!(ours, CRATES);
    }

    #[test]
    fn what_changes_is_built_again() {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = folder.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        for name in CRATES.iter().map(|name| format!("crates/{name}")).chain(["oracles/rapier".into()]) {
            write(&format!("{name}/src/deep/a.rs"), "one");
        }
        let mut seen = vec![sources(folder.path()).unwrap()];
        for path in
            ["oracles/rapier/Cargo.lock", "oracles/rapier/build.rs", "crates/model/src/deep/a.rs", "crates/formats/src/b.rs", "Cargo.toml"]
        {
            write(path, "another");
            seen.push(sources(folder.path()).unwrap());
        }
        write("crates/formats/tests/c.rs", "a test is no part of it");
        assert_eq!(sources(folder.path()).ok().as_ref(), seen.last());
        let of = seen.len();
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), of);
    }

    #[test]
    fn the_cause_that_cargo_gives_is_told() {
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let offline =
            "    Updating crates.io index\nerror: failed to get `x`\n\nCaused by:\n  download failed\n\nCaused by:\n  no network\n";
        assert_eq!(complaint(&lines(offline)), "error: failed to get `x`: no network");
        assert_eq!(complaint(&lines("   Compiling a\nerror[E0425]: no value\n --> a.rs")), "error[E0425]: no value");
        assert_eq!((complaint(&lines("killed")), complaint(&[])), ("killed".into(), String::new()));
    }
}
