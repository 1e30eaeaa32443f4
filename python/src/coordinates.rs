//! The engines' coordinates: configurations, velocities and joint forces, there and back.

use crate::Error;
use crate::robot::Robot;
use crate::states::{Argument, failed, map};
use featherbench_library::{Convention, Robot as Library};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

/// The engine of a name.
fn convention(engine: &str) -> PyResult<Convention> {
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
        f: impl Fn(&Library, &[f64]) -> Result<Vec<f64>, featherbench_library::Error> + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        map(py, self, [argument], &[size], Some(1), |workspace, [x], out| {
            out.copy_from_slice(&f(workspace.robot(), x)?);
            Ok(())
        })
    }

    fn to_engine<'py>(&self, py: Python<'py>, convention: Convention, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let size = self.robot.nq_of(convention).map_err(failed)?;
        self.convert(py, ("q", q, self.robot.nq()), size, |robot, q| robot.configuration_to(convention, q))
    }

    fn neutral_from<'py>(&self, py: Python<'py>, convention: Convention, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let size = self.robot.nq_of(convention).map_err(failed)?;
        self.convert(py, ("q", q, size), self.robot.nq(), |robot, q| robot.configuration_from(convention, q))
    }
}

#[pymethods]
impl Robot {
    /// Give Pinocchio's numbers of configurations; a planar joint has the cosine and sine of its angle.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n,) or (states, n)
    ///     For a model with this robot's order of joints, and angles of continuous joints. Pinocchio's own URDF parser sorts siblings by
    ///     name, and gives continuous joints a cosine and a sine.
    fn to_pinocchio<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.to_engine(py, Convention::Pinocchio, q)
    }

    /// Give the configurations that Pinocchio's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (n,) or (states, n)
    ///     Pinocchio's numbers.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    #[pyo3(name = "from_pinocchio")]
    fn neutral_from_pinocchio<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.neutral_from(py, Convention::Pinocchio, q)
    }

    /// Give MuJoCo's numbers of configurations: quaternions (w, x, y, z), free joints with the pose in the world.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     qpos.
    fn to_mujoco<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.to_engine(py, Convention::MuJoCo, q)
    }

    /// Give the configurations that MuJoCo's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     qpos.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    #[pyo3(name = "from_mujoco")]
    fn neutral_from_mujoco<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.neutral_from(py, Convention::MuJoCo, q)
    }

    /// Give Drake's numbers of configurations: free joints begin with the quaternion (w, x, y, z), spherical ones have roll, pitch, yaw.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n,) or (states, n)
    ///     Drake's positions.
    fn to_drake<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.to_engine(py, Convention::Drake, q)
    }

    /// Give the configurations that Drake's numbers stand for.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (n,) or (states, n)
    ///     Drake's positions.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    #[pyo3(name = "from_drake")]
    fn neutral_from_drake<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.neutral_from(py, Convention::Drake, q)
    }

    /// Give an engine's numbers of velocities.
    ///
    /// Parameters
    /// ----------
    /// engine : {'pinocchio', 'mujoco', 'drake'}
    ///     The engine.
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations, in this robot's numbers.
    /// v : ndarray, shape (nv,) or (states, nv)
    ///     Velocities.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of v
    ///     The engine's velocities.
    fn velocity_to<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (engine, nq, nv) = (convention(engine)?, self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv)], &[nv], Some(1), |workspace, [q, v], out| {
            out.copy_from_slice(&workspace.robot().velocity_to(engine, q, v)?);
            Ok(())
        })
    }

    /// Give an engine's numbers of joint forces.
    ///
    /// Parameters
    /// ----------
    /// engine : {'pinocchio', 'mujoco', 'drake'}
    ///     The engine.
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations, in this robot's numbers.
    /// tau : ndarray, shape (nv,) or (states, nv)
    ///     Joint forces.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of tau
    ///     The engine's joint forces.
    fn force_to<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
        q: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (engine, nq, nv) = (convention(engine)?, self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("tau", tau, nv)], &[nv], Some(1), |workspace, [q, tau], out| {
            out.copy_from_slice(&workspace.robot().force_to(engine, q, tau)?);
            Ok(())
        })
    }
}
