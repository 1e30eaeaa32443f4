//! What the section shows, from the rows of the studies `scaling` and `growth`.

use super::others::{self, Other};
use crate::growth::OfLine;
use crate::scaling::What;
use featherbench_bench::params;
use featherbench_report::Overview;
use featherbench_results::{Row, Verdict};
use std::collections::BTreeMap;

/// The study of exact rows.
pub(super) const SCALING: &str = "scaling";
/// The study of measured rows.
pub(super) const GROWTH: &str = "growth";

/// Everything.
#[derive(Debug, Default)]
pub(super) struct Data<'a> {
    /// Methods along lines.
    pub(super) series: Vec<Series<'a>>,
    /// Ratios of our two ways along lines.
    pub(super) ratios: Vec<Ratios<'a>>,
    /// Our methods beside the serial ones that they are compared with.
    pub(super) beside: Vec<Beside<'a>>,
    /// Work and span on several cores.
    pub(super) shares: Vec<Shares<'a>>,
    /// Counts and fill-in of trees.
    pub(super) trees: Vec<Tree<'a>>,
    /// Errors of forward dynamics.
    pub(super) errors: Vec<Error<'a>>,
    /// Factorizations of other engines.
    pub(super) others: Vec<Other<'a>>,
}

/// A method of an engine along a line.
#[derive(Debug, Default)]
pub(super) struct Series<'a> {
    pub(super) line: &'a str,
    /// Index of the engine.
    pub(super) engine: usize,
    pub(super) quantity: &'a str,
    pub(super) method: &'a str,
    /// One per tree, by size.
    pub(super) points: Vec<Point>,
    /// The exponent of the time, and its interval.
    pub(super) exponent: Option<[f64; 3]>,
    /// Bytes per dof between the last two sizes.
    pub(super) memory_per_dof: Option<f64>,
    /// The exponent of the memory beyond that at the smallest size.
    pub(super) memory_exponent: Option<f64>,
    /// Dofs of the largest tree that was answered.
    pub(super) largest: Option<f64>,
    /// Why no larger one was.
    pub(super) reason: &'a str,
}

/// One size of a series.
#[derive(Debug, Default)]
pub(super) struct Point {
    /// Index of the robot.
    pub(super) robot: usize,
    pub(super) size: u64,
    pub(super) seconds: Option<f64>,
    pub(super) low: Option<f64>,
    pub(super) high: Option<f64>,
    /// Whether the time counts.
    pub(super) valid: bool,
    pub(super) estimated: bool,
    pub(super) resident: Option<f64>,
    pub(super) error: Option<f64>,
}

/// Our way by the mass matrix over our articulated-body algorithm, along a line.
#[derive(Debug, Default)]
pub(super) struct Ratios<'a> {
    pub(super) line: &'a str,
    /// (robot, dofs, ratio of counted operations).
    pub(super) work: Vec<(usize, u64, f64)>,
    /// (robot, dofs, ratio of times).
    pub(super) time: Vec<(usize, u64, f64)>,
    /// (numbers in a register, dofs).
    pub(super) predicted: Vec<(f64, f64)>,
    pub(super) measured: Option<f64>,
}

/// A method of ours beside the serial one that it is compared with, along a line and on so many threads.
#[derive(Debug)]
pub(super) struct Beside<'a> {
    pub(super) line: &'a str,
    pub(super) quantity: &'a str,
    /// With the number of threads behind it, if it uses several.
    pub(super) method: &'a str,
    pub(super) over: &'a str,
    pub(super) threads: Option<usize>,
    /// (robot, dofs, ratio of times).
    pub(super) time: Vec<(usize, u64, f64)>,
    /// Dofs where both take the same time.
    pub(super) crossing: Option<f64>,
}

impl Beside<'_> {
    /// The method without its threads.
    pub(super) fn plain(&self) -> &str {
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        match self.method.rsplit_once('_') {
            Some((plain, threads)) if self.threads.is_some() && digits(threads) => plain,
            _ => self.method,
        }
    }
}

/// Work and span of a method on several cores, over the work of the serial one.
#[derive(Debug)]
pub(super) struct Shares<'a> {
    pub(super) robot: usize,
    pub(super) size: u64,
    pub(super) quantity: &'a str,
    pub(super) method: &'a str,
    pub(super) work: Option<f64>,
    pub(super) span: Option<f64>,
    pub(super) verdict: Verdict,
}

/// The counts of a tree.
#[derive(Debug, Default)]
pub(super) struct Tree<'a> {
    pub(super) robot: usize,
    pub(super) size: u64,
    /// Counts by metric.
    pub(super) counts: BTreeMap<&'a str, f64>,
    /// `counted` or `pattern`.
    pub(super) route: String,
    /// Fill-in by order.
    pub(super) fill: BTreeMap<&'a str, f64>,
    /// Errors per dof of the factors and of a solution.
    pub(super) errors: [Option<f64>; 2],
    /// The worst verdict of its rows.
    pub(super) verdict: Option<Verdict>,
}

