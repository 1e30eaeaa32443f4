//! `oracles/engines.toml` against what stands elsewhere: folders, lock files, and the versions that the README names.

use crate::support::project;
use featherbench_bench::{Engines, Start};

fn read(name: &str) -> String {
    std::fs::read_to_string(project().join(name)).unwrap()
}

fn engines() -> Engines {
    Engines::read(&project().join("oracles/engines.toml")).unwrap()
}

#[test]
fn each_engine_has_the_folder_of_its_start() {
    for engine in engines().iter() {
        let file = match &engine.start {
            Start::Python { module } | Start::PythonAlone { module } => format!("oracles/featherbench_oracles/{module}/__main__.py"),
            Start::Cargo { folder, .. } | Start::CargoLibrary { folder, .. } => format!("oracles/{folder}/Cargo.toml"),
            Start::Native(library) => format!("oracles/native/{}/CMakeLists.txt", library.folder),
        };
        assert!(project().join(&file).is_file(), "{}: there is no {file}", engine.name);
        if let Start::Native(_) = &engine.start {
            // The target's name is the library's. Pinocchio's ends with the compiler.
            let stem = engine.name.split('-').next().unwrap();
            assert!(read(&file).contains(&format!("add_oracle({stem}-")), "{}: {file} has no such target", engine.name);
        }
    }
}

#[test]
fn what_cargo_builds_is_locked_to_the_version() {
    for engine in engines().iter() {
        let (folder, made) = match &engine.start {
            Start::Cargo { folder, program } => (folder, program.clone()),
            // A library's name is its package's, as a word of Rust.
            Start::CargoLibrary { folder, library } => (folder, library.replace('_', "-")),
            Start::Python { .. } | Start::PythonAlone { .. } | Start::Native(_) => continue,
        };
        let engines = engines();
        let package = engines.package(engine).unwrap();
        let lock = read(&format!("oracles/{folder}/Cargo.lock"));
        assert!(lock.contains(&format!("name = \"{}\"\nversion = \"{}\"\n", package.name, package.version)), "{}", engine.name);
        assert!(read(&format!("oracles/{folder}/Cargo.toml")).contains(&format!("name = \"{made}\"")), "{}", engine.name);
    }
}

#[test]
fn the_readme_names_each_engine_with_its_version() {
    let (engines, readme) = (engines(), read("README.md"));
    for engine in engines.iter().filter(|engine| !engine.is_native()) {
        let named = format!("{} {}", engine.title, engines.package(engine).unwrap().version);
        assert!(readme.contains(&named), "README.md does not name {named}");
    }
}

/// A pin of an engine stands in `engines.toml` alone.
#[test]
fn the_shared_requirements_pin_no_engine() {
    let shared = read("oracles/requirements.txt");
    for pin in engines().pins() {
        let name = pin.split_once("==").unwrap().0;
        assert!(!shared.lines().any(|line| line.starts_with(&format!("{name}=="))), "requirements.txt pins {name} too");
    }
}
