//! The standard form of the cone solvers: x and c in the self-dual cone's axes, free of units.

use super::Unsupported;
use crate::cones;
use crate::problem::{Friction, Problem};
use crate::solution::Point;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Rows and factors of a column.
type Entries = Vec<(usize, f64)>;

/// c = A x + b with cones of sizes 1, 2 and 3. Impulses are λ = T x.
pub(crate) struct Standard {
    pub offsets: Vec<usize>,
    pub matrix: DMatrix<f64>,
    pub free: DVector<f64>,
    impulses: DMatrix<f64>,
}

impl Standard {
    /// The standard form. A sliding contact becomes a cone of size 1 with one column that holds its friction; A is then not symmetric.
    pub fn new(problem: &Problem, solver: &'static str, takes_sliding: bool) -> Result<Self, Unsupported> {
        let refuse = |contact: &str, reason| Unsupported::Contact { solver, contact: contact.to_owned(), reason };
        let scales = problem.scales();
        let mut offsets = vec![0];
        let mut columns: Vec<(Entries, Entries)> = Vec::new();
        for (index, contact) in problem.contacts().iter().enumerate() {
            let row = problem.range(index).start;
            match &contact.friction {
                Friction::None => columns.push((vec![(row, 1.0)], vec![(row, 1.0)])),
                Friction::Coulomb { coefficients } => {
                    columns.push((vec![(row, 1.0)], vec![(row, 1.0)]));
                    for (k, mu) in coefficients.iter().enumerate().filter(|(_, mu)| **mu > 0.0) {
                        columns.push((vec![(row + 1 + k, *mu)], vec![(row + 1 + k, *mu)]));
                    }
                }
                Friction::Pyramid { .. } => return Err(refuse(&contact.name, "it has no friction pyramids")),
                Friction::Sliding { .. } if !takes_sliding => {
                    return Err(refuse(&contact.name, "a sliding direction makes the problem unsymmetric"));
                }
                Friction::Sliding { coefficient, direction } => {
                    let mut column = vec![(row, 1.0)];
                    column.extend(direction.iter().enumerate().map(|(k, d)| (row + 1 + k, -coefficient * d)));
                    columns.push((column, vec![(row, 1.0)]));
                }
            }
            offsets.push(columns.len());
        }
        let (mut impulses, mut velocities) = (DMatrix::zeros(problem.rows(), columns.len()), DMatrix::zeros(columns.len(), problem.rows()));
        for (k, (impulse, velocity)) in columns.iter().enumerate() {
            impulse.iter().for_each(|(row, factor)| impulses[(*row, k)] = factor * scales.impulse);
            velocity.iter().for_each(|(row, factor)| velocities[(k, *row)] = factor / scales.velocity);
        }
        let matrix = &velocities * problem.delassus() * &impulses;
        let free = &velocities * (problem.free() + problem.restitution_shift());
        Ok(Self { offsets, matrix, free, impulses })
    }

    pub fn contacts(&self) -> usize {
        self.offsets.len() - 1
    }

    pub fn size(&self) -> usize {
        self.free.len()
    }

    pub fn range(&self, contact: usize) -> Range<usize> {
        self.offsets[contact]..self.offsets[contact + 1]
    }

    pub fn velocities(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.matrix * x + &self.free
    }

    /// The natural-map residual of Coulomb's law.
    pub fn residual(&self, x: &DVector<f64>, c: &DVector<f64>) -> f64 {
        (0..self.contacts()).map(|k| cones::natural(&x.as_slice()[self.range(k)], &c.as_slice()[self.range(k)])).fold(0.0, larger)
    }

    pub fn point(&self, problem: &Problem, x: &DVector<f64>) -> Point {
        Point::new(problem, &self.impulses * x)
    }

    /// The steps of a block: the reciprocal of the normal diagonal entry and of the tangential trace. Where a diagonal entry is zero or
    /// negative (a contact that cannot move, a paradox of sliding) the step is 1, the scale of the problem.
    pub fn steps(&self, contact: usize) -> [f64; 2] {
        let range = self.range(contact);
        let step = |trace: f64| if trace > 1e-12 { 1.0 / trace } else { 1.0 };
        let tangents = range.start + 1..range.end;
        [step(self.matrix[(range.start, range.start)]), step(tangents.map(|k| self.matrix[(k, k)]).sum())]
    }

    /// One sweep of projected Gauss–Seidel: the normal row of a contact, then its tangent rows; the radius of the disk is the new x_n.
    /// Returns the largest change.
    pub fn sweep(&self, x: &mut DVector<f64>, compliance: f64) -> f64 {
        let mut largest = 0.0;
        let velocity = |x: &DVector<f64>, row: usize| (self.matrix.row(row) * x)[0] + self.free[row] + compliance * x[row];
        for contact in 0..self.contacts() {
            let range = self.range(contact);
            let [normal, tangent] = self.steps(contact);
            let old = x[range.start];
            let moved = old - normal / (1.0 + compliance * normal) * velocity(x, range.start);
            x[range.start] = if moved > 0.0 { moved } else { 0.0 * moved };
            largest = larger(largest, (x[range.start] - old).abs());
            let step = tangent / (1.0 + compliance * tangent);
            let tangents = range.start + 1..range.end;
            let mut moved: Vec<f64> = tangents.clone().map(|row| x[row] - step * velocity(x, row)).collect();
            let length = moved.iter().map(|t| t * t).sum::<f64>().sqrt();
            if length > x[range.start] {
                moved.iter_mut().for_each(|t| *t *= x[range.start] / length);
            }
            for (row, new) in tangents.zip(moved) {
                largest = larger(largest, (x[row] - new).abs());
                x[row] = new;
            }
        }
        largest
    }
}
