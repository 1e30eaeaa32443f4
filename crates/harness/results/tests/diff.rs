//! What counts as a change between two runs.

use featherbench_results::{
    COMMON, Change, ERROR_FACTOR, ERROR_FLOOR, FALSE_SHARE, Kind, NORMAL, Relation, Row, STUDENT, TIME_NOISE, Verdict, diff,
};

fn error(model: &str, value: f64, bound: f64) -> Row {
    let row = Row { study: "agreement".into(), robot: model.into(), engine: "drake".into(), quantity: "fd".into(), ..Row::default() };
    Row { metric: "backward".into(), unit: "1".into(), ..row }.gated(value, Relation::Le, bound)
}

/// A time with its interval.
fn time(value: f64, spread: f64) -> Vec<Row> {
    let row = Row { study: "timing".into(), robot: "panda".into(), quantity: "id".into(), cache: "stream".into(), ..Row::default() };
    let row = Row { engine: "featherbench".into(), metric: "ns_per_call".into(), kind: Kind::Measured, ..row };
    vec![row.measured(value, value * (1.0 - spread), value * (1.0 + spread))]
}

fn changes(before: &[Row], after: &[Row]) -> Vec<Change> {
    diff(before, after).changes.iter().map(|changed| changed.change).collect()
}

#[test]
fn a_run_does_not_differ_from_itself() {
    let rows = [vec![error("a", 1e-15, 1e-14), error("a", 1e-15, 1e-14)], time(100.0, 0.01)].concat();
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
        |value: f64| [Row { study: "operations".into(), unit: "numbers".into(), ..Row::default() }.gated(value, Relation::Eq, value)];
    assert_eq!(changes(&count(666.0), &count(666.0)), []);
    assert_eq!(changes(&count(666.0), &count(667.0)), [Change::Count]);
    let skipped = Row { verdict: Verdict::Pass, ..error("a", 1e-15, 1e-14) }.without_value(Verdict::Skip, "not offered");
    assert_eq!(changes(&[error("a", 1e-15, 1e-14)], &[skipped]), [Change::Verdict]);
}

/// Rows of times with these ratios to 100 ns and this relative half-width.
fn times(ratios: &[f64], spread: f64) -> Vec<Row> {
    let of = |(k, ratio): (usize, &f64)| Row { robot: format!("robot {k}"), ..time(100.0 * ratio, spread).remove(0) };
    ratios.iter().enumerate().map(of).collect()
}

/// Student's quantile for 14 degrees of freedom, by the density (1 + t²/14)^(−15/2), but for a factor, and Simpson's rule.
fn quantile(beyond: f64) -> f64 {
    let density = |t: f64| (1.0 + t * t / 14.0).powf(-7.5);
    // t = u/(1 − u²) takes u from 0 to 1 over all positive numbers.
    let until = |end: f64| {
        let h = end / 20_000.0;
        let of = |u: f64| density(u / (1.0 - u * u)) * (1.0 + u * u) / (1.0 - u * u).powi(2);
        (0..20_000).map(|k| f64::from(k) * h).map(|u| h / 6.0 * (of(u) + 4.0 * of(u + 0.5 * h) + of(u + h))).sum::<f64>()
    };
    let (whole, mut low, mut high) = (until(1.0 - 1e-9), 0.0, 1.0 - 1e-9);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 1.0 - until(middle) / whole > beyond { low = middle } else { high = middle }
    }
    low / (1.0 - low * low)
}

