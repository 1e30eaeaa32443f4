//! The quantities of a robot, each in a workspace of the call.

use crate::{Error, Robot};
use featherbench_dynamics::{FdPartials, IdPartials, TreeSparse};
use featherbench_spatial::{Motion, Transform};

impl Robot {
    /// Joint forces τ at configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// let q = robot.random(1);
    /// let tau = robot.inverse_dynamics(&q, &[0.1; 5], &[0.2; 5])?;
    /// assert!(robot.forward_dynamics(&q, &[0.1; 5], &tau)?.iter().all(|a| (a - 0.2).abs() < 1e-10));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn inverse_dynamics(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, Error> {
        let mut tau = vec![0.0; self.nv()];
        self.workspace().inverse_dynamics(q, v, a, None, &mut tau)?;
        Ok(tau)
    }

    /// Bias forces h at configuration `q` and velocity `v`: Coriolis, centrifugal and gravitational forces, τ at a = 0.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// let q = robot.random(1);
    /// let (h, tau) = (robot.bias_force(&q, &[0.1; 5])?, robot.inverse_dynamics(&q, &[0.1; 5], &[0.0; 5])?);
    /// assert!(h.iter().zip(&tau).all(|(h, tau)| (h - tau).abs() < 1e-13 * (1.0 + tau.abs())));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn bias_force(&self, q: &[f64], v: &[f64]) -> Result<Vec<f64>, Error> {
        let mut h = vec![0.0; self.nv()];
        self.workspace().bias_force(q, v, None, &mut h)?;
        Ok(h)
    }

    /// Accelerations a at configuration `q`, velocity `v` and joint forces `tau`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// assert!(robot.forward_dynamics(&robot.neutral(), &[0.0; 5], &[1.0, 0.0, 0.0, 0.0, f64::INFINITY]).is_err());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn forward_dynamics(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, Error> {
        let mut a = vec![0.0; self.nv()];
        self.workspace().forward_dynamics(q, v, tau, None, &mut a)?;
        Ok(a)
    }

    /// The joint-space inertia matrix M(q), tree-sparse; [`TreeSparse::to_dense`] gives all entries.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// let matrix = robot.mass_matrix(&robot.random(1))?;
    /// assert!(matrix.get(0, 4) == matrix.get(4, 0) && matrix.get(0, 0) > 0.0);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn mass_matrix(&self, q: &[f64]) -> Result<TreeSparse<f64>, Error> {
        Ok(self.workspace().mass_matrix(q)?.clone())
    }

    /// The solution x of M(q) x = b.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// let q = robot.random(1);
    /// let b = robot.mass_matrix(&q)?.product(&[1.0; 5])?;
    /// assert!(robot.solve(&q, &b)?.iter().all(|x| (x - 1.0).abs() < 1e-10));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn solve(&self, q: &[f64], b: &[f64]) -> Result<Vec<f64>, Error> {
        let mut x = b.to_vec();
        self.workspace().solve(q, &mut x)?;
        Ok(x)
    }

    /// The placement of a frame in the world at configuration `q`.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or when it has no such frame.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// let mut q = robot.neutral();
    /// q[2] = 1.5;
    /// assert_eq!(robot.placement(&q, robot.bodies()[0])?.translation.z, 1.5);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn placement(&self, q: &[f64], frame: &str) -> Result<Transform<f64>, Error> {
        let frame = self.frame(frame)?;
        self.workspace().placements(q)?.placement(&frame)
    }

    /// The Jacobian of a frame at configuration `q`: one column per dof. The velocity [ω; ṗ] of its origin in world axes is J v.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or when it has no such frame.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=3")?;
    /// let columns = robot.jacobian(&robot.random(1), robot.bodies()[1])?;
    /// assert_eq!(columns[2].to_array(), [0.0; 6], "the third joint does not move the second body");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn jacobian(&self, q: &[f64], frame: &str) -> Result<Vec<Motion<f64>>, Error> {
        let frame = self.frame(frame)?;
        Ok(self.workspace().jacobian(q, &frame)?.to_vec())
    }

    /// Derivatives of inverse dynamics: ∂τ/∂q on the tangent space, ∂τ/∂v and ∂τ/∂a = M.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let (q, step) = (robot.random(1), 1e-6);
    /// let partials = robot.inverse_dynamics_derivatives(&q, &[0.1; 2], &[0.2; 2])?;
    /// let moved = |h: f64| robot.inverse_dynamics(&robot.integrate(&q, &[0.0, h])?, &[0.1; 2], &[0.2; 2]);
    /// let difference = (moved(step)?[0] - moved(-step)?[0]) / (2.0 * step);
    /// assert!((partials.q.get(0, 1) - difference).abs() < 1e-7);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn inverse_dynamics_derivatives(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<IdPartials<f64>, Error> {
        Ok(self.workspace().inverse_dynamics_derivatives(q, v, a, None)?.clone())
    }

    /// Derivatives of forward dynamics: ∂a/∂q on the tangent space, ∂a/∂v and ∂a/∂τ = M⁻¹, each row after row, and a.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let (q, step) = (robot.random(1), 1e-6);
    /// let partials = robot.forward_dynamics_derivatives(&q, &[0.1; 2], &[0.2; 2])?;
    /// let moved = |h: f64| robot.forward_dynamics(&q, &[0.1, 0.1 + h], &[0.2; 2]);
    /// let difference = (moved(step)?[0] - moved(-step)?[0]) / (2.0 * step);
    /// assert!((partials.v[1] - difference).abs() < 1e-6 * (1.0 + difference.abs()));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn forward_dynamics_derivatives(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<FdPartials<f64>, Error> {
        Ok(self.workspace().forward_dynamics_derivatives(q, v, tau, None)?.clone())
    }
}
