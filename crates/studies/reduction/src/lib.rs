//! Reducing a failure: the smallest robot and state that still show it, and a program in the engine's own interface that prints it.
//!
//! A step makes the case simpler: a subtree less, a joint less, a coordinate that is zero, a number of fewer digits. It is kept if the severity of
//! the error stays at least [`KEEP`] times that of the case as given. Steps are tried one after another, again and again, until none is kept.

mod cases;
mod catalogue;
mod entries;
mod files;
mod finding;
mod programs;
mod section;
mod steps;

pub use cases::{Open, Reducing};
pub use catalogue::{CATALOGUE, CATALOGUE_NAME, Catalogue, Line, Reduction, Status, told};
pub use entries::{Entry, entries};
pub use files::save;
pub use finding::{Failure, Fault, Kind, Shown, metric, severity, true_answer};
pub use section::section;

use featherbench_bench::Robot;
use featherbench_model::{BodyDescription, Description, JointType};
use featherbench_results::ModelOrigin;
use featherbench_robots::Case as StateCase;
use std::collections::BTreeMap;

/// The share of its severity that an error keeps. A decade: a fault of one body is diluted or sharpened by the bodies around it, by less than that.
pub const KEEP: f64 = 0.1;
/// The most steps that are tried; those of a tree of 32 bodies are some thousands.
const PATIENCE: usize = 4000;

/// A robot of so few bodies is small: others are tried at other configurations, too.
pub const FEW: usize = 5;

/// The state of one joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointState {
    /// Its coordinates.
    pub q: Vec<f64>,
    /// Its velocities.
    pub v: Vec<f64>,
    /// Its accelerations, which inverse dynamics asks for.
    pub a: Vec<f64>,
    /// Its forces, which forward dynamics asks for.
    pub tau: Vec<f64>,
}

/// A robot at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// The name of the robot that it was reduced from.
    pub name: String,
    /// The kind of its state.
    pub kind: StateCase,
    /// The robot, canonical.
    pub description: Description,
    /// The state, by the name of the body that a joint carries.
    pub state: BTreeMap<String, JointState>,
}

impl Subject {
    /// A robot at one of its states. Wrenches on bodies are left out, and what the dynamics of the tree do not know of: loops, residuals.
    pub fn of(robot: &Robot, k: usize) -> Self {
        let (mut q, mut v) = (0, 0);
        let mut state = BTreeMap::new();
        for body in &robot.description.bodies {
            let (nq, nv) = (body.joint.kind.nq(), body.joint.kind.nv());
            let part = |values: &[f64], at: usize, count: usize| values.get(at..at + count).map(<[f64]>::to_vec).unwrap_or_default();
            let states = &robot.states;
            state.insert(
                body.name.clone(),
                JointState {
                    q: part(states.q(k), q, nq),
                    v: part(states.v(k), v, nv),
                    a: part(states.a(k), v, nv),
                    tau: part(states.tau(k), v, nv),
                },
            );
            (q, v) = (q + nq, v + nv);
        }
        let Description { name, gravity, bodies, .. } = robot.description.clone();
        let kind = robot.states.cases.get(k).copied().unwrap_or(StateCase::Random);
        Self { name: robot.name.clone(), kind, description: Description { name, gravity, bodies, ..Description::default() }, state }
    }

    /// The robot at this one state; `None` if it is no robot.
    pub fn robot(&self) -> Option<Robot> {
        let robot = Robot::new(&self.description, "reduced", ModelOrigin::Generated, 1, 1).ok()?;
        let mut states = robot.states.clone();
        let of = |part: fn(&JointState) -> &[f64]| -> Option<Vec<f64>> {
            let parts = robot.description.bodies.iter().map(|body| self.state.get(&body.name).map(part));
            Some(parts.collect::<Option<Vec<_>>>()?.concat())
        };
        (states.q, states.v) = (of(|at| &at.q)?, of(|at| &at.v)?);
        (states.a, states.tau) = (of(|at| &at.a)?, of(|at| &at.tau)?);
        states.wrench.fill(0.0);
        states.cases.fill(self.kind);
        states.check(&robot.model).ok()?;
        Some(Robot { name: self.name.clone(), ..robot.at(states) })
    }

