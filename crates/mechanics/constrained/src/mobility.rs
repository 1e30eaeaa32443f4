//! True mobility: the dofs of the tree less the rank of the constraint Jacobian, at configurations that close the loops.
//!
//! The rank counts the singular values of J above `1e-10` of the largest. A closed loop leaves 10⁻¹³ of a dependent row. The shortest
//! independent rows of a mechanism near its singularity are longer than 10⁻⁸. Rank is counted at each configuration. The generic mobility
//! is the least of all: at a singular configuration J loses rank, and gives more instantaneous freedom than there is motion.
//! Source: C. Gosselin and J. Angeles (1990) for singularities of loops.

use crate::constraint::Constraints;
use crate::error::Error;
use crate::rows::{Rows, expect_finite};
use featherbench_model::Model;
use featherbench_spatial::largest;
use nalgebra::DMatrix;

/// A singular value counts if it is more than this of the largest.
pub const RANK: f64 = 1e-10;

/// The mobility of a robot with loops at one configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// Degrees of freedom of the tree.
    pub dofs: usize,
    /// The rank of J.
    pub rank: usize,
    /// The singular values of J, largest first.
    pub singular_values: Vec<f64>,
    /// The largest residual |φ|: how well the configuration closes the loops.
    pub residual: f64,
}

impl Mobility {
    /// The mobility at configuration `q`.
    ///
    /// # Errors
    /// [`Error`]: `q` does not fit or is not finite, or a weld is half a turn off.
    pub fn at(model: &Model<f64>, constraints: &Constraints, q: &[f64]) -> Result<Self, Error> {
        let dofs = model.topology.nv();
        let mut rows = Rows::new(constraints);
        rows.run(model, constraints, q, &vec![0.0; dofs])?;
        expect_finite("Jacobian", rows.jacobian())?;
        let jacobian = DMatrix::from_row_slice(constraints.rows(), dofs, rows.jacobian());
        let mut singular_values = if jacobian.is_empty() { Vec::new() } else { jacobian.singular_values().as_slice().to_vec() };
        singular_values.sort_by(|a, b| b.total_cmp(a));
        let cut = singular_values.first().map_or(0.0, |largest| RANK * largest);
        let rank = singular_values.iter().filter(|value| **value > cut).count();
        let residual = largest(rows.residuals());
        Ok(Self { dofs, rank, singular_values, residual })
    }

    /// Instantaneous degrees of freedom: dofs − rank.
    pub fn freedom(&self) -> usize {
        self.dofs - self.rank
    }
}
