//! A robot's numbers in the coordinates of an engine, and back.

use crate::convention::Turn;
use crate::error::{check, check_result};
use crate::robot::Joint;
use crate::{Convention, Error, Robot};
use featherbench_model::JointType;
use std::ops::Range;

impl Robot {
    /// Length of an engine's configuration.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("humanoid")?;
    /// assert_eq!(robot.nq_of(Convention::MuJoCo)?, robot.nq());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NoCoordinates`] when the engine does not have a joint of this robot; [`Error::OtherCoordinates`] when the robot is of a URDF to
    /// which Pinocchio's own parser gives other coordinates.
    pub fn nq_of(&self, convention: Convention) -> Result<usize, Error> {
        self.check_parser(convention)?;
        self.joints().iter().map(|joint| convention.check(joint).map(|()| convention.nq(joint))).sum()
    }

    /// An engine's numbers of the configuration `q`.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("humanoid")?;
    /// let q = robot.random(1);
    /// let back = robot.configuration_from(Convention::Drake, &robot.configuration_to(Convention::Drake, &q)?)?;
    /// assert!(robot.difference(&q, &back)?.iter().all(|x| x.abs() < 1e-14));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn configuration_to(&self, convention: Convention, q: &[f64]) -> Result<Vec<f64>, Error> {
        self.check_q("q", q)?;
        let mut theirs = vec![0.0; self.nq_of(convention)?];
        self.each_q(convention, |joint, of_theirs| convention.write_q(joint, &q[joint.q.clone()], &mut theirs[of_theirs]));
        check_result("the engine's q", &theirs)?;
        Ok(theirs)
    }

    /// The configuration that an engine's numbers stand for.
    ///
    /// # Errors
    /// [`Error`] when the numbers do not fit, or when the engine does not have a joint of this robot.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("chain:n=1,base=free")?;
    /// let q = robot.configuration_from(Convention::Drake, &[1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.5])?;
    /// assert_eq!(q, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn configuration_from(&self, convention: Convention, theirs: &[f64]) -> Result<Vec<f64>, Error> {
        check("the engine's q", self.nq_of(convention)?, theirs)?;
        let mut q = vec![0.0; self.nq()];
        let mut zero = Ok(());
        self.each_q(convention, |joint, of_theirs| {
            if zero.is_ok() {
                zero = self.check_quaternion(convention, joint, theirs, &of_theirs);
                convention.read_q(joint, &theirs[of_theirs], &mut q[joint.q.clone()]);
            }
        });
        zero?;
        check_result("q", &q)?;
        Ok(q)
    }

    /// [`Robot::configuration_to`] Pinocchio.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// let q = robot.random(1);
    /// assert_eq!(robot.to_pinocchio(&q)?, q, "Pinocchio's coordinates are ours, but for planar joints");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn to_pinocchio(&self, q: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_to(Convention::Pinocchio, q)
    }

    /// [`Robot::configuration_from`] Pinocchio.
    ///
    /// # Errors
    /// [`Error`] when the numbers do not fit.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// assert!(robot.from_pinocchio(&vec![0.0; robot.nq()]).is_err(), "a quaternion of zeros is no rotation");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    #[allow(clippy::wrong_self_convention, reason = "the counterpart of to_pinocchio: the robot says what the numbers mean")]
    pub fn from_pinocchio(&self, theirs: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_from(Convention::Pinocchio, theirs)
    }

    /// [`Robot::configuration_to`] MuJoCo.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot, or MuJoCo does not have a joint of it.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// assert_eq!(robot.to_mujoco(&robot.neutral())?, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn to_mujoco(&self, q: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_to(Convention::MuJoCo, q)
    }

    /// [`Robot::configuration_from`] MuJoCo.
    ///
    /// # Errors
    /// [`Error`] when the numbers do not fit, or MuJoCo does not have a joint of this robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// assert_eq!(robot.from_mujoco(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])?, robot.neutral());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    #[allow(clippy::wrong_self_convention, reason = "the counterpart of to_mujoco: the robot says what the numbers mean")]
    pub fn from_mujoco(&self, theirs: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_from(Convention::MuJoCo, theirs)
    }

    /// [`Robot::configuration_to`] Drake.
    ///
    /// # Errors
    /// [`Error`] when `q` does not fit the robot.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// assert_eq!(robot.to_drake(&robot.neutral())?, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn to_drake(&self, q: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_to(Convention::Drake, q)
    }

    /// [`Robot::configuration_from`] Drake.
    ///
    /// # Errors
    /// [`Error`] when the numbers do not fit.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=1,base=free")?;
    /// assert_eq!(robot.from_drake(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])?, robot.neutral());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    #[allow(clippy::wrong_self_convention, reason = "the counterpart of to_drake: the robot says what the numbers mean")]
    pub fn from_drake(&self, theirs: &[f64]) -> Result<Vec<f64>, Error> {
        self.configuration_from(Convention::Drake, theirs)
    }

    /// v_e = T v: an engine's numbers of the velocity `v` at the neutral configuration `q`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("chain:n=1,base=free")?;
    /// let v = robot.velocity_to(Convention::Drake, &robot.neutral(), &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])?;
    /// assert_eq!(v, [4.0, 5.0, 6.0, 1.0, 2.0, 3.0, 7.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn velocity_to(&self, convention: Convention, q: &[f64], v: &[f64]) -> Result<Vec<f64>, Error> {
        self.each_v(convention, q, ("v", v), |_, turn, v, theirs| turn.apply(v, theirs))
    }

    /// v = T⁻¹ v_e: the velocity that an engine's numbers stand for at the neutral configuration `q`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("chain:n=1,base=free")?;
    /// let v = robot.velocity_from(Convention::Drake, &robot.neutral(), &[4.0, 5.0, 6.0, 1.0, 2.0, 3.0, 7.0])?;
    /// assert_eq!(v, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn velocity_from(&self, convention: Convention, q: &[f64], theirs: &[f64]) -> Result<Vec<f64>, Error> {
        self.each_v(convention, q, ("the engine's v", theirs), |_, turn, theirs, v| turn.undo(theirs, v))
    }

    /// a_e = T a + b: an engine's numbers of the acceleration `a` at neutral `q` and `v`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// // A body that turns about z while it moves along its x: the classical acceleration is along y.
    /// let robot = Robot::generated("chain:n=1,base=free")?;
    /// let v = [1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    /// let a = robot.acceleration_to(Convention::MuJoCo, &robot.neutral(), &v, &[0.0; 7])?;
    /// assert_eq!(a[..3], [0.0, 2.0, 0.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn acceleration_to(&self, convention: Convention, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, Error> {
        check("v", self.nv(), v)?;
        self.each_v(convention, q, ("a", a), |joint, turn, a, theirs| {
            turn.apply(a, theirs);
            let b = convention.bias(joint, &q[joint.q.clone()], &v[joint.v.clone()]);
            theirs.iter_mut().zip(b).for_each(|(theirs, b)| *theirs += b);
        })
    }

    /// a = T⁻¹ (a_e − b): the acceleration that an engine's numbers stand for at neutral `q` and `v`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("chain:n=1,base=free")?;
    /// let v = [1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    /// let a = robot.acceleration_from(Convention::MuJoCo, &robot.neutral(), &v, &[0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
    /// assert_eq!(a, [0.0; 7]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn acceleration_from(&self, convention: Convention, q: &[f64], v: &[f64], theirs: &[f64]) -> Result<Vec<f64>, Error> {
        check("v", self.nv(), v)?;
        self.each_v(convention, q, ("the engine's a", theirs), |joint, turn, theirs, a| {
            let mut without = [0.0; 6];
            let without = &mut without[..theirs.len()];
            let b = convention.bias(joint, &q[joint.q.clone()], &v[joint.v.clone()]);
            without.iter_mut().zip(theirs.iter().zip(b)).for_each(|(x, (theirs, b))| *x = theirs - b);
            turn.undo(without, a);
        })
    }

    /// τ_e = T⁻ᵀ τ: an engine's numbers of the joint forces `tau` at neutral `q`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("humanoid")?;
    /// let (q, v, tau) = (robot.random(1), vec![0.1; robot.nv()], vec![0.2; robot.nv()]);
    /// let power = |v: &[f64], tau: &[f64]| v.iter().zip(tau).map(|(v, tau)| v * tau).sum::<f64>();
    /// let theirs = power(&robot.velocity_to(Convention::Drake, &q, &v)?, &robot.force_to(Convention::Drake, &q, &tau)?);
    /// assert!((theirs - power(&v, &tau)).abs() < 1e-13, "the power is the same");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn force_to(&self, convention: Convention, q: &[f64], tau: &[f64]) -> Result<Vec<f64>, Error> {
        self.each_v(convention, q, ("tau", tau), |_, turn, tau, theirs| turn.apply(tau, theirs))
    }

    /// τ = Tᵀ τ_e: the joint forces that an engine's numbers stand for at neutral `q`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit the robot, or when the engine does not have a joint of it.
    ///
    /// ```
    /// use featherbench_rbd::{Convention, Robot};
    /// let robot = Robot::generated("chain:n=2")?;
    /// assert_eq!(robot.force_from(Convention::Drake, &robot.neutral(), &[1.0, 2.0])?, [1.0, 2.0]);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn force_from(&self, convention: Convention, q: &[f64], theirs: &[f64]) -> Result<Vec<f64>, Error> {
        self.each_v(convention, q, ("the engine's tau", theirs), |_, turn, theirs, tau| turn.undo(theirs, tau))
    }

    /// An error, if the engine's own parser gives the robot's file other coordinates.
    fn check_parser(&self, convention: Convention) -> Result<(), Error> {
        match &self.inner.otherwise {
            Some(reason) if convention == Convention::Pinocchio => Err(Error::OtherCoordinates { reason: reason.clone() }),
            _ => Ok(()),
        }
    }

    /// Calls `convert` with each joint and the place of its numbers in the engine's q.
    fn each_q(&self, convention: Convention, mut convert: impl FnMut(&Joint, Range<usize>)) {
        let mut at = 0;
        for joint in self.joints() {
            let next = at + convention.nq(joint);
            convert(joint, at..next);
            at = next;
        }
    }

    /// Calls `convert` with each joint, its T, its part of `x`, and that of the result.
    fn each_v(
        &self,
        convention: Convention,
        q: &[f64],
        (argument, x): (&'static str, &[f64]),
        mut convert: impl FnMut(&Joint, &Turn, &[f64], &mut [f64]),
    ) -> Result<Vec<f64>, Error> {
        self.check_parser(convention)?;
        self.check_q("q", q)?;
        check(argument, self.nv(), x)?;
        let mut result = vec![0.0; self.nv()];
        for joint in self.joints() {
            convention.check(joint)?;
            convert(joint, &convention.turn(joint, &q[joint.q.clone()]), &x[joint.v.clone()], &mut result[joint.v.clone()]);
        }
        check_result("the converted numbers", &result)?;
        Ok(result)
    }

    /// An error, if the engine's numbers of a joint have a quaternion, or a cosine and sine, of length zero.
    fn check_quaternion(&self, convention: Convention, joint: &Joint, theirs: &[f64], place: &Range<usize>) -> Result<(), Error> {
        let within = match (convention, joint.kind) {
            (Convention::Pinocchio, JointType::Planar) => 2..4,
            (Convention::Drake, JointType::Free) | (Convention::Pinocchio | Convention::MuJoCo, JointType::Spherical) => 0..4,
            (_, JointType::Free) => 3..7,
            _ => return Ok(()),
        };
        let index = place.start + within.start;
        let square = theirs[index..place.start + within.end].iter().map(|x| x * x).sum::<f64>();
        if square.is_normal() {
            return Ok(());
        }
        Err(Error::NotARotation { argument: "the engine's q", index, joint: joint.name.clone(), length: square.sqrt() })
    }
}
