//! The crate's files use each other in one direction, and none of them knows a study.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The sources of the crate, by module; the files of a folder are one module. `lib` is the root.
fn modules() -> BTreeMap<String, String> {
    let paths = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<PathBuf>>();
    let text = |path: &PathBuf| fs::read_to_string(path).unwrap();
    let read = |path: PathBuf| {
        let source = if path.is_dir() { paths(&path).iter().map(text).collect() } else { text(&path) };
        (path.file_stem().unwrap().to_str().unwrap().to_owned(), source)
    };
    paths(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")).into_iter().map(read).collect()
}

/// The modules that a source names after `crate::`, one by one or as a group in braces. What is no module belongs to the root.
fn used<'a>(text: &str, modules: &BTreeSet<&'a str>) -> BTreeSet<&'a str> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code = code.collect::<Vec<_>>().join("\n");
    let mut used = BTreeSet::new();
    for (at, prefix) in code.match_indices("crate::") {
        let rest = &code[at + prefix.len()..];
        let group = rest.strip_prefix('{').map(|rest| &rest[..rest.find(';').unwrap_or(rest.len())]);
        let mut depth = 0;
        // The first name of each path: at depth zero of the braces.
        let parts = group.unwrap_or(rest).split(|c: char| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        });
        let names = parts.map(|part| part.trim_start().split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default());
        let count = if group.is_some() { usize::MAX } else { 1 };
        used.extend(names.take(count).filter(|name| !name.is_empty()).map(|name| modules.get(name).copied().unwrap_or("lib")));
    }
    used
}

/// The modules of a circle, in their order; `None` if there is none.
fn circle<'a>(uses: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> Option<Vec<&'a str>> {
    fn walk<'a>(at: &'a str, uses: &BTreeMap<&'a str, BTreeSet<&'a str>>, path: &mut Vec<&'a str>, done: &mut BTreeSet<&'a str>) -> bool {
        if let Some(start) = path.iter().position(|&other| other == at) {
            path.drain(..start);
            return true;
        }
        if !done.insert(at) {
            return false;
        }
        path.push(at);
        let found = uses.get(at).into_iter().flatten().any(|next| walk(next, uses, path, done));
        if !found {
            path.pop();
        }
        found
    }
    let (mut path, mut done) = (Vec::new(), BTreeSet::new());
    uses.keys().any(|&start| walk(start, uses, &mut path, &mut done)).then_some(path)
}

#[test]
fn no_two_files_use_each_other_in_a_circle() {
    let sources = modules();
    let names: BTreeSet<&str> = sources.keys().map(String::as_str).collect();
    // The root declares and re-exports all modules; a module that uses an item of the root would close a circle.
    let uses: BTreeMap<&str, BTreeSet<&str>> = sources.iter().map(|(name, text)| (name.as_str(), used(text, &names))).collect();
    let all: BTreeSet<&str> = names.iter().copied().filter(|&name| name != "lib").collect();
    let uses: BTreeMap<&str, BTreeSet<&str>> =
        uses.into_iter().map(|(name, used)| (name, if name == "lib" { all.clone() } else { used })).collect();
    assert!(uses.len() > 15 && uses.values().map(BTreeSet::len).sum::<usize>() > 40, "{uses:?}");
    assert_eq!(circle(&uses), None);
}

#[test]
fn a_circle_is_found() {
    let names = BTreeSet::from(["a", "b", "c", "lib"]);
    assert_eq!(used("use crate::a::X;\n// crate::c\nlet y = crate::b::f();", &names), BTreeSet::from(["a", "b"]));
    assert_eq!(used("use crate::{a, b::{X, c}};", &names), BTreeSet::from(["a", "b"]));
    assert_eq!(used("use crate::Root;", &names), BTreeSet::from(["lib"]));
    let uses = |pairs: &[(&'static str, &'static str)]| {
        let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for &(one, other) in pairs {
            uses.entry(one).or_default().insert(other);
        }
        uses
    };
    assert_eq!(circle(&uses(&[("a", "b"), ("b", "c"), ("a", "c")])), None);
    assert_eq!(circle(&uses(&[("a", "b"), ("b", "c"), ("c", "b")])), Some(vec!["b", "c"]));
    assert_eq!(circle(&uses(&[("a", "a")])), Some(vec!["a"]));
}

/// The names of the studies: the folders of their crates.
fn studies() -> Vec<String> {
    let rooms =
        ["comparison", "answers", "speed"].map(|room| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies").join(room).join("src"));
    let paths = rooms.into_iter().flat_map(|room| fs::read_dir(room).unwrap().map(|entry| entry.unwrap().path()));
    paths.filter(|path| path.is_dir()).map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
}

/// Whether a name is a word of a text.
fn is_word(name: &str, text: &str) -> bool {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
}

#[test]
fn no_study_is_named() {
    let studies = studies();
    assert!(studies.len() >= 20, "{studies:?}");
    for (module, text) in modules() {
        for study in &studies {
            assert!(!is_word(study, &text), "src/{module}.rs names the study {study}");
        }
    }
    // Its scripts use such words for other things, but not as names.
    let assets = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")).unwrap().map(|entry| entry.unwrap().path());
    for path in assets {
        let text = fs::read_to_string(&path).unwrap();
        for study in &studies {
            let named = ["\"NAME\"", "'NAME'", "#NAME"].iter().any(|form| text.contains(&form.replace("NAME", study)));
            assert!(!named, "{} names the study {study}", path.display());
        }
    }
    assert!(is_word("steps", "a.steps()") && !is_word("steps", "footsteps and steps_of"));
}
