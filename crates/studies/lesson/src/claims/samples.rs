//! §10: the MATLAB lab draws one mass for six joints.
//!
//! τ = m·1 with m uniform in 5 ± 20 %. With N draws the standard error of the mean is σ/√N, and that of the deviation
//! √((κ − (N − 3)/(N − 1))/N) σ/2 with the kurtosis κ = 9/5 of a uniform law.

use crate::claim::{Claim, Failure, Holds, Number};
use crate::quadrature::Rule;
use featherbench_robots::Random;
use featherbench_spatial::larger;
use nalgebra::DMatrix;

/// The lab's numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lab {
    pub(crate) joints: usize,
    pub(crate) mass: f64,
    pub(crate) share: f64,
    pub(crate) draws: usize,
}

impl Default for Lab {
    fn default() -> Self {
        Self { joints: 6, mass: 5.0, share: 0.2, draws: 100 }
    }
}

/// Mean, deviation and rank of the covariance of rows of draws.
fn statistics(draws: &DMatrix<f64>) -> (f64, f64, usize) {
    let (rows, columns) = draws.shape();
    let mean = draws.row_mean();
    let centred = DMatrix::from_fn(rows, columns, |i, j| draws[(i, j)] - mean[j]);
    let covariance = centred.transpose() * &centred / (rows - 1) as f64;
    let values = covariance.clone().symmetric_eigen().eigenvalues;
    let largest = values.iter().copied().fold(0.0, larger);
    // Of independent masses the smallest is some tenths of the largest; of equal ones it is rounding.
    let rank = values.iter().filter(|value| **value > 1e-10 * largest).count();
    (mean[0], covariance[(0, 0)].sqrt(), rank)
}

impl Lab {
    pub(crate) fn numbers(&self, seed: u64) -> Result<Vec<Number>, Failure> {
        let (low, high) = (self.mass * (1.0 - self.share), self.mass * (1.0 + self.share));
        let mut random = Random::named(seed, "lesson: one mass for all joints");
        let one: Vec<f64> = (0..self.draws).map(|_| random.uniform(low, high)).collect();
        let shared = DMatrix::from_fn(self.draws, self.joints, |i, _| one[i]);
        let (mean, deviation, rank) = statistics(&shared);
        let mut random = Random::named(seed, "lesson: a mass for each joint");
        let own = DMatrix::from_fn(self.draws, self.joints, |_, _| random.uniform(low, high));
        let (_, _, own_rank) = statistics(&own);
        // The closed forms, and moments by quadrature.
        let n = self.draws as f64;
        let sigma = self.share * self.mass / 3.0_f64.sqrt();
        let error_of_mean = sigma / n.sqrt();
        let error_of_deviation = ((1.8 - (n - 3.0) / (n - 1.0)) / n).sqrt() * sigma / 2.0;
        let rule = Rule::gauss(8);
        let moment = |power: i32| rule.integral(low, high, |m| (m - self.mass).powi(power)) / (high - low);
        let (square, fourth) = (moment(2), moment(4));
        let variance_of_square = (fourth - square * square * (n - 3.0) / (n - 1.0)) / n;
        let within = |found: f64, known: f64, error: f64| usize::from((found - known).abs() <= 4.0 * error);
        Ok(vec![
            Number::new("deviation of a torque", "N·m", sigma, square.sqrt()).stated(sigma, 0.0),
            Number::new("standard error of its mean", "N·m", error_of_mean, (square / n).sqrt()),
            Number::new("standard error of its deviation", "N·m", error_of_deviation, variance_of_square.sqrt() / (2.0 * square.sqrt())),
            Number::count("mean of the draws within 4 standard errors", within(mean, self.mass, error_of_mean), 1),
            Number::count("deviation of the draws within 4 standard errors", within(deviation, sigma, error_of_deviation), 1),
            Number::count("draws outside the bounds", one.iter().filter(|m| !(low..=high).contains(m)).count(), 0),
            Number::count("rank of the torques' covariance", own_rank, self.joints).stated(rank as f64, 1.0 - self.joints as f64),
        ])
    }
}

/// The lab in MATLAB.
pub(super) const CLAIM: Claim = Claim {
    id: "sampled_masses",
    place: "§10",
    title: "Torques of uncertain masses",
    says: "A hundred draws of a mass within ±20 % show the spread of six joint torques.",
    right: "One mass for all joints gives six equal torques, and a covariance of rank 1. The spread of each is right: [4, 6], σ = 1/√3.",
    holds: Holds::InPart,
    numbers: |seed| Lab::default().numbers(seed),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_labs_and_seeds() {
        for seed in 0..20 {
            for lab in [Lab::default(), Lab { joints: 3, mass: 2.0, share: 0.5, draws: 400 }] {
                for number in lab.numbers(seed).unwrap() {
                    assert!(number.error() < 1e-13, "{seed} {number:?}");
                }
            }
        }
    }
}
