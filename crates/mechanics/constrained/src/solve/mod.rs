//! Constrained forward dynamics: v̇ and λ of
//!
//! ```text
//! M v̇ + h = τ + Jᵀ λ        J v̇ + J̇v = a*
//! ```
//!
//! | method | what it factors | redundant rows | accelerations that contradict |
//! |---|---|---|---|
//! | [`Kkt`] | M = RᵀR by the tree, then Y = R⁻ᵀJᵀ with column pivots | by the length of what is left of Y | error |
//! | [`RangeSpace`] | G = J M⁻¹ Jᵀ, by propagation, with diagonal pivots | by the pivot of G | error |
//! | [`Proximal`] | G + μ 1, repeatedly | need no decision | the least-squares answer, with its residual |
//!
//! λ of redundant rows is not unique; v̇ and Jᵀλ are. The direct methods give dependent rows λ = 0.

mod kkt;
mod proximal;
mod range_space;
pub(crate) mod rank;

pub use kkt::Kkt;
pub use proximal::Proximal;
pub use range_space::RangeSpace;

use crate::constraint::Constraints;
use crate::error::Error;
use crate::rows::{Rows, expect_finite};
use featherbench_dynamics::{Bias, Crba, DimensionError, TreeSparse};
use featherbench_model::Model;
use featherbench_spatial::largest;

/// What an acceleration may miss, of the size of the terms of a row: the direct methods refuse more. Half of the digits: near a singular
/// configuration the others are lost.
pub const CONSISTENCY: f64 = 1e-8;

/// The equations at a state.
#[derive(Clone, Copy, Debug)]
pub struct Equations<'a> {
    /// The model.
    pub model: &'a Model<f64>,
    /// The constraints.
    pub constraints: &'a Constraints,
    /// Their rows at the state.
    pub rows: &'a Rows<f64>,
    /// M.
    pub mass: &'a TreeSparse<f64>,
    /// q.
    pub q: &'a [f64],
    /// τ − h.
    pub force: &'a [f64],
    /// a* − J̇v: what J v̇ must be.
    pub target: &'a [f64],
}

/// How a solution came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The equations hold to the method's tolerance.
    Solved,
    /// The accelerations asked for contradict each other: v̇ misses them by as little as possible (in the norm of the rows). λ is that of
    /// the last iteration, and has no limit.
    LeastSquares,
    /// The cap of the iterations was reached before either was known.
    CapReached,
}

/// An answer, with what it misses.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// v̇.
    pub acceleration: Vec<f64>,
    /// λ, one number per row.
    pub multipliers: Vec<f64>,
    /// How it came about.
    pub outcome: Outcome,
    /// The rank that the method found; none where it decides no rank.
    pub rank: Option<usize>,
    /// Iterations; 1 of a direct method.
    pub iterations: usize,
    /// μ of the proximal method.
    pub mu: Option<f64>,
    /// The largest |J v̇ + J̇v − a*|, in the unit of its row per s².
    pub residual: f64,
    /// The largest |M v̇ + h − τ − Jᵀ λ|, N or N·m.
    pub imbalance: f64,
}

/// A method of constrained forward dynamics.
pub trait Method {
    /// Its name.
    fn name(&self) -> &'static str;

    /// v̇ and λ.
    ///
    /// # Errors
    /// [`Error`]: a dof meets no inertia, a parameter makes no sense, or accelerations contradict each other where the method does not
    /// report it.
    fn solve(&self, equations: &Equations<'_>) -> Result<Solution, Error>;
}

impl Equations<'_> {
    /// `c = target − J a`.
    pub(crate) fn shortfall(&self, a: &[f64]) -> Result<Vec<f64>, Error> {
        let mut c = vec![0.0; self.target.len()];
        self.rows.multiply(a, &mut c)?;
        c.iter_mut().zip(self.target).for_each(|(c, target)| *c = target - *c);
        Ok(c)
    }

    /// `Jᵀ λ`.
    pub(crate) fn constraint_force(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.force.len()];
        for (row, lambda) in multipliers.iter().enumerate() {
            force.iter_mut().zip(self.rows.jacobian_row(row)).for_each(|(f, j)| *f = j.mul_add(*lambda, *f));
        }
        force
    }

    /// The size of the terms of a row, the largest of all: |target| + Σ |J| (|v̇| + |v̇ without constraints|).
    pub(crate) fn scale(&self, a: &[f64], free: &[f64]) -> f64 {
        let row_scale = |(row, target): (usize, &f64)| {
            let terms = self.rows.jacobian_row(row).iter().zip(a.iter().zip(free)).map(|(j, (a, free))| j.abs() * (a.abs() + free.abs()));
            target.abs() + terms.sum::<f64>()
        };
        largest(self.target.iter().enumerate().map(row_scale))
    }

    /// The solution with its residuals.
    pub(crate) fn judged(&self, acceleration: Vec<f64>, multipliers: Vec<f64>) -> Result<Solution, Error> {
        expect_finite("acceleration", &acceleration)?;
        expect_finite("multipliers", &multipliers)?;
        let residual = largest(self.shortfall(&acceleration)?);
        let mut inertial = vec![0.0; acceleration.len()];
        self.mass.mul(&acceleration, &mut inertial)?;
        let forces = self.constraint_force(&multipliers);
        let rest = inertial.iter().zip(self.force.iter().zip(forces)).map(|(m, (force, constraint))| m - force - constraint);
        let imbalance = largest(rest);
        Ok(Solution { acceleration, multipliers, outcome: Outcome::Solved, rank: None, iterations: 1, mu: None, residual, imbalance })
    }

    /// The solution of a direct method of this rank, unless it misses an acceleration.
    pub(crate) fn consistent(&self, solution: Solution, free: &[f64], rank: usize) -> Result<Solution, Error> {
        let within = solution.residual <= CONSISTENCY * self.scale(&solution.acceleration, free);
        if within {
            return Ok(Solution { rank: Some(rank), ..solution });
        }
        let misses = self.shortfall(&solution.acceleration)?;
        let largest = |(a, b): (&(usize, f64), &(usize, f64))| a.1.abs().total_cmp(&b.1.abs());
        let worst = misses.iter().copied().enumerate().max_by(|a, b| largest((a, b)));
        let (row, residual) = worst.unwrap_or((0, solution.residual));
        let constraint = self.constraints.name_of_row(row).to_owned();
        Err(Error::Inconsistent { constraint, row, residual: residual.abs(), rank, rows: misses.len() })
    }
}

