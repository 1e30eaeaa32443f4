//! The quantities of one state, computed again and again without an allocation.
//!
//! Each is computed by the usual method of the studies: the fastest that is as accurate as the best engine.

use crate::error::{check, check_length, check_result};
use crate::{Error, Frame, Robot};
use featherbench_dynamics::{
    Aba, BodyMotion, FdDerivatives, FdPartials, IdDerivatives, IdPartials, Ltdl, PackedCrba, PackedJacobian, PackedKinematics, PackedRnea,
    TreeSparse,
};
use featherbench_spatial::{Force, Motion, Transform, Vec3};

/// Computes quantities of a robot, one state at a time.
///
/// | call | kernel |
/// |---|---|
/// | [`Workspace::inverse_dynamics`], [`Workspace::bias_force`] | [`PackedRnea`] |
/// | [`Workspace::forward_dynamics`] | [`Aba`] |
/// | [`Workspace::mass_matrix`], [`Workspace::factors`], [`Workspace::solve`] | [`PackedCrba`], [`Ltdl`] |
/// | [`Workspace::placements`], [`Workspace::kinematics`] | [`PackedKinematics`] |
/// | [`Workspace::jacobian`] | [`PackedJacobian`] |
/// | [`Workspace::inverse_dynamics_derivatives`] | [`IdDerivatives`] |
/// | [`Workspace::forward_dynamics_derivatives`] | [`FdDerivatives`] |
///
/// The first call of a quantity makes the workspace of its kernel. Later calls do not allocate, unless they fail.
///
/// Wrenches are one per body ([`Robot::bodies`]): [moment; force] at the origin of the body's frame, in its axes.
///
/// ```
/// use featherbench_rbd::Robot;
///
/// // A pendulum of 36 links falls for a second, by steps of a millisecond (symplectic Euler).
/// let robot = Robot::generated("chain:n=36")?;
/// let mut workspace = robot.workspace();
/// let (mut q, mut v, mut a, zero) = (robot.neutral(), vec![0.0; 36], vec![0.0; 36], vec![0.0; 36]);
/// let (mut next, h) = (q.clone(), 1e-3);
/// q[0] = 0.5;
/// for _ in 0..1000 {
///     workspace.forward_dynamics(&q, &v, &zero, None, &mut a)?;
///     v.iter_mut().zip(&a).for_each(|(v, a)| *v += h * a);
///     let step: Vec<f64> = v.iter().map(|v| h * v).collect();
///     robot.integrate_into(&q, &step, &mut next)?;
///     std::mem::swap(&mut q, &mut next);
/// }
/// assert!(q.iter().all(|q| q.is_finite()));
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Workspace {
    robot: Robot,
    rnea: Option<PackedRnea>,
    aba: Option<Aba<f64>>,
    mass: Option<Mass>,
    factors: Option<Ltdl<f64>>,
    kinematics: Option<PackedKinematics>,
    jacobian: Option<PackedJacobian>,
    columns: Vec<Motion<f64>>,
    of_id: Option<Box<(IdDerivatives<f64>, IdPartials<f64>)>>,
    of_fd: Option<Box<(FdDerivatives<f64>, FdPartials<f64>)>>,
    /// One per compiled body.
    wrenches: Vec<Force<f64>>,
}

/// The kernel of M, and its result.
#[derive(Clone, Debug)]
struct Mass {
    crba: PackedCrba,
    matrix: TreeSparse<f64>,
}

impl Workspace {
    pub(crate) fn new(robot: &Robot) -> Self {
        Self {
            robot: robot.clone(),
            rnea: None,
            aba: None,
            mass: None,
            factors: None,
            kinematics: None,
            jacobian: None,
            columns: Vec::new(),
            of_id: None,
            of_fd: None,
            wrenches: vec![Force::zero(); robot.inner.model.topology.bodies()],
        }
    }

