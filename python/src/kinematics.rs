//! What moves how: placements, motions and Jacobians of frames.

use crate::arrays::{Doubles, Given};
use crate::robot::Robot;
use crate::states::{failed, map};
use crate::text::text;
use pyo3::prelude::*;

#[pymethods]
impl Robot {
    /// Compute the placements of a frame in the world.
    #[doc = text!(given q frame threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (4, 4) or (states, 4, 4)
    ///     Homogeneous transforms, frame to world; translations in m.
    #[doc = text!(errors "Naming the frame that the robot does not have.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> place = robot.placement(robot.neutral(), "pelvis")
    /// >>> np.array_equal(place, np.eye(4))
    /// True
    #[pyo3(signature = (q, frame, *, threads = Some(1)))]
    fn placement<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, frame: &str, threads: Option<i64>) -> Doubles<'py> {
        let frame = self.robot.frame(frame).map_err(failed)?;
        map(py, self, [("q", q, self.robot.nq())], &[4, 4], threads, |workspace, [q], out| {
            let x = workspace.placements(q)?.placement(&frame)?;
            let (rotation, translation) = (x.rotation.to_array(), x.translation.to_array());
            for i in 0..3 {
                out[4 * i..4 * i + 3].copy_from_slice(&rotation[3 * i..3 * i + 3]);
                out[4 * i + 3] = translation[i];
            }
            out[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
            Ok(())
        })
    }

    /// Compute velocities and classical accelerations of a frame's origin.
    #[doc = text!(given q v a frame threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (2, 6) or (states, 2, 6)
    ///     Velocity and acceleration, each [angular, linear] in world axes, rad/s, m/s, rad/s², m/s². Gravity does not enter.
    #[doc = text!(errors "Naming the frame that the robot does not have.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, a = robot.random(seed=1), np.ones(robot.nv), np.ones(robot.nv)
    /// >>> velocity, acceleration = robot.motion(q, v, a, "pelvis")
    /// >>> np.allclose(velocity, robot.jacobian(q, "pelvis") @ v)
    /// True
    #[pyo3(signature = (q, v, a, frame, *, threads = Some(1)))]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
        frame: &str,
        threads: Option<i64>,
    ) -> Doubles<'py> {
        let frame = self.robot.frame(frame).map_err(failed)?;
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv), ("a", a, nv)], &[2, 6], threads, |workspace, [q, v, a], out| {
            let motion = workspace.kinematics(q, v, a)?.motion(&frame)?;
            out[..6].copy_from_slice(&motion.velocity.to_array());
            out[6..].copy_from_slice(&motion.acceleration.to_array());
            Ok(())
        })
    }

    /// Compute Jacobians of a frame.
    #[doc = text!(given q frame threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (6, nv) or (states, 6, nv)
    ///     J, with J v = [angular, linear] velocity of the frame's origin in world axes. Entries are 1 and m.
    #[doc = text!(errors "Naming the frame that the robot does not have.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> robot.jacobian(robot.random(seed=1, states=5), "pelvis").shape
    /// (5, 6, 36)
    #[pyo3(signature = (q, frame, *, threads = Some(1)))]
    fn jacobian<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, frame: &str, threads: Option<i64>) -> Doubles<'py> {
        let frame = self.robot.frame(frame).map_err(failed)?;
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq)], &[6, nv], threads, |workspace, [q], out| {
            for (j, column) in workspace.jacobian(q, &frame)?.iter().enumerate() {
                column.to_array().into_iter().enumerate().for_each(|(i, x)| out[i * nv + j] = x);
            }
            Ok(())
        })
    }
}
