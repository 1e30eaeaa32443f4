//! The class `Robot`.

use crate::Error;
use crate::arrays::{Scalar, is_double, numbers, output};
use crate::states::{Argument, agreed, failed, map, pool, threads as threads_of};
use featherbench_library::dynamics::{Batch, BatchError, Element as BatchElement};
use featherbench_library::{Convention, Robot as Library, Workspace};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Mutex;

/// A joint of a robot.
#[pyclass(frozen, module = "featherbench", get_all)]
pub(crate) struct Joint {
    /// Its name.
    name: String,
    /// Its kind: 'revolute', 'free', …
    kind: String,
    /// Its numbers in q: (first, one past the last).
    q: (usize, usize),
    /// Its numbers in v, a and tau: (first, one past the last).
    v: (usize, usize),
    /// The body that it moves.
    body: String,
    /// The body that carries it, or None for the world.
    parent: Option<String>,
    /// Position limits of each dof, rad or m.
    limits: Vec<(f64, f64)>,
}

#[pymethods]
impl Joint {
    fn __repr__(&self) -> String {
        format!("Joint('{}', {}, q={}:{}, v={}:{})", self.name, self.kind, self.q.0, self.q.1, self.v.0, self.v.1)
    }
}

/// A robot: read once, computed with often.
///
/// Notes
/// -----
/// Arrays have the shape (n,) for one state, or (states, n) for many. They are float64; inverse and forward dynamics and bias forces take
/// float32 too. C-contiguous arrays are not copied. The GIL is released while many states are computed.
#[pyclass(frozen, module = "featherbench")]
pub(crate) struct Robot {
    robot: Library,
    /// For one state at a time. A call that finds it in use makes its own.
    workspace: Mutex<Workspace>,
}

impl Robot {
    fn new(robot: Library) -> Self {
        let workspace = Mutex::new(robot.workspace());
        Self { robot, workspace }
    }

    /// Calls `f` with a workspace.
    fn with_workspace<R>(&self, f: impl FnOnce(&mut Workspace) -> R) -> R {
        match self.workspace.try_lock() {
            Ok(mut workspace) => f(&mut workspace),
            Err(_) => f(&mut self.robot.workspace()),
        }
    }

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

    fn convert<'py>(
        &self,
        py: Python<'py>,
        argument: Argument<'_, 'py>,
        size: usize,
        f: impl Fn(&Library, &[f64]) -> Result<Vec<f64>, featherbench_library::Error> + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        map(py, &self.robot, [argument], &[size], Some(1), |workspace, [x], out| {
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

#[derive(Clone, Copy)]
enum Quantity {
    InverseDynamics,
    ForwardDynamics,
}

/// The engine of a name.
fn convention(engine: &str) -> PyResult<Convention> {
    match engine {
        "pinocchio" => Ok(Convention::Pinocchio),
        "mujoco" => Ok(Convention::MuJoCo),
        "drake" => Ok(Convention::Drake),
        _ => Err(Error::new_err(format!("engine is '{engine}'; give 'pinocchio', 'mujoco' or 'drake'"))),
    }
}

#[pymethods]
impl Robot {
    /// Read a URDF file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file. A link that is fixed to another is merged with it and stays as a frame.
    /// floating : bool
    ///     Whether the root link has a free joint to the world.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot. `notes` tells what was left out or altered.
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming file, line, column and the link or joint.
    #[staticmethod]
    #[pyo3(signature = (path, *, floating = false))]
    fn from_urdf(path: PathBuf, floating: bool) -> PyResult<Self> {
        let read = if floating { Library::from_urdf_floating(path) } else { Library::from_urdf(path) };
        read.map(Self::new).map_err(failed)
    }

    /// Read a neutral description file, which `featherbench gen` writes from URDF and MJCF.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming file, line, column and field.
    #[staticmethod]
    fn from_json(path: PathBuf) -> PyResult<Self> {
        Library::from_json(path).map(Self::new).map_err(failed)
    }

    /// Generate a robot, such as 'chain:n=36,layout=spatial' or 'humanoid'.
    ///
    /// Parameters
    /// ----------
    /// family : str
    ///     The family, and its parameters as key=value.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    #[staticmethod]
    fn generated(family: &str) -> PyResult<Self> {
        Library::generated(family).map(Self::new).map_err(failed)
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        self.robot.name()
    }

    /// Length of a configuration.
    #[getter]
    fn nq(&self) -> usize {
        self.robot.nq()
    }

    /// Degrees of freedom.
    #[getter]
    fn nv(&self) -> usize {
        self.robot.nv()
    }

    /// The joints, in the order of their numbers.
    #[getter]
    fn joints(&self) -> Vec<Joint> {
        let joint = |joint: &featherbench_library::Joint| Joint {
            name: joint.name.clone(),
            kind: joint.kind.name().to_owned(),
            q: (joint.q.start, joint.q.end),
            v: (joint.v.start, joint.v.end),
            body: joint.body.clone(),
            parent: joint.parent.clone(),
            limits: joint.limits.clone(),
        };
        self.robot.joints().iter().map(joint).collect()
    }

    /// The names of the bodies that move.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.robot.bodies()
    }

    /// The names of all frames: those of the bodies first.
    #[getter]
    fn frames(&self) -> Vec<&str> {
        self.robot.frames()
    }

    /// What the import left out or altered, and what is unphysical.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.robot.notes().to_vec()
    }

    fn __repr__(&self) -> String {
        format!("Robot('{}', nq={}, nv={})", self.robot.name(), self.robot.nq(), self.robot.nv())
    }

    /// Give the neutral configuration.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,)
    ///     Zeros, and quaternions without rotation.
    fn neutral<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        filled(py, &self.robot.neutral(), &[self.robot.nq()])
    }

