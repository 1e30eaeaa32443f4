//! Projection of configurations and velocities onto the constraints, in the metric of M.
//!
//! Computes, with `J M⁻¹ Jᵀ` of the rank that [`Kkt`](crate::Kkt) finds:
//!
//! ```text
//! q ← q ⊕ δ,   δ = −M⁻¹ Jᵀ (J M⁻¹ Jᵀ)⁺ φ     until |φ| ≤ tolerance, and does not fall any more
//! v ← v − M⁻¹ Jᵀ (J M⁻¹ Jᵀ)⁺ J v             once: the velocity nearest in kinetic energy
//! ```
//!
//! δ is the shortest step in the metric of M, so a configuration on the constraints is left as it is, but for rounding. Rows below `cut` of the longest are
//! taken as redundant: near a singular configuration a smaller one would ask for a large step.
//! Source: E. Eich, *Convergence results for a coordinate projection method applied to mechanical systems* (SIAM J. Numer. Anal. 30, 1993);
//! the book, section 8.3 (constraint stabilization). Convergence: quadratic where J has constant rank. Units: as [`Law`](crate::Law). It
//! allocates.

use crate::constraint::Constraints;
use crate::delassus::half_solved;
use crate::error::Error;
use crate::rows::Rows;
use crate::solve::check_tolerance;
use crate::solve::rank::Revealed;
use featherbench_dynamics::{Crba, Ltdl};
use featherbench_model::{Model, Topology};
use featherbench_spatial::largest;

/// How to project.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The largest residual |φ| that is allowed, m and rad.
    pub tolerance: f64,
    /// What a row's rest may be of the longest row, and count as redundant.
    pub cut: f64,
    /// The most iterations.
    pub iterations: usize,
    /// The longest step of one iteration, rad and m per dof: a longer one is shortened. From far away Newton's steps lead anywhere.
    pub reach: f64,
}

impl Default for Projection {
    /// |φ| ≤ 10⁻¹², cut 10⁻⁸, 50 iterations, steps of 0.5 at most.
    fn default() -> Self {
        Self { tolerance: 1e-12, cut: 1e-8, iterations: 50, reach: 0.5 }
    }
}

/// How often [`Projection::beside`] halves a step: to 10⁻⁶ of it, where Newton's method converges.
pub const HALVINGS: u32 = 20;

/// What a projection did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// The largest |φ| at the end.
    pub residual: f64,
    /// The rank of J there.
    pub rank: usize,
}

/// The workspace of a projection.
#[derive(Clone, Debug)]
struct Metric {
    rows: Rows<f64>,
    crba: Crba<f64>,
    factors: Ltdl<f64>,
}

impl Metric {
    fn new(constraints: &Constraints) -> Self {
        let topology = constraints.topology();
        Self { rows: Rows::new(constraints), crba: Crba::new(topology), factors: Ltdl::new(topology) }
    }

    /// Rows at q and v; the factors of `J M^−½`.
    fn form(&mut self, model: &Model<f64>, constraints: &Constraints, q: &[f64], v: &[f64], cut: f64) -> Result<Revealed, Error> {
        self.rows.run(model, constraints, q, v)?;
        self.crba.run(model, q, self.factors.matrix_mut())?;
        self.factors.factor()?;
        Ok(Revealed::of(half_solved(self.rows.jacobian(), &self.factors)?, cut))
    }

    /// The shortest δ with J δ = c.
    fn step(&self, revealed: &Revealed, c: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.factors.applied(Ltdl::solve_root, revealed.shortest(c).as_slice())?)
    }
}

