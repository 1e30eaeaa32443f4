//! Who is timed: our solvers and those of engines, on the problems of a landed robot.

use super::{CAP, TARGET};
use featherbench_answers::contact::standing::{FRICTION, Stand};
use featherbench_bench::{ContactProblems, ContactSolver, ContactSteps, Context, Evaluation, NoAnswer, OWN};
use featherbench_contact::solver::Blocks;
use featherbench_contact::{BlockGaussSeidel, Newton, Problem, Residuals, Solver, Unsupported};
use featherbench_spatial::smaller;
use featherbench_study::known::largest;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::ops::Range;

/// Our methods, the reference first.
pub(super) const SOLVERS: [&str; 3] = ["block_gauss_seidel", WHOLE, "newton"];
/// The cap on iterations of an engine with a model of its own: engines make some ten or a hundred in a step.
const CAP_OF_STEPS: usize = 2_000;
/// The one that begins with M and J.
pub(super) const WHOLE: &str = "block_gauss_seidel_whole";
/// How many landings there are.
const LANDINGS: u64 = 8;
/// Tolerances that are tried, as powers of ten.
const TOLERANCES: Range<i32> = 5..15;
/// The tolerance of the answers that are the limit of an engine's own model. In doubles its solver stops at rounding before it.
const LIMIT: f64 = 1e-16;

/// The problems of a robot with all contacts closed.
pub(super) struct Landed {
    pub problems: Vec<Problem>,
    /// The same without units, for engines: G over its largest entry, b over its own.
    given: ContactProblems,
    /// The same as steps of the robot.
    steps: ContactSteps,
    /// Of each problem: by what an engine's impulses are multiplied.
    scales: Vec<f64>,
}

impl Landed {
    /// Those of a run with this seed, and of the first step of further ones.
    pub fn of(stand: Stand, seed: u64) -> Result<Self, NoAnswer> {
        let standing = stand.make()?;
        let mut taken = standing.run(seed)?;
        for landing in 1..LANDINGS {
            taken.extend(standing.landing(seed.wrapping_add(landing))?);
        }
        taken.retain(|taken| taken.problem.contacts().len() == stand.contacts());
        let steps = standing.steps(&taken)?;
        let problems: Vec<Problem> = taken.into_iter().map(|taken| taken.problem).collect();
        let mut given = ContactProblems { count: problems.len(), contacts: stand.contacts(), ..ContactProblems::default() };
        let mut scales = Vec::new();
        for problem in &problems {
            let (of_g, of_b) = (problem.delassus().amax(), problem.free().amax());
            // G is symmetric: its columns are its rows.
            given.delassus.extend(problem.delassus().iter().map(|entry| entry / of_g));
            given.free.extend(problem.free().iter().map(|entry| entry / of_b));
            given.friction.extend(problem.contacts().iter().map(|_| FRICTION));
            scales.push(of_b / of_g);
        }
        if problems.is_empty() {
            return Err(NoAnswer::Failed("the robot does not stand on all its contacts".into()));
        }
        Ok(Self { problems, given, steps, scales })
    }

    /// The largest natural-map residual of impulses; infinite where one is NaN.
    fn residual(&self, impulses: &[DVector<f64>]) -> f64 {
        bounded(self.problems.iter().zip(impulses).map(|(problem, impulses)| Residuals::of(problem, impulses).natural_map))
    }

    /// The largest difference of the velocities after two answers, over the largest free velocity: |G (λ − λ′)| / |b|.
    fn apart(&self, found: &[DVector<f64>], due: &[DVector<f64>]) -> f64 {
        let each = self.problems.iter().zip(found).zip(due);
        bounded(each.map(|((problem, found), due)| (problem.delassus() * (found - due)).amax() / problem.free().amax()))
    }
}

/// The largest number; infinite where one is NaN.
fn bounded(numbers: impl Iterator<Item = f64>) -> f64 {
    let largest = largest(numbers);
    if largest.is_nan() { f64::INFINITY } else { largest }
}

/// What is told of a candidate before it is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Told {
    /// The loosest tolerance with which all its answers count.
    pub tolerance: f64,
    /// Their largest natural-map residual.
    pub residual: f64,
    /// Of a method with a model of its own: how far the velocities are from that model's limit. NaN of others.
    pub from_limit: f64,
}

impl Told {
    /// Of a candidate without such a tolerance.
    pub const NONE: Self = Self { tolerance: f64::NAN, residual: f64::NAN, from_limit: f64::NAN };

    pub fn to_values(self) -> [f64; 3] {
        [self.tolerance, self.residual, self.from_limit]
    }

    pub fn from_values(values: &[f64]) -> Self {
        match *values {
            [tolerance, residual, from_limit] => Self { tolerance, residual, from_limit },
            _ => Self::NONE,
        }
    }
}

/// A method of an engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Candidate {
    pub engine: String,
    pub version: String,
    pub method: String,
    /// Whether it is the A/A replicate of the reference.
    pub control: bool,
    /// Of a method that answers by the engine's own model of contact: its settings. Null of others.
    pub own_model: Value,
}

impl Candidate {
    pub fn new(engine: &str, method: &str, control: bool) -> Self {
        Self { engine: engine.into(), version: String::new(), method: method.into(), control, own_model: Value::Null }
    }

