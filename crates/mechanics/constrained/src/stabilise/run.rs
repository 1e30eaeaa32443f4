//! A run in time with loops, and its drift.
//!
//! Each step is one of Runge and Kutta's of order 4 on the configuration space, with v̇ of a [`Method`]. What the stabilisation adds is in
//! its table. The drift of each step is measured and returned: |φ| and |φ̇|, and the energy. Frames, shapes, units: as [`Constrained`].

use super::projection::Projection;
use crate::constraint::Constraints;
use crate::error::Error;
use crate::rows::Rows;
use crate::solve::{Constrained, Method, Outcome};
use featherbench_dynamics::integrate::{IntegrationError, Integrator, RungeKutta4};
use featherbench_dynamics::{DimensionError, energy};
use featherbench_model::Model;
use featherbench_spatial::largest;

/// What keeps the loops closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stabilisation {
    /// Nothing: a* = 0.
    None,
    /// a* = −2α φ̇ − β² φ. With α = β errors decay without oscillation, as e^(−αt).
    ///
    /// Source: J. Baumgarte, *Stabilization of constraints and integrals of motion in dynamical systems* (1972).
    Baumgarte {
        /// Damping α, 1/s; not negative.
        alpha: f64,
        /// Stiffness β, 1/s; not negative.
        beta: f64,
    },
    /// q and v are projected after each step, and before each acceleration.
    ///
    /// Rows that are redundant on the constraints are not so beside them, and the stages of a step lie h² beside them.
    Projection(Projection),
}

impl Stabilisation {
    /// a* of a row with this residual and rate.
    fn ask(self, phi: f64, rate: f64) -> f64 {
        match self {
            Self::Baumgarte { alpha, beta } => -2.0 * alpha * rate - beta * beta * phi,
            Self::None | Self::Projection(_) => 0.0,
        }
    }

    fn check(self) -> Result<(), Error> {
        let Self::Baumgarte { alpha, beta } = self else { return Ok(()) };
        for (parameter, value) in [("alpha", alpha), ("beta", beta)] {
            let good = value.is_finite() && value >= 0.0;
            if !good {
                return Err(Error::Parameter { parameter, value, demand: "it must be finite and not negative" });
            }
        }
        Ok(())
    }
}

/// How far the state is from the constraints after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// The time, s.
    pub time: f64,
    /// The largest |φ|, m and rad.
    pub position: f64,
    /// The largest |φ̇|, m/s and rad/s.
    pub velocity: f64,
    /// Kinetic and potential energy, J.
    pub energy: f64,
}

/// The end of a run, and its drift.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The configuration at the end.
    pub q: Vec<f64>,
    /// The velocity at the end.
    pub v: Vec<f64>,
    /// The drift at the beginning and after each step.
    pub drift: Vec<Drift>,
}

impl Run {
    /// The largest |φ| of all steps.
    pub fn position_drift(&self) -> f64 {
        largest(self.drift.iter().map(|drift| drift.position))
    }

    /// The largest change of the energy since the beginning, J.
    pub fn energy_drift(&self) -> f64 {
        let first = self.drift.first().map_or(0.0, |drift| drift.energy);
        largest(self.drift.iter().map(|drift| drift.energy - first))
    }
}

/// Joint forces at a time, configuration and velocity: added to the slice, which is zero.
pub type Forces<'a> = dyn Fn(f64, &[f64], &[f64], &mut [f64]) + 'a;

/// What is run: a model with constraints, the forces on it, and how.
#[derive(Clone, Copy)]
pub struct Simulation<'a> {
    /// The model.
    pub model: &'a Model<f64>,
    /// Its constraints.
    pub constraints: &'a Constraints,
    /// The joint forces.
    pub forces: &'a Forces<'a>,
    /// The method of constrained dynamics.
    pub method: &'a dyn Method,
    /// What keeps the loops closed.
    pub stabilisation: Stabilisation,
}

