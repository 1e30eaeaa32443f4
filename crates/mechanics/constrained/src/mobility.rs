//! True mobility: the dofs of the tree less the rank of the constraint Jacobian, at configurations that close the loops.
//!
//! The rank counts the singular values of J above `1e-10` of the largest. A closed loop leaves 10⁻¹³ of a dependent row. The shortest
//! independent rows of a mechanism near its singularity are longer than 10⁻⁸. Rank is counted at each configuration. The generic mobility
//! is the least of all: at a singular configuration J loses rank, and gives more instantaneous freedom than there is motion.
//! Source: C. Gosselin and J. Angeles (1990) for singularities of loops; singular values: `singular.rs`.

use crate::constraint::Constraints;
use crate::error::Error;
use crate::rows::Rows;
use crate::singular::singular_values;
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
    ///
    /// ```
    /// use featherbench_constrained::{Mobility, library::Ladder};
    /// let ladder = Ladder::default();
    /// let four_bar = ladder.mechanism()?;
    /// let at = |angle: f64| Mobility::at(&four_bar.model, &four_bar.constraints, &ladder.spread(angle));
    /// assert_eq!(at(0.5)?.freedom(), 1);
    /// // All bars on one line.
    /// assert_eq!(at(std::f64::consts::FRAC_PI_2)?.freedom(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn at(model: &Model<f64>, constraints: &Constraints, q: &[f64]) -> Result<Self, Error> {
        let dofs = model.topology.nv();
        let mut rows = Rows::new(constraints);
        rows.run(model, constraints, q, &vec![0.0; dofs])?;
        let singular_values = singular_values(&DMatrix::from_row_slice(constraints.rows(), dofs, rows.jacobian()));
        let cut = singular_values.first().map_or(0.0, |largest| RANK * largest);
        let rank = singular_values.iter().filter(|value| **value > cut).count();
        let residual = largest(rows.residuals());
        Ok(Self { dofs, rank, singular_values, residual })
    }

    /// The mobility at the configuration where J has the largest rank: the generic one, if one of the configurations is not singular.
    /// `None` without configurations.
    ///
    /// # Errors
    /// As [`Mobility::at`].
    pub fn generic<'q>(
        model: &Model<f64>,
        constraints: &Constraints,
        configurations: impl IntoIterator<Item = &'q [f64]>,
    ) -> Result<Option<Self>, Error> {
        let mut best: Option<Self> = None;
        for q in configurations {
            let found = Self::at(model, constraints, q)?;
            if best.as_ref().is_none_or(|best| found.rank > best.rank) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    /// Instantaneous degrees of freedom: dofs − rank.
    pub fn freedom(&self) -> usize {
        self.dofs - self.rank
    }

    /// Rows that the others make superfluous.
    pub fn redundant(&self, constraints: &Constraints) -> usize {
        constraints.rows() - self.rank
    }
}
