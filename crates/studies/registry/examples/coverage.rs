//! Whether intervals of times hold what they say: several runs of one program on one machine, which `ci/coverage` makes.
//! `cargo run --release -p featherbench-registry --example coverage -- RUN RUN…`
//!
//! | number | definition | limit |
//! |---|---|---|
//! | coverage | intervals that hold the mean of their row over all runs in which it counts, of all ratios, and of all times | each 90 to 98 % |
//! | false alarms | rows that `diff` calls changed between a run and the next one | 1 % |
//! | found | rows that `diff` calls changed if each in turn is 3 % slower in the second run | at least 90 % |
//! | least | the smallest slowdown of which nine in ten are found | told |
//!
//! A row counts in a run if it is valid there; those that count in less than half of the runs are left out. Ends with 1 if a number is beyond
//! its limit. That the machine was not quiet is told, and changes no limit.

use featherbench_bench::statistics::PROCESSES;
use featherbench_results::{Change, Row, diff, read_run};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

/// The planted slowdown that must be found.
const DUE: f64 = 0.03;
/// The planted slowdowns, of which the least that is found is told.
const PLANTED: [f64; 8] = [0.01, 0.02, DUE, 0.04, 0.05, 0.07, 0.1, 0.15];
/// The share of the planted slowdowns that must be found.
const FOUND: f64 = 90.0;
/// The share of the processes with the core at its fastest, from which on a machine is quiet.
const QUIET: f64 = 0.9;

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
    for rows in by_row.values().filter(|rows| 2 * rows.len() >= runs.len()) {
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
fn planted(rows: &[Row], slowdown: f64, of: usize, from: usize) -> Vec<Row> {
    let slower = |(at, row): (usize, &Row)| {
        let by = |number: Option<f64>| number.map(|number| number * if at % of == from { 1.0 + slowdown } else { 1.0 });
        Row { value: by(row.value), ci_low: by(row.ci_low), ci_high: by(row.ci_high), ..row.clone() }
    };
    rows.iter().enumerate().map(slower).collect()
}

/// How many of the planted slowdowns are found between runs and the next ones, and how many were planted.
fn found(runs: &[Vec<Row>], slowdown: f64) -> [usize; 2] {
    // Ten parts: where many rows are slower, that is the factor that all have in common.
    const PARTS: usize = 10;
    let mut found = [0, 0];
    for pair in runs.windows(2) {
        let known: Vec<_> = diff(&pair[0], &pair[1]).changes.iter().filter_map(|changed| changed.after).map(key).collect();
        let both: Vec<_> = pair[0].iter().map(key).collect();
        for from in 0..PARTS {
            let slower = planted(&pair[1], slowdown, PARTS, from);
            let changes = diff(&pair[0], &slower);
            let new = changes.changes.iter().filter(|changed| changed.change == Change::Time).filter_map(|changed| changed.after);
            found[0] += new.filter(|row| !known.contains(&key(row))).count();
            found[1] += slower.iter().enumerate().filter(|(at, row)| at % PARTS == from && both.contains(&key(row))).count();
        }
    }
    found
}

/// The share of the processes in which the core was at its fastest.
fn fastest(rows: &[Row]) -> f64 {
    let share = |row: &Row| {
        // Absent if the core was at its fastest in all.
        let params: serde_json::Value = serde_json::from_str(&row.params).unwrap_or_default();
        params["fastest"].as_f64().map_or(1.0, |count| count / PROCESSES as f64)
    };
    rows.iter().map(share).sum::<f64>() / rows.len() as f64
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let folders: Vec<String> = std::env::args().skip(1).collect();
    let read = |folder: &String| read_run(Path::new(folder)).map(|(_, rows)| rows);
    let all: Vec<Vec<Row>> = folders.iter().map(read).collect::<Result<_, _>>()?;
    if all.len() < 2 {
        return Err("give the folders of two runs or more".into());
    }
    let runs: Vec<Vec<Row>> = all.iter().map(|rows| rows.iter().filter(|row| is_time(row)).cloned().collect()).collect();
    let timed: Vec<Row> = all.iter().flatten().filter(|row| row.metric == "ns_per_call" && row.value.is_some()).cloned().collect();
    let fastest = fastest(&timed);
    let valid = timed.iter().filter(|row| row.valid).count() as f64 / timed.len() as f64;
    let percent = |[part, whole]: [usize; 2]| 100.0 * part as f64 / whole as f64;
    let covered = ["ratio", "ns_per_call"].map(|metric| percent(coverage(&runs, metric)));
    let mut alarms = [0, 0];
    for pair in runs.windows(2) {
        alarms = [alarms[0] + changed(&pair[0], &pair[1]), alarms[1] + pair[1].len()];
    }
    let alarms = percent(alarms);
    let power = PLANTED.map(|slowdown| (slowdown, percent(found(&runs, slowdown))));
    let of_due = power.iter().find(|(slowdown, _)| *slowdown == DUE).map_or(f64::NAN, |(_, found)| *found);
    let least = power.iter().find(|(_, found)| *found >= FOUND);
    println!("{} runs with {} times each; {:.1} % of all times count", runs.len(), timed.len() / all.len(), 100.0 * valid);
    let quiet = if fastest < QUIET { ": the machine was not quiet" } else { "" };
    println!("the core was at its fastest in {:.0} % of the processes{quiet}", 100.0 * fastest);
    println!("coverage of ratios: {:.1} %, of times: {:.1} % (each 90 to 98 %)", covered[0], covered[1]);
    println!("false alarms of diff: {alarms:.2} % (at most 1 %)");
    println!("slowdowns of 3 % that diff finds: {of_due:.1} % (at least {FOUND} %)");
    match least {
        Some((slowdown, _)) => println!("nine of ten slowdowns of {:.0} % are found", 100.0 * slowdown),
        None => println!("of slowdowns of {:.0} % less than nine of ten are found", 100.0 * PLANTED[PLANTED.len() - 1]),
    }
    let good = covered.iter().all(|share| (90.0..=98.0).contains(share)) && alarms <= 1.0 && of_due >= FOUND;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
