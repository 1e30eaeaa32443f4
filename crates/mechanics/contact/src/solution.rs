//! What a solver answers: an outcome that says what is known, never a number without it.

use crate::problem::Problem;
use crate::residual::Residuals;
use nalgebra::DVector;

/// Impulses, the velocities that they give, and how well both obey the laws.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// λ in N·s (or N), in the order of the contacts' rows.
    pub impulses: DVector<f64>,
    /// c = G λ + b in m/s (or m/s²).
    pub velocities: DVector<f64>,
    /// The residuals of the governing equations: of the true contact laws, whatever the solver's model is.
    pub residuals: Residuals,
}

impl Point {
    /// The point of these impulses.
    ///
    /// # Panics
    /// If `impulses` does not have [`Problem::rows`] numbers.
    pub fn new(problem: &Problem, impulses: DVector<f64>) -> Self {
        let (velocities, residuals) = (problem.velocities(&impulses), Residuals::of(problem, &impulses));
        Self { impulses, velocities, residuals }
    }
}

/// Why there is no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Certificate {
    /// A combination y ≥ 0 of normal velocities that no impulses within the cones make larger, and that is negative without impulses. So
    /// some contact closes, whatever the impulses are: [`crate::Lemke`] has the proof. Its signs are certain, with every rounding bounded.
    Ray {
        /// y, one number per contact.
        direction: Vec<f64>,
        /// The most that impulses within the cones, of size 1 or less at each contact, add to the combination: zero or less.
        growth: f64,
        /// The combination without impulses: less than zero.
        descent: f64,
    },
    /// Every contact mode was tried in double-double arithmetic, and each breaks a law by more than the bound of its error.
    Enumeration {
        /// How many modes.
        modes: usize,
        /// The smallest violation, free of units: how far the problem is from having a solution in one of its modes. Infinite where no
        /// mode has impulses at all.
        margin: f64,
    },
}

/// What is known when a solver ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The equations of the solver's model hold to its tolerance. For enumeration: no other mode gave a solution.
    Converged(Point),
    /// The cap on iterations was reached, and the equations do not hold. The last iterate is no answer.
    CapReached {
        /// The last iterate, for diagnosis.
        last: Point,
    },
    /// The iteration cannot go on (no step makes the residual smaller, or a number is none), and the equations do not hold. The last
    /// iterate is no answer.
    Stalled {
        /// The last iterate, for diagnosis.
        last: Point,
    },
    /// There is no solution, and this proves it.
    NoSolution(Certificate),
    /// Several solutions exist: all isolated ones, and the corners of each connected family.
    Several(Vec<Point>),
    /// No solution was found, and no proof that there is none: by Lemke's ray, or where a mode's law is broken by less than its error.
    Undecided,
}

impl Outcome {
    /// The outcome of an iteration that ended: its equations hold, or its cap was reached, or it could not go on.
    pub(crate) fn judged(point: Point, holds: bool, capped: bool) -> Self {
        match (holds, capped) {
            (true, _) => Self::Converged(point),
            (false, true) => Self::CapReached { last: point },
            (false, false) => Self::Stalled { last: point },
        }
    }
}

/// A solver's answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What is known.
    pub outcome: Outcome,
    /// Pivots, sweeps, Newton steps or modes: the solver's unit of work.
    pub iterations: usize,
    /// The size of each step of an iterative solver, for [`crate::rate::fitted`]. Empty for direct solvers.
    pub steps: Vec<f64>,
}

impl Solution {
    /// The solver's single answer: only if it converged.
    pub fn point(&self) -> Option<&Point> {
        match &self.outcome {
            Outcome::Converged(point) => Some(point),
            _ => None,
        }
    }

    /// All answers: one if the solver converged, several if it found several, none otherwise.
    pub fn points(&self) -> &[Point] {
        match &self.outcome {
            Outcome::Converged(point) => std::slice::from_ref(point),
            Outcome::Several(points) => points,
            _ => &[],
        }
    }

    /// The outcome as one word of a row: `converged`, `cap_reached`, `stalled`, `no_solution`, `several` or `undecided`.
    pub fn status(&self) -> &'static str {
        match self.outcome {
            Outcome::Converged(_) => "converged",
            Outcome::CapReached { .. } => "cap_reached",
            Outcome::Stalled { .. } => "stalled",
            Outcome::NoSolution(_) => "no_solution",
            Outcome::Several(_) => "several",
            Outcome::Undecided => "undecided",
        }
    }
}
