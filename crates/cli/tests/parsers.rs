//! Every parser of ours gets some thousand damaged texts. A text that is accepted is written and read again with the same result. Nothing
//! panics.
//!
//! The targets are those of `ci/fuzz`, which fuzzes each of them at night.

#[path = "../../../ci/fuzz/src/lib.rs"]
#[allow(dead_code, reason = "the fuzzer's own entry points")]
mod fuzz;

use crate::share::one_of;
use featherbench_robots::Random;
use std::path::Path;

/// Inputs for each target.
const INPUTS: usize = 4000;

/// A seed with some bytes changed, removed, doubled, or taken from another seed.
fn damaged(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..1 + random.below(5) {
        let (a, b) = (random.below(bytes.len() + 1), random.below(bytes.len() + 1));
        let (from, to) = (a.min(b), a.max(b).min(a.min(b) + 60));
        match random.below(6) {
            0 if from < bytes.len() => bytes[from] ^= 1 << random.below(8),
            1 if from < bytes.len() => bytes[from] = b"0123456789-+.eE\"<>/= ,:[]{}#\n\0\xff"[random.below(31)],
            2 => drop(bytes.drain(from..to)),
            3 => {
                let copy = bytes[from..to].to_vec();
                drop(bytes.splice(from..from, copy));
            }
            4 => {
                let other = &seeds[random.below(seeds.len())];
                let at = random.below(other.len() + 1);
                let part = other[at..other.len().min(at + 40)].to_vec();
                drop(bytes.splice(from..to, part));
            }
            _ => bytes.truncate(to),
        }
    }
    bytes
}

#[test]
fn damaged_texts_are_refused_or_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ci/fuzz/seeds");
    for (name, target) in fuzz::TARGETS {
        let kept = std::fs::read_dir(folder.join(name)).into_iter().flatten().map(|entry| std::fs::read(entry.unwrap().path()).unwrap());
        let seeds: Vec<Vec<u8>> = kept.chain(fuzz::made_seeds(name)).collect();
        assert!(!seeds.is_empty(), "{name} has no seeds");
        seeds.iter().for_each(|seed| target(seed));
        let mut random = Random::named(1, name);
        for k in 0..INPUTS / one_of(4) {
            let input = damaged(&mut random, &seeds);
            let judged = std::panic::catch_unwind(|| target(&input));
            assert!(judged.is_ok(), "{name}, input {k}: {}", String::from_utf8_lossy(&input));
        }
    }
}

/// Every seed must be accepted: the fuzzer cannot start from one that is not.
#[test]
fn seeds_are_good() {
    let read = |name: &str| std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ci/fuzz/seeds").join(name)).unwrap();
    let options = featherbench_formats::urdf::Options { allow_massless: true, independent_mimics: true, ..Default::default() };
    for name in ["urdf/arm.urdf", "urdf/floating.urdf"] {
        featherbench_formats::urdf::import(&read(name), name, &options).unwrap_or_else(|error| panic!("{error}"));
    }
    for name in ["mjcf/arm.xml", "mjcf/short.xml"] {
        featherbench_formats::mjcf::import(&read(name), name).unwrap_or_else(|error| panic!("{error}"));
    }
    for name in ["neutral/all.json", "neutral/short.json"] {
        featherbench_formats::neutral::parse(&read(name), name).unwrap_or_else(|error| panic!("{error}"));
    }
    featherbench_bench::Suite::parse(&read("suite/small.toml"), Path::new("small.toml")).unwrap_or_else(|error| panic!("{error}"));
    let text = read("gates/small.toml");
    let [gates, deviations, engines] = text.split("\n---\n").collect::<Vec<_>>().try_into().unwrap();
    featherbench_bench::Gates::parse(gates, Path::new("small")).unwrap_or_else(|error| panic!("{error}"));
    featherbench_bench::DeviationFile::parse(deviations, Path::new("small")).unwrap_or_else(|error| panic!("{error}"));
    featherbench_bench::Engines::parse(engines, Path::new("small")).unwrap_or_else(|error| panic!("{error}"));
    assert!(featherbench_engines::Recording::from_bytes(&fuzz::recording_seed(), &fuzz::recorded_robot()).is_ok());
    for seed in [fuzz::records_seed(), fuzz::run_info_seed()] {
        assert!(std::str::from_utf8(&seed).is_ok_and(|text| !text.is_empty()));
    }
    featherbench_results::parse_csv(std::str::from_utf8(&fuzz::records_seed()).unwrap(), Path::new("rows"))
        .unwrap_or_else(|error| panic!("{error}"));
    featherbench_results::RunInfo::parse(std::str::from_utf8(&fuzz::run_info_seed()).unwrap(), Path::new("run"))
        .unwrap_or_else(|error| panic!("{error}"));
    for k in 0..8 {
        assert!(featherbench_robots::Family::parse(&read(&format!("family/{k}"))).is_ok(), "family {k}");
    }
}
