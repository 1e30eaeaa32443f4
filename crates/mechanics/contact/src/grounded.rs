//! A robot over level ground: where it touches, its contact problem, and one step in time.
//!
//! Points of bodies may touch the plane z = 0. A step of length h by Moreau's scheme, with the contacts that are closed at its start:
//!
//! ```text
//! v_free = v + h M⁻¹ (τ − C)        c = J v_free + G λ        v⁺ = v_free + M⁻¹ Jᵀ λ        q⁺ = q ⊕ h v⁺
//! ```
//!
//! Rows of a contact: z, x, y of the world. Units: SI; λ in N·s. Source: J. J. Moreau, *Unilateral contact and dry friction in finite freedom
//! dynamics* (1988), section 10, at level ground. It allocates.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use crate::solution::Solution;
use crate::solver::{Solver, Unsupported};
use featherbench_dynamics::{DimensionError, Jacobian, Kinematics, NotPositiveDefinite, bias_force, mass_matrix};
use featherbench_model::{Model, integrate};
use featherbench_spatial::Vec3;
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// A point of a body that may touch the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// A name for messages.
    pub name: String,
    /// The compiled body ([`Model::described`] gives it).
    pub body: usize,
    /// The point in the described axes of the body, m.
    pub point: [f64; 3],
    /// μ.
    pub friction: f64,
    /// Newton's coefficient of restitution.
    pub restitution: f64,
}

/// A robot over the plane z = 0.
#[derive(Clone, Debug)]
pub struct Grounded<'a> {
    model: &'a Model<f64>,
    touches: Vec<Touch>,
    /// How far above the ground a point counts as closed, m.
    pub reach: f64,
}

/// A state one step later.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepped {
    /// The configuration.
    pub q: Vec<f64>,
    /// The velocity.
    pub v: Vec<f64>,
    /// The solver's answer, where a point was closed.
    pub solution: Option<Solution>,
}

/// Why there is no contact problem of a robot.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GroundedError {
    /// An argument has the wrong size, or a touch is on no body.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// A number of the state is NaN or infinite.
    #[error("{what} number {index} is not finite; look for NaN in what computes it")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Where the number stands in it.
        index: usize,
    },
    /// The joint-space inertia matrix is not positive definite.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
    /// The numbers are no contact problem.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The solver does not take such a problem.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// The solver has no answer.
    #[error("{solver} has no answer: {status}; the state is kept")]
    NoAnswer {
        /// The solver's name.
        solver: &'static str,
        /// What it says.
        status: &'static str,
    },
}

/// Where a touch is, in world axes.
struct Place {
    /// From the body's origin to the point, m.
    arm: Vec3<f64>,
    /// The body's origin, m.
    origin: Vec3<f64>,
}

impl<'a> Grounded<'a> {
    /// A robot with these points. A point counts as closed up to 1e-9 m above the ground.
    pub fn new(model: &'a Model<f64>, touches: Vec<Touch>) -> Self {
        Self { model, touches, reach: 1e-9 }
    }

    /// The points that may touch.
    pub fn touches(&self) -> &[Touch] {
        &self.touches
    }

    fn places(&self, q: &[f64]) -> Result<Vec<Place>, GroundedError> {
        expect_finite("configuration q", q)?;
        let still = vec![0.0; self.model.topology.nv()];
        let mut kinematics = Kinematics::new(&self.model.topology);
        kinematics.run(self.model, q, &still, &still)?;
        let found = self.touches.iter().map(|touch| {
            let what = "bodies, for the one of a touch";
            let missing = DimensionError { what, expected: touch.body + 1, found: self.model.topology.bodies() };
            let place = kinematics.body(touch.body).ok_or(missing)?.placement;
            Ok(Place { arm: place.rotation * Vec3::from_array(touch.point), origin: place.translation })
        });
        found.collect()
    }

