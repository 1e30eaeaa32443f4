//! The errors of the factorization M = LᵀDL and of a solution of M x = b, in units that do not depend on those of M.
//!
//! A factorization without pivoting of a positive definite M commits at most the error γ |L|ᵀ|D||L| entry by entry, with γ of the order of
//! the depth times ε (N. J. Higham, *Accuracy and stability of numerical algorithms*, 2002, section 10.1), and (|L|ᵀD|L|)_ij ≤ √(M_ii M_jj). So
//! - the error of the factors is `max_ij |LᵀDL − M|_ij / √(M_ii M_jj)`;
//! - the error of a solution is its residual as a change of M in the same units: `max_i |b − M x|_i / (√M_ii Σ_j √M_jj |x_j|)`, where j runs
//!   over the dofs that share a path with i.
//!
//! LᵀDL and M x are formed in double-double arithmetic, from the f64 that the kernels took and gave: the measure has no error of its own.

use featherbench_bench::Robot;
use featherbench_bench::measure::{ratio, worst};
use featherbench_dynamics::{Ltdl, TreeSparse, mass_matrix};
use featherbench_spatial::{DoubleDouble, Lift, Real};

/// The errors of the factors and of a solution at the robot's first state.
///
/// # Errors
/// A sentence, when M cannot be factorized.
pub(super) fn errors(robot: &Robot) -> Result<[f64; 2], String> {
    let mut ltdl = Ltdl::new(&robot.model.topology);
    ltdl.run(&matrix(robot)?).map_err(|error| error.to_string())?;
    let mut x = robot.states.tau(0).to_vec();
    ltdl.solve(&mut x).map_err(|error| error.to_string())?;
    Ok([error_of_factors(robot, ltdl.factors().values())?, error_of_solution(robot, &x)?])
}

/// The error of factors in the tree-sparse layout, L below the diagonal and D on it, at the robot's first state.
///
/// # Errors
/// A sentence, when there is no M.
pub(super) fn error_of_factors(robot: &Robot, factors: &[f64]) -> Result<f64, String> {
    let matrix = matrix(robot)?;
    Ok(Rows::of(robot.model.topology.dof_parents()).of_factors(&matrix, factors, &roots(&matrix)))
}

/// The error of a solution of M x = τ at the robot's first state.
///
/// # Errors
/// A sentence, when there is no M.
pub(super) fn error_of_solution(robot: &Robot, x: &[f64]) -> Result<f64, String> {
    let matrix = matrix(robot)?;
    Ok(Rows::of(robot.model.topology.dof_parents()).of_solution(&matrix, &roots(&matrix), robot.states.tau(0), x))
}

fn matrix(robot: &Robot) -> Result<TreeSparse<f64>, String> {
    mass_matrix(&robot.model, robot.states.q(0)).map_err(|error| error.to_string())
}

fn roots(matrix: &TreeSparse<f64>) -> Vec<f64> {
    matrix.diagonal().map(f64::sqrt).collect()
}

/// The rows of a tree-sparse matrix: row i has the entries (i, j) of the dofs j from the root to i.
struct Rows<'a> {
    parents: &'a [Option<usize>],
    /// Where each row begins, and the end of the last one.
    starts: Vec<usize>,
}

impl<'a> Rows<'a> {
    fn of(parents: &'a [Option<usize>]) -> Self {
        let (mut starts, mut depths) = (vec![0], Vec::with_capacity(parents.len()));
        for (dof, parent) in parents.iter().enumerate() {
            depths.push(1 + parent.map_or(0, |parent: usize| depths[parent]));
            starts.push(starts[dof] + depths[dof]);
        }
        Self { parents, starts }
    }

    /// The dofs from the root to `dof`, into memory that is used again.
    fn path(&self, dof: usize, path: &mut Vec<usize>) {
        path.clear();
        path.extend(std::iter::successors(Some(dof), |&dof| self.parents[dof]));
        path.reverse();
    }

