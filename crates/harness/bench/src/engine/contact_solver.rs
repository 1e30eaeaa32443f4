//! The trait [`ContactSolver`]: an engine that solves contact problems as such. Oracles offer it by the operations `contact_problems` and
//! `solve_contacts`, and steps of a robot on its contacts by `contact_steps` and `solve_contact_steps`.

use crate::{Evaluation, NoAnswer};
use featherbench_model::Description;
use serde_json::Value;

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

/// A robot that touches the ground z = 0 at points, and states from which it makes a step with all of them closed: the contact problems of
/// engines whose solvers take no G.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ContactSteps {
    /// The robot, a canonical description.
    pub robot: Description,
    /// The length of a step, s.
    pub dt: f64,
    /// The body of each point, by its index in the description.
    pub bodies: Vec<usize>,
    /// The points in body axes, m: three numbers of each.
    pub points: Vec<f64>,
    /// μ of each point.
    pub friction: Vec<f64>,
    /// How many states there are.
    pub count: usize,
    /// Positions, neutral, state after state.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Forces of the joints.
    pub tau: Vec<f64>,
}

/// A way of an engine to find the impulses of a step by its own model of contact.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct StepMethod {
    /// Its name.
    pub name: String,
    /// The model, as an object. `time` says what a time includes. `limit` names the method whose answers by a small tolerance are those of the
    /// same model without an error of the solver.
    pub settings: Value,
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

    /// Its methods for steps of a robot on its contacts.
    fn contact_step_methods(&self) -> Vec<StepMethod> {
        Vec::new()
    }

    /// Makes a method ready for such steps. Ranges, blocks and clock are as of [`ContactSolver::prepare_contacts`], with a state for a problem.
    /// What is read are impulses along z, x and y of each point, N·s.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the method, or refuses the robot or a state.
    fn prepare_contact_steps<'a>(
        &'a self,
        _steps: &'a ContactSteps,
        method: &str,
        _tolerance: f64,
        _iterations: usize,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        Err(NoAnswer::NotOffered(format!("it makes no step on contacts by {method}")))
    }
}
