//! Single precision: is single precision good enough for this robot?
//!
//! Each engine that computes in `f32`, and our own kernels in `f32`, are compared with our kernels in `f64`. The difference is told in units:
//! newton metres of torque, radians per second squared of acceleration, radians after a second. *Drift* is the difference of two simulations
//! from rest, with the same steps (semi-implicit Euler). Only the accelerations are the engine's. A number in units says what a user feels,
//! and has no bound.
//! The agreement study has the same errors in units of rounding, with their bounds.

pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::measure::worst;
use featherbench_bench::truth::conditioning_bound;
use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoAnswer, NoSettings, OWN, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::Aba;
use featherbench_results::{Row, Verdict};
use featherbench_robots::{Case, StateBatch};
use featherbench_study::{Entry, row, unanswered};
use serde::{Deserialize, Serialize};

/// The study of single precision.
pub struct Single;

/// The study in the registry.
pub const ENTRY: Entry =
    Entry { name: "single", make: |setup| setup.made("single", |_: NoSettings| Single), sections: section::sections, words: words::WORDS };

/// The simulation.
const SECONDS: f64 = 1.0;
const STEPS: usize = 500;
/// States that are simulated together: the first of the robot, at rest.
const SIMULATED: usize = 4;
/// The conditioning bound hardly depends on the state, and each costs O(n²).
const BOUNDS: usize = 3;
/// Above this size no conditioning bound is computed.
const BOUND_DOFS: usize = 300;
/// The quantity of a simulation.
const DRIFT: &str = "drift";

/// The parameters of a cell and its rows.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Params {
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
}

impl Params {
    fn of_drift() -> Self {
        Self { seconds: Some(SECONDS), step: Some(SECONDS / STEPS as f64) }
    }
}

/// The quantities of an engine, each in the precision that it computes in.
fn quantities(engine: &dyn Engine) -> Vec<Quantity> {
    match engine.identity() {
        identity if identity.scalar() == "f32" => vec![Quantity::InverseDynamics, Quantity::ForwardDynamics],
        identity if identity.name == OWN => vec![Quantity::ForwardDynamicsSingle],
        _ => Vec::new(),
    }
}

impl Study for Single {
    fn name(&self) -> &'static str {
        "single"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn asks(&self, engine: &dyn Engine) -> bool {
        !quantities(engine).is_empty()
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            for engine in context.engines {
                let cell = |quantity: &str, method: String, params: Params| Cell {
                    scalar: "f32".into(),
                    ..Cell::new(self.name(), robot, engine.identity(), quantity, method, params)
                };
                for quantity in quantities(engine.as_ref()) {
                    let methods = engine.methods(quantity);
                    cells.extend(methods.iter().map(|method| cell(quantity.name(), method.clone(), Params::default())));
                    if quantity != Quantity::InverseDynamics {
                        cells.extend(methods.into_iter().take(1).map(|method| cell(DRIFT, method, Params::of_drift())));
                    }
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        if asked.cell.quantity != DRIFT {
            return featherbench_study::evaluate(asked);
        }
        let ends = || {
            let (engine, robot) = (asked.engine()?, asked.robot()?);
            let quantity = quantities(engine).into_iter().find(|&quantity| quantity != Quantity::InverseDynamics);
            let quantity = quantity.ok_or_else(|| NoAnswer::NotOffered("it has no forward dynamics in single precision".into()))?;
            simulated(robot, |states, a| {
                let mut prepared = engine.prepare(robot, quantity, &asked.cell.method, states)?;
                prepared.run(0..states.count())?;
                featherbench_study::as_many(prepared.read().len(), a.len())?;
                a.copy_from_slice(prepared.read());
                Ok(())
            })
        };
        ends().into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            let blank = Row { reference: OWN.into(), states: "all".into(), ..row(cell, robot) };
            match outcome.answer() {
                Ok(values) => rows.extend(compared(context, robot, cell, values, &blank)),
                Err(no_answer) => rows.push(context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip))),
            }
        }
        rows
    }
}