    /// The robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// assert_eq!(robot.workspace().robot().nv(), 2);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Joint forces `tau` at configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// use featherbench_rbd::spatial::{Force, Vec3};
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1")?;
    /// let (mut workspace, mut tau) = (robot.workspace(), [0.0]);
    /// workspace.inverse_dynamics(&[0.3], &[0.0], &[0.0], None, &mut tau)?;
    /// let free = tau[0];
    /// // A moment of 2 N·m on the link, about each of its axes.
    /// let moment = Force::new(Vec3::new(2.0, 2.0, 2.0), Vec3::zero());
    /// workspace.inverse_dynamics(&[0.3], &[0.0], &[0.0], Some(&[moment]), &mut tau)?;
    /// assert!((tau[0] - (free - 2.0)).abs() < 1e-12, "what the wrench does, the joint need not");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn inverse_dynamics(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        wrenches: Option<&[Force<f64>]>,
        tau: &mut [f64],
    ) -> Result<(), Error> {
        self.check_state(q, v, ("a", a), ("tau", tau.len()))?;
        let wrenches = per_compiled_body(&mut self.wrenches, &self.robot, wrenches)?;
        let packed = &self.robot.inner.packed;
        self.rnea.get_or_insert_with(|| PackedRnea::new(packed)).run(packed, q, v, a, wrenches, tau)?;
        check_result("tau", tau)
    }

    /// Bias forces `h` at configuration `q`, velocity `v` and external wrenches: τ at a = 0.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut h = [0.0; 2];
    /// robot.workspace().bias_force(&[0.3; 2], &[0.1; 2], None, &mut h)?;
    /// assert!(h[0] != 0.0);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn bias_force(&mut self, q: &[f64], v: &[f64], wrenches: Option<&[Force<f64>]>, h: &mut [f64]) -> Result<(), Error> {
        self.robot.check_q("q", q)?;
        check("v", self.robot.nv(), v)?;
        check_length("h", self.robot.nv(), h.len())?;
        let wrenches = per_compiled_body(&mut self.wrenches, &self.robot, wrenches)?;
        let packed = &self.robot.inner.packed;
        self.rnea.get_or_insert_with(|| PackedRnea::new(packed)).bias(packed, q, v, wrenches, h)?;
        check_result("h", h)
    }

    /// Accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite, or when a dof moves no inertia; `a` then
    /// means nothing.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let (mut workspace, mut tau, mut a) = (robot.workspace(), [0.0; 2], [0.0; 2]);
    /// workspace.inverse_dynamics(&[0.3; 2], &[0.1; 2], &[1.0, -1.0], None, &mut tau)?;
    /// workspace.forward_dynamics(&[0.3; 2], &[0.1; 2], &tau, None, &mut a)?;
    /// assert!((a[0] - 1.0).abs() < 1e-12 && (a[1] + 1.0).abs() < 1e-12);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn forward_dynamics(
        &mut self,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        wrenches: Option<&[Force<f64>]>,
        a: &mut [f64],
    ) -> Result<(), Error> {
        self.check_state(q, v, ("tau", tau), ("a", a.len()))?;
        let wrenches = per_compiled_body(&mut self.wrenches, &self.robot, wrenches)?;
        let model = &self.robot.inner.model;
        self.aba.get_or_insert_with(|| Aba::new(&model.topology)).run(model, q, v, tau, wrenches, a)?;
        check_result("a", a)
    }

    /// The joint-space inertia matrix M(q), armature included.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let dense = robot.workspace().mass_matrix(&[0.3; 2])?.to_dense();
    /// assert_eq!(dense[(0, 1)], dense[(1, 0)]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn mass_matrix(&mut self, q: &[f64]) -> Result<&TreeSparse<f64>, Error> {
        self.robot.check_q("q", q)?;
        let inner = &self.robot.inner;
        let make = || Mass { crba: PackedCrba::new(&inner.packed), matrix: TreeSparse::new(&inner.model.topology) };
        let Mass { crba, matrix } = self.mass.get_or_insert_with(make);
        crba.run(&inner.packed, q, matrix)?;
        check_result("M", matrix.values())?;
        Ok(matrix)
    }

    /// The factors M = LᵀDL: for solutions, the inverse, half-solutions and the determinant.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut workspace = robot.workspace();
    /// let mut x = workspace.mass_matrix(&[0.3; 2])?.product(&[1.0, 2.0])?;
    /// workspace.factors(&[0.3; 2])?.solve(&mut x)?;
    /// assert!((x[0] - 1.0).abs() < 1e-13 && (x[1] - 2.0).abs() < 1e-13);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn factors(&mut self, q: &[f64]) -> Result<&Ltdl<f64>, Error> {
        self.mass_matrix(q)?;
        let topology = &self.robot.inner.model.topology;
        let factors = self.factors.get_or_insert_with(|| Ltdl::new(topology));
        if let Some(Mass { matrix, .. }) = &self.mass {
            factors.run(matrix)?;
        }
        Ok(factors)
    }

    /// Puts the solution of M(q) x = b in the place of b.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut x = [1.0, 2.0];
    /// robot.workspace().solve(&[0.3; 2], &mut x)?;
    /// let b = robot.mass_matrix(&[0.3; 2])?.product(&x)?;
    /// assert!((b[0] - 1.0).abs() < 1e-13 && (b[1] - 2.0).abs() < 1e-13);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn solve(&mut self, q: &[f64], x: &mut [f64]) -> Result<(), Error> {
        check("b", self.robot.nv(), x)?;
        self.factors(q)?.solve(x)?;
        check_result("x", x)
    }

    /// Places every body at configuration `q`.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let tip = robot.frame(robot.bodies()[1])?;
    /// let mut workspace = robot.workspace();
    /// assert_eq!(workspace.placements(&[0.3; 2])?.placement(&tip)?, robot.placement(&[0.3; 2], tip.name())?);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn placements(&mut self, q: &[f64]) -> Result<Bodies<'_>, Error> {
        self.robot.check_q("q", q)?;
        let packed = &self.robot.inner.packed;
        let kinematics = self.kinematics.get_or_insert_with(|| PackedKinematics::new(packed));
        kinematics.place(packed, q)?;
        Ok(Bodies { kinematics })
    }

    /// Moves every body at configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let tip = robot.frame(robot.bodies()[1])?;
    /// let mut workspace = robot.workspace();
    /// let velocity = workspace.kinematics(&[0.3; 2], &[1.0, 0.0], &[0.0; 2])?.motion(&tip)?.velocity;
    /// let column = workspace.jacobian(&[0.3; 2], &tip)?[0];
    /// assert!(velocity.to_array().iter().zip(column.to_array()).all(|(v, j)| (v - j).abs() < 1e-14));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn kinematics(&mut self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Bodies<'_>, Error> {
        self.check_state(q, v, ("a", a), ("a", a.len()))?;
        let packed = &self.robot.inner.packed;
        let kinematics = self.kinematics.get_or_insert_with(|| PackedKinematics::new(packed));
        kinematics.run(packed, q, v, a)?;
        Ok(Bodies { kinematics })
    }

    /// The Jacobian of a frame at configuration `q`: one column [angular; linear] per dof, in world axes at the frame's origin.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or when the frame is another robot's.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let tip = robot.frame(robot.bodies()[1])?;
    /// assert_eq!(robot.workspace().jacobian(&[0.3; 2], &tip)?.len(), 2);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn jacobian(&mut self, q: &[f64], frame: &Frame) -> Result<&[Motion<f64>], Error> {
        self.robot.check_q("q", q)?;
        let packed = &self.robot.inner.packed;
        self.columns.resize(self.robot.nv(), Motion::zero());
        let Some(body) = frame.body else {
            self.columns.fill(Motion::zero());
            return Ok(&self.columns);
        };
        let reach = match frame.offset {
            Some(offset) => {
                let kinematics = self.kinematics.get_or_insert_with(|| PackedKinematics::new(packed));
                kinematics.place(packed, q)?;
                let place = kinematics.placement(body).ok_or_else(|| foreign(frame))?;
                place.rotation * offset.translation
            }
            None => Vec3::zero(),
        };
        let jacobian = self.jacobian.get_or_insert_with(|| PackedJacobian::new(packed));
        let columns = jacobian.run(packed, q, body).map_err(|_| foreign(frame))?;
        for (own, column) in self.columns.iter_mut().zip(columns) {
            *own = moved(*column, reach);
            check_result("J", &own.to_array())?;
        }
        Ok(&self.columns)
    }

    /// Derivatives of inverse dynamics at configuration `q`, velocity `v`, acceleration `a` and external wrenches, which turn with their
    /// bodies.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut workspace = robot.workspace();
    /// let by_a = workspace.inverse_dynamics_derivatives(&[0.3; 2], &[0.1; 2], &[0.0; 2], None)?.a.get(0, 1);
    /// assert!((by_a - workspace.mass_matrix(&[0.3; 2])?.get(0, 1)).abs() < 1e-12, "∂τ/∂a = M");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn inverse_dynamics_derivatives(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        wrenches: Option<&[Force<f64>]>,
    ) -> Result<&IdPartials<f64>, Error> {
        self.check_state(q, v, ("a", a), ("a", a.len()))?;
        let wrenches = per_compiled_body(&mut self.wrenches, &self.robot, wrenches)?;
        let model = &self.robot.inner.model;
        let make = || Box::new((IdDerivatives::new(&model.topology), IdPartials::new(&model.topology)));
        let (kernel, partials) = &mut **self.of_id.get_or_insert_with(make);
        kernel.run(model, q, v, a, wrenches, partials)?;
        for values in [partials.q.lower(), partials.q.upper(), partials.v.lower(), partials.v.upper(), partials.a.values()] {
            check_result("the derivative", values)?;
        }
        Ok(partials)
    }

    /// Derivatives of forward dynamics at configuration `q`, velocity `v`, joint forces `tau` and external wrenches, which turn with their
    /// bodies.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or has a number that is not finite, or when a dof moves no inertia.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut workspace = robot.workspace();
    /// let inverse = workspace.forward_dynamics_derivatives(&[0.3; 2], &[0.1; 2], &[0.0; 2], None)?.tau[1];
    /// assert!((inverse - workspace.factors(&[0.3; 2])?.dense_inverse()[1]).abs() < 1e-10 * inverse.abs(), "∂a/∂τ = M⁻¹");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        wrenches: Option<&[Force<f64>]>,
    ) -> Result<&FdPartials<f64>, Error> {
        self.check_state(q, v, ("tau", tau), ("tau", tau.len()))?;
        let wrenches = per_compiled_body(&mut self.wrenches, &self.robot, wrenches)?;
        let model = &self.robot.inner.model;
        let make = || Box::new((FdDerivatives::new(&model.topology), FdPartials::new(&model.topology)));
        let (kernel, partials) = &mut **self.of_fd.get_or_insert_with(make);
        kernel.run(model, q, v, tau, wrenches, partials)?;
        for values in [&partials.acceleration, &partials.q, &partials.v, &partials.tau] {
            check_result("the derivative", values)?;
        }
        Ok(partials)
    }

    /// Checks q, v, one more vector of `nv` numbers, and the length of the place for the result.
    fn check_state(&self, q: &[f64], v: &[f64], third: (&'static str, &[f64]), result: (&'static str, usize)) -> Result<(), Error> {
        self.robot.check_q("q", q)?;
        check("v", self.robot.nv(), v)?;
        check(third.0, self.robot.nv(), third.1)?;
        check_length(result.0, self.robot.nv(), result.1)
    }
}

