//! The trait [`ContactSolver`]: an engine that solves contact problems as such. Oracles offer it by the operations `contact_problems` and
//! `solve_contacts`.

use crate::{Evaluation, NoAnswer};

/// Problems of one size: find impulses λ whose velocities c = G λ + b obey Signorini's and Coulomb's laws. A contact has three rows: normal,
/// tangent, tangent.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ContactProblems {
    /// How many there are.
    pub count: usize,
    /// Contacts of each.
    pub contacts: usize,
    /// G of each, row by row.
    pub delassus: Vec<f64>,
    /// b of each.
    pub free: Vec<f64>,
    /// μ of each contact of each.
    pub friction: Vec<f64>,
}

/// An engine that solves contact problems.
pub trait ContactSolver {
    /// Its methods, the usual one first.
    fn contact_methods(&self) -> Vec<String>;

    /// Its methods for the convex relaxation: minimise ½λᵀGλ + bᵀλ over the friction cones. They are prepared like the others. The velocities
    /// of a relaxation are unique.
    fn contact_relaxations(&self) -> Vec<String> {
        Vec::new()
    }

    /// Makes a method ready for these problems. A range of [`Evaluation::run`] is one of problems, which begin again at their end. What is
    /// read are the impulses of the last round, problem after problem. Problems differ, so a block of timed calls has whole rounds of them.
    /// Every solution begins at impulses of zero; a clock has the time of the engine's call alone.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the method, or refuses a problem.
    fn prepare_contacts<'a>(
        &'a self,
        problems: &'a ContactProblems,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer>;
}