/// An error of forward dynamics.
#[derive(Debug)]
pub(super) struct Error<'a> {
    pub(super) robot: usize,
    pub(super) size: u64,
    pub(super) method: &'a str,
    pub(super) error: Option<f64>,
    pub(super) floor: Option<f64>,
    pub(super) over: Option<f64>,
    pub(super) verdict: Verdict,
    pub(super) reason: &'a str,
}

impl<'a> Data<'a> {
    /// Collects a run's rows.
    pub(super) fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let mut data = Self::default();
        let mut trees: Vec<Tree> = Vec::new();
        for row in rows.iter().filter(|row| row.study == SCALING) {
            let (what, robot): (Option<What>, _) = (params::of_row(row), overview.robot(&row.robot));
            let Some(what) = what else { continue };
            match (&what, robot) {
                (What::Counts { .. } | What::FillIn | What::Factors, Some(robot)) => {
                    let place = trees.iter().position(|tree| tree.robot == robot).unwrap_or_else(|| {
                        trees.push(Tree { robot, ..Tree::default() });
                        trees.len() - 1
                    });
                    trees[place].add(row, what);
                }
                (What::Others, Some(robot)) => others::add(&mut data.others, robot, row),
                (What::Dynamics, Some(robot)) => data.add_error(robot, row),
                (What::Parallel, Some(robot)) => data.add_share(robot, row),
                (What::Work { .. }, Some(robot)) => {
                    let ratios = data.ratios_of(&row.family);
                    ratios.work.extend(row.value.map(|value| (robot, row.nv.unwrap_or(0), value)));
                }
                (What::Crossover { lanes }, _) => data.ratios_of(&row.family).predicted.extend(row.value.map(|value| (*lanes, value))),
                _ => {}
            }
        }
        for row in rows.iter().filter(|row| row.study == GROWTH) {
            data.add_growth(overview, row);
        }
        data.series.iter_mut().for_each(|series| series.points.sort_by_key(|point| point.size));
        data.ratios.iter_mut().for_each(|ratios| {
            ratios.work.sort_by_key(|(_, size, _)| *size);
            ratios.time.sort_by_key(|(_, size, _)| *size);
        });
        data.beside.iter_mut().for_each(|one| one.time.sort_by_key(|(_, size, _)| *size));
        Self { trees, ..data }
    }

    /// Whether the run has nothing to show.
    pub(super) fn is_empty(&self) -> bool {
        let tables = [self.series.is_empty(), self.trees.is_empty(), self.others.is_empty(), self.errors.is_empty()];
        tables.into_iter().all(|empty| empty) && self.ratios.is_empty() && self.shares.is_empty()
    }

    fn ratios_of(&mut self, line: &'a str) -> &mut Ratios<'a> {
        let place = self.ratios.iter().position(|ratios| ratios.line == line).unwrap_or_else(|| {
            self.ratios.push(Ratios { line, ..Ratios::default() });
            self.ratios.len() - 1
        });
        &mut self.ratios[place]
    }

    /// The errors of a method stand in two rows: the error, and its ratio to the conditioning bound.
    fn add_error(&mut self, robot: usize, row: &'a Row) {
        let known = self.errors.iter().position(|error| error.robot == robot && error.method == row.method);
        let place = known.unwrap_or_else(|| {
            let size = row.nv.unwrap_or(0);
            let blank = Error { robot, size, method: &row.method, error: None, floor: None, over: None, verdict: row.verdict, reason: "" };
            self.errors.push(blank);
            self.errors.len() - 1
        });
        let error = &mut self.errors[place];
        match row.metric.as_str() {
            "error_over_floor" => error.over = row.value,
            _ => error.error = row.value,
        }
        error.floor = error.floor.or(row.floor);
        error.verdict = worse(error.verdict, row.verdict);
        if !row.reason.is_empty() {
            error.reason = &row.reason;
        }
    }

    /// Work and span stand in two rows.
    fn add_share(&mut self, robot: usize, row: &'a Row) {
        let known = self.shares.iter().position(|one| one.robot == robot && one.method == row.method);
        let place = known.unwrap_or_else(|| {
            let (size, quantity, method) = (row.nv.unwrap_or(0), row.quantity.as_str(), row.method.as_str());
            self.shares.push(Shares { robot, size, quantity, method, work: None, span: None, verdict: row.verdict });
            self.shares.len() - 1
        });
        let share = &mut self.shares[place];
        match row.metric.as_str() {
            "parallel_span" => share.span = row.value,
            _ => share.work = row.value,
        }
        share.verdict = worse(share.verdict, row.verdict);
    }

    /// The entry of a row that compares a method of ours with a serial one.
    fn beside_of(&mut self, row: &'a Row) -> &mut Beside<'a> {
        let key = (row.family.as_str(), row.quantity.as_str(), row.method.as_str());
        let place = self.beside.iter().position(|one| (one.line, one.quantity, one.method) == key).unwrap_or_else(|| {
            let ((line, quantity, method), threads) = (key, params::of_row(row).and_then(|params: OfLine| params.threads));
            self.beside.push(Beside { line, quantity, method, over: &row.reference, threads, time: Vec::new(), crossing: None });
            self.beside.len() - 1
        });
        &mut self.beside[place]
    }

    /// Our way by the mass matrix has a figure with counted operations; all other methods are compared in times alone.
    fn by_mass_matrix(row: &Row) -> bool {
        row.quantity == "fd" && row.method == "ltdl"
    }

    fn add_growth(&mut self, overview: &Overview<'a>, row: &'a Row) {
        let Some(engine) = overview.engine(&row.engine) else { return };
        let (robot, value) = (overview.robot(&row.robot), row.value);
        match row.metric.as_str() {
            "time_ratio" => {
                let point = robot.zip(value).map(|(robot, value)| (robot, row.nv.unwrap_or(0), value));
                let by_mass_matrix = Self::by_mass_matrix(row);
                let time = if by_mass_matrix { &mut self.ratios_of(&row.family).time } else { &mut self.beside_of(row).time };
                time.extend(point);
                return;
            }
            "crossover_measured" if Self::by_mass_matrix(row) => {
                self.ratios_of(&row.family).measured = value;
                return;
            }
            "crossover_measured" => {
                self.beside_of(row).crossing = value;
                return;
            }
            "different_answers" => return,
            _ => {}
        }
        let key = (row.family.as_str(), engine, row.quantity.as_str(), row.method.as_str());
        let known = self.series.iter().position(|one| (one.line, one.engine, one.quantity, one.method) == key);
        let place = known.unwrap_or_else(|| {
            let (line, engine, quantity, method) = key;
            self.series.push(Series { line, engine, quantity, method, ..Series::default() });
            self.series.len() - 1
        });
        let series = &mut self.series[place];
        let Some(robot) = robot else {
            match row.metric.as_str() {
                "time_exponent" => series.exponent = value.zip(row.ci_low).zip(row.ci_high).map(|((value, low), high)| [value, low, high]),
                "memory_per_dof" => series.memory_per_dof = value,
                "memory_exponent" => series.memory_exponent = value,
                _ => (series.largest, series.reason) = (value, &row.reason),
            }
            return;
        };
        let place = series.points.iter().position(|point| point.robot == robot).unwrap_or_else(|| {
            series.points.push(Point { robot, size: row.nv.unwrap_or(0), ..Point::default() });
            series.points.len() - 1
        });
        let point = &mut series.points[place];
        match row.metric.as_str() {
            "seconds" => {
                (point.seconds, point.low, point.high) = (value, row.ci_low, row.ci_high);
                (point.valid, point.estimated) = (row.valid, row.estimated);
            }
            "resident" => point.resident = value,
            "error" => point.error = value,
            _ => {}
        }
    }

    /// The names of the lines, in the order of the suite.
    pub(super) fn lines(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.series.iter().map(|one| one.line) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

impl<'a> Tree<'a> {
    fn add(&mut self, row: &'a Row, what: What) {
        self.size = row.nv.unwrap_or(self.size);
        if let What::Counts { route: Some(route) } = what {
            self.route = route;
        }
        match (row.metric.as_str(), row.value) {
            ("fill_in", Some(value)) => drop(self.fill.insert(&row.method, value)),
            ("factor_error_per_dof", value) => self.errors[0] = value,
            ("solution_error_per_dof", value) => self.errors[1] = value,
            ("multiply_subtracts", _) | (_, None) => {}
            (metric, Some(value)) => drop(self.counts.insert(metric, value)),
        }
        self.verdict = Some(self.verdict.map_or(row.verdict, |verdict| worse(verdict, row.verdict)));
    }
}

/// The worse of two verdicts: an error or a failure, then what passes, then what is not judged.
pub(super) fn worse(a: Verdict, b: Verdict) -> Verdict {
    let rank = |verdict: Verdict| match verdict {
        Verdict::Error => 5,
        Verdict::Fail => 4,
        Verdict::Deviation => 3,
        Verdict::Skip => 2,
        Verdict::Pass => 1,
        Verdict::Info => 0,
    };
    if rank(a) >= rank(b) { a } else { b }
}
