//! What the sources and the dependency tree promise: an example for each public item, and no harness below the library.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What a program that adds the library must not compile: our harness, and what reports, the command and Python need.
const REFUSED: &[&str] = &[
    "featherbench-bench",
    "featherbench-engines",
    "featherbench-protocol",
    "featherbench-reference",
    "featherbench-report",
    "featherbench-results",
    "featherbench-registry",
    "clap",
    "csv",
    "indicatif",
    "libloading",
    "maud",
    "numpy",
    "parquet",
    "pyo3",
    "toml",
];

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_dependency_tree_has_no_harness() {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let arguments = ["tree", "-p", "featherbench-rbd", "-e", "normal", "--all-features", "--prefix", "none", "--offline", "--locked"];
    let output = Command::new(cargo).args(arguments).current_dir(here()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let names: Vec<&str> = text.lines().filter_map(|line| line.split(' ').next()).collect();
    assert!(names.contains(&"featherbench-dynamics") && names.contains(&"glam"), "this is another tree: {text}");
    let found: Vec<&&str> = REFUSED.iter().filter(|refused| names.contains(refused)).collect();
    assert!(found.is_empty(), "the library needs {found:?}");
}

/// Each public function, type and trait of this crate has a code block in the comment before it.
#[test]
fn every_public_item_has_an_example() {
    let (mut items, mut without) = (0, Vec::new());
    let files = std::fs::read_dir(here().join("src")).unwrap().map(|entry| entry.unwrap().path());
    for path in files.collect::<Vec<PathBuf>>() {
        let text = std::fs::read_to_string(&path).unwrap();
        let mut example = false;
        for (number, line) in text.lines().enumerate() {
            let line = line.trim_start();
            if line.starts_with("///") {
                example |= line.starts_with("/// ```");
            } else if !line.starts_with("#[") {
                let is_item = ["pub fn ", "pub struct ", "pub enum ", "pub trait "].iter().any(|start| line.starts_with(start));
                items += usize::from(is_item);
                if is_item && !example {
                    without.push(format!("{}:{}: {line}", path.display(), number + 1));
                }
                example = false;
            }
        }
    }
    assert!(items > 50, "{items} items were found");
    assert!(without.is_empty(), "these have no example:\n{}", without.join("\n"));
}
