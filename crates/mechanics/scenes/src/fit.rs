//! Errors over step lengths: the part that falls with the step, and the bias that does not.
use featherbench_spatial::larger;

/// The line value(dt) ≈ limit + slope·dt through the values at several steps, by least squares.
///
/// ```
/// use featherbench_scenes::Fit;
/// let fit = Fit::of(&[(4e-3, 1.08), (2e-3, 1.04), (1e-3, 1.02)]).unwrap();
/// assert!((fit.limit - 1.0).abs() < 1e-12 && (fit.slope - 20.0).abs() < 1e-9 && fit.off < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The value at dt → 0.
    pub limit: f64,
    /// Change of the value per second of dt.
    pub slope: f64,
    /// The largest distance of a value from the line: how far the limit can be trusted.
    pub off: f64,
}

impl Fit {
    /// Fits (dt, value). None of fewer than two steps, or of numbers that are not finite.
    pub fn of(points: &[(f64, f64)]) -> Option<Self> {
        if points.iter().any(|(dt, value)| !(dt.is_finite() && value.is_finite())) {
            return None;
        }
        let count = points.len() as f64;
        let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
        let (xx, xy) = points.iter().fold((0.0, 0.0), |(xx, xy), point| (xx + (point.0 - x).powi(2), xy + (point.0 - x) * (point.1 - y)));
        // Fewer than two different steps: no line.
        if xx.is_nan() || xx <= 0.0 {
            return None;
        }
        let slope = xy / xx;
        let limit = y - slope * x;
        let off = points.iter().map(|(dt, value)| (value - limit - slope * dt).abs()).fold(0.0, larger);
        Some(Self { limit, slope, off })
    }
}
