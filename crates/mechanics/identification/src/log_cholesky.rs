//! Ten unconstrained numbers for every body that can exist.
//!
//! Source: C. Rucker & P. Wensing, *Smooth parameterization of rigid-body inertia* (2022). The pseudo-inertia is `P = U Uᵀ`, with
//!
//! ```text
//!             ⎡ e^{d₁}  s₁₂     s₁₃     t₁ ⎤
//!   U = e^α · ⎢ 0       e^{d₂}  s₂₃     t₂ ⎥      φ = (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃)
//!             ⎢ 0       0       e^{d₃}  t₃ ⎥
//!             ⎣ 0       0       0       1  ⎦
//! ```
//!
//! `m = e^{2α}`, and t is the centre of mass, m. Every φ gives a P ≻ 0, and every P ≻ 0 has one φ.

use crate::PseudoInertia;
use featherbench_dynamics::PARAMETERS;
use nalgebra::{Matrix4, SMatrix, SVector};

/// The places of s and t in U, in the order of φ.
const PLACES: [(usize, usize); 6] = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)];

/// The numbers φ of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogCholesky(pub [f64; PARAMETERS]);

impl LogCholesky {
    /// The φ of ten inertial parameters; `None` unless P ≻ 0.
    ///
    /// ```
    /// use featherbench_identification::LogCholesky;
    /// let ball = [1.0, 0.1, 0.0, 0.2, 0.08, 0.0, -0.01, 0.09, 0.0, 0.05];
    /// let back = LogCholesky::of(&ball).unwrap().parameters();
    /// assert!(ball.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14));
    /// ```
    pub fn of(pi: &[f64; PARAMETERS]) -> Option<Self> {
        let p = PseudoInertia::of(pi).0;
        // Upper factor, column after column from the last.
        let mut u = Matrix4::<f64>::zeros();
        for j in (0..4).rev() {
            for i in (0..=j).rev() {
                let sum: f64 = (j + 1..4).map(|k| u[(i, k)] * u[(j, k)]).sum();
                let rest = p[(i, j)] - sum;
                // NaN is not positive either.
                u[(i, j)] = if i < j {
                    rest / u[(j, j)]
                } else if rest > 0.0 {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
        }
        let scale = u[(3, 3)];
        let mut phi =
            [scale.ln(), (u[(0, 0)] / scale).ln(), (u[(1, 1)] / scale).ln(), (u[(2, 2)] / scale).ln(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (slot, place) in phi[4..].iter_mut().zip(PLACES) {
            *slot = u[place] / scale;
        }
        phi.iter().all(|x| x.is_finite()).then_some(Self(phi))
    }

    fn factor(&self) -> Matrix4<f64> {
        let [alpha, d1, d2, d3, ..] = self.0;
        let mut u = Matrix4::from_diagonal(&nalgebra::Vector4::new(d1.exp(), d2.exp(), d3.exp(), 1.0));
        for (&value, place) in self.0[4..].iter().zip(PLACES) {
            u[place] = value;
        }
        u * alpha.exp()
    }

    /// The ten inertial parameters.
    pub fn parameters(&self) -> [f64; PARAMETERS] {
        let u = self.factor();
        PseudoInertia(u * u.transpose()).parameters()
    }

    /// `∂U/∂φ`, of each number of φ.
    fn changes(&self) -> [Matrix4<f64>; PARAMETERS] {
        let u = self.factor();
        std::array::from_fn(|k| {
            let mut change = Matrix4::zeros();
            match k {
                0 => change = u,
                1..=3 => change[(k - 1, k - 1)] = u[(k - 1, k - 1)],
                _ => change[PLACES[k - 4]] = self.0[0].exp(),
            }
            change
        })
    }

    /// `∂π/∂φ`: a column per number of φ. Exact: `dP = dU Uᵀ + U dUᵀ`, and π is linear in P.
    pub fn jacobian(&self) -> SMatrix<f64, PARAMETERS, PARAMETERS> {
        let u = self.factor();
        let columns = self.changes().map(|change| {
            let half = change * u.transpose();
            SVector::from(PseudoInertia(half + half.transpose()).parameters())
        });
        SMatrix::from_columns(&columns)
    }

    /// What the second order of P = U Uᵀ adds to a cost with this slope `∂cost/∂π`, where it adds: the square of these rows times a change of φ.
    ///
    /// The slope is a symmetric Λ with `cost = tr(Λ P)`. A change of U adds `tr(Λ dU dUᵀ) = ‖Λ^½ dU‖²`. At the least cost on the edge of what
    /// can exist, Λ has no negative eigenvalue. Elsewhere such eigenvalues are left out.
    pub fn curvature(&self, slope: &[f64; PARAMETERS]) -> SMatrix<f64, 16, PARAMETERS> {
        if !slope.iter().all(|slope| slope.is_finite()) {
            return SMatrix::zeros();
        }
        let lambda: Matrix4<f64> = Matrix4::from_fn(|i, j| {
            let mut entry = Matrix4::zeros();
            entry[(i, j)] += 0.5;
            entry[(j, i)] += 0.5;
            PseudoInertia(entry).parameters().iter().zip(slope).map(|(change, slope)| change * slope).sum()
        });
        let eigen = lambda.symmetric_eigen();
        let root = Matrix4::from_diagonal(&eigen.eigenvalues.map(|value: f64| value.max(0.0).sqrt())) * eigen.eigenvectors.transpose();
        SMatrix::from_columns(&self.changes().map(|change| SVector::<f64, 16>::from_column_slice((root * change).as_slice())))
    }
}
