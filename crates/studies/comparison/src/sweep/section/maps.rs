//! Quantiles of errors by engine, method and level of an axis, from the rows.

use crate::accuracy::Params;
use featherbench_bench::params;
use featherbench_report::{EVERYONE, Overview};
use featherbench_results::{Row, Verdict};
use std::collections::BTreeMap;

/// The study's name in rows.
pub const STUDY: &str = "sweep";
/// The metric of the error of a cell.
const ERROR: &str = "error_worst";
/// The axis that is no parameter of the family, but what its parameters lead to.
const DEPTH: &str = "depth";
/// The quantiles: their names and fractions.
pub const QUANTILES: [(&str, f64); 4] = [("50 %", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("largest", 1.0)];
/// Quantities in the order of the page.
const ORDER: [&str; 3] = ["fd", "id", "mass_matrix"];

/// An engine's method for one quantity, in one arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Answer<'a> {
    rank: usize,
    /// The quantity. The matrix M is one quantity, as a whole or through products.
    pub quantity: &'a str,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// Its arithmetic.
    pub precision: &'a str,
}

/// A level of an axis. Numbers are in the order of their size.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The axis.
    pub axis: String,
    /// The level.
    pub name: String,
    number: Option<f64>,
}

/// What is known of one answer at one level.
#[derive(Clone, Debug, Default)]
pub struct Spot {
    /// The errors with their robots, once finished in the order of their size.
    pub errors: Vec<(f64, usize)>,
    /// Cells whose answer or error is no number.
    pub failed: usize,
}

impl Spot {
    /// The four quantiles, if there is an error.
    pub fn quantiles(&self) -> Option<[f64; 4]> {
        let sorted: Vec<f64> = self.errors.iter().map(|(error, _)| *error).collect();
        (!sorted.is_empty()).then(|| QUANTILES.map(|(_, fraction)| featherbench_bench::statistics::quantile(&sorted, fraction)))
    }

    /// The robot with the largest error.
    pub fn worst(&self) -> Option<usize> {
        self.errors.last().map(|(_, robot)| *robot)
    }
}

/// The maps of a run.
#[derive(Debug)]
pub struct Maps<'a> {
    /// The rows of a map.
    pub answers: Vec<Answer<'a>>,
    /// The columns of a map, axis by axis; the first is all robots.
    pub levels: Vec<Level>,
    /// The spots, by answer and level.
    pub spots: Vec<Vec<Spot>>,
    /// How many robots have a row.
    pub robots: usize,
}

impl<'a> Maps<'a> {
    /// Collects a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let own = || rows.iter().filter(|row| row.study == STUDY && row.engine != EVERYONE);
        // The levels of each robot, from one row of it.
        let mut levels_of: BTreeMap<usize, Vec<Level>> = BTreeMap::new();
        for row in own() {
            if let Some(robot) = overview.robot(&row.robot) {
                levels_of.entry(robot).or_insert_with(|| levels(row));
            }
        }
        let mut all: Vec<Level> = levels_of.values().flatten().cloned().collect();
        all.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal));
        all.dedup();
        all.insert(0, Level { axis: String::new(), name: "all".into(), number: None });
        let places: BTreeMap<usize, Vec<usize>> = levels_of
            .iter()
            .map(|(robot, levels)| {
                let places = levels.iter().filter_map(|level| all.iter().position(|known| known == level));
                (*robot, std::iter::once(0).chain(places).collect())
            })
            .collect();

        let mut found: BTreeMap<Answer, Vec<Spot>> = BTreeMap::new();
        // A cell has several rows. Its error is in one of them; a cell without an answer has a row without a metric.
        for row in own().filter(|row| row.metric == ERROR || (row.metric.is_empty() && row.verdict != Verdict::Skip)) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            let quantity = if row.quantity == "mass_matrix_probe" { "mass_matrix" } else { &row.quantity };
            let rank = ORDER.iter().position(|&known| known == quantity).unwrap_or(ORDER.len());
            let answer = Answer { rank, quantity, engine, method: &row.method, precision: &row.precision };
            let spots = found.entry(answer).or_insert_with(|| vec![Spot::default(); all.len()]);
            for &place in places.get(&robot).into_iter().flatten() {
                match row.value {
                    Some(error) => spots[place].errors.push((error, robot)),
                    None => spots[place].failed += 1,
                }
            }
        }
        let sort = |mut spots: Vec<Spot>| {
            spots.iter_mut().for_each(|spot| spot.errors.sort_by(|a, b| a.0.total_cmp(&b.0)));
            spots
        };
        let (answers, spots) = found.into_iter().map(|(answer, spots)| (answer, sort(spots))).unzip();
        Self { answers, levels: all, spots, robots: levels_of.len() }
    }

    /// The quantities in the order of the page.
    pub fn quantities(&self) -> Vec<&'a str> {
        let mut quantities: Vec<&str> = self.answers.iter().map(|answer| answer.quantity).collect();
        quantities.dedup();
        quantities
    }

    /// The axes in the order of the columns, each with the number of its levels.
    pub fn axes(&self) -> Vec<(&str, usize)> {
        self.levels.chunk_by(|a, b| a.axis == b.axis).filter_map(|group| Some((&*group.first()?.axis, group.len()))).collect()
    }
}

/// The levels of a row's robot: those at which it was drawn, and its depth up to the next power of two.
fn levels(row: &Row) -> Vec<Level> {
    let params: Params = params::of_row(row).unwrap_or_default();
    let drawn = params.axes.into_iter().map(|(axis, level)| {
        let number = level.as_f64();
        let name = match (level.as_str(), number) {
            (Some(word), _) => word.to_owned(),
            (None, Some(number)) => named(number),
            (None, None) => level.to_string(),
        };
        Level { axis, name, number }
    });
    let depth = row.depth.map(u64::next_power_of_two).map(|depth| Level {
        axis: DEPTH.into(),
        name: format!("≤ {depth}"),
        number: Some(depth as f64),
    });
    drawn.chain(depth).collect()
}

/// A level as people write it.
fn named(number: f64) -> String {
    if number == 0.0 || (0.01..1e3).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") }
}

fn order(level: &Level) -> (&str, Option<f64>, &str) {
    (&level.axis, level.number, &level.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(params: &str, depth: u64) -> Row {
        Row { params: params.into(), depth: Some(depth), ..Row::default() }
    }

    #[test]
    fn levels_are_those_of_the_draw_and_the_depth() {
        let told = |params: &str, depth| {
            levels(&row(params, depth)).into_iter().map(|level| format!("{} {}", level.axis, level.name)).collect::<Vec<_>>()
        };
        assert_eq!(told(r#"{"axes":{"joints":"all","n":16,"tip_scale":1e-6}}"#, 5), ["joints all", "n 16", "tip_scale 1e-6", "depth ≤ 8"]);
        assert_eq!(told("no JSON", 1), ["depth ≤ 1"]);
    }

    #[test]
    fn quantiles_are_over_the_errors_and_failures_are_counted() {
        let spot = Spot { errors: (0..=100).map(|k| (f64::from(k), k as usize)).collect(), failed: 2 };
        assert_eq!(spot.quantiles(), Some([50.0, 90.0, 99.0, 100.0]));
        assert_eq!(spot.worst(), Some(100));
        assert_eq!(Spot::default().quantiles(), None);
    }
}
