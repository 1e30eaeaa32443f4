//! What counts as a change between two runs.

use featherbench_results::{Change, ERROR_FACTOR, ERROR_FLOOR, Kind, Record, Relation, TIME_NOISE, Verdict, diff};

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

/// A row of a study without a gate.
fn exact(metric: &str, unit: &str, value: f64) -> Record {
    Record { study: "structure".into(), metric: metric.into(), unit: unit.into(), ..Record::default() }.informed(value)
}

/// A measured row that is no time.
fn measured(metric: &str, value: f64) -> Record {
    Record { study: "timing".into(), metric: metric.into(), unit: "1".into(), kind: Kind::Measured, ..Record::default() }.informed(value)
}

/// The kinds in the order of [`Change::ALL`]; within a kind, the order of the second run, and of the first for what is gone.
#[test]
fn changes_are_listed_by_kind_and_then_in_the_order_of_the_run() {
    let void = |name: &str| error(name, 1e-15, 1e-14);
    let before = [vec![void("gone z"), void("gone a"), error("e2", 1e-15, 1.0), error("e1", 1e-15, 1.0)], time(100.0, 0.0, 0.0)].concat();
    let count = |value| Record { study: "structure".into(), unit: "numbers".into(), ..Record::default() }.informed(value);
    let before = [before, vec![count(5.0), error("v", 1e-15, 1e-14)]].concat();
    let after = [
        vec![void("new z"), error("e2", 1e-13, 1.0), void("new a"), error("e1", 1e-13, 1.0)],
        time(200.0, 0.0, 0.0),
        vec![error("v", 1e-13, 1e-14), count(6.0)],
    ]
    .concat();
    let found = diff(&before, &after);
    let listed: Vec<(Change, &str)> =
        found.changes.iter().map(|changed| (changed.change, changed.after.or(changed.before).unwrap().model.as_str())).collect();
    let expected = [
        (Change::Verdict, "v"),
        (Change::Count, ""),
        (Change::Error, "e2"),
        (Change::Error, "e1"),
        (Change::Time, "panda"),
        (Change::Gone, "gone z"),
        (Change::Gone, "gone a"),
        (Change::New, "new z"),
        (Change::New, "new a"),
    ];
    assert_eq!(listed, expected);
    // The errors of two robots, the verdict, the count, and the five rows of the time; none of them void.
    assert_eq!((found.compared, found.void), (9, 0));
}

/// Rows that nothing tells apart are compared one by one, in their order.
#[test]
fn rows_that_nothing_tells_apart_are_numbered() {
    let before = [exact("links", "links", 1.0), exact("links", "links", 2.0)];
    let after = [exact("links", "links", 1.0), exact("links", "links", 3.0), exact("links", "links", 4.0)];
    let found = diff(&before, &after);
    let listed: Vec<_> = found
        .changes
        .iter()
        .map(|changed| (changed.change, changed.before.and_then(|row| row.value), changed.after.and_then(|row| row.value)))
        .collect();
    assert_eq!(listed, [(Change::Count, Some(2.0), Some(3.0)), (Change::New, None, Some(4.0))]);
    assert_eq!(found.compared, 2);
    assert_eq!(changes(&after, &before), [Change::Count, Change::Gone]);
}

/// Only exact values are counts or errors: a measured row that is no time says nothing by moving, in either run.
#[test]
fn measured_values_are_no_errors() {
    for metric in ["control_low", "ns_low", "instructions"] {
        assert_eq!(changes(&[measured(metric, 1.0)], &[measured(metric, 2.0)]), [], "{metric}");
    }
    let now_exact = |value| Record { kind: Kind::Exact, ..measured("spread", value) };
    assert_eq!(changes(&[measured("spread", 1.0)], &[now_exact(9.0)]), []);
    assert_eq!(changes(&[now_exact(1.0)], &[measured("spread", 9.0)]), []);
    assert_eq!(changes(&[now_exact(1.0)], &[now_exact(9.0)]), [Change::Error]);
    // An exact row with the name of a time is none.
    let named = |value| Record { kind: Kind::Exact, ..measured("ns_per_call", value) };
    assert_eq!(changes(&[named(1.0)], &[named(1.1)]), []);
    assert_eq!(changes(&[named(1.0)], &[named(5.0)]), [Change::Error]);
}

