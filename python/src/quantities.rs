//! What forces do: inverse and forward dynamics, M, solutions with it, derivatives.

use crate::Error;
use crate::arrays::{Doubles, Given, Scalar, is_double, numbers, output};
use crate::robot::Robot;
use crate::states::{Argument, agreed, failed, map, pool, threads as threads_of};
use crate::text::text;
use featherbench_rbd::dynamics::{Batch, BatchError, Element as BatchElement};
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
        out: Option<Given<'_, 'py>>,
        threads: Option<i64>,
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
        out: Option<Given<'_, 'py>>,
        threads: Option<i64>,
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
    #[doc = text!(given q_of_either v a threads out)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The joint forces tau = M a + h, N m and N.
    #[doc = text!(errors of "float64 or float32, or that has another dtype than q.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, a = robot.random(seed=1), np.ones(robot.nv), np.ones(robot.nv)
    /// >>> tau = robot.inverse_dynamics(q, v, a)
    /// >>> np.allclose(robot.forward_dynamics(q, v, tau), a)
    /// True
    /// >>> q = robot.random(seed=1, states=1000)
    /// >>> robot.inverse_dynamics(q, *np.zeros((2, 1000, robot.nv)), threads=None).shape
    /// (1000, 36)
    #[pyo3(signature = (q, v, a, *, threads = Some(1), out = None))]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
        threads: Option<i64>,
        out: Option<Given<'_, 'py>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        self.three(py, [("q", q, nq), ("v", v, nv), ("a", a, nv)], out, threads, Quantity::InverseDynamics)
    }

    /// Compute forward dynamics.
    #[doc = text!(given q_of_either v tau threads out)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The accelerations, rad/s² and m/s². Of a free joint they are the rates of the numbers in v.
    #[doc = text!(errors of "float64 or float32, or that has another dtype than q." "Naming the dof that moves no inertia.")]
    /// >>> robot = featherbench.Robot.generated("chain:n=2")
    /// >>> q, v = np.array([0.3, -0.1]), np.zeros(2)
    /// >>> a = robot.forward_dynamics(q, v, robot.bias_force(q, v))
    /// >>> np.allclose(a, 0)  # the forces that hold it
    /// True
    #[pyo3(signature = (q, v, tau, *, threads = Some(1), out = None))]
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        threads: Option<i64>,
        out: Option<Given<'_, 'py>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        self.three(py, [("q", q, nq), ("v", v, nv), ("tau", tau, nv)], out, threads, Quantity::ForwardDynamics)
    }

    /// Compute bias forces: Coriolis, centrifugal and gravitational.
    #[doc = text!(given q v threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The joint forces at a = 0, N m and N.
    #[doc = text!(errors)]
    /// >>> robot = featherbench.Robot.generated("chain:n=2")
    /// >>> q, v = np.array([0.3, -0.1]), np.ones(2)
    /// >>> np.array_equal(robot.bias_force(q, v), robot.inverse_dynamics(q, v, np.zeros(2)))
    /// True
    #[pyo3(signature = (q, v, *, threads = Some(1)))]
    fn bias_force<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, v: Given<'_, 'py>, threads: Option<i64>) -> Doubles<'py> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv)], &[nv], threads, |workspace, [q, v], out| workspace.bias_force(q, v, None, out))
    }

    /// Compute joint-space inertia matrices.
    #[doc = text!(given q threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv, nv) or (states, nv, nv)
    ///     M, both triangles, armature included. Entries are kg m², kg m and kg, as the dofs are angles or lengths.
    #[doc = text!(errors)]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> m = robot.mass_matrix(robot.random(seed=1))
    /// >>> np.array_equal(m, m.T)
    /// True
    #[pyo3(signature = (q, *, threads = Some(1)))]
    fn mass_matrix<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, threads: Option<i64>) -> Doubles<'py> {
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
    #[doc = text!(q)]
    /// b : ndarray, shape (nv,) or (states, nv)
    ///     Right-hand sides, N m and N.
    #[doc = text!(threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     The solutions x, rad/s² and m/s².
    #[doc = text!(errors "Naming the dof that moves no inertia.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, b = robot.random(seed=1), np.ones(robot.nv)
    /// >>> np.allclose(robot.mass_matrix(q) @ robot.solve(q, b), b)
    /// True
    #[pyo3(signature = (q, b, *, threads = Some(1)))]
    fn solve<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, b: Given<'_, 'py>, threads: Option<i64>) -> Doubles<'py> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("b", b, nv)], &[nv], threads, |workspace, [q, b], out| {
            out.copy_from_slice(b);
            workspace.solve(q, out)
        })
    }

    /// Compute the derivatives of inverse dynamics.
    #[doc = text!(given q v a threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3, nv, nv) or (states, 3, nv, nv)
    ///     Of tau by q on the tangent space of the configurations, by v, and by a, which is M. Row i is tau[i], in SI units and rad.
    #[doc = text!(errors)]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, a = robot.random(seed=1), np.ones(robot.nv), np.ones(robot.nv)
    /// >>> by_q, by_v, by_a = robot.inverse_dynamics_derivatives(q, v, a)
    /// >>> np.allclose(by_a, robot.mass_matrix(q))
    /// True
    #[pyo3(signature = (q, v, a, *, threads = Some(1)))]
    fn inverse_dynamics_derivatives<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
        threads: Option<i64>,
    ) -> Doubles<'py> {
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
    #[doc = text!(given q v tau threads)]
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3, nv, nv) or (states, 3, nv, nv)
    ///     Of a by q on the tangent space of the configurations, by v, and by tau, which is the inverse of M. Row i is a[i], in SI units
    ///     and rad.
    #[doc = text!(errors "Naming the dof that moves no inertia.")]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v, tau = robot.random(seed=1), np.ones(robot.nv), np.ones(robot.nv)
    /// >>> by_q, by_v, by_tau = robot.forward_dynamics_derivatives(q, v, tau)
    /// >>> np.allclose(by_tau @ robot.mass_matrix(q), np.eye(robot.nv))
    /// True
    #[pyo3(signature = (q, v, tau, *, threads = Some(1)))]
    fn forward_dynamics_derivatives<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        threads: Option<i64>,
    ) -> Doubles<'py> {
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
