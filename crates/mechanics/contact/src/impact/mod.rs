//! Impacts with a named law each, and simultaneous impacts as sequences.

mod planar;
mod sequence;

pub use sequence::{Orders, Sequence, orders, sequence};

use crate::problem::{Level, Problem};
use crate::solution::Outcome;
use crate::solver::{Enumeration, Newton, Solver, Unsupported};
use nalgebra::DVector;
use thiserror::Error;

/// An impact law: what the coefficient of restitution e means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Newton: c_n⁺ + e c_n⁻ obeys Signorini's law, and c_t⁺ Coulomb's. It may create energy with friction (Kane's puzzle).
    Newton,
    /// Poisson: the normal impulse of restitution is e times that of compression. Coulomb's law holds along the impact (Routh, Keller).
    Poisson,
    /// Stronge: the work of the normal impulse in restitution is −e² times that in compression. Coulomb's law holds along the impact.
    Stronge,
    /// Moreau: c⁺ + e c⁻ obeys Signorini's and Coulomb's laws, with e in the normal and `tangential` in the tangent rows. If both are equal
    /// at all contacts, no energy is created.
    Moreau {
        /// The tangential coefficient of restitution, in [0, 1].
        tangential: f64,
    },
}

impl Law {
    /// The law's name in rows and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Newton => "newton",
            Self::Poisson => "poisson",
            Self::Stronge => "stronge",
            Self::Moreau { .. } => "moreau",
        }
    }
}

/// The end of an impact.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// The impulses in N·s.
    pub impulses: DVector<f64>,
    /// The contact velocities after it, in m/s.
    pub velocities: DVector<f64>,
    /// The change of kinetic energy in J.
    pub energy: f64,
}

/// Why an impact has no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoImpact {
    /// The solver does not take the problem.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// The law is not defined for this problem here.
    #[error("the law '{law}' {reason}")]
    Law {
        /// The law's name.
        law: &'static str,
        /// What it would need.
        reason: &'static str,
    },
    /// No impulse obeys the law.
    #[error("no impulse obeys the law '{law}'")]
    NoSolution {
        /// The law's name.
        law: &'static str,
    },
    /// Several post-impact velocities obey the law.
    #[error("{count} impulses with different velocities obey the law '{law}'")]
    Several {
        /// The law's name.
        law: &'static str,
        /// How many.
        count: usize,
    },
    /// The solver did not converge.
    #[error("the solver did not converge under the law '{law}': {status}")]
    NotConverged {
        /// The law's name.
        law: &'static str,
        /// The solver's status.
        status: &'static str,
    },
}

/// The impact of a problem under a law. The velocities before it are the problem's free velocity b.
///
/// ```
/// use featherbench_contact::impact::{Law, impact};
/// use featherbench_contact::systems::Kane;
/// // Kane's puzzle: under Newton's law with Coulomb's friction the double pendulum gains energy.
/// let problem = Kane::default().problem()?;
/// assert!(impact(&problem, Law::Newton)?.energy > 0.0);
/// assert!(impact(&problem, Law::Stronge)?.energy < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NoImpact`] says why there is no answer. Poisson's and Stronge's laws take one planar or frictionless contact.
pub fn impact(problem: &Problem, law: Law) -> Result<Impact, NoImpact> {
    if problem.level() != Level::Impulse {
        return Err(NoImpact::Law { law: law.name(), reason: "needs a problem at the level of impulses" });
    }
    let impulses = match law {
        Law::Newton => coulomb(problem, law, 0.0)?,
        Law::Moreau { tangential } => coulomb(problem, law, tangential)?,
        Law::Poisson | Law::Stronge => planar::impulses(problem, law)?,
    };
    Ok(Impact { velocities: problem.velocities(&impulses), energy: problem.energy_change(&impulses), impulses })
}

/// Solves Coulomb's and Signorini's laws for c⁺ + E c⁻.
fn coulomb(problem: &Problem, law: Law, tangential: f64) -> Result<DVector<f64>, NoImpact> {
    if !(0.0..=1.0).contains(&tangential) {
        return Err(NoImpact::Law { law: law.name(), reason: "needs a tangential coefficient in [0, 1]" });
    }
    let mut free = problem.free().clone();
    for (index, contact) in problem.contacts().iter().enumerate() {
        let range = problem.range(index);
        // A contact that does not close has no impact of its own.
        if problem.free()[range.start] < 0.0 {
            free[range.start] += contact.restitution * problem.free()[range.start];
            range.skip(1).for_each(|row| free[row] += tangential * problem.free()[row]);
        }
    }
    let contacts = problem.contacts().iter().map(|contact| contact.clone().with_restitution(0.0)).collect();
    let shifted = Problem::from_delassus(problem.name(), Level::Impulse, contacts, problem.delassus().clone(), free)
        .map_err(|_| NoImpact::Law { law: law.name(), reason: "needs velocities whose sum with the restitution is finite" })?;
    // All solutions where they can be enumerated in short time; one otherwise.
    let solution = match (Enumeration { modes: 1 << 12 }).solve(&shifted) {
        Ok(solution) => solution,
        Err(_) => Newton::default().solve(&shifted)?,
    };
    match &solution.outcome {
        Outcome::Converged(point) => Ok(point.impulses.clone()),
        Outcome::NoSolution(_) => Err(NoImpact::NoSolution { law: law.name() }),
        Outcome::Several(points) => {
            let scale = shifted.scales().velocity;
            // Impulses of more rows than dofs are not unique, but what they do is.
            let same = points.iter().all(|point| (&point.velocities - &points[0].velocities).amax() <= 1e-9 * scale);
            if same { Ok(points[0].impulses.clone()) } else { Err(NoImpact::Several { law: law.name(), count: points.len() }) }
        }
        _ => Err(NoImpact::NotConverged { law: law.name(), status: solution.status() }),
    }
}