#[test]
fn times_change_beyond_the_noise_and_beyond_chance() {
    let base = time(100.0, 0.005);
    for (after, expected) in [
        (time(105.0, 0.005), vec![Change::Time]),
        (time(95.0, 0.005), vec![Change::Time]),
        (time(100.9, 0.001), vec![]), // apart, and within the noise that is always there
        (time(105.0, 0.06), vec![]),  // beyond the noise, and as likely by chance
    ] {
        assert_eq!(changes(&base, &after), expected, "{:?}", after[0].value);
    }
    // A single time changes where chance alone is as far with this probability: at so many of its standard errors, of logarithms.
    let half = |spread: f64| 0.5 * ((1.0 + spread) / (1.0 - spread)).ln();
    let at = |p: f64| 100.0 * (quantile(p) * half(0.005).hypot(half(0.03)) / STUDENT).exp();
    let edge = at(FALSE_SHARE);
    assert_eq!(changes(&base, &time(edge - 1e-6, 0.03)), []);
    assert_eq!(changes(&base, &time(edge + 1e-6, 0.03)), [Change::Time]);
    assert_eq!(changes(&time(edge + 1e-6, 0.03), &base), [Change::Time]);
    let mut invalid = time(150.0, 0.005);
    invalid[0] = invalid[0].clone().invalid("the machine was not quiet");
    let found = diff(&base, &invalid);
    assert_eq!((found.changes.len(), found.invalid), (0, 1));
    let ratios = |value| {
        time(value, 0.005).into_iter().map(|row| Row { metric: row.metric.replace("ns_per_call", "ratio"), ..row }).collect::<Vec<_>>()
    };
    assert_eq!(changes(&ratios(2.0), &ratios(2.2)), [Change::Time]);
}

