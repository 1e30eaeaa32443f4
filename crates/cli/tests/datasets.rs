//! The committed data: small, reproducible, and complete.

use crate::support;

use featherbench_formats::neutral;
use featherbench_robots::Family;
use std::path::Path;
use support::project;

fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

/// The generators' texts are beside the models in the default suite: `model = "…" # family:parameters`.
fn generated() -> Vec<(String, String)> {
    let suite = std::fs::read_to_string(project().join("datasets/suites/default.toml")).unwrap();
    let lines = suite.lines().filter_map(|line| line.strip_prefix("model = \"")?.split_once("\" # "));
    lines.map(|(name, spec)| (name.to_owned(), spec.to_owned())).collect()
}

/// Nineteen in twenty bytes are recorded answers: every quantity, of every body, at every state. What else is kept may grow by some hundred
/// kilobytes before somebody has to choose.
#[test]
fn the_data_stay_below_fourteen_megabytes() {
    let files = files(&project().join("datasets"));
    assert!(files.len() >= 50, "{} files in datasets", files.len());
    let size = |files: &[std::path::PathBuf]| -> u64 { files.iter().map(|path| path.metadata().unwrap().len()).sum() };
    // Runs that time engines are kept whole, with their samples: each machine has a megabyte and a half.
    let speed = project().join("datasets/speed");
    let (timed, others): (Vec<_>, Vec<_>) = files.into_iter().partition(|path| path.starts_with(&speed));
    assert!(size(&others) <= 14_000_000, "{} bytes in datasets", size(&others));
    for machine in std::fs::read_dir(&speed).unwrap().map(|entry| entry.unwrap().path()) {
        let own: Vec<_> = timed.iter().filter(|path| path.starts_with(&machine)).cloned().collect();
        assert!((1..=1_500_000).contains(&size(&own)), "{} bytes in {}", size(&own), machine.display());
    }
}

#[test]
fn generated_models_are_what_their_generators_give() {
    let models = generated();
    assert!(models.len() >= 30, "{} models", models.len());
    for (name, spec) in models {
        let written = neutral::read(project().join(format!("datasets/models/{name}.json"))).unwrap();
        let again = Family::parse(&spec).unwrap().generate().unwrap();
        assert_eq!(written, again, "{name} is no longer {spec}");
    }
}

#[test]
fn at_least_eight_real_robots_come_with_the_words_that_allow_it() {
    let robots: Vec<_> = files(&project().join("datasets/models"))
        .into_iter()
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .filter_map(|path| neutral::read(path).unwrap().provenance)
        .collect();
    assert!(robots.len() >= 8, "{} robots", robots.len());
    for robot in robots {
        for text in [&robot.source, &robot.licence, &robot.header, &robot.readme] {
            assert!(!text.is_empty(), "{robot:?}");
        }
        let licence = robot.licence.as_str();
        assert!(licence.contains("BSD") || licence.contains("MIT") || licence.contains("Apache"), "{licence} is not permissive");
    }
}