impl Projection {
    /// Moves `q` onto the constraints.
    ///
    /// # Errors
    /// [`Error::NotConverged`] when the residual is above the tolerance after all iterations: `q` is then as it was.
    /// The others as [`Rows::run`](crate::Rows::run).
    pub fn configuration(&self, model: &Model<f64>, constraints: &Constraints, q: &mut [f64]) -> Result<Projected, Error> {
        check_tolerance("cut of the projection", self.cut)?;
        check_tolerance("tolerance of the projection", self.tolerance)?;
        let mut metric = Metric::new(constraints);
        let still = vec![0.0; model.topology.nv()];
        let (mut at, mut best) = (q.to_vec(), q.to_vec());
        let (mut iterations, mut before) = (0, f64::INFINITY);
        loop {
            let revealed = metric.form(model, constraints, &at, &still, self.cut)?;
            let phi: Vec<f64> = metric.rows.residuals().map(|residual| -residual).collect();
            let residual = largest(phi.iter().copied());
            if residual < before {
                best.copy_from_slice(&at);
            }
            // Near a singular configuration each digit counts twice: it goes on while the residual falls.
            let last = residual == 0.0 || residual > 0.5 * before || iterations == self.iterations;
            if last && (residual <= self.tolerance || before <= self.tolerance) {
                let residual = if residual < before { residual } else { before };
                q.copy_from_slice(&best);
                return Ok(Projected { iterations, residual, rank: revealed.rank() });
            }
            if iterations == self.iterations {
                return Err(Error::NotConverged { what: "the projection onto the constraints", iterations, residual });
            }
            before = residual;
            let mut step = metric.step(&revealed, &phi)?;
            let longest = largest(step.iter().copied());
            if longest > self.reach {
                step.iter_mut().for_each(|x| *x *= self.reach / longest);
            }
            at = integrated(&model.topology, &at, &step)?;
            iterations += 1;
        }
    }

    /// A configuration on the constraints near `start ⊕ step`, where `start` is on them; and how often the step was halved.
    ///
    /// Far from the constraints Newton's method may wander without end. Then the step is halved, again until it ends: at `start` it does.
    ///
    /// # Errors
    /// As [`Projection::configuration`], whose error is that after [`HALVINGS`]: `start` is then not on the constraints.
    pub fn beside(&self, model: &Model<f64>, constraints: &Constraints, start: &[f64], step: &[f64]) -> Result<(Vec<f64>, u32), Error> {
        let mut halved = 0;
        loop {
            let shorter: Vec<f64> = step.iter().map(|x| x * 0.5_f64.powi(halved as i32)).collect();
            let mut q = integrated(&model.topology, start, &shorter)?;
            match self.configuration(model, constraints, &mut q) {
                Err(Error::NotConverged { .. }) if halved < HALVINGS => halved += 1,
                Err(error) => return Err(error),
                Ok(_) => return Ok((q, halved)),
            }
        }
    }

    /// Moves `v` to the nearest velocity with J v = 0.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit or is not finite, a dof meets no inertia, or a weld is half a turn off.
    ///
    /// ```
    /// use featherbench_constrained::{stabilise::Projection, systems::Ladder};
    /// let ladder = Ladder::default();
    /// let four_bar = ladder.mechanism()?;
    /// let mut v = [1.0, 0.0, 0.0];
    /// Projection::default().velocity(&four_bar.model, &four_bar.constraints, &ladder.spread(0.5), &mut v)?;
    /// // Both cranks turn alike, and the coupler turns back.
    /// assert!((v[0] - v[2]).abs() < 1e-14 && (v[0] + v[1]).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn velocity(&self, model: &Model<f64>, constraints: &Constraints, q: &[f64], v: &mut [f64]) -> Result<(), Error> {
        check_tolerance("cut of the projection", self.cut)?;
        let mut metric = Metric::new(constraints);
        let revealed = metric.form(model, constraints, q, v, self.cut)?;
        let mut rate = vec![0.0; constraints.rows()];
        metric.rows.multiply(v, &mut rate)?;
        let change = metric.step(&revealed, &rate)?;
        v.iter_mut().zip(change).for_each(|(v, change)| *v -= change);
        Ok(())
    }
}

fn integrated(topology: &Topology, q: &[f64], step: &[f64]) -> Result<Vec<f64>, Error> {
    Ok(featherbench_model::integrate(topology, q, step)?)
}
