//! A port-Hamiltonian model with polynomials: H(q, p) = ½ pᵀM(q)⁻¹p + V(q), and a damping port.
//!
//! ```text
//! q̇ = ∂H/∂p        ṗ = −∂H/∂q − D q̇ + τ        so dH/dt = q̇ᵀτ − q̇ᵀD q̇
//! ```
//!
//! The entries of M = Mᵀ and V are polynomials of q. In Lagrange's form, with p = M v, the same equations are
//!
//! ```text
//! τ = M a + Ṁ v − ½ ∂(vᵀM v)/∂q + ∂V/∂q + D v
//! ```
//!
//! which is linear in all coefficients: ridge regression finds them. D is then replaced by the nearest matrix with D + Dᵀ ⪰ 0
//! ([`featherbench_residuals::Passive`]). So energy is never made, whatever the data were. M ≻ 0 is not by form: [`PortHamiltonian::smallest_mass`]
//! is the certificate over states. Source: A. van der Schaft and D. Jeltsema, *Port-Hamiltonian Systems Theory* (2014), chapter 6.

use crate::learned::{expect_state, solved};
use crate::ridge::ridge;
use crate::{Chebyshev, Dynamics, Range, ResidualError, Sample};
use featherbench_residuals::{Linear, Passive, Projection};
use nalgebra::DMatrix;

/// The degrees of the polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Degrees {
    /// Of each entry of M and of V, in all of q.
    pub total: usize,
    /// Whether D is learned; without, it is zero.
    pub damping: bool,
}

/// A port-Hamiltonian model.
#[derive(Clone, Debug, PartialEq)]
pub struct PortHamiltonian {
    n: usize,
    basis: Chebyshev,
    /// Of each pair i ≥ j of M, row by row: a coefficient per product; then of V.
    coefficients: Vec<f64>,
    damping: DMatrix<f64>,
}

/// The pairs i ≥ j, row by row.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

impl PortHamiltonian {
    /// Fits the polynomials with a ridge of λ.
    ///
    /// # Errors
    /// [`ResidualError`] if there are no samples, a variable does not vary, or λ is not positive.
    pub fn fit(samples: &[Sample], degrees: Degrees, lambda: f64) -> Result<Self, ResidualError> {
        let n = samples.first().map_or(0, |sample| sample.q.len());
        let ranges: Result<Vec<Range>, ResidualError> = (0..n).map(|k| Range::of(samples, |sample| sample.q[k])).collect();
        let basis = Chebyshev::new(ranges?, degrees.total);
        let (count, matrices) = (basis.len(), n * (n + 1) / 2);
        let energies = count * (matrices + 1);
        let columns = energies + if degrees.damping { n * n } else { 0 };
        let mut regressor = DMatrix::zeros(samples.len() * n, columns);
        let mut forces = DMatrix::zeros(samples.len() * n, 1);
        for (number, Sample { q, v, a, tau }) in samples.iter().enumerate() {
            expect_state(n, q, v, a)?;
            let (values, by) = basis.gradients(q);
            for product in 0..count {
                let rate: f64 = (0..n).map(|k| by[k][product] * v[k]).sum();
                for (pair, (i, j)) in pairs(n).enumerate() {
                    // E has ones at (i, j) and (j, i): φ E a + φ̇ E v − ½ ∂φ/∂q (vᵀE v).
                    let column = pair * count + product;
                    let square = if i == j { v[i] * v[i] } else { 2.0 * v[i] * v[j] };
                    regressor[(number * n + i, column)] += values[product] * a[j] + rate * v[j];
                    if i != j {
                        regressor[(number * n + j, column)] += values[product] * a[i] + rate * v[i];
                    }
                    (0..n).for_each(|k| regressor[(number * n + k, column)] -= 0.5 * by[k][product] * square);
                }
                (0..n).for_each(|k| regressor[(number * n + k, matrices * count + product)] = by[k][product]);
            }
            for row in 0..n {
                if degrees.damping {
                    (0..n).for_each(|k| regressor[(number * n + row, energies + row * n + k)] = v[k]);
                }
                forces[(number * n + row, 0)] = tau[row];
            }
        }
        let solution = ridge(&regressor, &forces, lambda)?;
        let found: Vec<f64> = solution.iter().copied().collect();
        let damping = match degrees.damping {
            true => passive(n, &found[energies..])?,
            false => DMatrix::zeros(n, n),
        };
        Ok(Self { n, basis, coefficients: found[..energies].to_vec(), damping })
    }

