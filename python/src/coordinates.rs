//! The engines' coordinates of configurations, there and back.

use crate::Error;
use crate::arrays::{Doubles, Given};
use crate::robot::Robot;
use crate::states::{Argument, failed, map};
use crate::text::text;
use featherbench_rbd::{Convention, Robot as Library};
use pyo3::prelude::*;

/// The engine of a name.
pub(crate) fn convention(engine: &str) -> PyResult<Convention> {
    match engine {
        "pinocchio" => Ok(Convention::Pinocchio),
        "mujoco" => Ok(Convention::MuJoCo),
        "drake" => Ok(Convention::Drake),
        _ => Err(Error::new_err(format!("engine is '{engine}'; give 'pinocchio', 'mujoco' or 'drake'"))),
    }
}
impl Robot {
    fn convert<'py>(
        &self,
        py: Python<'py>,
        argument: Argument<'_, 'py>,
        size: usize,
        f: impl Fn(&Library, &[f64]) -> Result<Vec<f64>, featherbench_rbd::Error> + Sync,
    ) -> Doubles<'py> {
        map(py, self, [argument], &[size], Some(1), |workspace, [x], out| {
            out.copy_from_slice(&f(workspace.robot(), x)?);
            Ok(())
        })
    }

    fn to_engine<'py>(&self, py: Python<'py>, convention: Convention, q: Given<'_, 'py>) -> Doubles<'py> {
        let size = self.robot.nq_of(convention).map_err(failed)?;
        self.convert(py, ("q", q, self.robot.nq()), size, |robot, q| robot.configuration_to(convention, q))
    }

    fn neutral_from<'py>(&self, py: Python<'py>, convention: Convention, q: Given<'_, 'py>) -> Doubles<'py> {
        let size = self.robot.nq_of(convention).map_err(failed)?;
        self.convert(py, ("q", q, size), self.robot.nq(), |robot, q| robot.configuration_from(convention, q))
    }
}

#[pymethods]
impl Robot {
    /// Give Pinocchio's numbers of configurations; a planar joint has the cosine and sine of its angle.
    #[doc = text!(given q)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n,) or (states, n)
    ///     Rad and m, for a model with this robot's order of joints, and angles of continuous joints.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or saying why Pinocchio's own parser gives the URDF others.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q = robot.random(seed=1)
    /// >>> np.array_equal(robot.to_pinocchio(q), q)  # it has no planar joint
    /// True
    fn to_pinocchio<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.to_engine(py, Convention::Pinocchio, q)
    }

    /// Give the configurations that Pinocchio's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (n,) or (states, n)
    ///     Pinocchio's numbers, rad and m.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations, rad and m; quaternions (x, y, z, w).
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q = robot.random(seed=1)
    /// >>> np.allclose(robot.from_pinocchio(robot.to_pinocchio(q)), q)
    /// True
    #[pyo3(name = "from_pinocchio")]
    fn neutral_from_pinocchio<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.neutral_from(py, Convention::Pinocchio, q)
    }

    /// Give MuJoCo's numbers of configurations: quaternions (w, x, y, z), free joints with the pose in the world.
    #[doc = text!(given q)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     qpos, rad and m.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> robot.to_mujoco(robot.neutral())[3:7]
    /// array([1., 0., 0., 0.])
    fn to_mujoco<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.to_engine(py, Convention::MuJoCo, q)
    }

    /// Give the configurations that MuJoCo's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     qpos, rad and m.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations, rad and m; quaternions (x, y, z, w).
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q = robot.random(seed=1)
    /// >>> np.allclose(robot.from_mujoco(robot.to_mujoco(q)), q)
    /// True
    #[pyo3(name = "from_mujoco")]
    fn neutral_from_mujoco<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.neutral_from(py, Convention::MuJoCo, q)
    }

    /// Give Drake's numbers of configurations: free joints begin with the quaternion (w, x, y, z), spherical ones have roll, pitch, yaw.
    #[doc = text!(given q)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n,) or (states, n)
    ///     Drake's positions, rad and m.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> robot.to_drake(robot.neutral())[:7]
    /// array([1., 0., 0., 0., 0., 0., 0.])
    fn to_drake<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.to_engine(py, Convention::Drake, q)
    }

    /// Give the configurations that Drake's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (n,) or (states, n)
    ///     Drake's positions, rad and m.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations, rad and m; quaternions (x, y, z, w).
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q = robot.random(seed=1)
    /// >>> np.allclose(robot.difference(q, robot.from_drake(robot.to_drake(q))), 0)
    /// True
    #[pyo3(name = "from_drake")]
    fn neutral_from_drake<'py>(&self, py: Python<'py>, q: Given<'_, 'py>) -> Doubles<'py> {
        self.neutral_from(py, Convention::Drake, q)
    }
}
