//! Physically consistent least squares as a semidefinite programme, for a solver outside.
//!
//! Source: P. Wensing, S. Kim & J.-J. Slotine (2018). With x = θ/s, each unknown in the size of its kind:
//!
//! ```text
//! minimise ½ |A x − b|²   while   D P_i(x) D ⪰ MARGIN · 1   for every body,   x_k ≥ 0 for armature and friction
//! ```
//!
//! A and b are the triangular factor of the stacked equations, and below it the pull towards the description. D = diag(1/ℓ, 1/ℓ, 1/ℓ, 1) makes
//! the blocks of P alike; ℓ is the radius of gyration of the largest inertia and mass. The margin is larger than a solver's tolerance: so
//! the eigenvalues are not negative. What is not negative stands on the diagonal of further 4×4 matrices, padded with ones.

use crate::estimate::sizes;
use crate::{IdentificationError, Information, Kind, LinearModel, PseudoInertia};
use featherbench_dynamics::PARAMETERS;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};

/// The least eigenvalue of a scaled pseudo-inertia, of the largest mass of the description.
pub const MARGIN: f64 = 1e-6;

/// A problem: minimise ½|A x − b|² while the maps of x to symmetric 4×4 matrices are positive semidefinite.
#[derive(Clone, Debug, PartialEq)]
pub struct Semidefinite {
    /// A, row by row.
    pub matrix: Vec<f64>,
    /// b.
    pub target: Vec<f64>,
    /// Of each matrix 16 rows of n + 1 numbers: what multiplies x, and what is added.
    pub maps: Vec<f64>,
    /// s: the size of each unknown.
    sizes: Vec<f64>,
}

impl Semidefinite {
    /// The problem of stacked equations; `pull` is the weight of the description, relative to the longest column.
    ///
    /// # Errors
    /// [`IdentificationError::Length`] when the equations are those of another robot.
    pub fn of(linear: &LinearModel, information: &Information, pull: f64) -> Result<Self, IdentificationError> {
        let (sizes, nominal) = (sizes(linear), linear.nominal());
        let count = sizes.len();
        if information.unknowns() != count {
            return Err(IdentificationError::Length { array: "equations", found: information.unknowns(), samples: 1, expected: count });
        }
        let scaled = information.factor() * DMatrix::from_diagonal(&DVector::from_column_slice(&sizes));
        let longest = scaled.column_iter().map(|column| column.norm()).fold(0.0, larger);
        // In units of the longest column: a solver's tolerances are for numbers near one.
        let mut matrix: Vec<f64> = scaled.transpose().iter().map(|x| x / longest).collect();
        let mut target: Vec<f64> = information.right().iter().map(|x| x / longest).collect();
        for k in 0..count {
            matrix.extend((0..count).map(|column| if column == k { pull } else { 0.0 }));
            target.push(pull * nominal[k] / sizes[k]);
        }
        let bodies = linear.description().bodies.len();
        let (mass, inertia) = (sizes[0], sizes[4]);
        let reach = (inertia / mass).sqrt();
        let mut maps = Vec::new();
        for body in 0..bodies {
            let mut map = DMatrix::<f64>::zeros(16, count + 1);
            for k in 0..PARAMETERS {
                let unknown = PARAMETERS * body + k;
                let unit: [f64; PARAMETERS] = std::array::from_fn(|j| if j == k { sizes[unknown] } else { 0.0 });
                let of_unit = PseudoInertia::of(&unit).0;
                for (i, j) in (0..16).map(|entry| (entry / 4, entry % 4)) {
                    let length = |axis: usize| if axis < 3 { reach } else { 1.0 };
                    map[(4 * i + j, unknown)] = of_unit[(i, j)] / (length(i) * length(j) * mass);
                }
            }
            (0..4).for_each(|i| map[(5 * i, count)] = -MARGIN);
            maps.extend(map.transpose().iter());
        }
        let positive = |kind| matches!(kind, Kind::Armature | Kind::Viscous | Kind::Coulomb);
        let positive: Vec<usize> = (0..count).filter(|&k| positive(linear.unknowns()[k].kind)).collect();
        for four in positive.chunks(4) {
            let mut map = DMatrix::<f64>::zeros(16, count + 1);
            for i in 0..4 {
                match four.get(i) {
                    Some(&unknown) => map[(5 * i, unknown)] = 1.0,
                    None => map[(5 * i, count)] = 1.0,
                }
            }
            maps.extend(map.transpose().iter());
        }
        Ok(Self { matrix, target, maps, sizes })
    }

    /// How many unknowns there are.
    pub fn unknowns(&self) -> usize {
        self.sizes.len()
    }

    /// θ of an answer x. A friction or armature below zero by a solver's tolerance is zero.
    ///
    /// # Errors
    /// [`IdentificationError`] when x has another length or is not finite.
    pub fn theta(&self, linear: &LinearModel, x: &[f64]) -> Result<Vec<f64>, IdentificationError> {
        if x.len() != self.sizes.len() {
            return Err(IdentificationError::Length { array: "x", found: x.len(), samples: 1, expected: self.sizes.len() });
        }
        if let Some((at, &value)) = x.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(IdentificationError::NotFinite { what: format!("x[{at}] of the solver"), value });
        }
        let positive = |k: usize| matches!(linear.unknowns()[k].kind, Kind::Armature | Kind::Viscous | Kind::Coulomb);
        Ok(x.iter().zip(&self.sizes).enumerate().map(|(k, (x, size))| if positive(k) { (x * size).max(0.0) } else { x * size }).collect())
    }
}
