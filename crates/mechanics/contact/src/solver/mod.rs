//! Solvers of contact problems behind one trait.
//!
//! | solver | kind | equations | contacts | knows |
//! |---|---|---|---|---|
//! | [`Lemke`] | direct | Coulomb; pyramids for round cones | all | one solution, a proof that there is none, or undecided |
//! | [`Enumeration`] | direct, double-double | Coulomb | planar, sliding, frictionless; one spatial | all solutions, a proof that there is none, or undecided |
//! | [`Newton`] | semismooth Newton | Coulomb | all but pyramids | one solution |
//! | [`GaussSeidel`] | first order | Coulomb | all but pyramids | one solution |
//! | [`BlockGaussSeidel`] | first order | Coulomb | no pyramids, no sliding direction | one solution |
//! | [`Admm`] | first order | Coulomb | no pyramids, no sliding direction | one solution |
//! | [`Convex`] | semismooth Newton | convex relaxation | no pyramids, no sliding direction | its one velocity |
//! | [`Penalty`] | semismooth Newton | compliant contacts | no pyramids, no sliding direction | one solution |

mod admm;
mod block;
mod enumeration;
mod gauss_seidel;
mod lcp;
mod lemke;
mod newton;
mod spatial;
mod standard;

pub use admm::Admm;
pub use block::{BlockGaussSeidel, Blocks};
pub use enumeration::Enumeration;
pub use gauss_seidel::GaussSeidel;
pub use lcp::Lcp;
pub use lemke::Lemke;
pub use newton::{Convex, Newton, Penalty};

use crate::problem::Problem;
use crate::solution::Solution;
use thiserror::Error;

/// A problem that a solver does not take.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unsupported {
    /// A kind of contact.
    #[error("{solver} does not take contact '{contact}': {reason}")]
    Contact {
        /// The solver's name.
        solver: &'static str,
        /// The contact's name.
        contact: String,
        /// What it does not take.
        reason: &'static str,
    },
    /// Too many contacts.
    #[error("{solver} would try {modes:e} modes; its limit is {limit:e}")]
    TooMany {
        /// The solver's name.
        solver: &'static str,
        /// How many modes the problem has.
        modes: f64,
        /// The most that it tries.
        limit: f64,
    },
    /// A setting that makes no sense.
    #[error("{solver}: the setting '{setting}' is {value}; {advice}")]
    Setting {
        /// The solver's name.
        solver: &'static str,
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What to do.
        advice: &'static str,
    },
}

/// A solver of contact problems.
///
/// ```
/// use featherbench_contact::systems::PainleveRod;
/// use featherbench_contact::{Enumeration, Lemke, Solver};
/// // The sliding rod with μ = 1.5 at rest in rotation: no force obeys the laws.
/// let problem = PainleveRod { friction: 1.5, ..PainleveRod::default() }.problem()?;
/// for solver in [&Lemke::default() as &dyn Solver, &Enumeration::default()] {
///     assert_eq!(solver.solve(&problem)?.status(), "no_solution", "{}", solver.name());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Solver {
    /// The name in rows and messages.
    fn name(&self) -> &'static str;

    /// Solves a problem.
    ///
    /// # Errors
    /// [`Unsupported`] if the solver does not take such a problem. That no solution was found is no error but an outcome.
    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported>;
}

/// Every solver with its usual settings.
pub fn all() -> Vec<Box<dyn Solver>> {
    vec![
        Box::new(Lemke::default()),
        Box::new(Enumeration::default()),
        Box::new(Newton::default()),
        Box::new(GaussSeidel::default()),
        Box::new(BlockGaussSeidel::default()),
        Box::new(Admm::default()),
        Box::new(Convex::default()),
        Box::new(Penalty::default()),
    ]
}

/// Checks that a setting is positive and finite.
fn positive(solver: &'static str, setting: &'static str, value: f64) -> Result<(), Unsupported> {
    let advice = "give a positive number";
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Unsupported::Setting { solver, setting, value, advice }) }
}
