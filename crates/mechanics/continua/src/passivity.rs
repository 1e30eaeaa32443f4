//! Whether matrices are those of a passive rod: M ≻ 0, K ⪰ 0, D ⪰ 0, by the eigenvalues of their symmetric parts.
//!
//! With E = ½ ẋᵀ M ẋ + ½ xᵀ K x and M, K symmetric, M ẍ + D ẋ + K x = 0 gives dE/dt = −ẋᵀ D ẋ ≤ 0. A Galerkin discretisation, which tests
//! with its own shape functions, has such matrices. Collocation asks for the equation at points instead. Its matrices are not symmetric:
//! with the energy of the symmetric parts, dE/dt = −ẋᵀ D ẋ − ẋᵀ ½(K − Kᵀ) x − ẋᵀ ½(M − Mᵀ) ẍ, which has no sign.

use crate::{Basis, Refused, Rod};
use nalgebra::{DMatrix, SymmetricEigen};

/// What was found of three matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passivity {
    /// The smallest eigenvalues of the symmetric parts of M, K and D, each over the largest magnitude of an eigenvalue of that part. Zero
    /// for a matrix of zeros.
    pub smallest: [f64; 3],
    /// ‖A − Aᵀ‖/‖A‖ of M, K and D, in the Frobenius norm; zero for a matrix of zeros.
    pub asymmetry: [f64; 3],
    /// The size of the matrices.
    pub size: usize,
}

/// An entry of a symmetric matrix and its mirror image differ by roundings of sums of products: 1e-12 leaves four digits of room, and a
/// collocation's differ in the first digit.
const SYMMETRIC: f64 = 1e-12;

impl Passivity {
    /// Whether M ≻ 0, K ⪰ 0, D ⪰ 0, and M and K are symmetric. An eigenvalue is zero below n ε times the largest.
    pub fn passive(&self) -> bool {
        let rounding = self.size as f64 * f64::EPSILON;
        let [m, k, d] = self.smallest;
        m > rounding && k >= -rounding && d >= -rounding && self.asymmetry[0] <= SYMMETRIC && self.asymmetry[1] <= SYMMETRIC
    }
}

/// Judges the matrices M, K and D; they are square and of one size. NaN in a matrix is NaN in the answer, which is then not passive.
pub fn passivity(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> Passivity {
    let matrices = [mass, stiffness, damping];
    let asymmetry = matrices.map(|matrix| {
        let (difference, norm) = ((matrix - matrix.transpose()).norm(), matrix.norm());
        if norm == 0.0 { 0.0 } else { difference / norm }
    });
    Passivity { smallest: matrices.map(smallest), asymmetry, size: mass.nrows() }
}

/// The smallest eigenvalue of the symmetric part over the largest magnitude.
fn smallest(matrix: &DMatrix<f64>) -> f64 {
    let symmetric = (matrix + matrix.transpose()) * 0.5;
    if symmetric.iter().any(|x| !x.is_finite()) {
        return f64::NAN;
    }
    let eigenvalues = SymmetricEigen::new(symmetric).eigenvalues;
    let largest = eigenvalues.amax();
    if largest == 0.0 { 0.0 } else { eigenvalues.min() / largest }
}

/// The matrices M and K of a cantilever's bending by collocation: ρA ẅ + EI w⁗ = 0 at n Gauss points for n shape functions,
/// M_ij = ρA φ_j(x_i), K_ij = EI φ_j⁗(x_i)/L⁴. It is here to be judged, not to be used.
///
/// # Errors
/// [`Refused`] for a basis without terms.
pub fn collocation(rod: &Rod, basis: Basis) -> Result<(DMatrix<f64>, DMatrix<f64>), Refused> {
    let terms = basis.terms(true);
    if terms == 0 {
        return Err(Refused::new("basis", crate::Defect::None));
    }
    let points = crate::quadrature::gauss(terms);
    let bending = rod.stiffness(crate::Strain::BendZ) / rod.length().powi(4);
    let matrix = |entry: &dyn Fn(crate::Shape) -> f64| DMatrix::from_fn(terms, terms, |i, j| entry(basis.at(true, j, points[i].0)));
    Ok((matrix(&|shape| rod.mass_per_length() * shape.value), matrix(&|shape| bending * shape.fourth)))
}
