//! How the error of a mean falls with the number of samples N: N^(−1/2) for random points, faster for scrambled Sobol' points.
//!
//! The answer is the first joint's acceleration of an arm with six uncertain masses. Its mean is that of polynomial chaos. The error at N is the
//! root mean square over replicates, and the slope is that of a line through the logarithms.

use super::arms::{ARM, Uncertain};
use super::{Case, count, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_report::fit::power_law;
use featherbench_study::known::Number;
use featherbench_uncertainty::{Points, chaos, draw};
use serde_json::json;

/// The numbers of samples, with the names of their errors in rows.
pub(super) const SIZES: [(usize, &str); 6] =
    [(64, "error_64"), (128, "error_128"), (256, "error_256"), (512, "error_512"), (1024, "error_1024"), (2048, "error_2048")];
/// Replicates. The root mean square of R is known to 1/√(2R), and those of sizes N < M have the correlation N/M, as samples are shared: so the
/// slope of random points deviates by 0.287/√R.
const fn replicates(points: Points) -> u64 {
    match points {
        Points::Random => 1000,
        Points::Sobol => 100,
    }
}

pub(super) fn cases() -> Vec<Case> {
    vec![case(Points::Random), case(Points::Sobol)]
}

fn case(points: Points) -> Case {
    let (method, judged): (&str, Number) = match points {
        Points::Random => ("monte_carlo", error("slope_error", "−1/2")),
        Points::Sobol => ("sobol", count("steep", 1.0, "−0.9 and steeper")),
    };
    Case {
        name: format!("{ARM}, mean"),
        quantity: "convergence",
        method: method.into(),
        params: json!({"robot": ARM, "replicates": replicates(points), "sizes": SIZES.map(|(size, _)| size)}),
        numbers: [judged, told("slope", "1"), told("slope_standard_error", "1")]
            .into_iter()
            .chain(SIZES.map(|(_, name)| told(name, "rad/s²")))
            .collect(),
        evaluate: Box::new(move |seed| {
            let known = Uncertain::new(ARM, seed)?;
            let mean = chaos(&known.space, &known.response, 5).map_err(failed)?.mean(0);
            let largest = SIZES.map(|(size, _)| size)[SIZES.len() - 1];
            let mut squares = [0.0; SIZES.len()];
            for replicate in 0..replicates(points) {
                let drawn = draw(&known.space, &known.response, points, largest as u64, 1000 * seed + replicate).map_err(failed)?;
                for (square, (size, _)) in squares.iter_mut().zip(SIZES) {
                    let found = drawn[0][..size].iter().sum::<f64>() / size as f64;
                    *square += (found - mean).powi(2) / replicates(points) as f64;
                }
            }
            let errors = squares.map(f64::sqrt);
            let fit = power_law(SIZES.iter().zip(errors).map(|((size, _), error)| (*size as f64, error)));
            let fit = fit.ok_or_else(|| NoAnswer::Failed("the errors have no slope".into()))?;
            let judged = if points == Points::Random { (fit.slope + 0.5).abs() } else { f64::from(u8::from(fit.slope < -0.9)) };
            Ok([judged, fit.slope, fit.error].into_iter().chain(errors).collect())
        }),
    }
}
