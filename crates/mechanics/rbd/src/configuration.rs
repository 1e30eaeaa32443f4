//! Configurations of a robot: neutral and random ones, steps along velocities, differences.

use crate::error::{check, check_length, check_result};
use crate::{Error, Robot};
use featherbench_model::neutral;
use featherbench_robots::{Random, random_configuration};

impl Robot {
    /// The neutral configuration: zeros, and quaternions without rotation.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// assert_eq!(robot.neutral(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn neutral(&self) -> Vec<f64> {
        neutral(&self.inner.model.topology)
    }

    /// A random configuration: joints within their limits, other angles in (−π, π), distances in (−1, 1), quaternions uniform.
    ///
    /// A seed gives the same configuration on every platform.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// assert_eq!(robot.random(7), robot.random(7));
    /// assert_ne!(robot.random(7), robot.random(8));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn random(&self, seed: u64) -> Vec<f64> {
        random_configuration(self.model(), &mut Random::new(seed, 0))
    }

    /// `count` random configurations, one after the other. The first is [`Robot::random`].
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// assert_eq!(robot.random_batch(3, 7)[..robot.nq()], robot.random(7));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn random_batch(&self, count: usize, seed: u64) -> Vec<f64> {
        (0..count as u64).flat_map(|state| random_configuration(self.model(), &mut Random::new(seed, state))).collect()
    }

    /// q ⊕ v: where the velocity `v` leads from `q` in a unit of time. For a step of h give h·v.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// let q = robot.integrate(&robot.neutral(), &[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.5])?;
    /// assert_eq!(q, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn integrate(&self, q: &[f64], v: &[f64]) -> Result<Vec<f64>, Error> {
        let mut result = vec![0.0; self.nq()];
        self.integrate_into(q, v, &mut result)?;
        Ok(result)
    }

    /// The same into `result`, without an allocation.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut q = [0.0; 2];
    /// robot.integrate_into(&[1.0, 2.0], &[0.5, 0.0], &mut q)?;
    /// assert_eq!(q, [1.5, 2.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn integrate_into(&self, q: &[f64], v: &[f64], result: &mut [f64]) -> Result<(), Error> {
        self.check_q("q", q)?;
        check("v", self.nv(), v)?;
        check_length("result", self.nq(), result.len())?;
        self.inner.model.topology.integrate(q, v, result)?;
        check_result("q ⊕ v", result)
    }

    /// end ⊖ start: the velocity that leads from `start` to `end` in a unit of time. Rotations take the shortest way.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// let (start, end) = (robot.random(1), robot.random(2));
    /// let there = robot.integrate(&start, &robot.difference(&start, &end)?)?;
    /// let left = robot.difference(&there, &end)?;
    /// assert!(left.iter().all(|x| x.abs() < 1e-13));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn difference(&self, start: &[f64], end: &[f64]) -> Result<Vec<f64>, Error> {
        let mut v = vec![0.0; self.nv()];
        self.difference_into(start, end, &mut v)?;
        Ok(v)
    }

    /// The same into `v`, without an allocation.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut v = [0.0; 2];
    /// robot.difference_into(&[1.0, 2.0], &[1.5, 2.0], &mut v)?;
    /// assert_eq!(v, [0.5, 0.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn difference_into(&self, start: &[f64], end: &[f64], v: &mut [f64]) -> Result<(), Error> {
        self.check_q("start", start)?;
        self.check_q("end", end)?;
        check_length("v", self.nv(), v.len())?;
        self.inner.model.topology.difference(start, end, v)?;
        check_result("end ⊖ start", v)
    }

    /// An error, unless `q` has `nq` finite numbers and each of its quaternions is a rotation.
    pub(crate) fn check_q(&self, argument: &'static str, q: &[f64]) -> Result<(), Error> {
        check(argument, self.nq(), q)?;
        for &(index, joint) in &self.inner.quaternions {
            // The kernels divide by |q|². Below the smallest normal number it has lost digits, and infinity is no length.
            let square = q[index..index + 4].iter().map(|x| x * x).sum::<f64>();
            if !square.is_normal() {
                let joint = self.inner.joints[joint].name.clone();
                return Err(Error::NotARotation { argument, index, joint, length: square.sqrt() });
            }
        }
        Ok(())
    }
}
