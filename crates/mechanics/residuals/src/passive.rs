//! A linear residual that makes no energy: r = K q + D v + A a + c.
//!
//! With K = Kᵀ, A = Aᵀ and M + A ≻ 0 it has the energy E = ½ vᵀA v + ½ qᵀK q + cᵀq beside the nominal model's, and
//!
//! ```text
//! d/dt (Ê + E) = vᵀτ − vᵀD v
//! ```
//!
//! so it is conservative for D = 0 (or D skew) and dissipative for D + Dᵀ ⪰ 0. The nearest such residual, in the Frobenius norm of each
//! matrix, is known in closed form:
//!
//! - of K, the symmetric part;
//! - of D, the skew part, and the symmetric part with its negative eigenvalues set to zero;
//! - of A, the symmetric part, with the eigenvalues of L + A raised to a margin.
//!
//! L is any matrix with M(q) ⪰ L for all q: zero is one. The [`Certificate`] is the smallest eigenvalue of each, computed from the result.

use crate::error::{expect, finite};
use crate::{Linear, Residual, ResidualError, State};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A linear residual with a certificate of passivity.
#[derive(Clone, Debug, PartialEq)]
pub struct Passive {
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    inertia: DMatrix<f64>,
    constant: DVector<f64>,
}

/// What a projection demands.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// A symmetric lower bound L of the nominal mass matrix: M(q) ⪰ L for all q.
    pub mass_below: DMatrix<f64>,
    /// The smallest eigenvalue that L + A must have, kg·m²; positive.
    pub margin: f64,
}

/// The proof that a residual is passive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// The largest entry of K − Kᵀ and A − Aᵀ, in absolute value.
    pub asymmetry: f64,
    /// The smallest eigenvalue of (D + Dᵀ)/2.
    pub damping: f64,
    /// The smallest eigenvalue of L + A.
    pub inertia: f64,
}

impl Certificate {
    /// Whether it proves passivity. Eigenvalues have rounding errors of some ulp of the largest, `scale`: 10⁻¹⁴ of it is forgiven.
    pub fn holds(&self, scale: f64) -> bool {
        self.asymmetry == 0.0 && self.damping >= -1e-14 * scale && self.inertia > 0.0
    }
}

impl Passive {
    /// The passive residual that is nearest to a linear one, and its distance (the Frobenius norm of what changed).
    ///
    /// # Errors
    /// [`ResidualError::NotAVectorSpace`] for a robot with nq ≠ nv, whose q has no stiffness matrix; [`ResidualError`] if L does not fit, or a number
    /// is not finite, or the margin is not positive.
    pub fn nearest(linear: &Linear, projection: &Projection) -> Result<(Self, f64), ResidualError> {
        let (nq, n) = linear.sizes();
        if nq != n {
            return Err(ResidualError::NotAVectorSpace { what: "a passive linear residual", nq, nv: n });
        }
        let below = &projection.mass_below;
        expect("rows of the mass matrix's lower bound", n, below.nrows())?;
        expect("columns of the mass matrix's lower bound", n, below.ncols())?;
        finite("the mass matrix's lower bound", below.as_slice())?;
        crate::error::demand("margin", &[projection.margin], "it must be finite and positive", |x| x > 0.0)?;
        let [k, d, a] = [0, n, 2 * n].map(|first| linear.block(first, n));
        let stiffness = symmetric(&k);
        let skew = (&d - d.transpose()) * 0.5;
        let damping = raised(&symmetric(&d), 0.0) + skew;
        // The sum is made symmetric once more: its rounding errors are not.
        let inertia = symmetric(&(raised(&symmetric(&(below + &a)), projection.margin) - symmetric(below)));
        let constant = DVector::from_column_slice(linear.block(3 * n, 1).as_slice());
        let moved = [(&stiffness - k).norm(), (&damping - d).norm(), (&inertia - a).norm()];
        let distance = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
        Ok((Self { stiffness, damping, inertia, constant }, distance))
    }

