//! The Python package of the oracles, `oracles/featherbench_oracles`: the commands of its modules, and where Python finds it.

use crate::root::Root;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// What Python calls the places where it looks for packages.
const VARIABLE: &str = "PYTHONPATH";

/// The command of a module of the package, whatever the current folder holds: `-P` keeps Python from looking there. What the user's
/// PYTHONPATH names comes behind the package.
pub fn command(root: &Root, python: &Path, module: &str) -> Result<Vec<OsString>, String> {
    let places = std::iter::once(root.oracles()).chain(named());
    let module = format!("featherbench_oracles.{module}").into();
    Ok(vec!["env".into(), variable(places)?, python.into(), "-P".into(), "-m".into(), module])
}

/// A user's own command, from which the package can be imported too, behind what the user's PYTHONPATH names.
pub fn reachable(root: &Root, command: &[OsString]) -> Result<Vec<OsString>, String> {
    // `env` would take such a word for a variable.
    if command.first().is_some_and(|program| program.as_encoded_bytes().contains(&b'=')) {
        return Ok(command.to_vec());
    }
    let places = named().into_iter().chain([root.oracles()]);
    Ok([&["env".into(), variable(places)?], command].concat())
}

/// The sources of a module that `python -m` runs: those of its whole package, in the first of the places that has it.
pub fn sources(root: &Root, module: &OsStr) -> Vec<PathBuf> {
    let module = module.to_string_lossy();
    let package = module.split('.').next().unwrap_or_default();
    if package.is_empty() {
        return Vec::new();
    }
    let places = std::iter::once(PathBuf::from(".")).chain(named()).chain([root.oracles()]);
    let found = |place: PathBuf| {
        let (folder, file) = (place.join(package), place.join(format!("{package}.py")));
        let mut files = Vec::new();
        collect(&folder, &mut files);
        files.extend(file.is_file().then_some(file));
        files.sort();
        (!files.is_empty()).then_some(files)
    };
    places.into_iter().find_map(found).unwrap_or_default()
}

/// The Python files of a folder and of those within.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path()) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "py") {
            files.push(path);
        }
    }
}

/// What the user's PYTHONPATH names.
fn named() -> Vec<PathBuf> {
    std::env::var_os(VARIABLE)
        .map(|paths| std::env::split_paths(&paths).filter(|path| !path.as_os_str().is_empty()).collect())
        .unwrap_or_default()
}

/// `PYTHONPATH=…` for `env`.
fn variable(places: impl IntoIterator<Item = PathBuf>) -> Result<OsString, String> {
    let joined = std::env::join_paths(places).map_err(|error| format!("Python cannot be told where the oracles are: {error}"))?;
    let mut word = OsString::from(format!("{VARIABLE}="));
    word.push(joined);
    Ok(word)
}
