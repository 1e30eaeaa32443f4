//! Quantities of a robot: inverse and forward dynamics, M, placements, Jacobians, derivatives.

use crate::Error;
use crate::arrays::{Scalar, is_double, numbers, output};
use crate::robot::Robot;
use crate::states::{Argument, agreed, failed, map, pool, threads as threads_of};
use featherbench_library::dynamics::{Batch, BatchError, Element as BatchElement};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

#[derive(Clone, Copy)]
enum Quantity {
    InverseDynamics,
    ForwardDynamics,
}
impl Robot {
    /// A quantity of three vectors: one state in the workspace, many in a batch.
    #[allow(clippy::too_many_arguments, reason = "three arguments, what is written, and by what")]
    fn three<'py>(
        &self,
        py: Python<'py>,
        arguments: [Argument<'_, 'py>; 3],
        out: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
        quantity: Quantity,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !is_double(arguments[0].0, arguments[0].1)? {
            return self.batched::<f32>(py, arguments, out, threads, quantity, self.robot.batch_f32());
        }
        let (q, states) = numbers::<f64>(arguments[0].0, arguments[0].1, arguments[0].2)?;
        if states.is_some() {
            drop(q);
            return self.batched::<f64>(py, arguments, out, threads, quantity, self.robot.batch());
        }
        threads_of(threads)?;
        let (x, of_x) = numbers::<f64>(arguments[1].0, arguments[1].1, arguments[1].2)?;
        let (y, of_y) = numbers::<f64>(arguments[2].0, arguments[2].1, arguments[2].2)?;
        agreed((arguments[0].0, states), &[(arguments[1].0, of_x), (arguments[2].0, of_y)])?;
        let (array, mut writable) = output::<f64>(py, out, None, &[self.robot.nv()])?;
        let (q, x, y, result) = (q.as_slice()?, x.as_slice()?, y.as_slice()?, writable.as_slice_mut()?);
        self.with_workspace(|workspace| match quantity {
            Quantity::InverseDynamics => workspace.inverse_dynamics(q, x, y, None, result),
            Quantity::ForwardDynamics => workspace.forward_dynamics(q, x, y, None, result),
        })
        .map_err(failed)?;
        drop(writable);
        Ok(array.into_any())
    }

    fn batched<'py, S: Scalar + BatchElement<S>>(
        &self,
        py: Python<'py>,
        arguments: [Argument<'_, 'py>; 3],
        out: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
        quantity: Quantity,
        batch: Batch<'_, S>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let threads = threads_of(threads)?;
        let [(q, states), (x, of_x), (y, of_y)] = [
            numbers::<S>(arguments[0].0, arguments[0].1, arguments[0].2)?,
            numbers::<S>(arguments[1].0, arguments[1].1, arguments[1].2)?,
            numbers::<S>(arguments[2].0, arguments[2].1, arguments[2].2)?,
        ];
        agreed((arguments[0].0, states), &[(arguments[1].0, of_x), (arguments[2].0, of_y)])?;
        let (array, mut writable) = output::<S>(py, out, states, &[self.robot.nv()])?;
        let (q, x, y, result) = (q.as_slice()?, x.as_slice()?, y.as_slice()?, writable.as_slice_mut()?);
        let run = |mut batch: Batch<'_, S>, result: &mut [S]| match quantity {
            Quantity::InverseDynamics => batch.inverse_dynamics(q, x, y, None, result),
            Quantity::ForwardDynamics => batch.forward_dynamics(q, x, y, None, result),
        };
        let pool = if threads == 1 { None } else { Some(pool(threads)?) };
        let done: Result<(), BatchError> = py.detach(|| match pool {
            None => run(batch, result),
            Some(pool) => pool.install(|| run(batch.on_all_cores(), result)),
        });
        done.map_err(|error| Error::new_err(error.to_string()))?;
        drop(writable);
        Ok(array.into_any())
    }
}