    /// `max_ij |LᵀDL − M|_ij / √(M_ii M_jj)`. Row k of L adds L_ki D_k L_kj to the entry (i, j) of each two dofs on its path.
    fn of_factors(&self, matrix: &TreeSparse<f64>, factors: &[f64], roots: &[f64]) -> f64 {
        let wide = |&x: &f64| -> DoubleDouble { x.lift() };
        let mut difference: Vec<DoubleDouble> = matrix.values().iter().map(|m| -wide(m)).collect();
        let (mut path, mut row) = (Vec::new(), Vec::new());
        for dof in 0..self.parents.len() {
            self.path(dof, &mut path);
            row.clear();
            row.extend(factors[self.starts[dof]..self.starts[dof + 1]].iter().map(wide));
            // L has ones on its diagonal, and D stands in their places.
            let pivot = row.pop().unwrap_or_else(DoubleDouble::zero);
            row.push(DoubleDouble::one());
            for (i, &above) in path.iter().enumerate() {
                let scaled = row[i] * pivot;
                let entries = &mut difference[self.starts[above]..=self.starts[above] + i];
                entries.iter_mut().zip(&row).for_each(|(sum, &l)| *sum = scaled.mul_add(l, *sum));
            }
        }
        let mut largest = 0.0;
        for dof in 0..self.parents.len() {
            self.path(dof, &mut path);
            for (&error, &other) in difference[self.starts[dof]..self.starts[dof + 1]].iter().zip(&path) {
                largest = worst(largest, ratio(error.to_f64().abs(), roots[dof] * roots[other]));
            }
        }
        largest
    }

    /// `max_i |b − M x|_i / (√M_ii Σ_j √M_jj |x_j|)`.
    fn of_solution(&self, matrix: &TreeSparse<f64>, roots: &[f64], b: &[f64], x: &[f64]) -> f64 {
        let wide = |&x: &f64| -> DoubleDouble { x.lift() };
        let mut residual: Vec<DoubleDouble> = b.iter().map(wide).collect();
        let (mut magnitude, mut path) = (vec![0.0; b.len()], Vec::new());
        for dof in 0..self.parents.len() {
            self.path(dof, &mut path);
            for (m, &other) in matrix.values()[self.starts[dof]..self.starts[dof + 1]].iter().zip(&path) {
                residual[dof] -= wide(m) * wide(&x[other]);
                magnitude[dof] += roots[other] * x[other].abs();
                if other != dof {
                    residual[other] -= wide(m) * wide(&x[dof]);
                    magnitude[other] += roots[dof] * x[dof].abs();
                }
            }
        }
        let errors = residual.iter().zip(&magnitude).zip(roots);
        errors.map(|((r, magnitude), root)| ratio(r.to_f64().abs(), root * magnitude)).fold(0.0, worst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_bench::alone;

    fn spoilt(spec: &str, spoil: impl FnOnce(&mut [f64], &mut [f64])) -> [f64; 2] {
        let robot = alone::robot(spec, 1).unwrap();
        let topology = &robot.model.topology;
        let matrix = mass_matrix(&robot.model, robot.states.q(0)).unwrap();
        let mut ltdl = Ltdl::new(topology);
        ltdl.run(&matrix).unwrap();
        let (b, mut x) = (robot.states.tau(0), robot.states.tau(0).to_vec());
        ltdl.solve(&mut x).unwrap();
        let mut factors = ltdl.factors().clone();
        spoil(factors.values_mut(), &mut x);
        let rows = Rows::of(topology.dof_parents());
        let roots: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
        [rows.of_factors(&matrix, factors.values(), &roots), rows.of_solution(&matrix, &roots, b, &x)]
    }

    #[test]
    fn right_factors_are_within_rounding_and_every_spoilt_number_shows() {
        for spec in ["chain:n=20,layout=spatial", "binary_tree:depth=5", "star:n=6", "humanoid", "tree:n=30,seed=4"] {
            let [factors, solution] = spoilt(spec, |_, _| ());
            assert!(factors < 1e-15 && solution < 1e-15, "{spec}: {factors:e} {solution:e}");
            let robot = alone::robot(spec, 1).unwrap();
            for at in [0, robot.model.topology.stored() / 2, robot.model.topology.stored() - 1] {
                let [factors, solution] = spoilt(spec, |l, _| l[at] += 1e-10 * (1.0 + l[at].abs()));
                assert!(factors > 1e-13 && solution < 1e-15, "{spec}, number {at}: {factors:e}");
            }
            let [_, solution] = spoilt(spec, |_, x| x[0] *= 1.0 + 1e-9);
            assert!(solution > 1e-13, "{spec}: {solution:e}");
            let [factors, solution] = spoilt(spec, |l, x| (l[0], x[0]) = (f64::NAN, f64::NAN));
            assert!(factors.is_nan() && solution.is_nan(), "{spec}: a NaN never passes");
        }
    }
}
