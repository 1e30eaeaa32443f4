//! Lemke's complementary pivoting, with a lexicographic rule against cycles.
//!
//! Source: R. W. Cottle, J.-S. Pang and R. E. Stone, *The Linear Complementarity Problem* (1992), sections 4.4 and 4.9. The method ends with
//! a solution or with a ray. A ray proves nothing by itself: its direction is the candidate of a proof, which `crate::farkas` checks.

use super::lcp::Lcp;
use super::{Solver, Unsupported};
use crate::farkas;
use crate::problem::Problem;
use crate::solution::{Outcome, Point, Solution};
use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::{DMatrix, DVector};

/// Lemke's method. Exact for planar contacts and pyramids; a round cone becomes an inscribed pyramid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lemke {
    /// The vertices of the pyramid that stands for a round cone, at least 3.
    pub directions: usize,
    /// The cap on pivots.
    pub pivots: usize,
}

impl Default for Lemke {
    fn default() -> Self {
        Self { directions: 8, pivots: 10_000 }
    }
}

impl Solver for Lemke {
    fn name(&self) -> &'static str {
        "lemke"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        if self.directions < 3 {
            let (setting, value, advice) = ("directions", self.directions as f64, "a pyramid has at least 3 vertices");
            return Err(Unsupported::Setting { solver: self.name(), setting, value, advice });
        }
        let lcp = Lcp::new(problem, self.directions);
        let (end, iterations) = pivot(&lcp.matrix, &lcp.constant, self.pivots);
        let outcome = match end {
            End::Solved(z) => Outcome::Converged(Point::new(problem, lcp.impulses(&z))),
            End::Cap(z) => Outcome::CapReached { last: Point::new(problem, lcp.impulses(&z)) },
            End::Inexact(z) => Outcome::Stalled { last: Point::new(problem, lcp.impulses(&z)) },
            End::Ray(z) => farkas::proof(problem, &lcp.impulses(&z)).map_or(Outcome::Undecided, Outcome::NoSolution),
        };
        Ok(Solution { outcome, iterations, steps: Vec::new() })
    }
}

enum End {
    Solved(DVector<f64>),
    /// A complementary basis whose solution is not one within rounding.
    Inexact(DVector<f64>),
    Cap(DVector<f64>),
    Ray(DVector<f64>),
}

/// What counts as zero in the tableau. Its entries are of size 1 by the scales; pivots down to here lose at most seven digits, which the
/// last step restores.
const ZERO: f64 = 1e-9;
/// How well the complementarity problem must hold in the end.
const SOLVED: f64 = 1e-11;

/// The tableau of w − M z − 1 z0 = q: columns w (0 … n−1), z (n … 2n−1), z0 (2n), and the right side.
struct Tableau {
    entries: DMatrix<f64>,
    basis: Vec<usize>,
    size: usize,
}

impl Tableau {
    fn new(matrix: &DMatrix<f64>, constant: &DVector<f64>) -> Self {
        let size = constant.len();
        let mut entries = DMatrix::zeros(size, 2 * size + 2);
        entries.view_mut((0, 0), (size, size)).fill_with_identity();
        entries.view_mut((0, size), (size, size)).copy_from(&-matrix);
        entries.column_mut(2 * size).fill(-1.0);
        entries.set_column(2 * size + 1, constant);
        Self { entries, basis: (0..size).collect(), size }
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let scaled = self.entries.row(row) / self.entries[(row, column)];
        self.entries.set_row(row, &scaled);
        for other in (0..self.size).filter(|other| *other != row) {
            let factor = self.entries[(other, column)];
            if factor != 0.0 {
                for k in 0..self.entries.ncols() {
                    self.entries[(other, k)] -= factor * scaled[k];
                }
                self.entries[(other, column)] = 0.0;
            }
        }
        self.basis[row] = column;
    }

    /// Whether row `a` is lexicographically before row `b`, both divided by their entry of a column: right side, then the columns of w.
    fn before(&self, a: usize, b: usize, by: impl Fn(usize) -> f64) -> bool {
        let right = 2 * self.size + 1;
        for column in std::iter::once(right).chain(0..self.size) {
            let difference = self.entries[(a, column)] / by(a) - self.entries[(b, column)] / by(b);
            if difference.abs() > ZERO {
                return difference < 0.0;
            }
        }
        false
    }

