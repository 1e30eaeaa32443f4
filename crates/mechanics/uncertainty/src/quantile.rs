//! Quantiles with their errors, from the histograms of replicates.
//!
//! With F̂ the part of all samples below a value and se its standard error at the quantile q(p), an interval of q ends where F̂ is p ± t se (R. S.
//! Woodruff, *JASA* 47, 1952). No density is estimated. The sides differ, and one error is told: their root mean square. Their mean would hold the
//! truth less often by the square of their difference. Of N random points se = √(p (1 − p)/N). Of replicates it is that of the mean of F̂_r; parts
//! of N samples have steps of 1/N, which adds (3/4N)² to its square: Sobol' points may be on the same side of q(p) in all replicates.

use crate::Histogram;
use crate::estimate::{Estimate, of_replicates, student};
use std::f64::consts::FRAC_1_SQRT_2;

/// The probabilities of the quantiles that are told.
pub const QUANTILES: [f64; 5] = [0.01, 0.05, 0.5, 0.95, 0.99];

/// What a step of 1/N may hide, in steps. With R replicates of n points, all miss a point of the same stratum that has it with the probability
/// 2/R in one case of e². Then the part is wrong by 2/(R n) = 2/N, and nothing shows it; 3/4 times Student's 2.00 is 1.5.
const STEP: f64 = 0.75;

/// The value that a part p of the samples is below; `None` where it or its error is outside the bounds of the histogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// p.
    pub probability: f64,
    /// The value.
    pub found: Option<Estimate>,
}

impl Quantile {
    /// Of all samples together, and of each replicate.
    pub(crate) fn of<'a>(probability: f64, all: &Histogram, each: impl Iterator<Item = &'a Histogram>, random: bool) -> Self {
        let found = || {
            let (value, samples) = (all.quantile(probability)?, all.total() as f64);
            let part = if random {
                Estimate { value: probability, error: (probability * (1.0 - probability) / samples).sqrt(), freedom: f64::INFINITY }
            } else {
                let parts = each.map(|own| own.below(value)).collect::<Option<Vec<f64>>>()?;
                let part = of_replicates(&parts);
                Estimate { error: part.error.hypot(STEP / samples), ..part }
            };
            let side = |sign: f64| Some(all.quantile((probability + sign * part.half_width()).clamp(0.0, 1.0))? - value);
            let error = (side(1.0)?.hypot(side(-1.0)?) * FRAC_1_SQRT_2) / student(part.freedom);
            Some(Estimate { value, error, freedom: part.freedom })
        };
        Self { probability, found: found() }
    }
}
