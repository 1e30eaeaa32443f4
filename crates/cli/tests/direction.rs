//! Rules for the whole workspace: no dependency points back, kernels do not depend on files, and tests draw the same numbers every time.

use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A floor, and its rooms from the lowest: each with the rooms of its own floor that it may use, and of floors below.
type Floor = (&'static str, &'static [(&'static str, &'static [&'static str])]);

/// The floors, the lowest first. A floor uses those before it here, and within a floor rooms use each other in one direction.
const FLOORS: [Floor; 4] = [
    (
        "mechanics",
        &[
            ("spatial", &[]),
            ("model", &["spatial"]),
            ("robots", &["model"]),
            ("formats", &["model", "spatial"]),
            ("dynamics", &["spatial", "model"]),
            // What programs add: it has no harness, no report and no process in its tree.
            ("rbd", &["spatial", "model", "robots", "formats", "dynamics"]),
            ("reference", &["model"]),
            ("contact", &["spatial", "model", "dynamics"]),
            ("constrained", &["spatial", "model", "dynamics"]),
            ("hybrid", &["spatial"]),
            ("scenes", &["spatial", "model", "robots", "dynamics", "contact"]),
            ("residuals", &["spatial", "model", "dynamics"]),
            ("learning", &["spatial", "model", "robots", "dynamics", "residuals"]),
            ("identification", &["spatial", "model", "robots", "formats", "dynamics"]),
            ("uncertainty", &["spatial", "model", "robots", "dynamics"]),
            ("continua", &["spatial", "model", "dynamics"]),
        ],
    ),
    (
        "harness",
        &[
            ("results", &[]),
            // The only crate that compiles `parquet`; no crate may use it: the command starts its program.
            ("parquet", &["results"]),
            ("report", &["results"]),
            ("protocol", &[]),
            ("bench", &["spatial", "model", "robots", "formats", "dynamics", "scenes", "residuals", "results", "protocol"]),
            ("kernels", &["spatial", "model", "robots", "dynamics", "results", "bench"]),
            (
                "engines",
                &["spatial", "model", "robots", "formats", "dynamics", "scenes", "residuals", "results", "protocol", "bench", "kernels"],
            ),
        ],
    ),
    (
        "studies",
        &[
            ("lesson", &[MECHANICS]),
            ("study", &["spatial", "results", "report", "bench"]),
            ("comparison", &[MECHANICS, "results", "report", "bench", "study"]),
            ("answers", &[MECHANICS, "results", "report", "bench", "study", "lesson"]),
            ("speed", &[MECHANICS, "results", "report", "bench", "kernels", "study", "comparison", "answers"]),
            ("reduction", &[MECHANICS, "results", "report", "bench", "study", "comparison"]),
            ("registry", &["results", "report", "bench", "study", "lesson", "comparison", "answers", "speed"]),
            // For tests alone.
            ("doubles", &["model", "robots", "results", "bench", "engines", "comparison"]),
        ],
    ),
    // The engines' coordinates come from `rbd`.
    ("", &[("cli", &[MECHANICS, "results", "report", "bench", "engines", "study", "comparison", "speed", "reduction", "registry"])]),
];

/// Stands for every room of the floor of this name.
const MECHANICS: &str = "mechanics";

/// What `cargo metadata` says of the workspace: its packages alone.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    name: String,
    /// `None` of a normal dependency, else `dev` or `build`.
    kind: Option<String>,
}

/// The manifests of the workspace.
fn packages() -> Vec<Package> {
    let output = cargo(&["metadata", "--offline", "--no-deps", "--format-version", "1"]);
    serde_json::from_str::<Metadata>(&output).unwrap().packages
}

/// What cargo prints in the folder of the workspace.
fn cargo(arguments: &[&str]) -> String {
    let output = std::process::Command::new(env!("CARGO")).current_dir("../..").args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn short(name: &str) -> Option<&str> {
    if name == "featherbench" { Some("cli") } else { name.strip_prefix("featherbench-") }
}

fn normal(package: &Package) -> impl Iterator<Item = &str> {
    package.dependencies.iter().filter(|dependency| dependency.kind.is_none()).map(|dependency| dependency.name.as_str())
}

/// The rooms that come before one in the house.
fn before(room: &str) -> Vec<&'static str> {
    FLOORS.iter().flat_map(|(_, rooms)| rooms.iter().map(|(name, _)| *name)).take_while(|name| *name != room).collect()
}

#[test]
fn the_table_has_one_direction() {
    for (_, rooms) in FLOORS {
        for (room, uses) in rooms {
            let before = before(room);
            for used in uses.iter().filter(|used| **used != MECHANICS) {
                assert!(before.contains(used), "{room} stands before {used} and must not use it");
            }
        }
    }
}

#[test]
fn nothing_points_back() {
    let mechanics: Vec<&str> = FLOORS[0].1.iter().map(|(name, _)| *name).collect();
    let mut seen = BTreeSet::new();
    for package in &packages() {
        let name = short(&package.name).unwrap_or_else(|| panic!("{} is named unlike the others", package.name));
        let (room, tests) = name.strip_suffix("-tests").map_or((name, false), |room| (room, true));
        let of_floor = |(floor, rooms): &Floor| rooms.iter().find(|(known, _)| *known == room).map(|(_, uses)| (*floor, *uses));
        let (floor, allowed) = FLOORS.iter().find_map(of_floor).unwrap_or_else(|| panic!("{name} has no place in the design"));
        let folder = Path::new("crates").join(floor).join(room).join(if tests { "tests" } else { "" });
        let parent = package.manifest_path.parent().unwrap();
        assert!(parent.ends_with(&folder), "{name} stands in {} and not in {}", parent.display(), folder.display());
        if tests {
            assert_eq!(normal(package).count(), 0, "{name}: tests have dependencies of tests alone");
            continue;
        }
        for dependency in normal(package).filter_map(short) {
            let is = allowed.contains(&dependency) || allowed.contains(&MECHANICS) && mechanics.contains(&dependency);
            assert!(is, "{name} must not depend on {dependency}");
        }
        seen.insert(name.to_owned());
    }
    assert_eq!(seen.len(), FLOORS.iter().map(|(_, rooms)| rooms.len()).sum::<usize>(), "a crate of the design is missing");
}

/// The names of all packages that one depends on through normal dependencies, directly or not, and its own.
fn reached(package: &str) -> BTreeSet<String> {
    reached_by(package, "normal")
}

/// The same through these kinds of dependencies.
fn reached_by(package: &str, kinds: &str) -> BTreeSet<String> {
    let text = cargo(&["tree", "--offline", "--edges", kinds, "--prefix", "none", "--package", package]);
    let names: BTreeSet<String> = text.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    assert!(names.contains(package), "cargo tree says nothing about {package}: {text}");
    names
}

/// What is compiled before the command answers has no Parquet in it, nor what comes with that.
#[test]
fn the_command_is_compiled_without_parquet() {
    let refused = ["parquet", "arrow", "chrono", "half", "num-bigint", "zerocopy"];
    let of = |package| refused.into_iter().filter(|name| reached_by(package, "normal,build").contains(*name)).collect::<Vec<_>>();
    assert_eq!(of("featherbench"), [""; 0]);
    // The crate that may have them has them: so the search works.
    assert!(of("featherbench-parquet").starts_with(&["parquet"]));
}

/// `cargo run` has one program, and `cargo bench` every benchmark. What only some commands need is built when they are called.
#[test]
fn the_command_is_what_cargo_builds_by_default() {
    #[derive(Deserialize)]
    struct Default {
        workspace_default_members: Vec<String>,
    }
    let output = cargo(&["metadata", "--offline", "--no-deps", "--format-version", "1"]);
    let members = serde_json::from_str::<Default>(&output).unwrap().workspace_default_members;
    let is = |name: &str| members.iter().any(|member| member.contains(&format!("/{name}#")));
    assert!(is("cli") && !is("parquet"), "{members:?}");
    for folder in rooms() {
        let name = folder.file_name().unwrap().to_str().unwrap();
        assert!(is(name) || !folder.join("benches").exists(), "`cargo bench` leaves out {name}");
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        // Criterion has arguments that a program of tests does not know.
        let targets = usize::from(folder.join("src/lib.rs").exists()) + manifest.matches("[[bin]]").count();
        assert_eq!(manifest.matches("\nbench = false\n").count(), targets, "{name}: its library and programs are no benchmarks");
    }
}

/// The packages for reading or writing files on which one package depends: serde, packages named after it, and parsers.
fn serialization(package: &str) -> Vec<String> {
    let parsers = ["csv", "toml", "basic-toml", "roxmltree", "ron", "bincode", "postcard"];
    reached(package).into_iter().filter(|name| name.split(['-', '_']).any(|word| word == "serde") || parsers.contains(&&**name)).collect()
}

/// Kernels and models do not depend on files: no serialization below `formats` and `bench`.
#[test]
fn kernels_reach_no_serialization() {
    for kernel in ["featherbench-spatial", "featherbench-model", "featherbench-robots", "featherbench-dynamics", "featherbench-reference"] {
        let found = serialization(kernel);
        assert!(found.is_empty(), "{kernel} reaches {found:?}");
    }
    // A crate that may have them has them: so the search works.
    let formats = serialization("featherbench-formats");
    for name in ["serde", "serde_json", "serde_path_to_error", "roxmltree"] {
        assert!(formats.iter().any(|found| found == name), "{name} is not among {formats:?}");
    }
}

/// The direct dependencies of the kernels on other authors' crates. One more is a decision, to be made here.
#[test]
fn kernels_depend_on_few_crates_of_others() {
    let outside: [(&str, &[&str]); 5] = [
        ("spatial", &["wide"]),
        ("model", &["thiserror"]),
        ("robots", &["thiserror"]),
        ("dynamics", &["nalgebra", "rayon", "thiserror", "wide"]),
        ("reference", &["dashu-float", "thiserror"]),
    ];
    let packages = packages();
    for (kernel, allowed) in outside {
        let package = packages.iter().find(|package| short(&package.name) == Some(kernel)).unwrap();
        let found: BTreeSet<&str> = normal(package).filter(|name| short(name).is_none()).collect();
        assert_eq!(found, allowed.iter().copied().collect(), "{kernel}");
    }
}

/// The library crate is for programs that are no benchmark: nothing of the harness comes with it, in no feature.
#[test]
fn the_library_reaches_five_crates_of_ours() {
    let text = cargo(&["tree", "--offline", "--edges", "normal", "--prefix", "none", "--all-features", "--package", "featherbench-rbd"]);
    let ours: BTreeSet<&str> = text.lines().filter_map(|line| line.split_whitespace().next()).filter_map(short).collect();
    assert_eq!(ours, BTreeSet::from(["dynamics", "formats", "model", "rbd", "robots", "spatial"]));
}

/// The folders of all crates.
fn rooms() -> Vec<PathBuf> {
    let folder = |floor: &str, room: &str| Path::new("..").join(floor).join(room);
    FLOORS.iter().flat_map(|(floor, rooms)| rooms.iter().map(move |(room, _)| folder(floor, room))).collect()
}

/// The Rust files below a folder.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| match path.is_dir() {
            true => sources(&path),
            false => vec![path],
        })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// Every property test draws the same cases in every run, and writes nothing into the source tree when it fails.
#[test]
fn property_tests_draw_the_same_cases_in_every_run() {
    let mut blocks = 0;
    for path in sources(Path::new("..")) {
        let text = std::fs::read_to_string(&path).unwrap();
        let here = text.lines().filter(|line| line.trim() == "proptest! {").count();
        if here > 0 {
            let of = |words: &str| text.matches(words).count();
            assert_eq!(of("#![proptest_config("), here, "{}: a block has no configuration of its own", path.display());
            for (setting, due) in
                [("rng_seed: RngSeed::Fixed(", true), ("failure_persistence: None", true), ("(ProptestConfig::with_cases(", false)]
            {
                assert_eq!(of(setting) > 0, due, "{}: {setting}", path.display());
            }
        }
        blocks += here;
    }
    assert!(blocks >= 16, "{blocks} blocks of property tests");
}

/// Each file of tests belongs to a test program: cargo does not look for them, because those of a crate are one program.
#[test]
fn no_test_file_is_left_out() {
    let (mut files, mut programs) = (0, 0);
    // Some crates are tested by those that use them.
    for folder in rooms().into_iter().filter(|folder| folder.join("tests").exists()) {
        let text = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let apart = folder.join("tests/Cargo.toml").exists();
        let (manifest, modules) = (text(if apart { "tests/Cargo.toml" } else { "Cargo.toml" }), text("tests/all.rs"));
        assert!(manifest.contains("name = \"all\""), "{}: the program of the tests is not named", folder.display());
        for entry in std::fs::read_dir(folder.join("tests")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            if path.extension().is_none_or(|extension| extension != "rs") || name == "all" {
                continue;
            }
            let module = modules.lines().any(|line| line == format!("mod {name};"));
            let program = manifest.contains(&format!("[[test]]\nname = \"{name}\"\n"));
            assert!(module != program, "{}: name it in tests/all.rs or as a [[test]] of Cargo.toml", path.display());
            files += 1;
        }
        programs += 1;
    }
    assert!(programs >= 26 && files >= 200, "{programs} programs, {files} files");
}
