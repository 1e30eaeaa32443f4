//! What the tests of every study of known answers ask.

use crate::share::one_of;
use featherbench_bench::{Cell, Context, Gates, NoAnswer, Outcome};
use featherbench_results::{Row, Verdict};
use featherbench_study::known::{Case, Judged};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde_json::json;

/// The gates of the project.
pub(crate) fn gates() -> Gates {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../ci/gates.toml");
    Gates::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap()
}

fn rows(study: &str, case: &Case, gates: &Gates, values: Vec<f64>) -> Vec<Row> {
    let context = Context { robots: &[], engines: &[], gates, seed: 1 };
    let cell = Cell::of_case(study, &case.name, ("featherbench", ""), case.quantity, &case.method, json!({"case": case.params, "seed": 1}));
    case.rows(&context, &cell, &Outcome::Values(values))
}

/// No case twice: a cell finds its case by these words. Returns how many there are.
pub(crate) fn cases_differ(cases: &[Case]) -> usize {
    let mut seen = std::collections::BTreeSet::new();
    for case in cases {
        assert!(seen.insert((case.name.clone(), case.quantity, case.method.clone())), "{} {} {}", case.name, case.quantity, case.method);
    }
    seen.len()
}

/// A case with what it answers.
pub(crate) type Answered = (Case, Result<Vec<f64>, NoAnswer>);

/// Those that are answered by day. At night, and when the suite runs, all are: these are its longest.
pub(crate) fn but_long(mut cases: Vec<Case>, long: impl Fn(&Case) -> bool) -> Vec<Case> {
    let count = cases.len();
    cases.retain(|case| one_of(2) == 1 || !long(case));
    assert!(cases.len() < count || one_of(2) == 1, "no case is long");
    cases
}

/// The answers of all cases for the seed 1.
pub(crate) fn answered(cases: Vec<Case>) -> Vec<Answered> {
    let answers: Vec<_> = cases.par_iter().map(|case| (case.evaluate)(1)).collect();
    cases.into_iter().zip(answers).collect()
}

/// Every number is as known, and every judged one has a gate. Returns how many passed.
pub(crate) fn numbers_are_as_known(study: &str, cases: Vec<Case>) -> usize {
    answers_are_as_known(study, &answered(cases))
}

/// The same of answers that are there.
pub(crate) fn answers_are_as_known(study: &str, answered: &[Answered]) -> usize {
    let gates = gates();
    let (mut passed, mut wrong) = (0, Vec::new());
    for (case, answer) in answered {
        let values = match answer {
            Ok(values) => values.clone(),
            Err(NoAnswer::NotOffered(_)) => continue,
            Err(other) => {
                wrong.push(format!("{} {} {}: {other}", case.name, case.quantity, case.method));
                continue;
            }
        };
        for (number, row) in case.numbers.iter().zip(rows(study, case, &gates, values)) {
            let due = if matches!(number.judged, Judged::No) { Verdict::Info } else { Verdict::Pass };
            passed += usize::from(row.verdict == Verdict::Pass);
            println!("{:<40} {:<18} {:<16} {:<22} {:e}", case.name, case.quantity, case.method, row.metric, row.value.unwrap_or(f64::NAN));
            if row.verdict != due {
                wrong.push(format!("{} {} {} {}: {:?} {:?}", case.name, case.quantity, case.method, row.metric, row.value, row.verdict));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    passed
}

/// A wrong number fails, and so does NaN. Returns how many were judged.
pub(crate) fn wrong_numbers_fail(study: &str, cases: &[Case]) -> usize {
    let gates = gates();
    let mut judged = 0;
    for case in cases {
        for (place, number) in case.numbers.iter().enumerate() {
            if matches!(number.judged, Judged::No) {
                continue;
            }
            // No known count or bound is as large.
            for wrong in [1e9, f64::NAN] {
                let mut values = vec![0.0; case.numbers.len()];
                values[place] = wrong;
                let rows = rows(study, case, &gates, values);
                assert_ne!(rows[place].verdict, Verdict::Pass, "{} {} {wrong}", case.name, number.metric);
                assert_ne!(rows[place].verdict, Verdict::Info, "{} {} has no gate", case.name, number.metric);
                judged += 1;
            }
        }
    }
    judged
}
