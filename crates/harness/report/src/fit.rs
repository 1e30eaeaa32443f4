//! A power law through points: y = c·xᵖ, fitted as a line through logarithms by least squares.

use serde::Serialize;

/// The exponent of a fitted power law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The exponent p.
    pub slope: f64,
    /// Its standard error, from the distances to the line.
    pub error: f64,
    /// log₁₀ c.
    pub intercept: f64,
    /// Points that were used.
    pub points: usize,
}

/// Fits at least three points of at least two sizes; points without a logarithm are left out.
pub fn power_law(points: impl Iterator<Item = (f64, f64)>) -> Option<Fit> {
    let logs: Vec<(f64, f64)> = points.filter(|&(x, y)| x > 0.0 && y > 0.0).map(|(x, y)| (x.log10(), y.log10())).collect();
    let count = logs.len();
    if count < 3 {
        return None;
    }
    let n = count as f64;
    let mean_x = logs.iter().map(|&(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|&(_, y)| y).sum::<f64>() / n;
    let xx: f64 = logs.iter().map(|&(x, _)| (x - mean_x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|&(x, y)| (x - mean_x) * (y - mean_y)).sum();
    // All sizes equal, up to rounding of the mean.
    if xx < 1e-20 {
        return None;
    }
    let slope = xy / xx;
    let intercept = mean_y - slope * mean_x;
    let residual: f64 = logs.iter().map(|&(x, y)| (y - intercept - slope * x).powi(2)).sum();
    let error = (residual / (n - 2.0) / xx).sqrt();
    Some(Fit { slope, error, intercept, points: count })
}

#[cfg(test)]
mod tests {
    use super::power_law;

    #[test]
    fn an_exact_power_law_is_found() {
        let fit = power_law([1.0, 2.0, 8.0, 64.0].into_iter().map(|x: f64| (x, 5.0 * x.powf(1.5)))).unwrap();
        assert!((fit.slope - 1.5).abs() < 1e-12 && fit.error < 1e-12 && (fit.intercept - 5.0_f64.log10()).abs() < 1e-12);
        assert_eq!(fit.points, 4);
    }

    #[test]
    fn relocation_shows_in_the_standard_error() {
        // Residuals (+d, -2d, +d)·… about a line of slope 1: by hand, Σr² = 6d², xx = 2, so the error is d·√3.
        let d = 0.01;
        let points = [(1.0, 1.0 + d), (2.0, 2.0 - 2.0 * d), (3.0, 3.0 + d)];
        let fit = power_law(points.into_iter().map(|(x, y): (f64, f64)| (10.0_f64.powf(x), 10.0_f64.powf(y)))).unwrap();
        assert!((fit.slope - 1.0).abs() < 1e-12 && (fit.error - d * 3.0_f64.sqrt()).abs() < 1e-12, "{fit:?}");
    }

    #[test]
    fn too_little_to_fit_is_no_fit() {
        assert_eq!(power_law([(1.0, 1.0), (2.0, 2.0)].into_iter()), None);
        assert_eq!(power_law([(7.0, 1.0), (7.0, 2.0), (7.0, 3.0)].into_iter()), None);
        assert_eq!(power_law([(1.0, 0.0), (2.0, 2.0), (3.0, 3.0)].into_iter()), None);
    }
}
