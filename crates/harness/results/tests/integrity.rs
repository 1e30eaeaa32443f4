//! Damage to a finished run: every flipped bit of every file is an error that names the file.

use std::fs;
use std::path::Path;

use featherbench_results::{
    CHECKSUMS_NAME, CSV_NAME, Checksums, RUN_NAME, Relation, ResultsError, Row, RunInfo, SCHEMA_NAME, checksum, read_run, seal, unsealed,
    write_run, write_run_with,
};

/// A run of three rows with one more file.
fn write(folder: &Path) {
    let row = |value| Row { engine: "mujoco".into(), nv: Some(7), unit: "1".into(), ..Row::default() }.gated(value, Relation::Le, 1e-14);
    fs::write(folder.join("samples.csv"), "1,2,3\n").unwrap();
    let run = RunInfo { suite: "smoke".into(), seed: 7, ..RunInfo::default() };
    write_run_with(folder, &run, &[row(1e-16), row(2.5e-15), row(1e-13)], &featherbench_results::Dictionary::default(), &["samples.csv"])
        .unwrap();
}

#[test]
fn every_flipped_bit_of_a_run_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    assert!(read_run(folder.path()).is_ok());
    let mut flips = 0;
    for name in [CSV_NAME, RUN_NAME, SCHEMA_NAME, CHECKSUMS_NAME, "samples.csv"] {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        // The list of columns is the same in every run: every eighth byte of it is tested, and all bits of all other files.
        for at in (0..whole.len()).step_by(if name == SCHEMA_NAME { 8 } else { 1 }) {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                fs::write(&path, damaged).unwrap();
                let error = read_run(folder.path()).expect_err(&format!("bit {bit} of byte {at} of {name}")).to_string();
                assert!(error.contains(name), "bit {bit} of byte {at} of {name}: {error}");
                flips += 1;
            }
        }
        fs::write(&path, &whole).unwrap();
    }
    assert!(flips > 10_000, "{flips} flips");
    assert!(read_run(folder.path()).is_ok());
}

#[test]
fn a_file_that_is_missing_or_not_listed_is_named() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    for name in [CSV_NAME, RUN_NAME, SCHEMA_NAME, "samples.csv"] {
        let path = folder.path().join(name);
        let kept = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        let error = read_run(folder.path()).unwrap_err();
        assert!(matches!(&error, ResultsError::Absent { path: absent, .. } if *absent == path), "{error}");
        fs::write(&path, kept).unwrap();
    }
    Checksums::of(folder.path(), &[CSV_NAME, RUN_NAME, "samples.csv"]).unwrap().write().unwrap();
    let error = read_run(folder.path()).unwrap_err().to_string();
    assert!(error.contains("has no checksum of schema.json"), "{error}");
    fs::remove_file(folder.path().join(CHECKSUMS_NAME)).unwrap();
    let error = read_run(folder.path()).unwrap_err().to_string();
    assert!(error.contains(CHECKSUMS_NAME) && error.contains("did not finish"), "{error}");
}

/// A run that is being overwritten is unreadable until its checksums are written too.
#[test]
fn rows_of_another_run_do_not_pass_for_those_of_this_one() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let other = tempfile::tempdir().unwrap();
    write_run(other.path(), &RunInfo::default(), &[Row::default()]).unwrap();
    fs::copy(other.path().join(CSV_NAME), folder.path().join(CSV_NAME)).unwrap();
    assert!(read_run(folder.path()).unwrap_err().to_string().contains(CSV_NAME));
    write(folder.path());
    assert!(read_run(folder.path()).is_ok());
}

/// The form of `b3sum`, and its hash of the empty file.
#[test]
fn checksums_are_those_of_b3sum() {
    let empty = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
    assert_eq!(checksum(b""), empty);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("b"), "").unwrap();
    fs::write(folder.path().join("a"), "").unwrap();
    Checksums::of(folder.path(), &["b", "a"]).unwrap().write().unwrap();
    assert_eq!(fs::read_to_string(folder.path().join(CHECKSUMS_NAME)).unwrap(), format!("{empty}  a\n{empty}  b\n"));
    assert_eq!(Checksums::read(folder.path()).unwrap(), Checksums::of(folder.path(), &["a", "b"]).unwrap());
}

#[test]
fn a_seal_holds_every_bit() {
    let mut sealed = b"some bytes\nand a line\n".to_vec();
    let body = sealed.clone();
    seal(&mut sealed);
    assert_eq!(unsealed(&sealed), Some(&body[..]));
    for at in 0..sealed.len() {
        for bit in 0..8 {
            let mut damaged = sealed.clone();
            damaged[at] ^= 1 << bit;
            assert_eq!(unsealed(&damaged), None, "bit {bit} of byte {at}");
        }
        assert_eq!(unsealed(&sealed[..at]), None, "cut to {at} bytes");
    }
    assert_eq!(unsealed(&[&sealed[..], b"\n"].concat()), None);
    let mut nothing = Vec::new();
    seal(&mut nothing);
    assert_eq!(unsealed(&nothing), Some(&b""[..]));
}