    /// The smallest eigenvalues that prove it passive, with the lower bound L of the mass matrix.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] if L does not fit.
    pub fn certificate(&self, mass_below: &DMatrix<f64>) -> Result<Certificate, ResidualError> {
        expect("rows of the mass matrix's lower bound", self.nv(), mass_below.nrows())?;
        expect("columns of the mass matrix's lower bound", self.nv(), mass_below.ncols())?;
        let asymmetry = |matrix: &DMatrix<f64>| (matrix - matrix.transpose()).amax();
        let smallest = |matrix: &DMatrix<f64>| symmetric(matrix).symmetric_eigenvalues().min();
        let [k, a] = [asymmetry(&self.stiffness), asymmetry(&self.inertia)];
        let asymmetry = if k.is_nan() || k > a { k } else { a };
        Ok(Certificate { asymmetry, damping: smallest(&self.damping), inertia: smallest(&(mass_below + &self.inertia)) })
    }

    /// The energy that it stores at a state: ½ vᵀA v + ½ qᵀK q + cᵀq, J.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] when an argument does not fit.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> Result<f64, ResidualError> {
        expect("configuration q", self.nv(), q.len())?;
        expect("velocity v", self.nv(), v.len())?;
        let [q, v] = [q, v].map(DVector::from_column_slice);
        Ok(0.5 * v.dot(&(&self.inertia * &v)) + 0.5 * q.dot(&(&self.stiffness * &q)) + self.constant.dot(&q))
    }

    /// The power that it dissipates, vᵀD v, W.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] when `v` does not fit.
    pub fn dissipated(&self, v: &[f64]) -> Result<f64, ResidualError> {
        expect("velocity v", self.nv(), v.len())?;
        let v = DVector::from_column_slice(v);
        Ok(v.dot(&(&self.damping * &v)))
    }

    /// The damping D.
    pub fn damping(&self) -> &DMatrix<f64> {
        &self.damping
    }

    /// The largest entry of D in absolute value: what its eigenvalues are measured by.
    pub fn damping_scale(&self) -> f64 {
        self.damping.amax()
    }

    /// It as a linear residual.
    ///
    /// # Errors
    /// [`ResidualError::NotFinite`] if the projection met NaN.
    pub fn to_linear(&self) -> Result<Linear, ResidualError> {
        let n = self.nv();
        let row = |i: usize| {
            let of = |matrix: &DMatrix<f64>| matrix.row(i).iter().copied().collect::<Vec<f64>>();
            [of(&self.stiffness), of(&self.damping), of(&self.inertia), vec![self.constant[i]]].concat()
        };
        Linear::new(n, n, (0..n).flat_map(row).collect())
    }
}

/// The symmetric part, symmetric to the bit.
fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]))
}

/// A symmetric matrix with its eigenvalues raised to at least `least`; the same to the bit if they are.
fn raised(matrix: &DMatrix<f64>, least: f64) -> DMatrix<f64> {
    let SymmetricEigen { eigenvectors, eigenvalues } = matrix.clone().symmetric_eigen();
    if eigenvalues.iter().all(|&x| x >= least) {
        return matrix.clone();
    }
    let lifted = eigenvalues.map(|x| if x < least { least } else { x });
    symmetric(&(&eigenvectors * DMatrix::from_diagonal(&lifted) * eigenvectors.transpose()))
}

impl Residual for Passive {
    fn nv(&self) -> usize {
        self.constant.len()
    }

    fn nq(&self) -> Option<usize> {
        Some(self.constant.len())
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let [q, v, a] = [state.q, state.v, state.a].map(DVector::from_column_slice);
        let sum = &self.stiffness * q + &self.damping * v + &self.inertia * a + &self.constant;
        r.iter_mut().zip(&sum).for_each(|(r, x)| *r += x);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        true
    }

    fn add_by_acceleration(&self, _: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        *matrix += &self.inertia;
        Ok(())
    }
}
