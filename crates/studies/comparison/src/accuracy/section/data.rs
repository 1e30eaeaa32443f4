//! The data of the accuracy section: errors against the truth per robot and method, and their growth within families.

use std::collections::BTreeMap;

use featherbench_report::fit::{Fit, power_law};
use featherbench_report::{EVERYONE, Overview, worst_first};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};
use serde::Serialize;

use super::STUDY;
use super::axes::{self, Axis};

/// The metric of rows that count the engines limited by the reference.
pub const LIMITED: &str = "limited_by_the_reference";
/// The spacing of doubles at one: an error of this size has lost no digit.
pub const ULP: f64 = f64::EPSILON;
/// Quantities in the order of the page: first the one with the largest loss.
const ORDER: [&str; 3] = ["fd", "id", "mass_matrix"];

/// The data of the section.
#[derive(Debug, Serialize)]
pub struct Accuracy<'a> {
    /// The table's columns: engine, method, quantity.
    pub answers: Vec<Answer<'a>>,
    /// The table's cells, by robot and answer.
    pub cells: Vec<Cell<'a>>,
    /// The growth of errors.
    #[serde(skip)]
    pub curves: Vec<Curve<'a>>,
    /// The rows that report engines limited by the reference.
    #[serde(skip)]
    pub limited: Vec<&'a Row>,
}

/// An engine's method for one quantity.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Answer<'a> {
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// Its arithmetic.
    pub scalar: &'a str,
    /// The quantity. The matrix M is one quantity, as a whole or through products.
    pub quantity: &'a str,
}

/// The errors of an answer on one robot.
#[derive(Clone, Debug, Serialize)]
pub struct Cell<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the answer.
    pub answer: usize,
    /// The rows' own quantity.
    pub quantity: &'a str,
    /// First quartile over the states.
    pub q1: Option<f64>,
    /// Median over the states.
    pub median: Option<f64>,
    /// Third quartile.
    pub q3: Option<f64>,
    /// Largest.
    pub worst: Option<f64>,
    /// The conditioning bound.
    pub floor: Option<f64>,
    /// Verdict of the row that decides, if it has a gate or no answer.
    pub verdict: Option<Verdict>,
    /// Its decades to the gate.
    pub margin: Option<f64>,
    /// Why it did not pass.
    pub reason: &'a str,
}

/// An answer's errors along one axis of one family.
#[derive(Debug)]
pub struct Curve<'a> {
    /// The axis.
    pub axis: Axis,
    /// The family.
    pub family: &'a str,
    /// Index of the answer.
    pub answer: usize,
    /// Place on the axis, index of the cell.
    pub points: Vec<(f64, usize)>,
    /// The growth of the median.
    pub fit: Option<Fit>,
    /// The range of that fit.
    pub span: Option<[f64; 2]>,
    /// The exponent between the last two points.
    pub last: Option<f64>,
}

/// The quantity under which a row is shown.
pub fn shown_quantity(name: &str) -> &str {
    if name == "mass_matrix_probe" { "mass_matrix" } else { name }
}

/// The place of a quantity on the page.
pub fn rank(name: &str) -> (usize, &str) {
    (ORDER.iter().position(|&known| known == name).unwrap_or(ORDER.len()), name)
}

/// Whether a row has a gate, or lacks an answer.
pub fn is_judged(row: &Row) -> bool {
    row.study == STUDY && row.metric != LIMITED && row.verdict != Verdict::Info
}

/// Decades of error above [`ULP`], none below.
pub fn lost(error: f64) -> f64 {
    (error / ULP).log10().max(0.0)
}

impl<'a> Accuracy<'a> {
    /// Collects a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        type Key<'a> = ((usize, &'a str), usize, &'a str, &'a str);
        let own = || rows.iter().filter(|row| row.study == STUDY);
        let limited = own().filter(|row| row.metric == LIMITED && row.value.is_some()).collect();

