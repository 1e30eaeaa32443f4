//! Trends over synthetic runs: a planted jump is found where it is, and noise is none.

use featherbench_results::{ChangePoint, Kind, Relation, Row, Trended, trends};

fn time(value: f64) -> Row {
    let text = |word: &str| word.to_owned();
    let row =
        Row { study: text("timing"), robot: text("arm"), engine: text("e"), quantity: text("id"), cache: text("hot"), ..Row::default() };
    let row = Row { metric: text("ns_per_call"), unit: text("ns"), kind: Kind::Measured, ..row };
    row.measured(value, 0.99 * value, 1.01 * value)
}

fn error(value: f64) -> Row {
    let text = |word: &str| word.to_owned();
    Row {
        study: text("s"),
        robot: text("arm"),
        engine: text("e"),
        quantity: text("id"),
        metric: text("scaled"),
        unit: text("1"),
        ..Row::default()
    }
    .gated(value, Relation::Le, 1e-14)
}

fn points(runs: &[Vec<Row>], machines: &[&str]) -> Vec<ChangePoint> {
    let rows: Vec<&[Row]> = runs.iter().map(Vec::as_slice).collect();
    let machines: Vec<String> = machines.iter().map(|&name| name.to_owned()).collect();
    let found = trends(&rows, &machines);
    found.iter().flat_map(|trend| trend.change_points()).collect()
}

fn of(values: &[f64], row: fn(f64) -> Row) -> Vec<ChangePoint> {
    let runs: Vec<Vec<Row>> = values.iter().map(|&value| vec![row(value)]).collect();
    points(&runs, &vec!["a"; values.len()])
}

#[test]
fn a_planted_jump_is_found_where_it_is() {
    let found = of(&[100.0, 101.0, 99.5, 100.5, 130.0, 131.0, 129.0, 130.5], time);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].before, found[0].after, found[0].confirmed), (3, 4, true));
    assert!((found[0].factor - 1.3).abs() < 0.01, "medians of 101, 99.5, 100.5 and of 130, 131, 129: {found:?}");
    let down = of(&[3e-13, 2.5e-13, 3e-13, 1e-15, 1.5e-15, 1e-15], error);
    assert_eq!(down.len(), 1, "{down:?}");
    assert!(down[0].factor < 0.01 && down[0].after == 3 && down[0].confirmed);
    // Up and down again, three runs each.
    let both: Vec<usize> =
        of(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0].map(|x| 100.0 * x), time).iter().map(|point| point.after).collect();
    assert_eq!(both, [3, 6]);
}

#[test]
fn runs_without_a_jump_have_no_change_point() {
    // Times that scatter within their intervals, one run out of line, and a drift below the noise.
    assert_eq!(of(&[100.0, 101.0, 99.0, 100.5, 101.5, 99.5, 100.2], time), []);
    assert_eq!(of(&[100.0, 100.0, 100.0, 150.0, 100.0, 100.0, 100.0], time), []);
    assert_eq!(of(&[100.0, 100.3, 100.6, 100.9, 101.2, 101.5], time), []);
    // Errors that change by rounding, also far below the floor.
    assert_eq!(of(&[3e-16, 1e-16, 8e-16, 0.0, 2e-16, 8e-17], error), []);
    assert_eq!(of(&[1e-14, 2e-14, 3e-14, 1.5e-14, 1e-14, 2e-14], error), []);
}

#[test]
fn a_jump_within_the_intervals_is_none() {
    let runs = |spread: f64| -> Vec<Vec<Row>> {
        [100.0, 100.0, 100.0, 110.0, 110.0, 110.0]
            .map(|value| vec![time(value).measured(value, value * (1.0 - spread), value * (1.0 + spread))])
            .to_vec()
    };
    assert_eq!(points(&runs(0.01), &["a"; 6]).len(), 1);
    // 100 and 110: intervals of ±4 % are apart, those of ±5 % are not.
    assert_eq!(points(&runs(0.04), &["a"; 6]).len(), 1);
    assert_eq!(points(&runs(0.05), &["a"; 6]), []);
}

#[test]
fn the_last_run_alone_is_not_confirmed() {
    let found = of(&[100.0, 100.0, 100.0, 130.0], time);
    assert_eq!((found.len(), found[0].confirmed), (1, false));
}

#[test]
fn times_of_other_machines_and_invalid_ones_are_left_out() {
    let runs: Vec<Vec<Row>> = [200.0, 200.0, 200.0, 100.0, 100.0, 100.0].map(|value| vec![time(value)]).to_vec();
    assert_eq!(points(&runs, &["b", "b", "b", "a", "a", "a"]), []);
    assert_eq!(points(&runs, &["a"; 6]).len(), 1);
    let bad: Vec<Vec<Row>> = [200.0, 200.0, 200.0, 100.0].map(|value| vec![time(value).invalid("not quiet")]).to_vec();
    assert_eq!(points(&bad, &["a"; 4]), []);
    // Errors are the same on every machine.
    let errors: Vec<Vec<Row>> = [1e-15, 1e-15, 1e-15, 1e-13, 1e-13, 1e-13].map(|value| vec![error(value)]).to_vec();
    assert_eq!(points(&errors, &["b", "b", "b", "a", "a", "a"]).len(), 1);
    let rows: Vec<&[Row]> = errors.iter().map(Vec::as_slice).collect();
    assert_eq!(trends(&rows, &vec!["a".to_owned(); 6])[0].kind, Trended::Error);
}
