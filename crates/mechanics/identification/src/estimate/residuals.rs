//! What an estimate leaves: residuals of any samples, and whether they are white.

use crate::{IdentificationError, LinearModel, Samples};

/// The lags of the test of whiteness. They are even: so the tail of χ² is a finite sum.
pub const LAGS: usize = 20;

/// Residuals of samples under parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Root mean square of `τ − τ̂` of each dof, N·m or N.
    pub rms: Vec<f64>,
    /// `‖τ − τ̂‖/‖τ − mean τ‖` of each dof; NaN where the torque does not vary.
    pub relative: Vec<f64>,
    /// `‖τ − τ̂‖/‖τ‖` over all dofs.
    pub total: f64,
    /// Is the residual of a dof white? `None` where the samples are too few.
    pub whiteness: Vec<Option<Whiteness>>,
}

/// The test of G. Ljung & G. Box (1978): `Q = n(n + 2) Σ_k r_k²/(n − k)` over [`LAGS`] lags is χ² distributed if the residual is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whiteness {
    /// The probability of a larger Q if the residual is white.
    pub probability: f64,
}

impl Whiteness {
    /// Not refuted at 1 %.
    pub fn is_white(&self) -> bool {
        self.probability >= 0.01
    }
}

/// The residuals of samples under parameters θ. Torques that are not used count neither here.
///
/// # Errors
/// [`IdentificationError`] when θ or the samples do not fit the robot.
pub fn fit(linear: &LinearModel, samples: &Samples, theta: &[f64]) -> Result<Fit, IdentificationError> {
    let torques = linear.torques(samples, theta)?;
    let nv = linear.model().topology.nv();
    let (mut all, mut size) = (0.0, 0.0);
    let mut fit = Fit { rms: Vec::new(), relative: Vec::new(), total: 0.0, whiteness: Vec::new() };
    for dof in 0..nv {
        let used = (dof..samples.tau.len()).step_by(nv).filter(|&at| samples.used[at]);
        let (measured, rest): (Vec<f64>, Vec<f64>) = used.map(|at| (samples.tau[at], samples.tau[at] - torques[at])).unzip();
        let count = measured.len() as f64;
        let mean = measured.iter().sum::<f64>() / count;
        let square = rest.iter().map(|r| r * r).sum::<f64>();
        let spread = measured.iter().map(|tau| (tau - mean).powi(2)).sum::<f64>();
        fit.rms.push(if rest.is_empty() { 0.0 } else { (square / count).sqrt() });
        fit.relative.push(if spread > 0.0 { (square / spread).sqrt() } else { f64::NAN });
        fit.whiteness.push(whiteness(&rest));
        all += square;
        size += measured.iter().map(|tau| tau * tau).sum::<f64>();
    }
    fit.total = (all / size).sqrt();
    Ok(fit)
}

/// The test of whiteness; `None` if there are fewer than five numbers per lag, or if they are all equal.
pub fn whiteness(residual: &[f64]) -> Option<Whiteness> {
    let count = residual.len();
    if count < 5 * LAGS {
        return None;
    }
    let n = count as f64;
    let mean = residual.iter().sum::<f64>() / n;
    let centred: Vec<f64> = residual.iter().map(|r| r - mean).collect();
    let variance = centred.iter().map(|r| r * r).sum::<f64>();
    if variance == 0.0 {
        return None;
    }
    let share = |lag: usize| {
        let together: f64 = centred.iter().zip(&centred[lag..]).map(|(a, b)| a * b).sum();
        (together / variance).powi(2) / (n - lag as f64)
    };
    Some(Whiteness { probability: tail(n * (n + 2.0) * (1..=LAGS).map(share).sum::<f64>()) })
}

/// The tail of χ² with [`LAGS`] degrees of freedom: `e^{−x/2} Σ_{k < LAGS/2} (x/2)ᵏ/k!`.
fn tail(x: f64) -> f64 {
    let half = 0.5 * x;
    let (mut term, mut sum) = ((-half).exp(), 0.0);
    for k in 0..LAGS / 2 {
        sum += term;
        term *= half / (k + 1) as f64;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 95 % point of χ² with twenty degrees is 31.410.
    #[test]
    fn the_tail_is_that_of_the_tables() {
        assert!((tail(31.410_43) - 0.05).abs() < 1e-6);
        assert_eq!(tail(0.0), 1.0);
    }
}