/// A count has a unit, or a bound that it must equal; any step of it is a change. An error is a pure number with neither.
#[test]
fn what_is_a_count_and_what_is_an_error() {
    assert_eq!(changes(&[exact("stored", "numbers", 100.0)], &[exact("stored", "numbers", 101.0)]), [Change::Count]);
    assert_eq!(changes(&[exact("ratio of counts", "1", 100.0)], &[exact("ratio of counts", "1", 101.0)]), []);
    let equal = |value: f64| [Record { unit: "1".into(), ..exact("same", "1", value) }.gated(value, Relation::Eq, value)];
    assert_eq!(changes(&equal(100.0), &equal(101.0)), [Change::Count]);
    assert_eq!(changes(&[exact("stored", "numbers", 0.0)], &[exact("stored", "numbers", 1e-17)]), [Change::Count], "counts have no floor");
    // The sign of a count is a change, that of an error is none.
    assert_eq!(changes(&[exact("energy", "J", 1.0)], &[exact("energy", "J", -1.0)]), [Change::Count]);
    assert_eq!(changes(&[exact("drift", "1", 1.0)], &[exact("drift", "1", -1.0)]), []);
    assert_eq!(changes(&[exact("drift", "1", -1.0)], &[exact("drift", "1", -5.0)]), [Change::Error]);
    // A row that never had a value has none to move.
    let none = || Record { unit: "numbers".into(), ..Record::default() }.without_value(Verdict::Skip, "not offered");
    assert_eq!(changes(&[none()], &[none()]), []);
}

/// [`ERROR_FACTOR`] itself is no change, and [`ERROR_FLOOR`] stands for whatever is smaller, on either side.
#[test]
fn errors_move_by_more_than_the_factor_and_above_the_floor() {
    let of = |was: f64, is: f64| changes(&[exact("scaled", "1", was)], &[exact("scaled", "1", is)]);
    let more = |x: f64| x * (1.0 + 1e-9);
    // From each start: exactly the factor, and a little more.
    for start in [1e-10, 1.0] {
        assert_eq!(of(start, ERROR_FACTOR * start), []);
        assert_eq!(of(start, more(ERROR_FACTOR * start)), [Change::Error]);
        assert_eq!(of(ERROR_FACTOR * start, start), []);
        assert_eq!(of(more(ERROR_FACTOR * start), start), [Change::Error]);
    }
    for nothing in [0.0, 1e-300, ERROR_FLOOR] {
        assert_eq!(of(nothing, ERROR_FACTOR * ERROR_FLOOR), []);
        assert_eq!(of(nothing, more(ERROR_FACTOR * ERROR_FLOOR)), [Change::Error]);
        assert_eq!(of(ERROR_FACTOR * ERROR_FLOOR, nothing), []);
        assert_eq!(of(more(ERROR_FACTOR * ERROR_FLOOR), nothing), [Change::Error]);
    }
}

/// The noise of an experiment is how far its control's interval reaches from one, on the side where it reaches farther, in either run.
#[test]
fn the_noise_is_the_farther_end_of_the_control() {
    let with = |value: f64, low: f64, high: f64| {
        let mut rows = time(value, 0.001, 0.0);
        for row in &mut rows {
            row.value = match row.metric.as_str() {
                "control_low" => Some(low),
                "control_high" => Some(high),
                _ => row.value,
            };
        }
        rows
    };
    let quiet = with(100.0, 1.0, 1.0);
    for noisy in [with(110.0, 0.88, 1.01), with(110.0, 0.99, 1.12), with(110.0, 1.0, 1.12), with(110.0, 0.88, 1.0)] {
        assert_eq!(changes(&quiet, &noisy), [], "10 % and a control of 12 %");
        assert_eq!(changes(&noisy, &quiet), [], "the first run's control counts as well");
    }
    for calm in [with(110.0, 0.92, 1.01), with(110.0, 0.99, 1.08)] {
        assert_eq!(changes(&quiet, &calm), [Change::Time], "10 % and a control of 8 %");
        assert_eq!(changes(&calm, &quiet), [Change::Time]);
    }
    // The control of another robot, quantity or case is another experiment's.
    let rename: [fn(&mut Record); 3] = [|row| row.model += "2", |row| row.quantity += "2", |row| row.case += "2"];
    for rename in rename {
        let mut after = with(110.0, 1.0, 1.0);
        let mut other = with(110.0, 0.5, 1.5);
        other.iter_mut().for_each(rename);
        after.extend(other);
        assert_eq!(changes(&quiet, &after), [Change::Time, Change::New, Change::New, Change::New, Change::New, Change::New]);
    }
}

