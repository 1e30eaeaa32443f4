//! The direction of dependencies, held over `cargo metadata`: nothing points back.

use cargo_metadata::{DependencyKind, MetadataCommand, Package};
use std::collections::BTreeSet;

/// What each crate may depend on among our own.
const ALLOWED: [(&str, &[&str]); 11] = [
    ("spatial", &[]),
    ("model", &["spatial"]),
    ("formats", &["model", "spatial"]),
    ("dynamics", &["spatial", "model"]),
    ("reference", &["model"]),
    ("record", &[]),
    ("report", &["record"]),
    ("harness", &["spatial", "model", "formats", "dynamics", "record"]),
    ("engines", &["spatial", "model", "formats", "dynamics", "record", "harness"]),
    ("studies", &["spatial", "model", "dynamics", "record", "harness"]),
    ("cli", &["spatial", "model", "formats", "dynamics", "record", "report", "harness", "engines", "studies"]),
];

fn short(name: &str) -> Option<&str> {
    if name == "featherbench" { Some("cli") } else { name.strip_prefix("featherbench-") }
}

fn normal(package: &Package) -> impl Iterator<Item = &str> {
    package.dependencies.iter().filter(|dependency| dependency.kind == DependencyKind::Normal).map(|dependency| dependency.name.as_str())
}

#[test]
fn nothing_points_back() {
    let metadata =
        MetadataCommand::new().manifest_path("../../Cargo.toml").no_deps().other_options(vec!["--offline".into()]).exec().unwrap();
    let mut seen = BTreeSet::new();
    for package in metadata.workspace_packages() {
        let name = short(&package.name).unwrap_or_else(|| panic!("{} is named unlike the others", package.name));
        let (_, allowed) = ALLOWED.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("{name} has no place in the design"));
        for dependency in normal(package).filter_map(short) {
            assert!(allowed.contains(&dependency), "{name} must not depend on {dependency}");
        }
        seen.insert(name.to_owned());
    }
    assert_eq!(seen.len(), ALLOWED.len(), "a crate of the design is missing");
}

/// Kernels and models know nothing about files: no serde below `formats` and `harness`.
#[test]
fn kernels_reach_no_serialization() {
    for kernel in ["featherbench-spatial", "featherbench-model", "featherbench-dynamics", "featherbench-reference"] {
        let mut command = std::process::Command::new(env!("CARGO"));
        let tree = command.current_dir("../..").args(["tree", "--offline", "--edges", "normal", "--prefix", "none", "--package", kernel]);
        let output = tree.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let reached = String::from_utf8(output.stdout).unwrap();
        assert!(reached.lines().count() > 1 || kernel == "featherbench-spatial", "cargo tree says nothing about {kernel}");
        assert!(!reached.lines().any(|line| line.starts_with("serde ")), "{kernel} reaches serde:\n{reached}");
    }
}
