//! A contact problem as a linear complementarity problem: w = M z + q, 0 ≤ w ⊥ z ≥ 0.
//!
//! Source: D. E. Stewart and J. C. Trinkle, *An implicit time-stepping scheme for rigid body dynamics with inelastic collisions and Coulomb
//! friction* (1996). Per contact z = [λ_n, β_1 … β_K, σ], λ_t = Σ β_k v_k with the vertices v_k of the friction set at λ_n = 1, and
//!
//! ```text
//! w_n = c_n        w_β = v_kᵀ c_t + σ        w_σ = λ_n − Σ β_k
//! ```

use crate::problem::{Friction, Problem};
use nalgebra::{DMatrix, DVector};

/// The complementarity problem of a contact problem, in the scales of [`Problem::scales`].
///
/// Each contact has a scale of its own beside them, a power of two. Its variables and rows are multiplied by it, and σ is divided. So the
/// entry of its normal is near 1 whatever the masses are.
#[derive(Clone, Debug, PartialEq)]
pub struct Lcp {
    /// M.
    pub matrix: DMatrix<f64>,
    /// q.
    pub constant: DVector<f64>,
    /// λ = T z.
    impulses: DMatrix<f64>,
}

impl Lcp {
    /// The complementarity problem. A round cone becomes a pyramid with this many vertices.
    pub fn new(problem: &Problem, directions: usize) -> Self {
        let scales = problem.scales();
        let rows = problem.rows();
        // Columns of T, rows of R (velocities), and where the slack of a contact stands.
        let (mut forces, mut motions): (Vec<DVector<f64>>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
        let mut couplings = Vec::new();
        for (index, contact) in problem.contacts().iter().enumerate() {
            let row = problem.range(index).start;
            let inverse_mass = problem.delassus()[(row, row)] * scales.impulse / scales.velocity;
            let own = if inverse_mass > 0.0 { (-0.5 * inverse_mass.log2()).round().exp2() } else { 1.0 };
            let normal = unit(rows, &[(row, own)]);
            let vertices = vertices(&contact.friction, directions);
            let mut force = normal.clone();
            if let Friction::Sliding { coefficient, direction } = &contact.friction {
                direction.iter().enumerate().for_each(|(k, d)| force[row + 1 + k] = -coefficient * d * own);
            }
            let first = forces.len();
            forces.push(force);
            motions.push(normal);
            for vertex in &vertices {
                let along: Vec<(usize, f64)> = vertex.iter().enumerate().map(|(k, v)| (row + 1 + k, *v * own)).collect();
                forces.push(unit(rows, &along));
                motions.push(unit(rows, &along));
            }
            if !vertices.is_empty() {
                couplings.push((first, vertices.len(), forces.len()));
                forces.push(DVector::zeros(rows));
                motions.push(DVector::zeros(rows));
            }
        }
        let impulses = DMatrix::from_columns(&forces) * scales.impulse;
        let velocities = DMatrix::from_columns(&motions).transpose() / scales.velocity;
        let mut matrix = &velocities * problem.delassus() * &impulses;
        for (normal, count, slack) in couplings {
            matrix[(slack, normal)] = 1.0;
            for beta in normal + 1..=normal + count {
                matrix[(beta, slack)] = 1.0;
                matrix[(slack, beta)] = -1.0;
            }
        }
        let constant = &velocities * (problem.free() + problem.restitution_shift());
        Self { matrix, constant, impulses }
    }

    /// The impulses λ of a solution z.
    ///
    /// # Panics
    /// If `z` has another size than the problem.
    pub fn impulses(&self, z: &DVector<f64>) -> DVector<f64> {
        &self.impulses * z
    }
}

fn unit(rows: usize, entries: &[(usize, f64)]) -> DVector<f64> {
    let mut vector = DVector::zeros(rows);
    entries.iter().for_each(|(row, value)| vector[*row] = *value);
    vector
}

/// The vertices of the friction set at λ_n = 1; none without friction.
fn vertices(friction: &Friction, directions: usize) -> Vec<Vec<f64>> {
    match friction {
        Friction::None | Friction::Sliding { .. } => Vec::new(),
        Friction::Coulomb { coefficients } if coefficients.iter().all(|mu| *mu == 0.0) => Vec::new(),
        Friction::Coulomb { coefficients } => match coefficients[..] {
            [mu] => vec![vec![mu], vec![-mu]],
            [first, second, ..] => {
                let angle = |k: usize| std::f64::consts::TAU * k as f64 / directions as f64;
                (0..directions).map(|k| vec![first * angle(k).cos(), second * angle(k).sin()]).collect()
            }
            [] => Vec::new(),
        },
        Friction::Pyramid { vertices } => vertices.iter().map(|vertex| vertex.to_vec()).collect(),
    }
}
