//! The golden data: they belong to the witnesses of this commit, and every run derives a random twentieth of them again, by day on a third
//! of the robots.
//!
//! `FEATHERBENCH_GOLDEN_SEED` chooses the twentieth (without it the day does); `FEATHERBENCH_GOLDEN_SHARE=1` derives all.

use crate::share::one_of;
use crate::support;

use featherbench_reference::{Precision, nearest_doubles};
use featherbench_results::{CHECKSUMS_NAME, Checksums};
use featherbench_robots::Random;
use serde_json::Value;
use support::CASES;
use support::golden::{Answers, COLUMNS, DIGITS, SEED, folder, hash_of_doubles, hash_of_python, hash_of_rust, hash_of_state};

/// What to do when the golden data are older than the witnesses.
const AGAIN: &str = "run `cargo run --release -p featherbench-reference --features examples --example golden -- make` (it needs Python with mpmath and numpy: \
                     `featherbench oracles install`) and commit datasets/truth";

/// A golden file, which must have its checksum.
fn text(name: &str) -> String {
    let bytes = Checksums::read(&folder()).and_then(|sums| sums.bytes(name)).unwrap_or_else(|error| panic!("{error}; {AGAIN}"));
    String::from_utf8(bytes).unwrap()
}

fn index() -> Value {
    serde_json::from_str(&text("index.json")).unwrap()
}

/// The rows of a golden file, each with its columns.
fn rows(name: &str) -> Vec<Vec<String>> {
    let text = text(&format!("{name}.csv"));
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    assert_eq!(lines.next().unwrap(), COLUMNS);
    lines.collect()
}

#[test]
fn golden_data_are_those_of_the_witnesses() {
    let index = index();
    assert_eq!(index["rust"], hash_of_rust(), "crates/mechanics/reference/src has changed since the golden data were made: {AGAIN}");
    assert_eq!(index["python"], hash_of_python(), "featherbench_oracles/truth has changed since the golden data were made: {AGAIN}");
    assert_eq!((&index["seed"], &index["digits"]), (&SEED.into(), &DIGITS.into()), "{AGAIN}");
    let cases = index["cases"].as_array().unwrap();
    assert_eq!(cases.len(), CASES.len(), "{AGAIN}");
    for (kept, case) in cases.iter().zip(&CASES) {
        assert_eq!((&kept["name"], &kept["family"]), (&case.name.into(), &case.family.into()), "{AGAIN}");
        assert_eq!(kept["state"], hash_of_state(&case.state(SEED, 0)), "{}: the states are drawn otherwise: {AGAIN}", case.name);
        let disagreement: f64 = kept["disagreement"].as_str().unwrap().parse().unwrap();
        assert!(disagreement <= 1e-100, "{}: the witnesses disagreed by {disagreement:e}", case.name);
    }
}

/// The index and one file per case have a checksum, and no other file has.
#[test]
fn every_golden_file_has_its_checksum() {
    let sums = Checksums::read(&folder()).unwrap();
    let mut due: Vec<String> = CASES.iter().map(|case| format!("{}.csv", case.name)).chain(["index.json".to_owned()]).collect();
    due.sort_unstable();
    assert_eq!(sums.names().collect::<Vec<_>>(), due);
    due.iter().for_each(|name| assert!(!text(name).is_empty()));
}

/// An error in one bit of a file, of the index or of the checksums themselves.
#[test]
fn a_flipped_bit_of_golden_data_is_an_error_that_names_the_file() {
    let copy = tempfile::tempdir().unwrap();
    let names = ["planar_small_10.csv", "index.json", CHECKSUMS_NAME];
    for name in std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name()) {
        std::fs::copy(folder().join(&name), copy.path().join(&name)).unwrap();
    }
    let check = || Checksums::read(copy.path()).and_then(|sums| sums.names().try_for_each(|name| sums.bytes(name).map(drop)));
    check().unwrap();
    let mut flips = 0;
    for name in names {
        let path = copy.path().join(name);
        let whole = std::fs::read(&path).unwrap();
        // All eight bits of every byte of the first line, one bit of each later byte.
        let first = whole.iter().position(|&byte| byte == b'\n').unwrap();
        for at in 0..whole.len() {
            for bit in if at <= first { 0..8 } else { at % 8..at % 8 + 1 } {
                let mut flipped = whole.clone();
                flipped[at] ^= 1 << bit;
                std::fs::write(&path, flipped).unwrap();
                let error = check().expect_err(&format!("bit {bit} of byte {at} of {name}")).to_string();
                assert!(error.contains(name), "bit {bit} of byte {at} of {name}: {error}");
                flips += 1;
            }
        }
        std::fs::write(&path, &whole).unwrap();
    }
    assert!(flips > 5000, "{flips} flips");
}

#[test]
fn golden_data_are_small() {
    let files = std::fs::read_dir(folder()).unwrap().map(Result::unwrap).filter(|entry| entry.file_name() != CHECKSUMS_NAME);
    let bytes: u64 = files.map(|entry| entry.metadata().unwrap().len()).sum();
    assert!((1_000..=100_000).contains(&bytes), "{bytes} bytes in datasets/truth");
}

/// Every number of a golden file is a decimal number that correct rounding turns into the right double.
#[test]
fn golden_numbers_round_as_doubles() {
    for case in &CASES {
        for row in rows(case.name) {
            for text in row {
                assert_eq!(text.parse::<f64>().unwrap(), Precision::STANDARD.parse(&text).unwrap().to_f64(), "{text}");
            }
        }
    }
}

#[test]
fn a_random_twentieth_is_derived_again() {
    let variable = |name: &str| std::env::var(name).ok();
    let day = || std::time::UNIX_EPOCH.elapsed().unwrap().as_secs() / 86_400;
    let seed = variable("FEATHERBENCH_GOLDEN_SEED").map_or_else(day, |text| text.parse().expect("FEATHERBENCH_GOLDEN_SEED is a number"));
    let share = variable("FEATHERBENCH_GOLDEN_SHARE").map_or(0.05, |text| text.parse().expect("FEATHERBENCH_GOLDEN_SHARE is a number"));
    let (index, mut compared) = (index(), 0);
    // By day of every third robot, from another one on each day; who asks for all gets all.
    let of = if share < 1.0 { one_of(3) } else { 1 };
    let cases = CASES.iter().zip(index["cases"].as_array().unwrap());
    for (case, kept) in cases.skip(seed as usize % of).step_by(of) {
        let answers = Answers::derive(case, &case.state(SEED, 0)).unwrap();
        let rows = rows(case.name);
        assert_eq!(rows.len(), answers.id.len(), "{}", case.name);
        let mut random = Random::named(seed, case.name);
        for (column, name) in COLUMNS.iter().enumerate() {
            let fresh = answers.text(name);
            for (dof, (row, fresh)) in rows.iter().zip(&fresh).enumerate() {
                if dof == random.below(rows.len()) || random.unit() < share {
                    assert_eq!(row[column], *fresh, "{}: {name} of dof {dof} (FEATHERBENCH_GOLDEN_SEED={seed}); {AGAIN}", case.name);
                    compared += 1;
                }
            }
        }
        if random.unit() < share {
            let hash = hash_of_doubles(&nearest_doubles(&answers.mass_matrix));
            assert_eq!(kept["mass_matrix"], hash, "{}: mass matrix (FEATHERBENCH_GOLDEN_SEED={seed}); {AGAIN}", case.name);
        }
    }
    println!("{compared} golden numbers derived again (FEATHERBENCH_GOLDEN_SEED={seed})");
    assert!(compared >= 100 / one_of(5), "{compared}");
}
