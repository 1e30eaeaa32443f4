//! Who is timed: our solvers and those of engines, on the problems of a landed robot.

use super::{CAP, TARGET};
use crate::contact::standing::{FRICTION, Stand};
use featherbench_bench::{Cell, ContactProblems, Context, Evaluation, NoAnswer};
use featherbench_contact::solver::Blocks;
use featherbench_contact::{BlockGaussSeidel, Newton, Problem, Residuals, Solver};
use nalgebra::DVector;
use serde_json::{Value, json};
use std::ops::Range;

/// Our methods, the reference first.
pub(super) const OWN: [&str; 3] = ["block_gauss_seidel", "block_gauss_seidel_whole", "newton"];
/// How many landings there are.
const LANDINGS: u64 = 8;
/// Tolerances that are tried, as powers of ten.
const TOLERANCES: Range<i32> = 5..15;

/// The problems of a robot with all contacts closed.
pub(super) struct Landed {
    pub problems: Vec<Problem>,
    /// The same without units, for engines: G over its largest entry, b over its own.
    given: ContactProblems,
    /// Of each problem: by what an engine's impulses are multiplied.
    scales: Vec<f64>,
}

impl Landed {
    /// Those of a run with this seed, and of the first step of further ones.
    pub fn of(stand: Stand, seed: u64) -> Result<Self, NoAnswer> {
        let standing = stand.make()?;
        let mut problems = standing.run(seed)?;
        for landing in 1..LANDINGS {
            problems.extend(standing.landing(seed.wrapping_add(landing))?);
        }
        problems.retain(|problem| problem.contacts().len() == stand.contacts());
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
        Ok(Self { problems, given, scales })
    }
}

/// A method of an engine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Candidate {
    pub engine: String,
    pub version: String,
    pub method: String,
    /// Whether it is the A/A replicate of the reference.
    pub control: bool,
}

impl Candidate {
    pub fn new(engine: &str, method: &str, control: bool) -> Self {
        Self { engine: engine.into(), version: String::new(), method: method.into(), control }
    }

    /// As a parameter of the cell.
    pub fn to_params(&self, context: &Context) -> Value {
        let version = context.engine(&self.engine).map(|engine| engine.identity().version.clone()).unwrap_or_default();
        json!({"engine": self.engine, "version": version, "method": self.method, "control": self.control})
    }

    /// The candidates of a cell, in the order of its samples.
    pub fn of(cell: &Cell) -> Vec<Self> {
        let text = |candidate: &Value, key: &str| candidate[key].as_str().unwrap_or_default().to_owned();
        let listed = cell.params["candidates"].as_array().into_iter().flatten();
        listed
            .map(|candidate| Self {
                engine: text(candidate, "engine"),
                version: text(candidate, "version"),
                method: text(candidate, "method"),
                control: candidate["control"] == true,
            })
            .collect()
    }

