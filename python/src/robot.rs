//! The class `Robot`.

use crate::arrays::{Doubles, Given, output};
use crate::states::{failed, map};
use crate::text::text;
use featherbench_rbd::{Error, Robot as Library, Workspace};
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
    pub(crate) robot: Library,
    /// For one state at a time. A call that finds it in use makes its own.
    workspace: Mutex<Workspace>,
}

impl Robot {
    fn new(robot: Library) -> Self {
        let workspace = Mutex::new(robot.workspace());
        Self { robot, workspace }
    }

    /// Calls `f` with a workspace.
    pub(crate) fn with_workspace<R>(&self, f: impl FnOnce(&mut Workspace) -> R) -> R {
        match self.workspace.try_lock() {
            Ok(mut workspace) => f(&mut workspace),
            Err(_) => f(&mut self.robot.workspace()),
        }
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
    ///
    /// Examples
    /// --------
    /// >>> featherbench.Robot.from_urdf("no_such.urdf")
    /// Traceback (most recent call last):
    /// featherbench.Error: no_such.urdf: the file cannot be read: No such file or directory (os error 2)
    #[staticmethod]
    #[pyo3(signature = (path, *, floating = false))]
    fn from_urdf(path: PathBuf, floating: bool) -> PyResult<Self> {
        let read = if floating { Library::from_urdf_floating(path) } else { Library::from_urdf(path) };
        read.map(Self::new).map_err(failed)
    }

    /// Read an MJCF file, as far as that needs no compiler of MuJoCo.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file. Bodies, joints, inertials, classes, shapes of closed form and included files are read. Meshes without an inertial
    ///     are errors.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot, with MuJoCo's coordinates but for quaternions, which end with w, and velocities of a free joint, in body axes.
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming file, line, column and the body.
    ///
    /// Examples
    /// --------
    /// >>> featherbench.Robot.from_mjcf("no_such.xml")
    /// Traceback (most recent call last):
    /// featherbench.Error: no_such.xml: ...
    #[staticmethod]
    fn from_mjcf(path: PathBuf) -> PyResult<Self> {
        Library::from_mjcf(path).map(Self::new).map_err(failed)
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
    ///
    /// Examples
    /// --------
    /// >>> featherbench.Robot.from_json("no_such.json")
    /// Traceback (most recent call last):
    /// featherbench.Error: no_such.json: ...
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
    ///
    /// Raises
    /// ------
    /// Error
    ///     Naming the family or the parameter that does not exist, or whose value does not fit.
    ///
    /// Examples
    /// --------
    /// >>> featherbench.Robot.generated("chain:n=36,layout=spatial").nv
    /// 36
    #[staticmethod]
    fn generated(family: &str) -> PyResult<Self> {
        Library::generated(family).map(Self::new).map_err(failed)
    }

    /// Write the neutral description, which `from_json` reads.
    ///
    /// Returns
    /// -------
    /// str
    ///     JSON.
    ///
    /// Examples
    /// --------
    /// >>> robot = featherbench.Robot.generated("chain:n=2")
    /// >>> robot.to_json().startswith("{")
    /// True
    fn to_json(&self) -> PyResult<String> {
        self.robot.to_json().map_err(failed)
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
        let joint = |joint: &featherbench_rbd::Joint| Joint {
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
    ///     Zeros, and quaternions without rotation; rad and m.
    ///
    /// Examples
    /// --------
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> robot.neutral()[:7]  # of the free joint: the origin, and the quaternion (x, y, z, w)
    /// array([0., 0., 0., 0., 0., 0., 1.])
    fn neutral<'py>(&self, py: Python<'py>) -> Doubles<'py> {
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
    ///     The configurations, rad and m.
    ///
    /// Raises
    /// ------
    /// OverflowError
    ///     When the seed or the number of states is negative.
    ///
    /// Examples
    /// --------
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> robot.random(seed=1).shape, robot.random(seed=1, states=5).shape
    /// ((37,), (5, 37))
    #[pyo3(signature = (seed = 0, states = None))]
    fn random<'py>(&self, py: Python<'py>, seed: u64, states: Option<usize>) -> Doubles<'py> {
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
    ///     Where to begin, rad and m; quaternions (x, y, z, w).
    /// v : ndarray, shape (nv,) or (states, nv)
    ///     The velocity, rad/s and m/s; h v for a step of h.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nq,) or (states, nq)
    ///     q plus v, on the space of configurations, rad and m.
    #[doc = text!(errors)]
    /// >>> robot = featherbench.Robot.generated("humanoid")
    /// >>> q, v = robot.random(seed=1), np.full(robot.nv, 0.1)
    /// >>> np.allclose(robot.difference(q, robot.integrate(q, v)), v)
    /// True
    fn integrate<'py>(&self, py: Python<'py>, q: Given<'_, 'py>, v: Given<'_, 'py>) -> Doubles<'py> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("q", q, nq), ("v", v, nv)], &[nq], Some(1), |workspace, [q, v], out| workspace.robot().integrate_into(q, v, out))
    }

    /// Give the velocities that lead from one configuration to another in a unit of time.
    ///
    /// Parameters
    /// ----------
    /// start, end : ndarray, shape (nq,) or (states, nq)
    ///     The configurations, rad and m; quaternions (x, y, z, w).
    ///
    /// Returns
    /// -------
    /// ndarray, shape (nv,) or (states, nv)
    ///     end minus start, on the space of configurations, rad/s and m/s. Rotations take the shortest way.
    #[doc = text!(errors)]
    /// >>> robot = featherbench.Robot.generated("chain:n=2")
    /// >>> robot.difference(np.zeros(2), np.array([0.25, -0.5]))
    /// array([ 0.25, -0.5 ])
    fn difference<'py>(&self, py: Python<'py>, start: Given<'_, 'py>, end: Given<'_, 'py>) -> Doubles<'py> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        map(py, self, [("start", start, nq), ("end", end, nq)], &[nv], Some(1), |workspace, [from, to], out| {
            workspace.robot().difference_into(from, to, out).map_err(renamed)
        })
    }
}

/// An error about the arguments of `difference`, by their names in Python, where `from` is a keyword.
fn renamed(error: Error) -> Error {
    let name = |argument| match argument {
        "from" => "start",
        "to" => "end",
        other => other,
    };
    match error {
        Error::NotFinite { argument, index, value } => Error::NotFinite { argument: name(argument), index, value },
        Error::NotARotation { argument, index, joint, length } => Error::NotARotation { argument: name(argument), index, joint, length },
        other => other,
    }
}

/// A new array of these numbers.
fn filled<'py>(py: Python<'py>, values: &[f64], shape: &[usize]) -> Doubles<'py> {
    let (array, mut writable) = output::<f64>(py, None, None, shape)?;
    writable.as_slice_mut()?.copy_from_slice(values);
    drop(writable);
    Ok(array)
}
