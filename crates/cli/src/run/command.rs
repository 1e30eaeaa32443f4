//! The command that makes a run again: it works in any folder.

use crate::root::Root;
use ::featherbench_results::{quoted, words};
use std::path::Path;

/// This command. In the project's folder it is as it was typed. Below it, files that it names are written with their whole path. Elsewhere cargo does not
/// find the project: there this program is written with its whole path, too.
pub fn typed(root: &Root) -> String {
    // An argument may be no Unicode, as a file's name can be.
    let typed = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let (Ok(here), Ok(home)) = (std::env::current_dir().and_then(|here| here.canonicalize()), root.path().canonicalize()) else {
        return line(CARGO, typed);
    };
    if here == home {
        return line(CARGO, typed);
    }
    let program = std::env::current_exe().ok().filter(|_| !here.starts_with(&home));
    let program = program.map_or_else(|| CARGO.to_owned(), |program| quoted(&program.to_string_lossy()));
    line(&program, typed.map(|word| anywhere(&here, &word)))
}

/// How the program is called in its project.
const CARGO: &str = "cargo run --release --";

fn line(program: &str, typed: impl Iterator<Item = String>) -> String {
    std::iter::once(program.to_owned()).chain(typed.map(|word| quoted(&word))).collect::<Vec<_>>().join(" ")
}

/// A word in which each file has its whole path: the word itself, the value of `--option=FILE`, the words of `NAME=PROGRAM ARGS…`.
fn anywhere(here: &Path, word: &str) -> String {
    if let Some(whole) = whole(here, word) {
        return whole;
    }
    let Some((name, rest)) = word.split_once('=') else { return word.to_owned() };
    match words(rest) {
        Ok(parts) if parts.iter().any(|part| whole(here, part).is_some()) => {
            let parts: Vec<String> = parts.iter().map(|part| quoted(&whole(here, part).unwrap_or_else(|| part.clone()))).collect();
            format!("{name}={}", parts.join(" "))
        }
        // A value with an equals sign of its own: --engine=NAME=PROGRAM.
        _ => format!("{name}={}", anywhere(here, rest)),
    }
}

/// The whole path of a file that is named from `here`. A word without a point or a slash may be a command's name.
fn whole(here: &Path, word: &str) -> Option<String> {
    let path = here.join(word);
    (word.contains(['.', '/']) && !Path::new(word).is_absolute() && path.exists())
        .then(|| path.components().collect::<std::path::PathBuf>().to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_their_whole_path() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        std::fs::write(here.join("engine.py"), "").unwrap();
        std::fs::create_dir(here.join("run")).unwrap();
        let full = here.join("engine.py").display().to_string();
        let of = |word: &str| anywhere(here, word);
        // What is no file of this folder stays: also a command whose name a folder has.
        for word in ["run", "--live", "mine=python3", "^import/.*", "absent.py", "a=b=c", full.as_str()] {
            assert_eq!(of(word), word);
        }
        assert_eq!(of("./engine.py"), full);
        assert_eq!(of("--file=engine.py"), format!("--file={full}"));
        assert_eq!(of("mine=python3 engine.py --fast"), format!("mine=python3 {full} --fast"));
        assert_eq!(of("--engine=mine=./engine.py"), format!("--engine=mine={full}"));
    }
}