    /// Draw random configurations: joints within their limits, other angles in (-pi, pi), quaternions uniform.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     The same seed gives the same numbers on every platform.
    /// states : int, optional
    ///     How many; None gives one without an axis of states.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     The configurations.
    #[pyo3(signature = (seed = 0, states = None))]
    fn random<'py>(&self, py: Python<'py>, seed: u64, states: Option<usize>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let nq = self.robot.nq();
        match states {
            None => filled(py, &self.robot.random(seed), &[nq]),
            Some(states) => filled(py, &self.robot.random_batch(states, seed), &[states, nq]),
        }
    }

    /// Move along velocities for a unit of time.
    ///
    /// Parameters
    /// ----------
    /// q : ndarray, shape (nq,) or (states, nq)
    ///     Where to begin.
    /// v : ndarray, shape (nv,) or (states, nv)
    ///     The velocity; h v for a step of h.
    ///
    /// Returns
    /// -------
    /// ndarray, shape of q
    ///     q plus v, on the space of configurations.
    fn integrate<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>, v: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, &self.robot, [("q", q, nq), ("v", v, nv)], &[nq], Some(1), |workspace, [q, v], out| {
            workspace.robot().integrate_into(q, v, out)
        })
    }

    /// Give the velocities that lead from one configuration to another in a unit of time.
    ///
    /// Parameters
    /// ----------
    /// start, end : ndarray, shape (nq,) or (states, nq)
    ///     The configurations.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     end minus start, on the space of configurations. Rotations take the shortest way.
    fn difference<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        end: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, &self.robot, [("start", start, nq), ("end", end, nq)], &[nv], Some(1), |workspace, [from, to], out| {
            workspace.robot().difference_into(from, to, out)
        })
    }

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
        map(py, &self.robot, [("q", q, nq), ("v", v, nv)], &[nv], threads, |workspace, [q, v], out| workspace.bias_force(q, v, None, out))
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
        map(py, &self.robot, [("q", q, nq)], &[nv, nv], threads, |workspace, [q], out| {
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
        map(py, &self.robot, [("q", q, nq), ("b", b, nv)], &[nv], threads, |workspace, [q, b], out| {
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
        map(py, &self.robot, [("q", q, self.robot.nq())], &[4, 4], threads, |workspace, [q], out| {
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
        map(py, &self.robot, [("q", q, nq), ("v", v, nv), ("a", a, nv)], &[2, 6], threads, |workspace, [q, v, a], out| {
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
        map(py, &self.robot, [("q", q, nq)], &[6, nv], threads, |workspace, [q], out| {
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
        map(py, &self.robot, [("q", q, nq), ("v", v, nv), ("a", a, nv)], &[3, nv, nv], threads, |workspace, [q, v, a], out| {
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
        map(py, &self.robot, [("q", q, nq), ("v", v, nv), ("tau", tau, nv)], &[3, nv, nv], threads, |workspace, [q, v, tau], out| {
            let partials = workspace.forward_dynamics_derivatives(q, v, tau, None)?;
            for (out, part) in out.chunks_exact_mut(nv * nv).zip([&partials.q, &partials.v, &partials.tau]) {
                out.copy_from_slice(part);
            }
            Ok(())
        })
    }

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
        map(py, &self.robot, [("q", q, nq), ("v", v, nv)], &[nv], Some(1), |workspace, [q, v], out| {
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
        map(py, &self.robot, [("q", q, nq), ("tau", tau, nv)], &[nv], Some(1), |workspace, [q, tau], out| {
            out.copy_from_slice(&workspace.robot().force_to(engine, q, tau)?);
            Ok(())
        })
    }
}

/// A new array of these numbers.
fn filled<'py>(py: Python<'py>, values: &[f64], shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let (array, mut writable) = output::<f64>(py, None, None, shape)?;
    writable.as_slice_mut()?.copy_from_slice(values);
    drop(writable);
    Ok(array)
}
