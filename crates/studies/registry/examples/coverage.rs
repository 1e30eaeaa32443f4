//! Whether intervals of times hold what they say: several runs of one program on one machine, which `ci/coverage` makes.
//! `cargo run --release -p featherbench-registry --example coverage -- RUN RUN…`
//!
//! | number | definition | limit |
//! |---|---|---|
//! | coverage | intervals that hold the mean of their row over all runs, of all ratios that count, and of all times | each 90 to 98 % |
//! | false alarms | rows that `diff` calls changed between a run and the next one | 1 % |
//! | found | rows that `diff` calls changed if each in turn is 3 % slower in the second run | at least 90 % |
//!
//! Ends with 1 if one of them is beyond its limit.

use featherbench_results::{Change, Row, diff, read_run};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

/// The planted slowdown.
const SLOWER: f64 = 1.03;

fn is_time(row: &Row) -> bool {
    row.valid && row.value.is_some() && ["ns_per_call", "ratio"].contains(&row.metric.as_str())
}

/// What tells rows apart within a run.
fn key(row: &Row) -> [&str; 8] {
    [&row.study, &row.robot, &row.engine, &row.method, &row.precision, &row.quantity, &row.cache, &row.metric]
}

/// How many of the intervals of a metric hold the mean of their row over the runs, and how many there are.
fn coverage(runs: &[Vec<Row>], metric: &str) -> [usize; 2] {
    let mut by_row: BTreeMap<[&str; 8], Vec<&Row>> = BTreeMap::new();
    for row in runs.iter().flatten().filter(|row| row.metric == metric) {
        by_row.entry(key(row)).or_default().push(row);
    }
    let mut held = [0, 0];
    for rows in by_row.values().filter(|rows| rows.len() == runs.len()) {
        let mean = (rows.iter().filter_map(|row| row.value).map(f64::ln).sum::<f64>() / rows.len() as f64).exp();
        let holds = |row: &&&Row| row.ci_low.is_some_and(|low| low <= mean) && row.ci_high.is_some_and(|high| mean <= high);
        held = [held[0] + rows.iter().filter(holds).count(), held[1] + rows.len()];
    }
    held
}

/// Rows that changed in time between two runs.
fn changed(before: &[Row], after: &[Row]) -> usize {
    diff(before, after).changes.iter().filter(|changed| changed.change == Change::Time).count()
}

/// The rows of the second run with a slowdown in one of so many, from one on.
fn planted(rows: &[Row], of: usize, from: usize) -> Vec<Row> {
    let slower = |(at, row): (usize, &Row)| {
        let by = |number: Option<f64>| number.map(|number| number * if at % of == from { SLOWER } else { 1.0 });
        Row { value: by(row.value), ci_low: by(row.ci_low), ci_high: by(row.ci_high), ..row.clone() }
    };
    rows.iter().enumerate().map(slower).collect()
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let runs: Vec<Vec<Row>> = std::env::args()
        .skip(1)
        .map(|folder| read_run(Path::new(&folder)).map(|(_, rows)| rows.into_iter().filter(is_time).collect()))
        .collect::<Result<_, _>>()?;
    if runs.len() < 2 {
        return Err("give the folders of two runs or more".into());
    }
    let percent = |[part, whole]: [usize; 2]| 100.0 * part as f64 / whole as f64;
    let ratios = percent(coverage(&runs, "ratio"));
    let times = percent(coverage(&runs, "ns_per_call"));
    // Ten parts: where many rows are slower, that is the factor that all have in common.
    const PARTS: usize = 10;
    let (mut alarms, mut found) = ([0, 0], [0, 0]);
    for pair in runs.windows(2) {
        let unplanted = changed(&pair[0], &pair[1]);
        alarms = [alarms[0] + unplanted, alarms[1] + pair[1].len()];
        for from in 0..PARTS {
            let slower = planted(&pair[1], PARTS, from);
            let known: Vec<_> = diff(&pair[0], &pair[1]).changes.iter().filter_map(|changed| changed.after).map(key).collect();
            let changes = diff(&pair[0], &slower);
            let new = changes.changes.iter().filter(|changed| changed.change == Change::Time).filter_map(|changed| changed.after);
            found[0] += new.filter(|row| !known.contains(&key(row))).count();
            found[1] += slower.iter().enumerate().filter(|(at, _)| at % PARTS == from).count();
        }
    }
    let [alarms, found] = [alarms, found].map(percent);
    println!("{} runs with {} times each", runs.len(), runs[0].len());
    println!("coverage of ratios: {ratios:.1} %, of times: {times:.1} % (each 90 to 98 %)");
    println!("false alarms of diff: {alarms:.2} % (at most 1 %)");
    println!("slowdowns of 3 % that diff finds: {found:.1} % (at least 90 %)");
    let good = [ratios, times].iter().all(|share| (90.0..=98.0).contains(share)) && alarms <= 1.0 && found >= 90.0;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