    /// The row that leaves when a column enters; none if no row limits it.
    fn leaving(&self, column: usize) -> Option<usize> {
        let entry = |row: usize| self.entries[(row, column)];
        let rows: Vec<usize> = (0..self.size).filter(|row| entry(*row) > ZERO).collect();
        let first = rows.iter().copied().reduce(|best, row| if self.before(row, best, entry) { row } else { best })?;
        // z0 leaves as soon as it may: that ends the search.
        let ratio = |row: usize| self.entries[(row, 2 * self.size + 1)] / entry(row);
        let artificial = rows.into_iter().find(|row| self.basis[*row] == 2 * self.size && ratio(*row) <= ratio(first) + ZERO);
        Some(artificial.unwrap_or(first))
    }

    /// The values of z.
    fn solution(&self) -> DVector<f64> {
        let mut z = DVector::zeros(self.size);
        for (row, column) in self.basis.iter().enumerate() {
            if (self.size..2 * self.size).contains(column) {
                z[column - self.size] = self.entries[(row, 2 * self.size + 1)];
            }
        }
        z
    }
}

fn pivot(matrix: &DMatrix<f64>, constant: &DVector<f64>, cap: usize) -> (End, usize) {
    let size = constant.len();
    if constant.iter().all(|q| *q >= 0.0) {
        return (End::Solved(DVector::zeros(size)), 0);
    }
    let mut tableau = Tableau::new(matrix, constant);
    let first = (0..size).reduce(|best, row| if tableau.before(row, best, |_| 1.0) { row } else { best });
    let Some(mut row) = first else { return (End::Solved(DVector::zeros(size)), 0) };
    let mut entering = 2 * size;
    for pivots in 1..=cap {
        let left = tableau.basis[row];
        tableau.pivot(row, entering);
        if left == 2 * size {
            let z = polished(matrix, constant, &tableau);
            let end = if violation(matrix, constant, &z) <= SOLVED { End::Solved(z) } else { End::Inexact(z) };
            return (end, pivots);
        }
        entering = if left < size { left + size } else { left - size };
        match tableau.leaving(entering) {
            Some(next) => row = next,
            None => return (End::Ray(ray(&tableau, entering)), pivots),
        }
    }
    (End::Cap(tableau.solution()), cap)
}

/// The direction of z along the ray, of length 1 in the largest entry.
fn ray(tableau: &Tableau, entering: usize) -> DVector<f64> {
    let size = tableau.size;
    let mut direction = DVector::zeros(size);
    for (row, column) in tableau.basis.iter().enumerate() {
        if (size..2 * size).contains(column) {
            let entry = -tableau.entries[(row, entering)];
            // Up to rounding no entry is negative, since no row limits the column.
            direction[column - size] = if entry.abs() <= ZERO { 0.0 } else { entry };
        }
    }
    if (size..2 * size).contains(&entering) {
        direction[entering - size] = 1.0;
    }
    let largest = direction.amax();
    if largest > 0.0 { direction / largest } else { direction }
}

/// The largest violation of 0 ≤ w ⊥ z ≥ 0.
fn violation(matrix: &DMatrix<f64>, constant: &DVector<f64>, z: &DVector<f64>) -> f64 {
    let w = matrix * z + constant;
    let smaller = w.iter().zip(z).map(|(w, z)| if w < z { w.abs() } else { z.abs() });
    let scale = 1.0 + z.amax();
    smaller.fold(0.0, featherbench_spatial::larger) / scale
}

/// The solution of the basis again, by elimination and three corrections with double-double residuals: pivoting lost digits.
fn polished(matrix: &DMatrix<f64>, constant: &DVector<f64>, tableau: &Tableau) -> DVector<f64> {
    let size = tableau.size;
    let found = tableau.solution();
    let mut active: Vec<usize> = tableau.basis.iter().filter(|c| (size..2 * size).contains(*c)).map(|c| c - size).collect();
    active.sort_unstable();
    let block = DMatrix::from_fn(active.len(), active.len(), |row, column| matrix[(active[row], active[column])]);
    let factor = block.lu();
    let mut better = found.clone();
    for _ in 0..3 {
        let residual = |row: &usize| {
            let sum = better
                .iter()
                .enumerate()
                .fold(DoubleDouble::from_f64(constant[*row]), |sum, (k, z)| sum + DoubleDouble::from_product(matrix[(*row, k)], *z));
            -sum.to_f64()
        };
        let residual = DVector::from_iterator(active.len(), active.iter().map(residual));
        let Some(correction) = factor.solve(&residual) else { return found };
        active.iter().zip(&correction).for_each(|(k, value)| better[*k] += value);
    }
    // A correction that made it worse, or that is no number, is none.
    if violation(matrix, constant, &better) <= violation(matrix, constant, &found) { better } else { found }
}