    /// All methods of an engine.
    pub fn all_of(engine: &str, solver: &dyn ContactSolver) -> Vec<Self> {
        let laws = solver.contact_methods().into_iter().map(|method| Self::new(engine, &method, false));
        let own = solver.contact_step_methods().into_iter();
        laws.chain(own.map(|method| Self { own_model: method.settings, ..Self::new(engine, &method.name, false) })).collect()
    }

    /// Makes it ready at a tolerance.
    pub fn prepare<'a>(&self, context: &'a Context<'_>, landed: &'a Landed, tolerance: f64) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        if self.engine != OWN {
            let lost = || NoAnswer::Failed(format!("{} solves no contact problems", self.engine));
            let solver = context.engine(&self.engine).and_then(|engine| engine.contact_solver()).ok_or_else(lost)?;
            return match self.own_model {
                Value::Null => solver.prepare_contacts(&landed.given, &self.method, tolerance, CAP),
                _ => solver.prepare_contact_steps(&landed.steps, &self.method, tolerance, CAP_OF_STEPS),
            };
        }
        let problems = &landed.problems;
        let (count, sweeps) = (problems.len(), BlockGaussSeidel { tolerance, sweeps: CAP });
        match self.method.as_str() {
            "block_gauss_seidel" => {
                let mut blocks = problems.iter().map(Blocks::new).collect::<Result<Vec<_>, _>>().map_err(unsupported)?;
                Ok(each(count, move |k| {
                    blocks[k].clear();
                    std::hint::black_box(blocks[k].run(&sweeps));
                    Ok(())
                }))
            }
            WHOLE => Ok(each(count, move |k| {
                std::hint::black_box(Blocks::new(&problems[k])?.run(&sweeps));
                Ok(())
            })),
            "newton" => {
                let solver = Newton { tolerance, ..Newton::default() };
                Ok(each(count, move |k| solver.solve(&problems[k]).map(|solution| drop(std::hint::black_box(solution)))))
            }
            other => Err(NoAnswer::NotOffered(format!("we have no method {other}"))),
        }
    }

    /// The loosest tolerance with which all answers are within the target, and what is told of them. A method with a model of its own is
    /// measured by the limit of that model: how near its answers are to the laws is not up to its solver.
    pub fn at_target(&self, context: &Context, landed: &Landed) -> Result<Told, NoAnswer> {
        let limit = match self.own_model["limit"].as_str() {
            Some(limit) => Some(Self { method: limit.to_owned(), ..self.clone() }.impulses(context, landed, LIMIT)?),
            None => None,
        };
        let mut best = f64::INFINITY;
        for power in TOLERANCES {
            let tolerance = 10.0_f64.powi(-power);
            let found = self.impulses(context, landed, tolerance)?;
            let residual = landed.residual(&found);
            let from_limit = limit.as_ref().map(|limit| landed.apart(&found, limit));
            let measure = from_limit.unwrap_or(residual);
            if measure <= TARGET {
                return Ok(Told { tolerance, residual, from_limit: from_limit.unwrap_or(f64::NAN) });
            }
            best = smaller(best, measure);
        }
        Err(NoAnswer::Failed(format!("its best residual is {best:.1e}, and {TARGET:.0e} is asked")))
    }

    /// The impulses of all problems at a tolerance, N·s; NaN where there is no answer.
    fn impulses(&self, context: &Context, landed: &Landed, tolerance: f64) -> Result<Vec<DVector<f64>>, NoAnswer> {
        let rows = 3 * landed.given.contacts;
        if self.engine == OWN {
            let sweeps = BlockGaussSeidel { tolerance, sweeps: CAP };
            let newton = Newton { tolerance, ..Newton::default() };
            let solver: &dyn Solver = if self.method == "newton" { &newton } else { &sweeps };
            let solved = landed.problems.iter().map(|problem| {
                let solution = solver.solve(problem).map_err(unsupported)?;
                Ok(solution.point().map_or_else(|| DVector::from_element(rows, f64::NAN), |point| point.impulses.clone()))
            });
            return solved.collect();
        }
        let mut prepared = self.prepare(context, landed, tolerance)?;
        prepared.run(0..landed.problems.len())?;
        let answers = prepared.read().chunks_exact(rows);
        if answers.len() != landed.problems.len() {
            return Err(NoAnswer::Failed("there is not an answer to each problem".into()));
        }
        // Problems by G and b were given without units; a robot has them.
        let unit = |scale: &f64| if self.own_model.is_null() { *scale } else { 1.0 };
        Ok(answers.zip(&landed.scales).map(|(impulses, scale)| DVector::from_column_slice(impulses) * unit(scale)).collect())
    }
}

/// One of our methods on so many problems, one after another.
fn each<'a>(count: usize, solve: impl FnMut(usize) -> Result<(), Unsupported> + Send + 'a) -> Box<dyn Evaluation + 'a> {
    Box::new(Each { count, solve })
}

struct Each<F> {
    count: usize,
    solve: F,
}

impl<F: FnMut(usize) -> Result<(), Unsupported> + Send> Evaluation for Each<F> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        for k in range {
            (self.solve)(k % self.count).map_err(unsupported)?;
        }
        Ok(())
    }

    /// Problems differ: a block has all of them.
    fn together(&self) -> usize {
        self.count
    }

    fn read(&self) -> &[f64] {
        &[]
    }
}

fn unsupported(error: Unsupported) -> NoAnswer {
    NoAnswer::NotOffered(error.to_string())
}