impl Simulation<'_> {
    /// The run from a state at t = 0 by `steps` steps of length `step`. It is taken as it is: [`Projection`] makes one that closes the
    /// loops.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit or is not finite, a parameter makes no sense, or what the method or the projection meets on the
    /// way. An iterative method that reaches its cap is [`Error::NotConverged`].
    ///
    /// ```
    /// use featherbench_constrained::{Kkt, stabilise::{Simulation, Stabilisation}, systems::Ladder};
    /// let ladder = Ladder::default();
    /// let four_bar = ladder.mechanism()?;
    /// let simulation = Simulation {
    ///     model: &four_bar.model,
    ///     constraints: &four_bar.constraints,
    ///     forces: &|_, _, _, _| (),
    ///     method: &Kkt::default(),
    ///     stabilisation: Stabilisation::Baumgarte { alpha: 10.0, beta: 10.0 },
    /// };
    /// let run = simulation.run(&ladder.spread(0.5), &ladder.spread(0.0), 1e-3, 10)?;
    /// assert!(run.position_drift() < 1e-12 && run.energy_drift() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run(&self, q: &[f64], v: &[f64], step: f64, steps: usize) -> Result<Run, Error> {
        self.stabilisation.check()?;
        let good = step.is_finite() && step != 0.0;
        if !good {
            return Err(Error::Parameter { parameter: "step", value: step, demand: "it must be finite and not zero" });
        }
        let (model, constraints) = (self.model, self.constraints);
        let mut dynamics = Constrained::new(model, constraints)?;
        let mut rows = Rows::new(constraints);
        let mut integrator = RungeKutta4::new(&model.topology);
        let (mut q, mut v, mut tau) = (q.to_vec(), v.to_vec(), vec![0.0; model.topology.nv()]);
        let mut drift = vec![self.measure(&mut rows, 0.0, &q, &v)?];
        for k in 0..steps {
            let time = k as f64 * step;
            // The integrator's errors are those of trees. So an error of ours waits here, and the integrator ends at the NaN.
            let mut failed = None;
            let mut accelerate = |t: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
                match self.acceleration(&mut dynamics, &mut tau, t, q, v) {
                    Ok(found) => a.copy_from_slice(&found),
                    Err(error) => {
                        failed = failed.take().or(Some(error));
                        a.fill(f64::NAN);
                    }
                }
                Ok(())
            };
            let stepped = integrator.step(&mut accelerate, time, step, &mut q, &mut v);
            if let Some(error) = failed {
                return Err(error);
            }
            stepped.map_err(|error| match error {
                IntegrationError::Dynamics(error) => Error::from(error),
                _ => Error::NotFinite { what: "state after step", index: k },
            })?;
            self.project(&mut q, &mut v)?;
            drift.push(self.measure(&mut rows, (k + 1) as f64 * step, &q, &v)?);
        }
        Ok(Run { q, v, drift })
    }

    /// The state on the constraints, where that is asked for.
    fn project(&self, q: &mut [f64], v: &mut [f64]) -> Result<(), Error> {
        if let Stabilisation::Projection(projection) = self.stabilisation {
            projection.configuration(self.model, self.constraints, q)?;
            projection.velocity(self.model, self.constraints, q, v)?;
        }
        Ok(())
    }

    fn acceleration(&self, dynamics: &mut Constrained<'_>, tau: &mut [f64], t: f64, q: &[f64], v: &[f64]) -> Result<Vec<f64>, Error> {
        let (mut on_q, mut on_v) = (q.to_vec(), v.to_vec());
        self.project(&mut on_q, &mut on_v)?;
        let (q, v) = (&*on_q, &*on_v);
        tau.fill(0.0);
        (self.forces)(t, q, v, tau);
        let equations = dynamics.equations(q, v, tau, |_, phi, rate| self.stabilisation.ask(phi, rate))?;
        let solution = self.method.solve(&equations)?;
        match solution.outcome {
            Outcome::Solved | Outcome::LeastSquares => Ok(solution.acceleration),
            Outcome::CapReached => Err(Error::NotConverged {
                what: "the method of constrained dynamics",
                iterations: solution.iterations,
                residual: solution.residual,
            }),
        }
    }

    fn measure(&self, rows: &mut Rows<f64>, time: f64, q: &[f64], v: &[f64]) -> Result<Drift, Error> {
        DimensionError::expect("velocity v", self.model.topology.nv(), v.len())?;
        rows.run(self.model, self.constraints, q, v)?;
        let position = largest(rows.residuals());
        let mut rate = vec![0.0; self.constraints.rows()];
        rows.multiply(v, &mut rate)?;
        let velocity = largest(rate);
        let energies = energy(self.model, q, v)?;
        Ok(Drift { time, position, velocity, energy: energies.kinetic + energies.potential })
    }
}