/// Times without intervals are their own; a ratio's interval is that of the ratio.
#[test]
fn times_without_intervals_are_compared_as_they_are() {
    let bare = |metric: &str, value: f64| vec![Record { unit: "ns".into(), ..measured(metric, value) }];
    for metric in ["ns_per_call", "ratio"] {
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, 103.0)), [Change::Time]);
        assert_eq!(changes(&bare(metric, 103.0), &bare(metric, 100.0)), [Change::Time]);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, 101.5)), []);
        assert_eq!(changes(&bare(metric, 101.5), &bare(metric, 100.0)), []);
        // Exactly the noise that is always there, and a little more.
        let edge = 100.0 * (1.0 + TIME_NOISE);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, edge - 1e-9)), []);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, edge + 1e-9)), [Change::Time]);
        assert_eq!(changes(&bare(metric, edge + 1e-9), &bare(metric, 100.0)), [Change::Time]);
    }
    // Intervals that touch are not apart.
    let wide = |value: f64, low: f64, high: f64| [bare("ns_per_call", value), bare("ns_low", low), bare("ns_high", high)].concat();
    assert_eq!(changes(&wide(100.0, 95.0, 105.0), &wide(110.0, 105.0, 115.0)), []);
    assert_eq!(changes(&wide(110.0, 105.0, 115.0), &wide(100.0, 95.0, 105.0)), []);
    assert_eq!(changes(&wide(100.0, 95.0, 105.0), &wide(110.0, 105.1, 115.0)), [Change::Time]);
    assert_eq!(changes(&wide(110.0, 105.1, 115.0), &wide(100.0, 95.0, 105.0)), [Change::Time]);
    // The interval of a time is not that of a ratio.
    let mixed = |value: f64| [bare("ratio", value), bare("ns_low", 0.0), bare("ns_high", 1e9)].concat();
    assert_eq!(changes(&mixed(1.0), &mixed(2.0)), [Change::Time]);
}

/// A void time is not compared in either direction, but its verdict is where it has no value.
#[test]
fn void_times_are_counted_and_not_compared() {
    let void = |value: f64| {
        let mut rows = time(value, 0.005, 0.01);
        rows[0].reason = "void: the machine was not quiet".into();
        rows
    };
    for (before, after) in [(void(100.0), time(150.0, 0.005, 0.01)), (time(100.0, 0.005, 0.01), void(150.0)), (void(100.0), void(150.0))] {
        let found = diff(&before, &after);
        assert_eq!((found.changes.len(), found.void, found.compared), (0, 1, before.len()));
    }
    // A reason that only mentions it, and a void row that is no time.
    let mut mentioned = time(150.0, 0.005, 0.01);
    mentioned[0].reason = "not void: ".into();
    assert_eq!(changes(&time(100.0, 0.005, 0.01), &mentioned), [Change::Time]);
    let mut failed = time(100.0, 0.005, 0.01);
    failed[0] = failed[0].clone().without_value(Verdict::Error, "void: it broke");
    assert_eq!(changes(&time(100.0, 0.005, 0.01), &failed), [Change::Verdict]);
    assert_eq!(changes(&failed, &time(100.0, 0.005, 0.01)), [Change::Verdict]);
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
