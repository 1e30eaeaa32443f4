//! The engines' coordinates of velocities, accelerations and joint forces, there and back.

use crate::arrays::{Doubles, Given};
use crate::coordinates::convention;
use crate::robot::Robot;
use crate::states::map;
use crate::text::text;
use featherbench_rbd::{Convention, Robot as Library};
use pyo3::prelude::*;

impl Robot {
    /// Converts numbers of one kind, at configurations in this robot's numbers.
    fn with_q<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
        q: Given<'_, 'py>,
        (name, x): (&'static str, Given<'_, 'py>),
        f: impl Fn(&Library, Convention, &[f64], &[f64]) -> Result<Vec<f64>, featherbench_rbd::Error> + Sync,
    ) -> Doubles<'py> {
        let (engine, nq, nv) = (convention(engine)?, self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), (name, x, nv)], &[nv], Some(1), |workspace, [q, x], out| {
            out.copy_from_slice(&f(workspace.robot(), engine, q, x)?);
            Ok(())
        })
    }

    /// Converts accelerations, at configurations and velocities in this robot's numbers.
    fn with_q_v<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
        [q, v, a]: [Given<'_, 'py>; 3],
        f: impl Fn(&Library, Convention, &[f64], &[f64], &[f64]) -> Result<Vec<f64>, featherbench_rbd::Error> + Sync,
    ) -> Doubles<'py> {
        let (engine, nq, nv) = (convention(engine)?, self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv), ("a", a, nv)], &[nv], Some(1), |workspace, [q, v, a], out| {
            out.copy_from_slice(&f(workspace.robot(), engine, q, v, a)?);
            Ok(())
        })
    }
}

#[pymethods]
impl Robot {
    /// Give an engine's numbers of velocities.
    #[doc = text!(given engine q v)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The engine's velocities, rad/s and m/s.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> v = np.arange(36.0)
    /// >>> robot.velocity_to("drake", robot.neutral(), v)[:6]  # [angular, linear] in world axes
    /// array([3., 4., 5., 0., 1., 2.])
    fn velocity_to<'py>(&self, py: Python<'py>, engine: &str, q: Given<'_, 'py>, v: Given<'_, 'py>) -> Doubles<'py> {
        self.with_q(py, engine, q, ("v", v), Library::velocity_to)
    }

    /// Give the velocities that an engine's numbers stand for.
    ///
    /// Parameters
    /// ----------
    #[doc = text!(engine)]
    #[doc = text!(q)]
    /// v : ndarray, shape (nv,) or (states, nv)
    ///     The engine's velocities, rad/s and m/s.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     Velocities, rad/s and m/s.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v = robot.random(seed=1), np.arange(36.0)
    /// >>> np.allclose(robot.velocity_from("mujoco", q, robot.velocity_to("mujoco", q, v)), v)
    /// True
    #[pyo3(name = "velocity_from")]
    fn neutral_velocity_from<'py>(&self, py: Python<'py>, engine: &str, q: Given<'_, 'py>, v: Given<'_, 'py>) -> Doubles<'py> {
        self.with_q(py, engine, q, ("v", v), Library::velocity_from)
    }

    /// Give an engine's numbers of accelerations.
    #[doc = text!(given engine q v a)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The engine's accelerations, rad/s² and m/s².
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> v, a = np.zeros(36), np.zeros(36)
    /// >>> v[0], v[5] = 2, 3  # ahead, and turning to the left
    /// >>> robot.acceleration_to("mujoco", robot.neutral(), v, a)[:3]  # of the origin, in world axes
    /// array([0., 6., 0.])
    fn acceleration_to<'py>(&self, py: Python<'py>, engine: &str, q: Given<'_, 'py>, v: Given<'_, 'py>, a: Given<'_, 'py>) -> Doubles<'py> {
        self.with_q_v(py, engine, [q, v, a], Library::acceleration_to)
    }

    /// Give the accelerations that an engine's numbers stand for.
    ///
    /// Parameters
    /// ----------
    #[doc = text!(engine)]
    #[doc = text!(q)]
    #[doc = text!(v)]
    /// a : ndarray, shape (nv,) or (states, nv)
    ///     The engine's accelerations, rad/s² and m/s².
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     Accelerations, rad/s² and m/s²: the rates of the numbers in v.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, a = robot.random(seed=1), np.ones(robot.nv), np.ones(robot.nv)
    /// >>> theirs = robot.acceleration_to("drake", q, v, a)
    /// >>> np.allclose(robot.acceleration_from("drake", q, v, theirs), a)
    /// True
    #[pyo3(name = "acceleration_from")]
    fn neutral_acceleration_from<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
    ) -> Doubles<'py> {
        self.with_q_v(py, engine, [q, v, a], Library::acceleration_from)
    }

    /// Give an engine's numbers of joint forces.
    #[doc = text!(given engine q tau)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The engine's joint forces, N m and N.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, tau = robot.random(seed=1), np.ones(36), np.arange(36.0)
    /// >>> power = robot.velocity_to("drake", q, v) @ robot.force_to("drake", q, tau)
    /// >>> np.isclose(power, v @ tau)  # the power is the same
    /// np.True_
    fn force_to<'py>(&self, py: Python<'py>, engine: &str, q: Given<'_, 'py>, tau: Given<'_, 'py>) -> Doubles<'py> {
        self.with_q(py, engine, q, ("tau", tau), Library::force_to)
    }

    /// Give the joint forces that an engine's numbers stand for.
    ///
    /// Parameters
    /// ----------
    #[doc = text!(engine)]
    #[doc = text!(q)]
    /// tau : ndarray, shape (nv,) or (states, nv)
    ///     The engine's joint forces, N m and N.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     Joint forces, N m and N.
    #[doc = text!(errors "Naming the joint for which the engine has no coordinates, or the engine that does not exist.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, tau = robot.random(seed=1), np.arange(36.0)
    /// >>> np.allclose(robot.force_from("mujoco", q, robot.force_to("mujoco", q, tau)), tau)
    /// True
    #[pyo3(name = "force_from")]
    fn neutral_force_from<'py>(&self, py: Python<'py>, engine: &str, q: Given<'_, 'py>, tau: Given<'_, 'py>) -> Doubles<'py> {
        self.with_q(py, engine, q, ("tau", tau), Library::force_from)
    }
}
