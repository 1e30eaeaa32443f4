//! Samples of a known model along Fourier trajectories.
//!
//! q_j(t) = c_j Σ_k (A_jk sin kωt + B_jk cos kωt), k = 1…K, with A and B drawn from [−1, 1) and c_j such that Σ |A| + |B| is the amplitude: so
//! |q_j| never exceeds it. Velocity and acceleration are the exact derivatives. Random accelerations would excite everything for free; a robot
//! cannot have them.

use crate::{Dynamics, ResidualError};
use featherbench_robots::Random;

/// A state, its acceleration and joint forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The configuration.
    pub q: Vec<f64>,
    /// The velocity.
    pub v: Vec<f64>,
    /// The acceleration.
    pub a: Vec<f64>,
    /// The joint forces.
    pub tau: Vec<f64>,
}

/// How motions are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The largest |q_j|, rad.
    pub amplitude: f64,
    /// The base frequency ω, rad/s.
    pub frequency: f64,
    /// The number of harmonics K.
    pub harmonics: usize,
    /// Trajectories, each drawn anew.
    pub trajectories: usize,
    /// Samples of each, evenly over its period.
    pub samples: usize,
    /// Root mean square of the noise on each joint force, over that of the force itself.
    pub noise: f64,
}

impl Motion {
    /// The samples of a model, by a seed and the name of a stream: motions of different names are independent.
    ///
    /// # Errors
    /// [`ResidualError`] if the model does not answer.
    pub fn samples<D: Dynamics + ?Sized>(&self, truth: &D, seed: u64, name: &str) -> Result<Vec<Sample>, ResidualError> {
        let n = truth.nv();
        let mut random = Random::named(seed, name);
        let mut samples = Vec::with_capacity(self.trajectories * self.samples);
        for _ in 0..self.trajectories {
            let waves: Vec<Vec<[f64; 2]>> = (0..n).map(|_| self.waves(&mut random)).collect();
            for number in 0..self.samples {
                let time = std::f64::consts::TAU / self.frequency * number as f64 / self.samples as f64;
                let [q, v, a] = [0, 1, 2].map(|order| waves.iter().map(|wave| self.at(wave, time, order)).collect::<Vec<f64>>());
                let tau = truth.inverse(&q, &v, &a)?;
                samples.push(Sample { q, v, a, tau });
            }
        }
        let scales: Vec<f64> = (0..n).map(|joint| rms(samples.iter().map(|sample| sample.tau[joint]))).collect();
        for sample in &mut samples {
            // A uniform number of [−√3, √3) has variance one.
            let noise = |scale: f64, random: &mut Random| self.noise * scale * random.uniform(-1.0, 1.0) * 3.0_f64.sqrt();
            sample.tau.iter_mut().zip(&scales).for_each(|(tau, &scale)| *tau += noise(scale, &mut random));
        }
        Ok(samples)
    }

    /// The coefficients of a joint's harmonics.
    fn waves(&self, random: &mut Random) -> Vec<[f64; 2]> {
        let drawn: Vec<[f64; 2]> = (0..self.harmonics).map(|_| [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]).collect();
        let sum: f64 = drawn.iter().flatten().map(|x| x.abs()).sum();
        drawn.iter().map(|pair| pair.map(|x| x * self.amplitude / sum)).collect()
    }

    /// The derivative of a wave of order 0, 1 or 2.
    fn at(&self, wave: &[[f64; 2]], time: f64, order: i32) -> f64 {
        let harmonic = |(k, [sine, cosine]): (usize, &[f64; 2])| {
            let rate = (k + 1) as f64 * self.frequency;
            // Each derivative turns the phase by a quarter.
            let (s, c) = (rate * time + f64::from(order) * std::f64::consts::FRAC_PI_2).sin_cos();
            rate.powi(order) * (sine * s + cosine * c)
        };
        wave.iter().enumerate().map(harmonic).sum()
    }
}

/// The root of the mean square.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), x| (count + 1, sum + x * x));
    (sum / f64::from(count.max(1))).sqrt()
}
