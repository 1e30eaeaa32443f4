use super::*;
use featherbench_bench::Gates;

fn gates() -> Gates {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ci/gates.toml");
    Gates::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap()
}

fn cell(case: &Case) -> Cell {
    Cell {
        study: STUDY.into(),
        robot: case.name.clone(),
        robot_hash: String::new(),
        params: json!({"case": case.params, "seed": 1}),
        engine: "featherbench".into(),
        version: String::new(),
        method: case.method.clone(),
        quantity: case.quantity.into(),
        scalar: "f64".into(),
    }
}

fn rows(case: &Case, gates: &Gates, values: Vec<f64>) -> Vec<Row> {
    let context = Context { robots: &[], engines: &[], gates, seed: 1 };
    case.rows(&context, &cell(case), &Outcome::Values(values))
}

/// No case twice: a cell finds its case by these words.
#[test]
fn cases_differ() {
    let mut seen = std::collections::BTreeSet::new();
    for case in cases() {
        assert!(seen.insert((case.name.clone(), case.quantity, case.method.clone())), "{} {} {}", case.name, case.quantity, case.method);
    }
    assert!(seen.len() > 250, "{}", seen.len());
    let problems = featherbench_contact::library::all().unwrap();
    assert_eq!(problems.len(), 18);
    for problem in problems {
        assert!(seen.iter().any(|(name, ..)| name == problem.name()), "{}", problem.name());
    }
}

/// Every number is as known, and every judged one has a gate.
#[test]
fn known_numbers_are_reproduced() {
    let gates = gates();
    let (mut passed, mut wrong) = (0, Vec::new());
    for case in cases() {
        let values = match (case.evaluate)(1) {
            Ok(values) => values,
            Err(NoAnswer::NotOffered(_)) => continue,
            Err(other) => {
                wrong.push(format!("{} {} {}: {other}", case.name, case.quantity, case.method));
                continue;
            }
        };
        for (number, row) in case.numbers.iter().zip(rows(&case, &gates, values)) {
            let due = if matches!(number.judged, Judged::No) { Verdict::Info } else { Verdict::Pass };
            passed += usize::from(row.verdict == Verdict::Pass);
            println!("{:<40} {:<18} {:<16} {:<22} {:e}", case.name, case.quantity, case.method, row.metric, row.value.unwrap_or(f64::NAN));
            if row.verdict != due {
                wrong.push(format!("{} {} {} {}: {:?} {:?}", case.name, case.quantity, case.method, row.metric, row.value, row.verdict));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(passed > 300, "{passed}");
}

/// A wrong number fails, and so does NaN.
#[test]
fn wrong_numbers_fail() {
    let gates = gates();
    let mut judged = 0;
    for case in cases() {
        for (place, number) in case.numbers.iter().enumerate() {
            if matches!(number.judged, Judged::No) {
                continue;
            }
            for wrong in [1e3, f64::NAN] {
                let mut values = vec![0.0; case.numbers.len()];
                values[place] = wrong;
                let rows = rows(&case, &gates, values);
                assert_ne!(rows[place].verdict, Verdict::Pass, "{} {} {wrong}", case.name, number.metric);
                assert_ne!(rows[place].verdict, Verdict::Info, "{} {} has no gate", case.name, number.metric);
                judged += 1;
            }
        }
    }
    assert!(judged > 600, "{judged}");
}

/// The same seed gives the same bits.
#[test]
fn draws_repeat() {
    let case = cases().into_iter().find(|case| case.quantity == "contact_draws").unwrap();
    assert_eq!((case.evaluate)(7).unwrap(), (case.evaluate)(7).unwrap());
}
