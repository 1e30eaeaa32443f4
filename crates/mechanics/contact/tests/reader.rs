//! The file of a contact problem: what it says comes back, and what is wrong is named with its place.

use featherbench_contact::systems::{self, Kane};
use featherbench_contact::{Contact, Friction, Level, Problem, file};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn every_case_comes_back() {
    for problem in systems::all().unwrap() {
        assert_eq!(file::parse(&file::to_text(&problem), "case.json").unwrap(), problem, "{}", problem.name());
    }
    let before = Kane::default().problem().unwrap().with_before(nalgebra::DVector::from_vec(vec![-1.0, 0.5])).unwrap();
    assert_eq!(file::parse(&file::to_text(&before), "before.json").unwrap(), before);
}

/// The files of `datasets/contact` hold the problems of `systems`. Numbers may differ by a few ulps: sines differ between platforms.
#[test]
fn the_dataset_holds_the_systems() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../datasets/contact");
    let cases = systems::all().unwrap();
    for problem in &cases {
        let kept = file::read(folder.join(format!("{}.json", problem.name()))).unwrap();
        assert_eq!((kept.name(), kept.level(), kept.contacts().len()), (problem.name(), problem.level(), problem.contacts().len()));
        assert!((kept.delassus() - problem.delassus()).amax() <= 1e-14 * problem.delassus().amax(), "{}", problem.name());
        assert!((kept.free() - problem.free()).amax() <= 1e-14 * problem.scales().velocity, "{}", problem.name());
    }
    let files = std::fs::read_dir(&folder).unwrap().filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|e| e == "json"));
    assert_eq!(files.count(), cases.len(), "each file is a case");
}

#[test]
fn files_are_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kane.json");
    let problem = Kane::default().problem().unwrap();
    file::write(&problem, &path).unwrap();
    assert_eq!(file::read(&path).unwrap(), problem);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let error = file::read(folder.path().join("none.json")).unwrap_err().to_string();
    assert!(error.contains("none.json: the file cannot be used"), "{error}");
    std::fs::write(&path, [0x7b, 0xff]).unwrap();
    assert!(file::read(&path).unwrap_err().to_string().contains("byte 1"));
}

const GOOD: &str = r#"{"schema": 1, "name": "two", "level": "impulse",
 "contacts": [{"name": "a", "friction": {"coulomb": [0.5]}},
              {"name": "b", "friction": "none", "restitution": 0.5}],
 "delassus": [[2.0, 0.5, 0.1],
              [0.5, 2.0, 0.2],
              [0.1, 0.2, 1.0]],
 "free": [-1.0, 0.3, -0.2]}"#;

/// Each mistake of the issue, and more: the message names the file, the line and the field.
#[test]
fn mistakes_are_named() {
    assert!(file::parse(GOOD, "good.json").is_ok());
    for (right, wrong, said) in [
        ("[0.5, 2.0, 0.2]", "[0.6, 2.0, 0.2]", "bad.json:5:16: field 'delassus[1][0]': is 0.6, but the entry across the diagonal is 0.5"),
        ("[[2.0, 0.5, 0.1]", "[[0.1, 0.5, 0.1]", "bad.json:4:14: field 'delassus': has the eigenvalue -"),
        ("[0.1, 0.2, 1.0]", "[0.1, 0.2]", "bad.json:6:15: field 'delassus[2]': has 2 entries, but the contacts need 3"),
        ("[0.1, 0.2, 1.0]", "[0.1, 0.2, NaN]", "bad.json:6:26: field 'delassus[2][2]'"),
        ("[0.1, 0.2, 1.0]", "[0.1, 0.2, 1e999]", "number out of range"),
        ("[0.1, 0.2, 1.0]", "[0.1, 0.2, null]", "bad.json:6:29: field 'delassus[2][2]': invalid type: null"),
        ("[-1.0, 0.3, -0.2]", "[-1.0, 0.3]", "bad.json:7:10: field 'free': has 2 entries, but the contacts need 3"),
        ("[0.5]}}", "[-0.5]}}", "bad.json:2:54: field 'contacts[0].friction.coulomb[0]': the coefficient of friction is -0.5"),
        ("[0.5]}}", "[0.5, 0.5, 0.5]}}", "field 'contacts[0].friction.coulomb': has 3 numbers"),
        (
            "\"none\"",
            "{\"sliding\": {\"coefficient\": 1, \"direction\": [0.5]}}",
            "field 'contacts[1].friction.sliding.direction': has the length 0.5",
        ),
        ("\"none\"", "{\"pyramid\": [[1, 0], [0, 1], [1, 1]]}", "field 'contacts[1].friction.pyramid': the hull"),
        (
            "\"restitution\": 0.5",
            "\"restitution\": 1.5",
            "bad.json:3:64: field 'contacts[1].restitution': the coefficient of restitution is 1.5",
        ),
        ("\"impulse\"", "\"force\"", "a problem at the level of forces has no impact"),
        ("\"impulse\"", "\"push\"", "bad.json:1:44: field 'level': unknown variant `push`"),
        ("\"schema\": 1", "\"schema\": 2", "bad.json:1:12: schema 2 is not known"),
        ("\"free\"", "\"fre\"", "field 'fre': unknown field"),
        (", \"level\": \"impulse\"", "", "missing field `level`"),
        (",\n \"free\": [-1.0, 0.3, -0.2]", "", "'free' is missing"),
        ("-0.2]}", "-0.2]} 7", "trailing characters"),
        ("-0.2]}", "-0.2]", "EOF"),
    ] {
        assert!(GOOD.contains(right), "{right}");
        let error = file::parse(&GOOD.replacen(right, wrong, 1), "bad.json").unwrap_err().to_string();
        assert!(error.starts_with("bad.json:") && error.contains(said), "{wrong}: {error}");
    }
}

