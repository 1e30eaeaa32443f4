//! A residual that is linear in its parameters: r = Y θ with Y = I ⊗ φᵀ and φ = [q; v; a; 1].
//!
//! Each dof has a row of parameters of its own: Y is nv × nv·p, with p = nq + 2 nv + 1. A robot with a free or spherical joint has nq ≠ nv; r has nv
//! numbers all the same. θ is the rows of the dofs, one after the other.

use crate::error::{expect, finite};
use crate::{Residual, ResidualError, State};
use nalgebra::DMatrix;

/// r = (I ⊗ [q; v; a; 1]ᵀ) θ.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    nq: usize,
    nv: usize,
    theta: Vec<f64>,
}

/// Columns of the scaled regressor that are this near to the span of others, as a share of the longest, count as dependent. Columns are scaled to
/// length one, so noise-free data leave a gap between 10⁻¹⁴ and the data's own excitation.
const RANK: f64 = 1e-10;

impl Linear {
    /// Of these parameters.
    ///
    /// # Errors
    /// [`ResidualError`] if there are not nv·(nq + 2 nv + 1), or one is not finite.
    pub fn new(nq: usize, nv: usize, theta: Vec<f64>) -> Result<Self, ResidualError> {
        expect("parameters of the linear residual, nv (nq + 2 nv + 1)", Self::parameters(nq, nv), theta.len())?;
        finite("parameters of the linear residual", &theta)?;
        Ok(Self { nq, nv, theta })
    }

    /// How many parameters it has: nv·(nq + 2 nv + 1).
    pub fn parameters(nq: usize, nv: usize) -> usize {
        nv * Self::features(nq, nv)
    }

    /// The length of φ.
    fn features(nq: usize, nv: usize) -> usize {
        nq + 2 * nv + 1
    }

    /// The parameters.
    pub fn theta(&self) -> &[f64] {
        &self.theta
    }

    /// φ = [q; v; a; 1] of a state.
    pub fn phi(state: &State<'_>) -> Vec<f64> {
        [state.q, state.v, state.a, &[1.0]].concat()
    }

    /// Y = I ⊗ φᵀ of a state, nv × nv·p.
    pub fn regressor(state: &State<'_>) -> DMatrix<f64> {
        let phi = Self::phi(state);
        let (n, p) = (state.v.len(), phi.len());
        DMatrix::from_fn(n, n * p, |row, column| if column / p == row { phi[column % p] } else { 0.0 })
    }

    /// The parameters of least squares for samples of r, and the rank of their φ. The shortest parameters are taken where the samples leave a
    /// choice.
    ///
    /// ```
    /// use featherbench_residuals::{Linear, State};
    /// // r = 2 v − 1, seen at three states of one joint.
    /// let states = [[0.3, 1.0, -0.4], [-0.2, 0.5, 0.9], [0.8, -1.5, 0.1], [0.1, 0.2, 0.7]];
    /// let samples: Vec<_> = states.iter().map(|[q, v, a]| (State::new(std::slice::from_ref(q), std::slice::from_ref(v), std::slice::from_ref(a)), vec![2.0 * v - 1.0])).collect();
    /// let (fit, rank) = Linear::fit(&samples)?;
    /// assert_eq!(rank, 4);
    /// assert!((fit.theta()[1] - 2.0).abs() < 1e-12 && (fit.theta()[3] + 1.0).abs() < 1e-12);
    /// # Ok::<(), featherbench_residuals::ResidualError>(())
    /// ```
    ///
    /// # Errors
    /// [`ResidualError`] if there is no sample, their sizes differ, or a number is not finite.
    pub fn fit(samples: &[(State<'_>, Vec<f64>)]) -> Result<(Self, usize), ResidualError> {
        let Some((first, _)) = samples.first() else { return Err(ResidualError::Learning("there is no sample".into())) };
        let (nq, nv) = (first.q.len(), first.v.len());
        let p = Self::features(nq, nv);
        for (state, r) in samples {
            expect("configuration q of a sample", nq, state.q.len())?;
            expect("velocity v of a sample", nv, state.v.len())?;
            expect("acceleration a of a sample", nv, state.a.len())?;
            expect("residual r of a sample", nv, r.len())?;
            finite("features of a sample", &Self::phi(state))?;
            finite("residual r of a sample", r)?;
        }
        let mut features = DMatrix::zeros(samples.len(), p);
        for (row, (state, _)) in samples.iter().enumerate() {
            features.row_mut(row).copy_from_slice(&Self::phi(state));
        }
        let norm = |column: usize| features.column(column).norm();
        let scales: Vec<f64> = (0..p).map(|column| if norm(column) > 0.0 { norm(column) } else { 1.0 }).collect();
        scales.iter().enumerate().for_each(|(column, scale)| features.column_mut(column).unscale_mut(*scale));
        let seen = DMatrix::from_fn(samples.len(), nv, |row, dof| samples[row].1[dof]);
        let (rows, rank) = shortest(features, seen)?;
        let theta = rows.column_iter().flat_map(|row| row.iter().zip(&scales).map(|(x, scale)| x / scale).collect::<Vec<f64>>());
        Ok((Self::new(nq, nv, theta.collect())?, rank))
    }

    /// A block of the parameters as a matrix: the columns `first..first + count` of each dof's row.
    pub(crate) fn block(&self, first: usize, count: usize) -> DMatrix<f64> {
        let p = Self::features(self.nq, self.nv);
        DMatrix::from_fn(self.nv, count, |row, column| self.theta[row * p + first + column])
    }

    /// The lengths of q and v.
    pub(crate) fn sizes(&self) -> (usize, usize) {
        (self.nq, self.nv)
    }
}

/// The shortest X of least squares A X = B, column by column, and the rank of A.
///
/// By the complete orthogonal factorization (G. Golub & C. Van Loan, *Matrix Computations* (2013), section 5.4.7): A P = Q [R₁ R₂; 0 E] with
/// |E| below the threshold, [R₁ R₂]ᵀ = Z T, X = P Z T⁻ᵀ (Qᵀ B)₁. It has no iteration that may end early, as one for singular values has.
fn shortest(a: DMatrix<f64>, b: DMatrix<f64>) -> Result<(DMatrix<f64>, usize), ResidualError> {
    let columns = a.ncols();
    let factors = a.col_piv_qr();
    let r = factors.r();
    let steps = r.nrows().min(r.ncols());
    let rank = (0..steps).take_while(|&k| r[(k, k)].abs() > RANK * r[(0, 0)].abs()).count();
    let mut solution = DMatrix::zeros(columns, b.ncols());
    if rank > 0 {
        let wide = r.rows(0, rank).transpose().qr();
        let seen = factors.q().transpose() * b;
        let singular = || ResidualError::Learning("the pivots of the factorization are zero".into());
        let inside = wide.r().tr_solve_upper_triangular(&seen.rows(0, rank)).ok_or_else(singular)?;
        solution.copy_from(&(wide.q() * inside));
    }
    factors.p().inv_permute_rows(&mut solution);
    Ok((solution, rank))
}

impl Residual for Linear {
    fn nv(&self) -> usize {
        self.nv
    }

    fn nq(&self) -> Option<usize> {
        Some(self.nq)
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let phi = Self::phi(state);
        for (r, row) in r.iter_mut().zip(self.theta.chunks_exact(phi.len())) {
            *r += row.iter().zip(&phi).map(|(theta, phi)| theta * phi).sum::<f64>();
        }
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        true
    }

    fn add_by_acceleration(&self, _: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        *matrix += self.block(self.nq + self.nv, self.nv);
        Ok(())
    }
}