    /// The case with its description in canonical form, and the states of the joints that it has; `None` if it is no robot.
    fn tidied(mut self) -> Option<Self> {
        self.description.frames.clear();
        self.description = self.description.canonical().ok()?;
        self.description.frames.clear();
        let bodies = &self.description.bodies;
        self.state.retain(|name, _| bodies.iter().any(|body| body.name == *name));
        (!bodies.is_empty()).then_some(self)
    }
}

/// The coordinates at which a joint does nothing.
fn neutral(kind: JointType) -> Vec<f64> {
    let mut q = vec![0.0; kind.nq()];
    if let (JointType::Spherical | JointType::Free, Some(w)) = (kind, q.last_mut()) {
        *w = 1.0;
    }
    q
}

/// A reduced case.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The case.
    pub case: Subject,
    /// The severity of the case as given.
    pub before: f64,
    /// The severity of the reduced case.
    pub after: f64,
    /// How many steps were tried.
    pub tried: usize,
}

/// What makes a case simpler.
type Step = Box<dyn Fn(&mut Subject)>;

/// Reduces a case whose error stays above `least`, too; `None` if it has no severity as given, or one that is not above.
pub fn reduce(case: Subject, least: f64, severity: &dyn Fn(&Robot) -> Option<f64>) -> Option<Reduced> {
    let before = severity(&case.robot()?)?;
    if before.is_nan() || before <= least {
        return None;
    }
    let mut reducer = Reducer { reduced: Reduced { case, before, after: before, tried: 0 }, severity, least };
    loop {
        let known = reducer.reduced.case.clone();
        reducer.pass(steps::fewer_bodies);
        reducer.pass(steps::fewer_joints);
        reducer.pass(steps::simpler_state);
        reducer.pass(steps::simpler_bodies);
        reducer.pass(steps::fewer_digits);
        if reducer.reduced.case.description.bodies.len() > FEW {
            reducer.pass(steps::fewer_bodies_elsewhere);
        }
        if reducer.reduced.case == known || reducer.reduced.tried >= PATIENCE {
            return Some(reducer.reduced);
        }
    }
}

struct Reducer<'a> {
    reduced: Reduced,
    severity: &'a dyn Fn(&Robot) -> Option<f64>,
    least: f64,
}

impl Reducer<'_> {
    /// Tries each step of a list. The list is made anew when one is kept: there may be fewer bodies.
    fn pass(&mut self, steps: fn(&Subject) -> Vec<Step>) {
        let mut at = 0;
        loop {
            let list = steps(&self.reduced.case);
            let Some(step) = list.get(at) else { return };
            let bodies = self.reduced.case.description.bodies.len();
            // The next step has the place of this one if a body is gone.
            if !(self.attempt(step) && self.reduced.case.description.bodies.len() < bodies) {
                at += 1;
            }
        }
    }

    /// Whether a step is kept.
    fn attempt(&mut self, step: &Step) -> bool {
        let mut case = self.reduced.case.clone();
        step(&mut case);
        if self.reduced.tried >= PATIENCE {
            return false;
        }
        let Some(case) = case.tidied().filter(|case| *case != self.reduced.case) else { return false };
        self.reduced.tried += 1;
        let severity = case
            .robot()
            .and_then(|robot| (self.severity)(&robot))
            .filter(|severity| *severity >= KEEP * self.reduced.before && *severity > self.least);
        if let Some(severity) = severity {
            (self.reduced.case, self.reduced.after) = (case, severity);
        }
        severity.is_some()
    }
}

/// The bodies that a body carries, itself first: they follow each other, as the order is depth first.
fn subtree(bodies: &[BodyDescription], root: usize) -> std::ops::Range<usize> {
    let mut end = root + 1;
    while bodies.get(end).and_then(|body| body.parent).is_some_and(|parent| parent >= root) {
        end += 1;
    }
    root..end
}
