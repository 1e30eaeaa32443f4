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

    /// `∂π/∂φ`: a column per number of φ. Exact: `dP = dU Uᵀ + U dUᵀ`, and π is linear in P.
    pub fn jacobian(&self) -> SMatrix<f64, PARAMETERS, PARAMETERS> {
        let u = self.factor();
        let scale = self.0[0].exp();
        let mut jacobian = SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros();
        for column in 0..PARAMETERS {
            let change = match column {
                0 => u,
                1..=3 => {
                    let mut change = Matrix4::zeros();
                    change[(column - 1, column - 1)] = u[(column - 1, column - 1)];
                    change
                }
                _ => {
                    let mut change = Matrix4::zeros();
                    change[PLACES[column - 4]] = scale;
                    change
                }
            };
            let half = change * u.transpose();
            let of = PseudoInertia(half + half.transpose()).parameters();
            jacobian.set_column(column, &SVector::from(of));
        }
        jacobian
    }
}