    /// Of each function (the pairs of M, then V): its value and its derivatives.
    fn functions(&self, q: &[f64]) -> Vec<(f64, Vec<f64>)> {
        let (values, by) = self.basis.gradients(q);
        let dot = |row: &[f64], c: &[f64]| row.iter().zip(c).map(|(x, c)| x * c).sum::<f64>();
        let of = |c: &[f64]| (dot(&values, c), by.iter().map(|row| dot(row, c)).collect());
        self.coefficients.chunks_exact(self.basis.len()).map(of).collect()
    }

    fn mass(&self, functions: &[(f64, Vec<f64>)]) -> DMatrix<f64> {
        let mut mass = DMatrix::zeros(self.n, self.n);
        for ((i, j), (value, _)) in pairs(self.n).zip(functions) {
            (mass[(i, j)], mass[(j, i)]) = (*value, *value);
        }
        mass
    }

    /// The forces that do not depend on a: Ṁ v − ½ ∂(vᵀM v)/∂q + ∂V/∂q + D v.
    fn bias(&self, functions: &[(f64, Vec<f64>)], v: &[f64]) -> Vec<f64> {
        let mut tau: Vec<f64> = (0..self.n).map(|row| (0..self.n).map(|k| self.damping[(row, k)] * v[k]).sum()).collect();
        for ((i, j), (_, by)) in pairs(self.n).zip(functions) {
            let rate: f64 = by.iter().zip(v).map(|(by, v)| by * v).sum();
            let square = if i == j { v[i] * v[i] } else { 2.0 * v[i] * v[j] };
            tau[i] += rate * v[j];
            if i != j {
                tau[j] += rate * v[i];
            }
            tau.iter_mut().zip(by).for_each(|(tau, by)| *tau -= 0.5 * by * square);
        }
        if let Some((_, by)) = functions.last() {
            tau.iter_mut().zip(by).for_each(|(tau, by)| *tau += by);
        }
        tau
    }

    /// The damping D, with D + Dᵀ ⪰ 0.
    pub fn damping(&self) -> &DMatrix<f64> {
        &self.damping
    }

    /// The smallest eigenvalue of M over the configurations of samples: the certificate that M ≻ 0 there.
    pub fn smallest_mass(&self, samples: &[Sample]) -> f64 {
        let smallest = |sample: &Sample| self.mass(&self.functions(&sample.q)).symmetric_eigenvalues().min();
        samples.iter().map(smallest).fold(f64::INFINITY, |least, x| if x.is_nan() || x < least { x } else { least })
    }
}

/// The nearest passive damping.
fn passive(n: usize, damping: &[f64]) -> Result<DMatrix<f64>, ResidualError> {
    let zeros = vec![0.0; n];
    let row = |row: &[f64]| [&zeros, row, &zeros, &[0.0]].concat();
    let linear = Linear::new(n, n, damping.chunks_exact(n).flat_map(row).collect())?;
    let (nearest, _) = Passive::nearest(&linear, &Projection { mass_below: DMatrix::identity(n, n), margin: 1e-12 })?;
    Ok(nearest.damping().clone())
}

impl Dynamics for PortHamiltonian {
    fn nv(&self) -> usize {
        self.n
    }

    fn inverse(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        expect_state(self.n, q, v, a)?;
        let functions = self.functions(q);
        let inertial = self.mass(&functions) * nalgebra::DVector::from_column_slice(a);
        Ok(self.bias(&functions, v).iter().zip(&inertial).map(|(bias, x)| bias + x).collect())
    }

    fn forward(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError> {
        expect_state(self.n, q, v, tau)?;
        let functions = self.functions(q);
        solved(self.mass(&functions), tau.iter().zip(self.bias(&functions, v)).map(|(tau, bias)| tau - bias).collect())
    }

    fn energy(&self, q: &[f64], v: &[f64]) -> Result<Option<f64>, ResidualError> {
        expect_state(self.n, q, v, v)?;
        let functions = self.functions(q);
        let v = nalgebra::DVector::from_column_slice(v);
        Ok(functions.last().map(|(potential, _)| 0.5 * v.dot(&(self.mass(&functions) * &v)) + potential))
    }
}