/// What moves all times of a machine is in their intervals, and in the factor that they have in common. A single time keeps it.
#[test]
fn the_drift_of_a_machine_is_no_noise_of_times_over_a_common_factor() {
    let drifting = |ratios: &[f64]| -> Vec<Row> {
        let wide = 0.01_f64.hypot(NORMAL * 0.02).exp() - 1.0;
        times(ratios, wide).into_iter().map(|row| Row { params: r#"{"drift":0.02,"states":7}"#.into(), ..row }).collect()
    };
    let [mut slower, all] = [[1.0; COMMON], [1.05; COMMON]];
    slower[3] = 1.05;
    assert_eq!(changes(&drifting(&[1.0; COMMON]), &drifting(&slower)), [Change::Time]);
    assert_eq!(changes(&drifting(&[1.0; COMMON]), &drifting(&all)), []);
    assert_eq!(changes(&drifting(&[1.0]), &drifting(&[1.05])), [], "of few times there is no common factor");
}

/// One change among many times needs more evidence than each of many changes (Benjamini and Hochberg).
#[test]
fn a_time_among_many_changes_if_chance_makes_no_such_among_so_many() {
    const TIMES: usize = 200;
    let base = times(&[1.0; TIMES], 0.03);
    let apart = |p: f64| (quantile(p) * 2.0_f64.sqrt() * 0.5 * (1.03_f64 / 0.97).ln() / STUDENT).exp();
    let found = |count: usize, p: f64| {
        let mut ratios = [1.0; TIMES];
        ratios[..count].fill(apart(p));
        changes(&base, &times(&ratios, 0.03)).len()
    };
    for count in [1, 10, 50] {
        let level = FALSE_SHARE * count as f64 / TIMES as f64;
        assert_eq!([found(count, 0.99 * level), found(count, 1.01 * level)], [count, 0], "{count}");
    }
    // A smaller p-value that is not good enough alone is taken along by a larger one that is, and a larger one takes itself.
    let step = |k: usize| FALSE_SHARE * k as f64 / TIMES as f64;
    let mut ratios = [1.0; TIMES];
    ratios[..3].copy_from_slice(&[apart(1.5 * step(1)), apart(1.2 * step(2)), apart(0.9 * step(3))]);
    assert_eq!(changes(&base, &times(&ratios, 0.03)).len(), 3);
    ratios[2] = apart(1.1 * step(3));
    assert_eq!(changes(&base, &times(&ratios, 0.03)).len(), 0);
}

/// Of times without a change, seldom a run has one that is told; of such with changes, few are told that have none.
#[test]
fn of_what_is_told_chance_made_a_small_share() {
    // A linear congruential generator (Knuth's MMIX); its upper bits from 0 to 1.
    let mut state = 45_u64;
    let mut unit = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * 2.0_f64.powi(-53)
    };
    // The mean of eight numbers with a deviation of 1 %, and the half-width of its interval.
    let mut drawn = |ratio: f64| {
        let logs: Vec<f64> = (0..8).map(|_| 0.01 * (0..12).map(|_| unit() - 0.5).sum::<f64>()).collect();
        let mean = logs.iter().sum::<f64>() / 8.0;
        let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / 7.0;
        let (value, half) = (100.0 * ratio * mean.exp(), STUDENT * (variance / 8.0).sqrt());
        time(1.0, 0.0).remove(0).measured(value, value * (-half).exp(), value * half.exp())
    };
    let mut run = |slower: usize| -> Vec<Row> {
        (0..400).map(|k| Row { robot: format!("robot {k}"), ..drawn(if k < slower { 1.04 } else { 1.0 }) }).collect()
    };
    let [mut alarms, mut told, mut by_chance] = [0, 0, 0];
    for _ in 0..50 {
        alarms += changes(&run(0), &run(0)).len();
        let (before, after) = (run(0), run(40));
        let found = diff(&before, &after).changes;
        told += found.len();
        by_chance += found.iter().filter(|changed| !(0..40).any(|k| changed.after.unwrap().robot == format!("robot {k}"))).count();
    }
    // Of 20 000 times without a change: one in a thousand at most. Of 2000 that changed: almost all.
    assert!(alarms <= 20 && told - by_chance >= 1990, "{alarms} alarms; {told} told, {by_chance} by chance");
    assert!((by_chance as f64) < FALSE_SHARE * told as f64, "{by_chance} of {told}");
}

/// A row of a study without a gate.
fn exact(metric: &str, unit: &str, value: f64) -> Row {
    Row { study: "operations".into(), metric: metric.into(), unit: unit.into(), ..Row::default() }.informed(value)
}

/// A measured row that is not a time.
fn measured(metric: &str, value: f64) -> Row {
    Row { study: "timing".into(), metric: metric.into(), unit: "1".into(), kind: Kind::Measured, ..Row::default() }.informed(value)
}

/// The kinds in the order of [`Change::ALL`]. Within a kind, the order of the second run; for rows that are gone, that of the first.
#[test]
fn changes_are_listed_by_kind_and_then_in_the_order_of_the_run() {
    let small = |name: &str| error(name, 1e-15, 1e-14);
    let before = [vec![small("gone z"), small("gone a"), error("e2", 1e-15, 1.0), error("e1", 1e-15, 1.0)], time(100.0, 0.0)].concat();
    let count = |value| Row { study: "operations".into(), unit: "numbers".into(), ..Row::default() }.informed(value);
    let before = [before, vec![count(5.0), error("v", 1e-15, 1e-14)]].concat();
    let after = [
        vec![small("new z"), error("e2", 1e-13, 1.0), small("new a"), error("e1", 1e-13, 1.0)],
        time(200.0, 0.0),
        vec![error("v", 1e-13, 1e-14), count(6.0)],
    ]
    .concat();
    let found = diff(&before, &after);
    let listed: Vec<(Change, &str)> =
        found.changes.iter().map(|changed| (changed.change, changed.after.or(changed.before).unwrap().robot.as_str())).collect();
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
    // The errors of two robots, the verdict, the count and the time; all of them valid.
    assert_eq!((found.compared, found.invalid), (5, 0));
}

/// Rows with the same key are compared one by one, in their order.
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

/// Only exact values are counts or errors. A measured row that is not a time has no changes, in either run.
#[test]
fn measured_values_are_no_errors() {
    for metric in ["control", "finding", "instructions"] {
        assert_eq!(changes(&[measured(metric, 1.0)], &[measured(metric, 2.0)]), [], "{metric}");
    }
    let now_exact = |value| Row { kind: Kind::Exact, ..measured("spread", value) };
    assert_eq!(changes(&[measured("spread", 1.0)], &[now_exact(9.0)]), []);
    assert_eq!(changes(&[now_exact(1.0)], &[measured("spread", 9.0)]), []);
    assert_eq!(changes(&[now_exact(1.0)], &[now_exact(9.0)]), [Change::Error]);
    // An exact row with the metric of a time is not a time.
    let named = |value| Row { kind: Kind::Exact, ..measured("ns_per_call", value) };
    assert_eq!(changes(&[named(1.0)], &[named(1.1)]), []);
    assert_eq!(changes(&[named(1.0)], &[named(5.0)]), [Change::Error]);
}

/// A count has a unit, or a bound that it must equal; any step of it is a change. An error is a pure number with neither.
#[test]
fn what_is_a_count_and_what_is_an_error() {
    assert_eq!(changes(&[exact("stored", "numbers", 100.0)], &[exact("stored", "numbers", 101.0)]), [Change::Count]);
    assert_eq!(changes(&[exact("ratio of counts", "1", 100.0)], &[exact("ratio of counts", "1", 101.0)]), []);
    let equal = |value: f64| [Row { unit: "1".into(), ..exact("same", "1", value) }.gated(value, Relation::Eq, value)];
    assert_eq!(changes(&equal(100.0), &equal(101.0)), [Change::Count]);
    assert_eq!(changes(&[exact("stored", "numbers", 0.0)], &[exact("stored", "numbers", 1e-17)]), [Change::Count], "counts have no floor");
    // The sign of a count is a change, that of an error is not.
    assert_eq!(changes(&[exact("energy", "J", 1.0)], &[exact("energy", "J", -1.0)]), [Change::Count]);
    assert_eq!(changes(&[exact("drift", "1", 1.0)], &[exact("drift", "1", -1.0)]), []);
    assert_eq!(changes(&[exact("drift", "1", -1.0)], &[exact("drift", "1", -5.0)]), [Change::Error]);
    // A row that never had a value has no change of value.
    let none = || Row { unit: "numbers".into(), ..Row::default() }.without_value(Verdict::Skip, "not offered");
    assert_eq!(changes(&[none()], &[none()]), []);
}

/// [`ERROR_FACTOR`] itself is not a change, and [`ERROR_FLOOR`] replaces any smaller value, on either side.
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

/// Where all times have a factor in common it is told, and each is compared over it. A ratio has its own.
#[test]
fn what_all_times_have_in_common_is_no_change_of_each() {
    let many = |factor: f64, planted: f64| -> Vec<Row> {
        let of = |k: usize| {
            let mut row = time(100.0 * (1 + k) as f64 * factor * if k == 3 { planted } else { 1.0 }, 0.004).remove(0);
            row.robot = format!("robot {k}");
            let ratio = Row { metric: "ratio".into(), ..row.clone() }.measured(2.0 * factor, 2.0 * factor, 2.0 * factor);
            [row, ratio]
        };
        (0..COMMON).flat_map(of).collect()
    };
    let base = many(1.0, 1.0);
    let slower = many(1.06, 1.0);
    let found = diff(&base, &slower);
    assert!((found.common - 1.06).abs() < 1e-12);
    assert!(found.changes.iter().all(|changed| changed.after.unwrap().metric == "ratio") && found.changes.len() == COMMON);
    let planted = many(1.06, 1.03);
    let found = diff(&base, &planted);
    let times: Vec<_> = found.changes.iter().filter(|changed| changed.after.unwrap().metric == "ns_per_call").collect();
    assert!(times.len() == 1 && times[0].after.unwrap().robot == "robot 3", "{times:?}");
    // Too few to say what they have in common.
    let few = diff(&base[..6], &slower[..6]);
    assert_eq!((few.common, few.changes.len()), (1.0, 6));
}

/// Times without intervals are their own intervals; a ratio's interval is that of the ratio.
#[test]
fn times_without_intervals_are_compared_as_they_are() {
    let bare = |metric: &str, value: f64| vec![Row { unit: "ns".into(), ..measured(metric, value) }];
    for metric in ["ns_per_call", "ratio"] {
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, 103.0)), [Change::Time]);
        assert_eq!(changes(&bare(metric, 103.0), &bare(metric, 100.0)), [Change::Time]);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, 100.5)), []);
        assert_eq!(changes(&bare(metric, 100.5), &bare(metric, 100.0)), []);
        // Exactly the smallest noise, and a little more.
        let edge = 100.0 * (1.0 + TIME_NOISE);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, edge - 1e-9)), []);
        assert_eq!(changes(&bare(metric, 100.0), &bare(metric, edge + 1e-9)), [Change::Time]);
        assert_eq!(changes(&bare(metric, edge + 1e-9), &bare(metric, 100.0)), [Change::Time]);
    }
    let wide = |value: f64, low: f64, high: f64| [measured("ns_per_call", 0.0).measured(value, low, high)];
    // The interval of a time is not that of its ratio.
    let ratio = |value: f64| [bare("ratio", value), wide(1.0, 0.0, 1e9).to_vec()].concat();
    assert_eq!(changes(&ratio(1.0), &ratio(2.0)), [Change::Time]);
}

