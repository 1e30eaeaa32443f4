//! The study's figures for papers: the largest error of each engine against depth and size, and the distribution of errors.

use std::collections::BTreeMap;

use featherbench_bench::BATCH;
use featherbench_report::figure::{Axis, Figure, Plot, Series};
use featherbench_report::numbers::{count, short};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;

use super::STUDY;
use featherbench_bench::statistics::quantile_of;
use featherbench_study::figures::{Measured, largest, shares};

/// The figures of a quantity: against depth, against size.
const CURVES: [(&str, &str, &str); 2] = [("id", "error-depth-id", "error-size-id"), ("fd", "error-depth-fd", "error-size-fd")];
/// Quantities of the distribution.
const SPREAD: [&str; 3] = ["id", "fd", "mass_matrix"];

/// The answers of one method: robots and their largest errors over the states.
type Answers = Vec<(usize, f64)>;

/// Makes the figures.
pub fn figures(overview: &Overview, rows: &[Row]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (quantity, against_depth, against_size) in CURVES {
        let answers = usual(overview, rows, quantity);
        figures
            .extend(curve(overview, &answers, quantity, against_depth, "joints on the longest path", |robot| overview.robots[robot].depth));
        figures.extend(curve(overview, &answers, quantity, against_size, "degrees of freedom nv", |robot| overview.robots[robot].nv));
    }
    figures.extend(distribution(overview, rows));
    figures
}

/// The usual method of each engine: of those with the most robots, the first that the engine names.
fn usual<'a>(overview: &Overview<'a>, rows: &'a [Row], quantity: &str) -> Vec<(usize, &'a str, Answers)> {
    let mut methods: BTreeMap<usize, Vec<(&str, Answers)>> = BTreeMap::new();
    let errors = rows.iter().filter(|row| row.study == STUDY && row.metric == "error_worst" && row.quantity == quantity && row.valid);
    for row in errors.filter(|row| row.precision == "f64" && row.method != BATCH) {
        let (Some(engine), Some(robot), Some(error)) = (overview.engine(&row.engine), overview.robot(&row.robot), row.value) else {
            continue;
        };
        let known = methods.entry(engine).or_default();
        match known.iter_mut().find(|(method, _)| *method == row.method) {
            Some((_, answers)) => answers.push((robot, error)),
            None => known.push((&row.method, vec![(robot, error)])),
        }
    }
    let of_engine = |(engine, methods): (usize, Vec<(&'a str, Answers)>)| {
        // The last of equally good ones is taken: so the first of the reversed.
        let (method, answers) = methods.into_iter().rev().max_by_key(|(_, answers)| answers.len())?;
        Some((engine, method, answers))
    };
    methods.into_iter().filter_map(of_engine).collect()
}

fn curve(
    overview: &Overview,
    answers: &[(usize, &str, Answers)],
    quantity: &str,
    name: &'static str,
    axis: &str,
    place: impl Fn(usize) -> Option<u64>,
) -> Option<Figure> {
    let series = |(engine, method, answers): &(usize, &str, Answers)| -> Series {
        let measured = |&(robot, error): &(usize, f64)| {
            Some(Measured { robot: overview.robots[robot].name, x: place(robot).filter(|&x| x > 0)? as f64, y: error })
        };
        let values: Vec<Measured> = answers.iter().filter_map(measured).collect();
        largest(overview.engines[*engine], format!("{} {method}", overview.engines[*engine]), &values)
    };
    let title = labels::quantity(quantity);
    let plot = Plot {
        title: format!("Largest error of {title} against {axis}"),
        x: Axis::log(axis),
        y: Axis::log(format!("largest relative error of {title}")),
        series: answers.iter().map(series).filter(|series| !series.points.is_empty()).collect(),
        ..Plot::default()
    };
    let mut worst: Vec<(f64, String)> = Vec::new();
    for (engine, _, answers) in answers {
        if let Some(&(robot, error)) = answers.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
            worst.push((error, format!("{} {} on {}", overview.engines[*engine], short(error), overview.robots[robot].name)));
        }
    }
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let worst: Vec<String> = worst.into_iter().map(|(_, words)| words).collect();
    let caption = format!(
        "The largest errors, from the worst engine: {}. Each mark is the worst robot and state at its place, by the engine's usual method, against \
         the answer in 32 digits. Errors of exactly zero have no place here and are in the data.",
        worst.join(", ")
    );
    plot.figure(name, caption)
}

fn distribution(overview: &Overview, rows: &[Row]) -> Option<Figure> {
    let mut errors: BTreeMap<usize, Vec<(f64, String)>> = BTreeMap::new();
    for quantity in SPREAD {
        for (engine, _, answers) in usual(overview, rows, quantity) {
            let named = answers
                .into_iter()
                .map(|(robot, error)| (error, format!("{} of {}", labels::quantity(quantity), overview.robots[robot].name)));
            errors.entry(engine).or_default().extend(named);
        }
    }
    let median = |errors: &[(f64, String)]| {
        let values: Vec<f64> = errors.iter().map(|(error, _)| *error).collect();
        quantile_of(&values, 0.5)
    };
    let words = |(engine, errors): (&usize, &Vec<(f64, String)>)| {
        format!("{} {} over {}", overview.engines[*engine], short(median(errors)), count(errors.len(), "answer"))
    };
    let caption = format!(
        "Median error: {}. An answer is a quantity (inverse dynamics, forward dynamics, mass matrix) of a robot by the engine's usual method; its \
         error is the largest over the states, against the answer in 32 digits. A curve farther left is more accurate.",
        errors.iter().map(words).collect::<Vec<_>>().join(", ")
    );
    let series = |(engine, errors): (usize, Vec<(f64, String)>)| {
        let (all, name) = (errors.len(), overview.engines[engine]);
        shares(name, name.to_owned(), errors, all)
    };
    let plot = Plot {
        title: "Distribution of errors by engine".into(),
        x: Axis::log("relative error"),
        y: Axis::linear("share of answers with at most this error"),
        series: errors.into_iter().map(series).collect(),
        ..Plot::default()
    };
    plot.figure("error-distribution", caption)
}
