//! The order and prefactor of errors over refinements: |error| ≈ prefactor / n^order.

/// A fitted law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The order, by least squares of log |error| over log n; NaN if an error is zero or not finite.
    pub order: f64,
    /// The prefactor, signed, of a known order p: error n^p, extrapolated to n = ∞ from the last two refinements.
    pub prefactor: f64,
}

/// Fits errors at numbers of elements n, increasing. `known` is the order p of the theory, and `next` that of the term after it: the
/// prefactor at the last two n is extrapolated with error n^p = prefactor + c/n^(next − p).
///
/// NaN for fewer than two refinements.
///
/// ```
/// use featherbench_continua::fit;
/// let errors: Vec<_> = [4.0, 8.0, 16.0, 32.0].map(|n: f64| (n, 0.25 / (n * n) + 0.1 / n.powi(4))).into();
/// let law = fit(&errors, 2.0, 4.0);
/// assert!((law.order - 2.0).abs() < 0.05 && (law.prefactor - 0.25).abs() < 1e-12);
/// ```
pub fn fit(errors: &[(f64, f64)], known: f64, next: f64) -> Fit {
    let [.., before, last] = errors else { return Fit { order: f64::NAN, prefactor: f64::NAN } };
    let logs: Vec<(f64, f64)> = errors.iter().map(|(n, error)| (n.ln(), error.abs().ln())).collect();
    let count = logs.len() as f64;
    let mean = logs.iter().fold((0.0, 0.0), |sum, log| (sum.0 + log.0 / count, sum.1 + log.1 / count));
    let covariance: f64 = logs.iter().map(|log| (log.0 - mean.0) * (log.1 - mean.1)).sum();
    let variance: f64 = logs.iter().map(|log| (log.0 - mean.0).powi(2)).sum();
    let scaled = |(n, error): &(f64, f64)| error * n.powf(known);
    let ratio = (last.0 / before.0).powf(next - known);
    let prefactor = (ratio * scaled(last) - scaled(before)) / (ratio - 1.0);
    Fit { order: -covariance / variance, prefactor }
}