/// A time that is not valid is not compared in either direction, but its verdict is where it has no value.
#[test]
fn invalid_times_are_counted_and_not_compared() {
    let invalid = |value: f64| {
        let mut rows = time(value, 0.005);
        rows[0] = rows[0].clone().invalid("the machine was not quiet");
        rows
    };
    for (before, after) in [(invalid(100.0), time(150.0, 0.005)), (time(100.0, 0.005), invalid(150.0)), (invalid(100.0), invalid(150.0))] {
        let found = diff(&before, &after);
        assert_eq!((found.changes.len(), found.invalid, found.compared), (0, 1, before.len()));
    }
    // No program reads the reason.
    let mut mentioned = time(150.0, 0.005);
    mentioned[0].reason = "invalid: the machine was not quiet".into();
    assert_eq!(changes(&time(100.0, 0.005), &mentioned), [Change::Time]);
    let mut failed = time(100.0, 0.005);
    failed[0] = failed[0].clone().without_value(Verdict::Error, "it broke");
    assert_eq!(changes(&time(100.0, 0.005), &failed), [Change::Verdict]);
    assert_eq!(changes(&failed, &time(100.0, 0.005)), [Change::Verdict]);
}

/// A NaN is not a small value: NaN.max(x) is x.
#[test]
fn no_number_is_lost() {
    let lost = |row: &Row| Row { value: Some(f64::NAN), ..row.clone() };
    let error = error("a", 1e-17, 1e-13);
    assert_eq!(changes(std::slice::from_ref(&error), &[lost(&error)]), [Change::Error]);
    assert_eq!(changes(&[lost(&error)], std::slice::from_ref(&error)), [Change::Error]);
    assert_eq!(changes(&[lost(&error)], &[lost(&error)]), [], "it was lost before");
    let base = time(100.0, 0.005);
    let without = |place: usize, rows: &[Row]| {
        let mut rows = rows.to_vec();
        rows[place] = lost(&rows[place]);
        rows
    };
    assert_eq!(changes(&base, &without(0, &base)), [Change::Time]);
    assert_eq!(changes(&without(0, &base), &base), [Change::Time]);
    // If an end of an interval is NaN, the noise is not known, in either run and at either end: the time is not compared.
    let lost_end = |low: bool, rows: &[Row]| {
        let mut rows = rows.to_vec();
        *(if low { &mut rows[0].ci_low } else { &mut rows[0].ci_high }) = Some(f64::NAN);
        rows
    };
    for low in [true, false] {
        for (before, after) in [(base.clone(), lost_end(low, &time(150.0, 0.005))), (lost_end(low, &base), time(150.0, 0.005))] {
            let found = diff(&before, &after);
            assert_eq!((found.changes.len(), found.invalid), (0, 1), "low {low}");
        }
    }
}