#[test]
fn mechanisms_are_checked() {
    let text = file::to_text(&Kane::default().problem().unwrap());
    for (right, wrong, said) in [
        ("\"mass\": [[1.3333333333333333", "\"mass\": [[-1.3333333333333333", "field 'mechanism.mass': is not positive definite"),
        ("\"jacobian\": [[", "\"jacobian\": [[1.0,", "field 'mechanism.jacobian[1]': has 2 entries, but the contacts need 3"),
        ("\"mechanism\":", "\"delassus\": [[1.0]], \"mechanism\":", "there are parts of both"),
    ] {
        assert!(text.contains(right), "{text}");
        let error = file::parse(&text.replacen(right, wrong, 1), "bad.json").unwrap_err().to_string();
        assert!(error.contains(said), "{wrong}: {error}");
    }
}

/// Numbers that are not finite cannot come by a file; they can by the fields.
#[test]
fn numbers_are_finite() {
    let build = |matrix: f64, free: f64, friction: f64| {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, matrix]);
        Problem::from_delassus("x", Level::Impulse, vec![Contact::planar("a", friction)], matrix, DVector::from_vec(vec![-1.0, free]))
    };
    for (problem, field) in [
        (build(f64::NAN, 0.0, 0.5), "delassus[1][1]"),
        (build(1.0, f64::INFINITY, 0.5), "free[1]"),
        (build(1.0, 0.0, f64::NAN), "contacts[0].friction.coulomb[0]"),
    ] {
        assert_eq!(problem.unwrap_err().field, field);
    }
    let none = Problem::from_delassus("x", Level::Impulse, Vec::new(), DMatrix::zeros(0, 0), DVector::zeros(0));
    assert_eq!(none.unwrap_err().field, "contacts");
}

fn friction() -> impl Strategy<Value = Friction> {
    prop_oneof![
        Just(Friction::None),
        prop::collection::vec(0.0..3.0, 1..=2).prop_map(|coefficients| Friction::Coulomb { coefficients }),
        (0.0..3.0, prop::bool::ANY)
            .prop_map(|(coefficient, right)| Friction::Sliding { coefficient, direction: vec![if right { 1.0 } else { -1.0 }] }),
        (0.1..2.0).prop_map(|a| Friction::Pyramid { vertices: vec![[a, 0.0], [0.0, a], [-a, 0.1], [0.0, -a]] }),
    ]
}

fn problem() -> impl Strategy<Value = Problem> {
    let contact = ("[a-z \"\\\\é]{0,8}", friction(), 0.0..=1.0).prop_map(|(name, friction, e)| Contact { name, friction, restitution: e });
    prop::collection::vec(contact, 1..5).prop_flat_map(|contacts| {
        let rows: usize = contacts.iter().map(Contact::dimension).sum();
        (Just(contacts), prop::collection::vec(-1.0..1.0, rows * rows), prop::collection::vec(-1e3..1e3, rows)).prop_map(
            move |(contacts, factor, free)| {
                let factor = DMatrix::from_vec(rows, rows, factor);
                let matrix: DMatrix<f64> = &factor * factor.transpose();
                // The products of mirrored entries are the same numbers in the same order, up to the compiler's choice.
                let matrix = (&matrix + matrix.transpose()) * 0.5;
                Problem::from_delassus("drawn", Level::Impulse, contacts, matrix, DVector::from_vec(free)).unwrap()
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(15),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Writing and reading gives the same bits.
    #[test]
    fn what_is_written_comes_back(problem in problem()) {
        let text = file::to_text(&problem);
        prop_assert_eq!(file::parse(&text, "drawn.json").unwrap(), problem);
    }

    /// A file that is cut anywhere or has a byte replaced is read or refused; nothing panics, and an error names the file.
    #[test]
    fn damaged_files_are_refused(problem in problem(), cut in 0.0..1.0, byte in 32_u8..127) {
        let text = file::to_text(&problem);
        let place = (0..=text.len()).rev().find(|place| text.is_char_boundary(*place) && *place as f64 <= cut * text.len() as f64).unwrap();
        let short = &text[..place];
        prop_assert!(short.trim_end().len() == text.trim_end().len() || file::parse(short, "cut.json").is_err());
        let mut changed = text.clone().into_bytes();
        if place < changed.len() && changed[place].is_ascii() {
            changed[place] = byte;
            if let Err(error) = file::parse(std::str::from_utf8(&changed).unwrap(), "changed.json") {
                prop_assert!(error.to_string().starts_with("changed.json"));
            }
        }
    }

    /// No solver panics or answers with a number that is none.
    #[test]
    fn answers_are_numbers(problem in problem()) {
        for solver in featherbench_contact::solver::all() {
            if ["gauss_seidel", "admm"].contains(&solver.name()) {
                continue;
            }
            if let Ok(solution) = solver.solve(&problem) {
                for point in solution.points() {
                    prop_assert!(point.impulses.iter().chain(&point.velocities).all(|x| x.is_finite()));
                }
            }
        }
    }
}