    /// The contact problem of a step of length `step` from `q`, `v` with joint forces `tau`; `None` where no point is closed.
    ///
    /// # Errors
    /// [`GroundedError`]: an argument does not fit, M is not positive definite, or a number is not finite.
    pub fn problem(&self, name: &str, q: &[f64], v: &[f64], tau: &[f64], step: f64) -> Result<Option<Problem>, GroundedError> {
        let places = self.places(q)?;
        let closed: Vec<usize> = (0..places.len()).filter(|k| places[*k].arm.z + places[*k].origin.z <= self.reach).collect();
        if closed.is_empty() {
            return Ok(None);
        }
        let n = self.model.topology.nv();
        let mut jacobian = DMatrix::zeros(3 * closed.len(), n);
        let mut of_body = Jacobian::new(&self.model.topology);
        for (k, &touch) in closed.iter().enumerate() {
            let arm = places[touch].arm;
            for (dof, column) in of_body.run(self.model, q, self.touches[touch].body)?.iter().enumerate() {
                let moved = column.lin + column.ang.cross(arm);
                for (row, entry) in [moved.z, moved.x, moved.y].into_iter().enumerate() {
                    jacobian[(3 * k + row, dof)] = entry;
                }
            }
        }
        let contacts = closed.iter().map(|touch| self.touches[*touch].contact()).collect();
        let free = DVector::from_vec(self.free(q, v, tau, step)?);
        let before = &jacobian * DVector::from_column_slice(v);
        let mass = mass_matrix(self.model, q)?.to_dense();
        let problem = Problem::from_mechanism(name, Level::Impulse, contacts, Mechanism { mass, jacobian, free })?;
        Ok(Some(problem.with_before(before)?))
    }

    /// `v + h M⁻¹ (τ − C)`.
    fn free(&self, q: &[f64], v: &[f64], tau: &[f64], step: f64) -> Result<Vec<f64>, GroundedError> {
        for (what, numbers) in [("configuration q", q), ("velocity v", v), ("joint forces tau", tau), ("length of the step", &[step])] {
            expect_finite(what, numbers)?;
        }
        let mut x = bias_force(self.model, q, v)?;
        DimensionError::expect("joint forces tau", x.len(), tau.len())?;
        for (x, tau) in x.iter_mut().zip(tau) {
            *x = step * (tau - *x);
        }
        mass_matrix(self.model, q)?.into_ltdl()?.solve(&mut x)?;
        Ok(x.iter().zip(v).map(|(change, v)| v + change).collect())
    }

    /// A step in time.
    ///
    /// ```
    /// use featherbench_contact::{Grounded, Newton, Touch};
    /// use featherbench_model::{Model, neutral};
    /// use featherbench_robots::Family;
    /// // A quadruped half a metre above the ground, and a stick from its trunk down to the ground.
    /// let model: Model<f64> = Model::build(&Family::parse("quadruped")?.generate()?)?;
    /// let mut q = neutral(&model.topology);
    /// q[2] = 0.5;
    /// let touch = Touch { name: "stick".into(), body: 0, point: [0.0, 0.0, -0.5], friction: 0.5, restitution: 0.0 };
    /// let robot = Grounded::new(&model, vec![touch]);
    /// let still = vec![0.0; model.topology.nv()];
    /// let stepped = robot.step(&q, &still, &still, 1e-3, &Newton::default())?;
    /// // It would fall, and the stick pushes back.
    /// let answer = stepped.solution.ok_or("nothing touches")?;
    /// assert!(answer.point().ok_or("no answer")?.impulses[0] > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`GroundedError`]: as [`Grounded::problem`], or the solver has no single answer.
    pub fn step(&self, q: &[f64], v: &[f64], tau: &[f64], step: f64, solver: &dyn Solver) -> Result<Stepped, GroundedError> {
        let mut v_next = self.free(q, v, tau, step)?;
        let mut solution = None;
        if let Some(problem) = self.problem("step", q, v, tau, step)? {
            let answer = solver.solve(&problem)?;
            let no_answer = GroundedError::NoAnswer { solver: solver.name(), status: answer.status() };
            let impulses = &answer.point().ok_or(no_answer)?.impulses;
            let mut change = vec![0.0; v.len()];
            if let Some(Mechanism { jacobian, .. }) = problem.mechanism() {
                change.copy_from_slice(jacobian.tr_mul(impulses).as_slice());
            }
            mass_matrix(self.model, q)?.into_ltdl()?.solve(&mut change)?;
            v_next.iter_mut().zip(&change).for_each(|(v, change)| *v += change);
            solution = Some(answer);
        }
        let way: Vec<f64> = v_next.iter().map(|v| step * v).collect();
        Ok(Stepped { q: integrate(&self.model.topology, q, &way)?, v: v_next, solution })
    }
}

fn expect_finite(what: &'static str, numbers: &[f64]) -> Result<(), GroundedError> {
    numbers.iter().position(|x| !x.is_finite()).map_or(Ok(()), |index| Err(GroundedError::NotFinite { what, index }))
}

impl Touch {
    fn contact(&self) -> Contact {
        Contact::spatial(&*self.name, self.friction).with_restitution(self.restitution)
    }
}