/// Constrained forward dynamics of a model: the workspace that forms the equations.
#[derive(Clone, Debug)]
pub struct Constrained<'a> {
    model: &'a Model<f64>,
    constraints: &'a Constraints,
    rows: Rows<f64>,
    crba: Crba<f64>,
    bias: Bias<f64>,
    mass: TreeSparse<f64>,
    force: Vec<f64>,
    target: Vec<f64>,
}

impl<'a> Constrained<'a> {
    /// A workspace for a model and its constraints.
    ///
    /// # Errors
    /// [`Error::OtherTree`] when the constraints were made for another tree.
    pub fn new(model: &'a Model<f64>, constraints: &'a Constraints) -> Result<Self, Error> {
        if model.topology != *constraints.topology() {
            return Err(Error::OtherTree);
        }
        let topology = &model.topology;
        Ok(Self {
            rows: Rows::new(constraints),
            crba: Crba::new(topology),
            bias: Bias::new(topology),
            mass: TreeSparse::new(topology),
            force: vec![0.0; topology.nv()],
            target: vec![0.0; constraints.rows()],
            model,
            constraints,
        })
    }

    /// The equations at a state with joint forces `tau`. `ask` gives a* of each row from its residual φ and rate φ̇.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit or is not finite, or a weld is half a turn off.
    pub fn equations<'b>(
        &'b mut self,
        q: &'b [f64],
        v: &[f64],
        tau: &[f64],
        ask: impl Fn(usize, f64, f64) -> f64,
    ) -> Result<Equations<'b>, Error> {
        DimensionError::expect("joint forces tau", self.model.topology.nv(), tau.len())?;
        expect_finite("joint forces tau", tau)?;
        self.rows.run(self.model, self.constraints, q, v)?;
        self.crba.run(self.model, q, &mut self.mass)?;
        self.bias.run(self.model, q, v, None, &mut self.force)?;
        self.force.iter_mut().zip(tau).for_each(|(h, tau)| *h = tau - *h);
        expect_finite("joint forces less bias forces", &self.force)?;
        self.rows.multiply(v, &mut self.target)?;
        for (row, (target, at)) in self.target.iter_mut().zip(self.rows.rows()).enumerate() {
            *target = ask(row, at.residual, *target) - at.bias;
        }
        expect_finite("accelerations asked for", &self.target)?;
        let Self { model, constraints, rows, mass, force, target, .. } = self;
        Ok(Equations { model, constraints, rows, mass, q, force, target })
    }

    /// v̇ and λ at a state, with a* = 0.
    ///
    /// # Errors
    /// [`Error`]: as [`Constrained::equations`] and [`Method::solve`].
    ///
    /// ```
    /// use featherbench_constrained::{Attachment, Constrained, Constraint, Constraints, Kkt};
    /// use featherbench_model::Model;
    /// use featherbench_robots::Family;
    /// let model: Model<f64> = Model::build(&Family::parse("chain:n=4")?.generate()?)?;
    /// // The tip is held where it happens to be: it does not accelerate.
    /// let held = Constraint::point("tip", Attachment::world([0.0; 3]), Attachment::point(3, [0.1, 0.0, 0.0]));
    /// let constraints = Constraints::new(&model.topology, vec![held])?;
    /// let mut dynamics = Constrained::new(&model, &constraints)?;
    /// let solution = dynamics.run(&[0.1, 0.5, 0.4, 0.3], &[0.0; 4], &[0.0; 4], &Kkt::default())?;
    /// assert!(solution.residual < 1e-10 && solution.imbalance < 1e-10);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run(&mut self, q: &[f64], v: &[f64], tau: &[f64], method: &dyn Method) -> Result<Solution, Error> {
        method.solve(&self.equations(q, v, tau, |_, _, _| 0.0)?)
    }
}

/// An error unless a tolerance is in [0, 1).
pub(crate) fn check_tolerance(parameter: &'static str, value: f64) -> Result<(), Error> {
    let good = (0.0..1.0).contains(&value);
    if good { Ok(()) } else { Err(Error::Parameter { parameter, value, demand: "it must be at least 0 and less than 1" }) }
}
