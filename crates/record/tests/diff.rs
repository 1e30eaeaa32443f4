//! What counts as a change between two runs.

use featherbench_record::{Change, Kind, Record, Relation, Verdict, diff};

fn error(model: &str, value: f64, bound: f64) -> Record {
    let row = Record { study: "agreement".into(), model: model.into(), engine: "drake".into(), quantity: "fd".into(), ..Record::default() };
    Record { metric: "backward".into(), unit: "1".into(), ..row }.gated(value, Relation::Le, bound)
}

/// A time with its interval, and the interval of its experiment's control.
fn time(value: f64, spread: f64, control: f64) -> Vec<Record> {
    let row = Record {
        study: "timing".into(),
        model: "panda".into(),
        quantity: "id".into(),
        case: "stream".into(),
        kind: Kind::Measured,
        ..Record::default()
    };
    let of =
        |engine: &str, metric: &str, value: f64| Record { engine: engine.into(), metric: metric.into(), ..row.clone() }.informed(value);
    vec![
        of("native", "ns_per_call", value),
        of("native", "ns_low", value * (1.0 - spread)),
        of("native", "ns_high", value * (1.0 + spread)),
        of("native", "control_low", 1.0 - control),
        of("native", "control_high", 1.0 + control),
    ]
}

fn changes(before: &[Record], after: &[Record]) -> Vec<Change> {
    diff(before, after).changes.iter().map(|changed| changed.change).collect()
}

#[test]
fn a_run_does_not_differ_from_itself() {
    let rows = [vec![error("a", 1e-15, 1e-14), error("a", 1e-15, 1e-14)], time(100.0, 0.01, 0.01)].concat();
    let same = diff(&rows, &rows);
    assert!(same.changes.is_empty());
    assert_eq!(same.compared, rows.len());
}

#[test]
fn verdicts_errors_counts_and_rows() {
    let base = [error("a", 3e-15, 1e-13), error("b", 1e-15, 1e-14)];
    assert_eq!(changes(&base, &[error("a", 1.1e-14, 1e-13), error("b", 1e-15, 1e-14)]), [], "3.7 times");
    assert_eq!(changes(&base, &[error("a", 1.3e-14, 1e-13), error("b", 1e-15, 1e-14)]), [Change::Error]);
    assert_eq!(changes(&[error("a", 1.3e-14, 1e-13)], &[error("a", 3e-15, 1e-13)]), [Change::Error], "smaller is a change too");
    assert_eq!(changes(&[error("a", 1e-17, 1e-13)], &[error("a", 8e-16, 1e-13)]), [], "both are as good as none");
    let worse =
        diff(&base, &[error("b", 2e-14, 1e-14)]).changes.iter().map(|changed| (changed.change, changed.factor())).collect::<Vec<_>>();
    assert_eq!(worse, [(Change::Verdict, Some(2e-14 / 1e-15)), (Change::Gone, None)]);
    assert_eq!(changes(&base[..1], &base), [Change::New]);
    let count =
        |value: f64| [Record { study: "structure".into(), unit: "numbers".into(), ..Record::default() }.gated(value, Relation::Eq, value)];
    assert_eq!(changes(&count(666.0), &count(666.0)), []);
    assert_eq!(changes(&count(666.0), &count(667.0)), [Change::Count]);
    let skipped = Record { verdict: Verdict::Pass, ..error("a", 1e-15, 1e-14) }.without_value(Verdict::Skip, "not offered");
    assert_eq!(changes(&[error("a", 1e-15, 1e-14)], &[skipped]), [Change::Verdict]);
}

#[test]
fn times_change_beyond_their_intervals_and_the_controls() {
    let base = time(100.0, 0.005, 0.01);
    for (after, expected) in [
        (time(105.0, 0.005, 0.01), vec![Change::Time]),
        (time(95.0, 0.005, 0.01), vec![Change::Time]),
        (time(101.5, 0.001, 0.001), vec![]), // apart, and within the noise that is always there
        (time(105.0, 0.06, 0.01), vec![]),   // beyond the noise, and the intervals overlap
        (time(105.0, 0.005, 0.06), vec![]),  // beyond both, but the second run was noisy by its own control
    ] {
        assert_eq!(changes(&base, &after), expected, "{:?}", after[0].value);
    }
    let mut void = time(150.0, 0.005, 0.01);
    void[0].reason = "void: the machine was not quiet".into();
    let found = diff(&base, &void);
    assert_eq!((found.changes.len(), found.void), (0, 1));
    let ratios = |value| {
        time(value, 0.005, 0.01)
            .into_iter()
            .map(|row| Record { metric: row.metric.replace("ns_per_call", "ratio").replace("ns_", "ratio_"), ..row })
            .collect::<Vec<_>>()
    };
    assert_eq!(changes(&ratios(2.0), &ratios(2.2)), [Change::Time]);
}

/// A value that is no number is no small value: NaN.max(x) is x.
#[test]
fn no_number_is_lost() {
    let lost = |row: &Record| Record { value: Some(f64::NAN), ..row.clone() };
    let error = error("a", 1e-17, 1e-13);
    assert_eq!(changes(std::slice::from_ref(&error), &[lost(&error)]), [Change::Error]);
    assert_eq!(changes(&[lost(&error)], std::slice::from_ref(&error)), [Change::Error]);
    assert_eq!(changes(&[lost(&error)], &[lost(&error)]), [], "it was lost before");
    let base = time(100.0, 0.005, 0.01);
    let without = |place: usize, rows: &[Record]| {
        let mut rows = rows.to_vec();
        rows[place] = lost(&rows[place]);
        rows
    };
    assert_eq!(changes(&base, &without(0, &base)), [Change::Time]);
    assert_eq!(changes(&without(0, &base), &base), [Change::Time]);
    // A control that is no number tells nothing about the noise, in either run and at either end: the time is not compared.
    for place in [3, 4] {
        for (before, after) in
            [(base.clone(), without(place, &time(150.0, 0.005, 0.01))), (without(place, &base), time(150.0, 0.005, 0.01))]
        {
            let found = diff(&before, &after);
            assert_eq!((found.changes.len(), found.void), (0, 1), "place {place}");
        }
    }
}