    /// Makes it ready at a tolerance.
    pub fn prepare<'a>(&self, context: &'a Context<'_>, landed: &'a Landed, tolerance: f64) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        if self.engine != "featherbench" {
            let lost = || NoAnswer::Failed(format!("{} solves no contact problems", self.engine));
            let solver = context.engine(&self.engine).and_then(|engine| engine.contact_solver()).ok_or_else(lost)?;
            return solver.prepare_contacts(&landed.given, &self.method, tolerance, CAP);
        }
        let problems = &landed.problems;
        let sweeps = BlockGaussSeidel { tolerance, sweeps: CAP };
        let unsupported = |error: featherbench_contact::Unsupported| NoAnswer::NotOffered(error.to_string());
        match self.method.as_str() {
            "block_gauss_seidel" => {
                let blocks = problems.iter().map(Blocks::new).collect::<Result<_, _>>().map_err(unsupported)?;
                Ok(Box::new(Sweeps { blocks, settings: sweeps }))
            }
            "block_gauss_seidel_whole" => Ok(Box::new(Whole { problems, settings: sweeps })),
            "newton" => Ok(Box::new(Solved { problems, solver: Newton { tolerance, ..Newton::default() } })),
            other => Err(NoAnswer::NotOffered(format!("we have no method {other}"))),
        }
    }

    /// The loosest tolerance with which all answers are within the target, and their largest residual.
    pub fn at_target(&self, context: &Context, landed: &Landed) -> Result<(f64, f64), NoAnswer> {
        let mut best = f64::INFINITY;
        for power in TOLERANCES {
            let tolerance = 10.0_f64.powi(-power);
            let residual = self.residual(context, landed, tolerance)?;
            if residual <= TARGET {
                return Ok((tolerance, residual));
            }
            if residual < best {
                best = residual;
            }
        }
        Err(NoAnswer::Failed(format!("its best residual is {best:.1e}, and {TARGET:.0e} is asked")))
    }

    /// The largest natural-map residual of all answers at a tolerance; infinite where there is no answer.
    fn residual(&self, context: &Context, landed: &Landed, tolerance: f64) -> Result<f64, NoAnswer> {
        let mut largest: f64 = 0.0;
        let mut keep = |residual: f64| {
            if residual.is_nan() || residual > largest {
                largest = if residual.is_nan() { f64::INFINITY } else { residual };
            }
        };
        if self.engine == "featherbench" {
            let sweeps = BlockGaussSeidel { tolerance, sweeps: CAP };
            let newton = Newton { tolerance, ..Newton::default() };
            let solver: &dyn Solver = if self.method == "newton" { &newton } else { &sweeps };
            for problem in &landed.problems {
                let solution = solver.solve(problem).map_err(|error| NoAnswer::NotOffered(error.to_string()))?;
                keep(solution.point().map_or(f64::INFINITY, |point| point.residuals.natural_map));
            }
            return Ok(largest);
        }
        let mut prepared = self.prepare(context, landed, tolerance)?;
        prepared.run(0..landed.problems.len())?;
        let rows = 3 * landed.given.contacts;
        let answers = prepared.read().chunks_exact(rows);
        if answers.len() != landed.problems.len() {
            return Err(NoAnswer::Failed("there is not an answer to each problem".into()));
        }
        for ((problem, impulses), scale) in landed.problems.iter().zip(answers).zip(&landed.scales) {
            keep(Residuals::of(problem, &(DVector::from_column_slice(impulses) * *scale)).natural_map);
        }
        Ok(largest)
    }
}

/// Sweeps over prepared problems.
struct Sweeps {
    blocks: Vec<Blocks>,
    settings: BlockGaussSeidel,
}

impl Evaluation for Sweeps {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        let count = self.blocks.len();
        for k in range {
            let blocks = &mut self.blocks[k % count];
            blocks.clear();
            std::hint::black_box(blocks.run(&self.settings));
        }
        Ok(())
    }

    /// Problems differ: a block has all of them.
    fn together(&self) -> usize {
        self.blocks.len()
    }

    fn read(&self) -> &[f64] {
        &[]
    }
}

/// Preparation and sweeps.
struct Whole<'a> {
    problems: &'a [Problem],
    settings: BlockGaussSeidel,
}

impl Evaluation for Whole<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        for k in range {
            let made = Blocks::new(&self.problems[k % self.problems.len()]);
            let mut blocks = made.map_err(|error| NoAnswer::NotOffered(error.to_string()))?;
            std::hint::black_box(blocks.run(&self.settings));
        }
        Ok(())
    }

    fn together(&self) -> usize {
        self.problems.len()
    }

    fn read(&self) -> &[f64] {
        &[]
    }
}

/// Solutions by a solver of the library.
struct Solved<'a> {
    problems: &'a [Problem],
    solver: Newton,
}

impl Evaluation for Solved<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        for k in range {
            let solution = self.solver.solve(&self.problems[k % self.problems.len()]);
            std::hint::black_box(solution.map_err(|error| NoAnswer::NotOffered(error.to_string()))?);
        }
        Ok(())
    }

    fn together(&self) -> usize {
        self.problems.len()
    }

    fn read(&self) -> &[f64] {
        &[]
    }
}
