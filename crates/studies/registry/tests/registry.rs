//! The registry: every suite of the project makes its studies, and an unknown one is named.

use featherbench_bench::alone::Question;
use featherbench_bench::{Counts, Engines, Gates, NoAnswer, Suite};
use featherbench_registry::{Setup, names, of_suite};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn suites() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/suites")
}

pub fn setup(suite: &Suite, live: bool) -> Setup<'_> {
    let refused = || NoAnswer::NotOffered("a test".into());
    let (reproduce, measure) = (Arc::new(move |_: &str, _: u64| Err(refused())), Arc::new(move |_: &Question| Err(refused())));
    Setup { suite, live, program: "", reproduce, measure }
}

fn made(suite: &Suite, live: bool) -> Vec<&'static str> {
    of_suite(&setup(suite, live)).unwrap().iter().map(|study| study.name()).collect()
}

#[test]
fn every_suite_makes_its_studies() {
    let (mut suites_read, mut seen) = (0, BTreeSet::new());
    let counts = std::fs::read_to_string(suites().join("../../ci/counts.csv")).unwrap();
    Counts::parse(&counts, Path::new("counts.csv")).unwrap();
    for entry in std::fs::read_dir(suites()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let (suite, _) = Suite::read(&path).unwrap();
        let made = made(&suite, true);
        let named: Vec<&str> = names().into_iter().filter(|name| suite.studies.iter().any(|study| study == name)).collect();
        let asked: Vec<&str> = made.iter().copied().filter(|name| *name != "repeatability").collect();
        assert_eq!(asked, named, "{}", path.display());
        assert_eq!(made.contains(&"repeatability"), suite.engines.is_some(), "{}: engines that answer are asked twice", path.display());
        // A suite whose answers count has its counts in the lock file.
        let name = path.file_stem().unwrap().to_str().unwrap();
        let counted = counts.lines().any(|line| line.starts_with(&format!("{name},")));
        assert_eq!(counted, suite.engines.is_some(), "{name} in counts.csv: `featherbench gate RUN --counts --write` writes it");
        seen.extend(made);
        suites_read += 1;
    }
    assert!(suites_read >= 9, "{suites_read} suites");
    assert!(seen.len() >= 9, "{seen:?}");
}

/// A complete run of a suite with reproductions has all of them: one that is added to an engine's deviations is counted in every such suite.
#[test]
fn suites_count_every_reproduction() {
    let ci = suites().join("../../ci");
    let engines = Engines::read(&ci.join("../oracles/engines.toml")).unwrap();
    let gates = Gates::read(&ci, &engines).unwrap();
    let mut due: BTreeMap<&str, usize> = BTreeMap::new();
    for shown in gates.reproductions() {
        *due.entry(&shown.engine).or_default() += 1;
    }
    let counts = std::fs::read_to_string(ci.join("counts.csv")).unwrap();
    let mut found: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for line in counts.lines() {
        if let [suite, "reproductions", engine, _, cells, _] = line.split(',').collect::<Vec<_>>()[..] {
            found.entry(suite).or_default().insert(engine, cells.parse().unwrap());
        }
    }
    assert!(found.len() >= 2 && due.len() >= 3, "{found:?}");
    for (suite, counted) in found {
        assert_eq!(counted, due, "{suite} in counts.csv: `featherbench gate RUN --counts --write` writes it");
    }
}

#[test]
fn recorded_engines_import_no_file() {
    let suite = Suite::parse("about = \"a\"\nseed = 1\nengines = []\n[import]\n", Path::new("s.toml")).unwrap();
    assert_eq!((made(&suite, true), made(&suite, false)), (vec!["import", "repeatability"], vec!["repeatability"]));
}

#[test]
fn what_is_wrong_with_a_table_is_named() {
    for (text, words) in [
        ("[toy]\n", "there is no study 'toy'; there are agreement, import"),
        ("[timing]\nstates = 3\n", "seconds"),
        ("[timing]\nstates = 3\nseconds = 0.1\npeers = []\n", "peers"),
        ("[timing]\nstates = 3\nseconds = 0.1\nquantities = [\"mass\"]\n", "there is no quantity 'mass'"),
        ("[accuracy]\nstates = 3\n", "states"),
    ] {
        let suite = Suite::parse(&format!("about = \"a\"\nseed = 1\n{text}"), Path::new("s.toml")).unwrap();
        let error = of_suite(&setup(&suite, true)).err().unwrap().to_string();
        assert!(error.contains("s.toml") && error.contains(words), "{error}");
    }
}
