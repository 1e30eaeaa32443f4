//! Derivatives of a log by local polynomials, and the same smoothing for positions and torques.
//!
//! Source: A. Savitzky & M. Golay, *Smoothing and differentiation of data* (1964). A polynomial of the order p is fitted to the 2h + 1 rows
//! around each row; its value and derivatives at the row are the answer. Rows need not be equally spaced. It is linear and without phase.
//! Torques get the same filter: `τ = Y θ` then holds for filtered rows as far as Y is linear within a window. The first and last h rows of a
//! stretch have no answer.

use crate::log::{Log, LogError, LogProblem};
use crate::{IdentificationError, LinearModel, Samples};
use featherbench_spatial::larger;
use nalgebra::DMatrix;

/// The order and width of the local polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothing {
    /// The order p of the polynomial: 2 to 6.
    pub order: usize,
    /// h: rows on each side. Zero takes the log as it is, which then needs velocities and accelerations.
    pub half: usize,
    /// A sample is taken every so many rows. Windows that share rows share their noise: then residuals are not white, and intervals too narrow.
    pub stride: usize,
}

impl Smoothing {
    /// Order 4 over 2·10 + 1 rows, windows that share none.
    pub const USUAL: Self = Self { order: 4, half: 10, stride: 21 };
    /// The log as it is.
    pub const NONE: Self = Self { order: 4, half: 0, stride: 1 };

    /// Rows of the window.
    pub fn window(self) -> usize {
        2 * self.half + 1
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`IdentificationError::Setting`].
    pub fn check(self) -> Result<(), IdentificationError> {
        if self.stride == 0 {
            return Err(IdentificationError::Setting { setting: "stride", value: "0".into(), expected: "give at least one row" });
        }
        if self.half > 0 && !(2..=6).contains(&self.order) {
            let (value, expected) = (self.order.to_string(), "give an order of 2 to 6");
            return Err(IdentificationError::Setting { setting: "order", value, expected });
        }
        if self.half > 0 && self.window() <= self.order + 1 {
            let (value, expected) = (self.window().to_string(), "give a window of at least two rows more than the order");
            return Err(IdentificationError::Setting { setting: "window", value, expected });
        }
        Ok(())
    }
}

/// The samples of a log, its derivatives taken.
///
/// Velocities are measured or the derivatives of positions; accelerations are measured, or the derivatives of measured velocities, or the
/// second derivatives of positions.
///
/// # Errors
/// [`LogError`] when no stretch is long enough or derivatives are missing.
pub fn samples(log: &Log, linear: &LinearModel, smoothing: Smoothing) -> Result<Samples, LogError> {
    let bad = |problem| LogError { file: log.file.clone(), line: None, problem };
    smoothing.check().map_err(|error| bad(LogProblem::Unreadable(error.to_string())))?;
    let used = log.unsaturated(linear);
    if smoothing.half == 0 {
        let v = log.v.clone().ok_or_else(|| bad(LogProblem::NoDerivatives { missing: "velocities" }))?;
        let a = log.a.clone().ok_or_else(|| bad(LogProblem::NoDerivatives { missing: "accelerations" }))?;
        let all = Samples { time: log.time.clone(), q: log.q.clone(), v, a, tau: log.tau.clone(), used };
        return Ok(all.every(linear, smoothing.stride));
    }
    let (nq, nv, half) = (linear.model().topology.nq(), linear.model().topology.nv(), smoothing.half);
    let mut samples = Samples::default();
    let mut weights = Weights { order: smoothing.order, times: Vec::new(), matrix: DMatrix::zeros(0, 0) };
    for segment in log.segments().into_iter().filter(|segment| segment.len() > 2 * half) {
        for row in (segment.start + half..segment.end - half).step_by(smoothing.stride) {
            let window = row - half..row + half + 1;
            weights.prepare(&log.time[window.clone()], log.time[row]);
            let of = |values: &[f64], each: usize, k: usize, derivative: usize| weights.apply(values, each, window.start, k, derivative);
            samples.time.push(log.time[row]);
            let mut q: Vec<f64> = (0..nq).map(|k| of(&log.q, nq, k, 0)).collect();
            for at in linear.model().topology.quaternions() {
                let length = q[at..at + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
                q[at..at + 4].iter_mut().for_each(|x| *x /= length);
            }
            samples.q.extend(q);
            for (dof, of_dof) in linear.dofs().iter().enumerate() {
                // A joint without a plain position has measured velocities: the reader saw to it.
                let by_position = |derivative| of_dof.position.map_or(f64::NAN, |at| of(&log.q, nq, at, derivative));
                samples.v.push(log.v.as_ref().map_or_else(|| by_position(1), |v| of(v, nv, dof, 0)));
                samples.a.push(match (&log.a, &log.v) {
                    (Some(a), _) => of(a, nv, dof, 0),
                    (None, Some(v)) => of(v, nv, dof, 1),
                    (None, None) => by_position(2),
                });
                samples.tau.push(of(&log.tau, nv, dof, 0));
                // One saturated torque within the window spoils the smoothed one.
                samples.used.push(window.clone().all(|row| used[row * nv + dof]));
            }
        }
    }
    if samples.time.is_empty() {
        return Err(bad(LogProblem::TooShort { window: smoothing.window() }));
    }
    Ok(samples)
}

/// What each row of a window adds to value and derivatives at its centre.
struct Weights {
    order: usize,
    /// The times of the window that the weights are of, less its centre.
    times: Vec<f64>,
    /// Derivative after derivative, a column per row of the window.
    matrix: DMatrix<f64>,
}

impl Weights {
    /// Weights of a window, kept from the last one if the times are the same to 1e-6 of a step.
    fn prepare(&mut self, times: &[f64], centre: f64) {
        let apart: Vec<f64> = times.iter().map(|t| t - centre).collect();
        let reach = apart.iter().fold(0.0, |most: f64, t| larger(most, t.abs()));
        let near = 1e-6 * reach / times.len() as f64;
        if self.times.len() == apart.len() && self.times.iter().zip(&apart).all(|(a, b)| (a - b).abs() <= near) {
            return;
        }
        // Times in units of the reach: then powers are at most one.
        let powers = DMatrix::from_fn(apart.len(), self.order + 1, |row, k| (apart[row] / reach).powi(k as i32));
        let decomposed = powers.qr();
        // The least squares solution R⁻¹Qᵀ, whose row k is the coefficient of tᵏ. The times differ, so R has an inverse.
        let solution = decomposed
            .r()
            .solve_upper_triangular(&decomposed.q().transpose())
            .unwrap_or_else(|| DMatrix::zeros(self.order + 1, apart.len()));
        let factors = [1.0, 1.0 / reach, 2.0 / (reach * reach)];
        self.matrix = DMatrix::from_fn(3, apart.len(), |derivative, row| factors[derivative] * solution[(derivative, row)]);
        self.times = apart;
    }

    fn apply(&self, values: &[f64], each: usize, start: usize, k: usize, derivative: usize) -> f64 {
        self.matrix.row(derivative).iter().enumerate().map(|(row, weight)| weight * values[(start + row) * each + k]).sum()
    }
}
