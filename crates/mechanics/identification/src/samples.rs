//! Samples: the states and torques that parameters are estimated from.

use crate::{IdentificationError, LinearModel};
use featherbench_robots::StateBatch;

/// States with their torques: what a log becomes once derivatives are taken.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Samples {
    /// Time of each sample, s. Times of different segments need not follow each other.
    pub time: Vec<f64>,
    /// Configurations, `count × nq`.
    pub q: Vec<f64>,
    /// Velocities, `count × nv`.
    pub v: Vec<f64>,
    /// Accelerations, `count × nv`.
    pub a: Vec<f64>,
    /// Torques, `count × nv`.
    pub tau: Vec<f64>,
    /// The torques that are used, `count × nv`: a saturated one is not what the motor was told.
    pub used: Vec<bool>,
}

impl Samples {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.time.len()
    }

    /// Configuration, velocity and acceleration of sample `k`.
    pub fn state(&self, linear: &LinearModel, k: usize) -> (&[f64], &[f64], &[f64]) {
        let (nq, nv) = (linear.model().topology.nq(), linear.model().topology.nv());
        (&self.q[k * nq..][..nq], &self.v[k * nv..][..nv], &self.a[k * nv..][..nv])
    }

    /// Random states with the torques of parameters θ, and no noise.
    ///
    /// Accelerations are drawn like velocities, which no motion of a robot does: such samples show the structure of a robot, not what a
    /// trajectory can tell.
    ///
    /// # Errors
    /// [`IdentificationError`] when θ does not fit the robot.
    pub fn random(linear: &LinearModel, count: usize, seed: u64, theta: &[f64]) -> Result<Self, IdentificationError> {
        let states = StateBatch::random(linear.model(), count, seed);
        let nv = linear.model().topology.nv();
        let time = (0..count).map(|k| k as f64).collect();
        let (tau, used) = (vec![0.0; count * nv], vec![true; count * nv]);
        let mut samples = Self { time, q: states.q, v: states.v, a: states.a, tau, used };
        samples.tau = linear.torques(&samples, theta)?;
        Ok(samples)
    }

    /// The samples of a range; those that are not there are left out.
    pub fn range(&self, linear: &LinearModel, range: std::ops::Range<usize>) -> Self {
        self.those(linear, (0..self.count()).filter(|k| range.contains(k)))
    }

    /// Every `stride`-th sample.
    pub fn every(&self, linear: &LinearModel, stride: usize) -> Self {
        self.those(linear, (0..self.count()).step_by(stride.max(1)))
    }

    fn those(&self, linear: &LinearModel, which: impl Iterator<Item = usize>) -> Self {
        let nv = linear.model().topology.nv();
        let mut those = Self::default();
        for k in which {
            let (q, v, a) = self.state(linear, k);
            those.time.push(self.time[k]);
            those.q.extend(q);
            those.v.extend(v);
            those.a.extend(a);
            those.tau.extend(&self.tau[k * nv..][..nv]);
            those.used.extend(&self.used[k * nv..][..nv]);
        }
        those
    }

    /// Checks lengths, and that every number is finite.
    ///
    /// # Errors
    /// [`IdentificationError::Length`] or [`IdentificationError::NotFinite`], naming the array.
    pub fn check(&self, linear: &LinearModel) -> Result<(), IdentificationError> {
        let (nq, nv) = (linear.model().topology.nq(), linear.model().topology.nv());
        let samples = self.count();
        let arrays: [(&'static str, &[f64], usize); 5] =
            [("time", &self.time, 1), ("q", &self.q, nq), ("v", &self.v, nv), ("a", &self.a, nv), ("tau", &self.tau, nv)];
        for (array, numbers, each) in arrays {
            if numbers.len() != samples * each {
                return Err(IdentificationError::Length { array, found: numbers.len(), samples, expected: samples * each });
            }
            if let Some((at, &value)) = numbers.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(IdentificationError::NotFinite { what: format!("{array}[{}] of sample {}", at % each, at / each), value });
            }
        }
        if self.used.len() != samples * nv {
            return Err(IdentificationError::Length { array: "used", found: self.used.len(), samples, expected: samples * nv });
        }
        Ok(())
    }
}