/// The rows of an answer.
fn compared(context: &Context, robot: &Robot, cell: &Cell, values: &[f64], blank: &Row) -> Vec<Row> {
    let informed = |metric: &str, unit: &str, value: f64| {
        context.gates.explain(Row { metric: metric.into(), unit: unit.into(), ..blank.clone() }.informed(value))
    };
    let reference = match Quantity::parse(&cell.quantity) {
        None => simulated(robot, |states, a| forward(robot, states, a)).map(|ends| (ends, "rad, m")),
        Some(Quantity::InverseDynamics) => inverse(robot).map(|tau| (tau, "N m, N")),
        Some(_) => {
            let mut a = vec![0.0; robot.states.count() * robot.states.nv];
            forward(robot, &robot.states, &mut a).map(|()| (a, "rad/s², m/s²"))
        }
    };
    let (reference, unit) = match reference {
        Ok(reference) => reference,
        Err(no_answer) => return vec![context.gates.explain(unanswered(blank.clone(), &no_answer, Verdict::Skip))],
    };
    if reference.len() != values.len() {
        let counted = format!("{} numbers came, {} are due", values.len(), reference.len());
        return vec![context.gates.explain(blank.clone().without_value(Verdict::Error, counted))];
    }
    let off = values.iter().zip(&reference).map(|(value, reference)| (value - reference).abs()).fold(0.0, worst);
    let largest = reference.iter().map(|reference| reference.abs()).fold(0.0, worst);
    let mut rows = vec![informed("off", unit, off)];
    if cell.quantity != DRIFT && largest > 0.0 {
        rows.push(informed("off_share", "1", off / largest));
    }
    let accelerations = Quantity::parse(&cell.quantity).is_some_and(|quantity| quantity.in_double() == Quantity::ForwardDynamics);
    if accelerations && robot.states.nv <= BOUND_DOFS {
        let nv = robot.states.nv;
        let states = values.chunks_exact(nv).zip(reference.chunks_exact(nv)).take(BOUNDS).enumerate();
        let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
        let shares = states.filter_map(|(k, (value, reference))| {
            let error = norm(&mut value.iter().zip(reference).map(|(value, reference)| value - reference));
            let single = conditioning_bound(robot, k)? * f64::from(f32::EPSILON) / f64::EPSILON;
            Some(error / norm(&mut reference.iter().copied()) / single)
        });
        rows.extend(shares.reduce(worst).map(|share| informed("off_bound", "1", share)));
    }
    rows
}

/// Our inverse dynamics at the robot's states, in `f64`.
fn inverse(robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
    let states = &robot.states;
    let (mut rnea, mut tau) = (featherbench_dynamics::Rnea::new(&robot.model.topology), vec![0.0; states.count() * states.nv]);
    for (k, tau) in tau.chunks_exact_mut(states.nv).enumerate() {
        let ran = rnea.run(&robot.model, states.q(k), states.v(k), states.a(k), None, tau);
        ran.map_err(|error| NoAnswer::Failed(error.to_string()))?;
    }
    Ok(tau)
}

/// Our forward dynamics at some states, in `f64`.
fn forward(robot: &Robot, states: &StateBatch, a: &mut [f64]) -> Result<(), NoAnswer> {
    let mut aba = Aba::new(&robot.model.topology);
    for (k, a) in a.chunks_exact_mut(states.nv).enumerate() {
        let ran = aba.run(&robot.model, states.q(k), states.v(k), states.tau(k), None, a);
        ran.map_err(|error| NoAnswer::NotOffered(format!("our forward dynamics: {error}")))?;
    }
    Ok(())
}

/// The last configurations of a simulation from the robot's first states, at rest and without forces. `accelerate` is told the states and
/// writes the accelerations.
///
/// # Errors
/// Those of `accelerate`, and [`NoAnswer::Failed`] when an acceleration is no number.
fn simulated(robot: &Robot, mut accelerate: impl FnMut(&StateBatch, &mut [f64]) -> Result<(), NoAnswer>) -> Result<Vec<f64>, NoAnswer> {
    let StateBatch { nq, nv, bodies, .. } = robot.states;
    let count = robot.states.count().min(SIMULATED);
    let mut states = StateBatch {
        nq,
        nv,
        bodies,
        cases: vec![Case::Random; count],
        q: robot.states.q[..count * nq].to_vec(),
        v: vec![0.0; count * nv],
        a: vec![0.0; count * nv],
        tau: vec![0.0; count * nv],
        wrench: vec![0.0; count * bodies * 6],
    };
    let (step, mut a) = (SECONDS / STEPS as f64, vec![0.0; count * nv]);
    for k in 0..STEPS {
        accelerate(&states, &mut a)?;
        if !a.iter().all(|a| a.is_finite()) {
            return Err(NoAnswer::Failed(format!("an acceleration at {:.3} s is no number", k as f64 * step)));
        }
        states.v.iter_mut().zip(&a).for_each(|(v, a)| *v += step * a);
        let moved: Vec<f64> = states.v.iter().map(|v| step * v).collect();
        let mut q = vec![0.0; count * nq];
        for ((before, moved), after) in states.q.chunks_exact(nq).zip(moved.chunks_exact(nv)).zip(q.chunks_exact_mut(nq)) {
            let integrated = robot.model.topology.integrate(before, moved, after);
            integrated.map_err(|error| NoAnswer::Failed(error.to_string()))?;
        }
        states.q = q;
    }
    Ok(states.q)
}