        let mut found: BTreeMap<Key, BTreeMap<usize, Cell>> = BTreeMap::new();
        let mut deciding: BTreeMap<(Key, usize), &Row> = BTreeMap::new();
        for row in own().filter(|row| row.metric != LIMITED && row.engine != EVERYONE) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            let key = (rank(shown_quantity(&row.quantity)), engine, row.method.as_str(), row.precision.as_str());
            let cell = found.entry(key).or_default().entry(robot).or_insert_with(|| Cell::empty(robot, &row.quantity));
            match row.metric.as_str() {
                "error_q1" => cell.q1 = row.value,
                "error_median" => cell.median = row.value,
                "error_q3" => cell.q3 = row.value,
                "error_worst" => cell.worst = row.value,
                _ => {}
            }
            cell.floor = cell.floor.or(row.floor);
            if is_judged(row) {
                let worst = deciding.entry((key, robot)).or_insert(row);
                if worst_first(row) < worst_first(worst) {
                    *worst = row;
                }
                (cell.verdict, cell.margin, cell.reason) = (Some(worst.verdict), worst.margin, &worst.reason);
            }
        }

        let (mut answers, mut cells) = (Vec::new(), Vec::new());
        for (((_, quantity), engine, method, scalar), robots) in found {
            let answer = answers.len();
            answers.push(Answer { engine, method, scalar, quantity });
            cells.extend(robots.into_values().map(|cell| Cell { answer, ..cell }));
        }
        let curves = curves(overview, &cells);
        Self { answers, cells, curves, limited }
    }

    /// The cell of a robot and an answer.
    pub fn cell(&self, robot: usize, answer: usize) -> Option<&Cell<'a>> {
        let at = self.cells.binary_search_by_key(&(answer, robot), |cell| (cell.answer, cell.robot));
        at.ok().map(|index| &self.cells[index])
    }

    /// Quantities in the order of the page.
    pub fn quantities(&self) -> Vec<&'a str> {
        let mut quantities: Vec<&str> = self.answers.iter().map(|answer| answer.quantity).collect();
        quantities.dedup();
        quantities
    }

    /// `featherbench aba`: engine, method, and precision unless it is f64.
    pub fn name(&self, overview: &Overview, answer: usize) -> String {
        let Answer { engine, method, scalar, .. } = self.answers[answer];
        let scalar = if scalar == "f64" { "" } else { scalar };
        [overview.engines[engine], method, scalar].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// The same, where the engine leads to its page.
    pub fn linked(&self, overview: &Overview, answer: usize) -> Markup {
        let (name, engine) = (self.name(overview, answer), overview.engines[self.answers[answer].engine]);
        html! { (featherbench_report::engine(overview, engine)) (name.strip_prefix(engine).unwrap_or_default()) }
    }
}

impl<'a> Cell<'a> {
    fn empty(robot: usize, quantity: &'a str) -> Self {
        Self {
            robot,
            answer: 0,
            quantity,
            q1: None,
            median: None,
            q3: None,
            worst: None,
            floor: None,
            verdict: None,
            margin: None,
            reason: "",
        }
    }
}

fn curves<'a>(overview: &Overview<'a>, cells: &[Cell]) -> Vec<Curve<'a>> {
    type Key<'a> = (Axis, &'a str, usize);
    let mut found: BTreeMap<Key, Vec<(f64, usize)>> = BTreeMap::new();
    let answered = || cells.iter().enumerate().filter(|(_, cell)| cell.median.is_some());
    for (index, cell) in answered() {
        let robot = &overview.robots[cell.robot];
        if let Some((axis, family, x)) = axes::place(robot.name, robot.nv, robot.depth) {
            found.entry((axis, family, cell.answer)).or_default().push((x, index));
        }
    }
    // The robot that gives a family of tips its name is the one with the usual tip.
    for (index, cell) in answered() {
        if let Some(points) = found.get_mut(&(Axis::Tip, overview.robots[cell.robot].name, cell.answer))
            && points.iter().all(|&(x, _)| x != 1.0)
        {
            points.push((1.0, index));
        }
    }
    let several = |points: &[(f64, usize)]| points.iter().any(|point| point.0 != points[0].0);
    found
        .into_iter()
        .filter(|(_, points)| several(points))
        .map(|((axis, family, answer), mut points)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // Below half the spacing of doubles an error is chance, or exactly zero.
            // Products with M and its entries have the same measure but are different quantities: a line connects one kind.
            let kind = cells[points[0].1].quantity;
            let fitted: Vec<(f64, f64)> = points
                .iter()
                .filter(|&&(x, index)| x >= axis.fit_from() && cells[index].quantity == kind)
                .filter_map(|&(x, index)| Some((x, cells[index].median.filter(|&error| error >= 0.5 * ULP)?)))
                .collect();
            let last = match fitted[..] {
                [.., (x0, y0), (x1, y1)] if x1 > x0 => Some((y1 / y0).ln() / (x1 / x0).ln()),
                _ => None,
            };
            let span = fitted.first().zip(fitted.last()).map(|(first, last)| [first.0, last.0]);
            Curve { axis, family, answer, points, fit: power_law(fitted.into_iter()), span, last }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::lost;

    #[test]
    fn digits_are_lost_above_the_spacing_of_doubles() {
        assert_eq!([lost(0.0), lost(1e-17)], [0.0, 0.0]);
        assert!((lost(f64::EPSILON * 1e4) - 4.0).abs() < 1e-12);
    }
}