#[pymethods]
impl Robot {
    /// Compute inverse dynamics.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations, float64 or float32.
    /// v, a : ndarray, shape (nv,) or (states, nv)
    ///     Velocities and accelerations, of the dtype of q.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    /// out : ndarray, optional
    ///     Where the result is written.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of v
    ///     The joint forces tau = M a + h.
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming the argument, and the state and number that is not finite.
    /// TypeError
    ///     When an argument is no array of float64 or float32.
    #[pyo3(signature = (q, v, a, *, threads = Some(1), out = None))]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
        threads: Option<usize>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        self.three(py, [("q", q, nq), ("v", v, nv), ("a", a, nv)], out, threads, Quantity::InverseDynamics)
    }

    /// Compute forward dynamics.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations, float64 or float32.
    /// v, tau : ndarray, shape (nv,) or (states, nv)
    ///     Velocities and joint forces, of the dtype of q.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    /// out : ndarray, optional
    ///     Where the result is written.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of v
    ///     The accelerations. Of a free joint they are the rates of the numbers in v.
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming the argument, and the state and number that is not finite, or the dof that moves no inertia.
    /// TypeError
    ///     When an argument is no array of float64 or float32.
    #[pyo3(signature = (q, v, tau, *, threads = Some(1), out = None))]
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        threads: Option<usize>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        self.three(py, [("q", q, nq), ("v", v, nv), ("tau", tau, nv)], out, threads, Quantity::ForwardDynamics)
    }

    /// Compute bias forces: Coriolis, centrifugal and gravitational.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// v : ndarray, shape (nv,) or (states, nv)
    ///     Velocities.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of v
    ///     tau at a = 0.
    #[pyo3(signature = (q, v, *, threads = Some(1)))]
    fn bias_force<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv)], &[nv], threads, |workspace, [q, v], out| workspace.bias_force(q, v, None, out))
    }

    /// Compute joint-space inertia matrices.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv, nv) or (states, nv, nv)
    ///     M, both triangles, armature included.
    #[pyo3(signature = (q, *, threads = Some(1)))]
    fn mass_matrix<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>, threads: Option<usize>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq)], &[nv, nv], threads, |workspace, [q], out| {
            let matrix = workspace.mass_matrix(q)?;
            out.chunks_exact_mut(nv).enumerate().for_each(|(i, row)| row.iter_mut().enumerate().for_each(|(j, m)| *m = matrix.get(i, j)));
            Ok(())
        })
    }

    /// Solve M(q) x = b.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// b : ndarray, shape (nv,) or (states, nv)
    ///     Right-hand sides.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of b
    ///     The solutions.
    #[pyo3(signature = (q, b, *, threads = Some(1)))]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        b: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("b", b, nv)], &[nv], threads, |workspace, [q, b], out| {
            out.copy_from_slice(b);
            workspace.solve(q, out)
        })
    }

    /// Compute the placements of a frame in the world.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// frame : str
    ///     A body, or a frame that is fixed to one.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (4, 4) or (states, 4, 4)
    ///     Homogeneous transforms, frame to world.
    #[pyo3(signature = (q, frame, *, threads = Some(1)))]
    fn placement<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
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
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// v, a : ndarray, shape (nv,) or (states, nv)
    ///     Velocities and accelerations.
    /// frame : str
    ///     A body, or a frame that is fixed to one.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (2, 6) or (states, 2, 6)
    ///     Velocity and acceleration, each [angular, linear] in world axes. Gravity does not enter.
    #[pyo3(signature = (q, v, a, frame, *, threads = Some(1)))]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
        frame: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
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
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// frame : str
    ///     A body, or a frame that is fixed to one.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (6, nv) or (states, 6, nv)
    ///     J, with J v = [angular, linear] velocity of the frame's origin in world axes.
    #[pyo3(signature = (q, frame, *, threads = Some(1)))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let frame = self.robot.frame(frame).map_err(failed)?;
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq)], &[6, nv], threads, |workspace, [q], out| {
            for (j, column) in workspace.jacobian(q, &frame)?.iter().enumerate() {
                column.to_array().into_iter().enumerate().for_each(|(i, x)| out[i * nv + j] = x);
            }
            Ok(())
        })
    }

    /// Compute the derivatives of inverse dynamics.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// v, a : ndarray, shape (nv,) or (states, nv)
    ///     Velocities and accelerations.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3, nv, nv) or (states, 3, nv, nv)
    ///     By q on the tangent space of the configurations, by v, and by a, which is M.
    #[pyo3(signature = (q, v, a, *, threads = Some(1)))]
    fn inverse_dynamics_derivatives<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv), ("a", a, nv)], &[3, nv, nv], threads, |workspace, [q, v, a], out| {
            let partials = workspace.inverse_dynamics_derivatives(q, v, a, None)?;
            let (by_q, rest) = out.split_at_mut(nv * nv);
            let (by_v, by_a) = rest.split_at_mut(nv * nv);
            partials.q.write_dense(by_q)?;
            partials.v.write_dense(by_v)?;
            by_a.chunks_exact_mut(nv)
                .enumerate()
                .for_each(|(i, row)| row.iter_mut().enumerate().for_each(|(j, m)| *m = partials.a.get(i, j)));
            Ok(())
        })
    }

    /// Compute the derivatives of forward dynamics.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Configurations.
    /// v, tau : ndarray, shape (nv,) or (states, nv)
    ///     Velocities and joint forces.
    /// threads : int, optional
    ///     Threads for many states; None takes all cores.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3, nv, nv) or (states, 3, nv, nv)
    ///     By q on the tangent space of the configurations, by v, and by tau, which is the inverse of M.
    #[pyo3(signature = (q, v, tau, *, threads = Some(1)))]
    fn forward_dynamics_derivatives<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv), ("tau", tau, nv)], &[3, nv, nv], threads, |workspace, [q, v, tau], out| {
            let partials = workspace.forward_dynamics_derivatives(q, v, tau, None)?;
            for (out, part) in out.chunks_exact_mut(nv * nv).zip([&partials.q, &partials.v, &partials.tau]) {
                out.copy_from_slice(part);
            }
            Ok(())
        })
    }
}