/// The placed or moved bodies of a [`Workspace`].
///
/// ```
/// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
/// let tip = robot.frame(robot.bodies()[1])?;
/// let mut workspace = robot.workspace();
/// let bodies = workspace.placements(&[0.3; 2])?;
/// assert!(bodies.placement(&tip)?.translation.norm() > 0.0);
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Debug)]
pub struct Bodies<'w> {
    kinematics: &'w PackedKinematics,
}

impl Bodies<'_> {
    /// The placement of a frame in the world.
    ///
    /// # Errors
    /// [`Error::ForeignFrame`] when the frame is another robot's, and [`Error::ResultNotFinite`].
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let root = robot.frame(robot.bodies()[0])?;
    /// let x = robot.workspace().placements(&[0.0; 2])?.placement(&root)?;
    /// assert_eq!(x, robot.joints()[0].placement);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn placement(&self, frame: &Frame) -> Result<Transform<f64>, Error> {
        let of_body = match frame.body {
            Some(body) => self.kinematics.placement(body).ok_or_else(|| foreign(frame))?,
            None => Transform::identity(),
        };
        let placed = frame.offset.map_or(of_body, |offset| of_body.compose(&offset));
        check_result("the placement", &placed.translation.to_array())?;
        check_result("the placement's rotation", &placed.rotation.to_array())?;
        Ok(placed)
    }

    /// Placement of a frame, velocity [ω; ṗ] and classical acceleration [ω̇; p̈] of its origin p, in world axes. Gravity does not enter.
    ///
    /// # Errors
    /// [`Error::ForeignFrame`] when the frame is another robot's, [`Error::NotMoved`] after [`Workspace::placements`], and
    /// [`Error::ResultNotFinite`].
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let tip = robot.frame(robot.bodies()[1])?;
    /// let motion = robot.workspace().kinematics(&[0.3; 2], &[0.0; 2], &[0.0; 2])?.motion(&tip)?;
    /// assert_eq!(motion.velocity.to_array(), [0.0; 6]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn motion(&self, frame: &Frame) -> Result<BodyMotion<f64>, Error> {
        let placement = self.placement(frame)?;
        let Some(body) = frame.body else {
            return Ok(BodyMotion { placement, velocity: Motion::zero(), acceleration: Motion::zero() });
        };
        let BodyMotion { placement: of_body, velocity, acceleration } = self.kinematics.body(body).ok_or(Error::NotMoved)?;
        let reach = frame.offset.map_or_else(Vec3::zero, |offset| of_body.rotation * offset.translation);
        let swing = velocity.ang.cross(velocity.ang.cross(reach));
        let velocity = moved(velocity, reach);
        // p̈ + ω̇ × r + ω × (ω × r)
        let mut acceleration = moved(acceleration, reach);
        acceleration.lin += swing;
        check_result("the velocity", &velocity.to_array())?;
        check_result("the acceleration", &acceleration.to_array())?;
        Ok(BodyMotion { placement, velocity, acceleration })
    }
}

/// A motion at a point that is displaced by `reach`: ṗ + ω × r.
fn moved(motion: Motion<f64>, reach: Vec3<f64>) -> Motion<f64> {
    Motion::new(motion.ang, motion.ang.cross_add(reach, motion.lin))
}

fn foreign(frame: &Frame) -> Error {
    Error::ForeignFrame { name: frame.name.clone() }
}

/// Wrenches of the compiled bodies, from those of the described ones.
fn per_compiled_body<'w>(
    all: &'w mut [Force<f64>],
    robot: &Robot,
    wrenches: Option<&[Force<f64>]>,
) -> Result<Option<&'w [Force<f64>]>, Error> {
    let Some(wrenches) = wrenches else { return Ok(None) };
    let described = &robot.inner.model.described;
    check_length("wrenches", described.len(), wrenches.len())?;
    for (k, (&body, wrench)) in described.iter().zip(wrenches).enumerate() {
        if let Some((at, &value)) = wrench.to_array().iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(Error::NotFinite { argument: "wrenches", index: 6 * k + at, value });
        }
        all[body] = *wrench;
    }
    Ok(Some(all))
}
