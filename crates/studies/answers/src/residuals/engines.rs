//! Engines that are corrected by a residual: each engine and robot, with three residuals, and with that of the robot's own description.
//!
//! | residual | what must hold |
//! |---|---|
//! | `zero` | the engine's own answer, to the bit |
//! | `friction` | τ = ID + r as ours; a solves M a + h + r = τ |
//! | `payload and friction` | the same with a part that depends on the acceleration |
//! | `described` | the same with the section `residuals` of the robot, if it has one |

use super::STUDY;
use featherbench_bench::measure::{ForwardScale, scaled_error, worst};
use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, OWN, Quantity, Robot, WithResidual};
use featherbench_dynamics::inverse_dynamics;
use featherbench_formats::neutral;
use featherbench_residuals::{Described, Payload, Residual, SmoothCoulomb, State, Sum, Viscous, Zero};
use featherbench_results::{Relation, Row, Verdict};
use featherbench_study::known::failed;
use featherbench_study::{answer, row, unanswered};
use serde::{Deserialize, Serialize};
use serde_json::Value;

const RESIDUALS: [&str; 3] = ["zero", "friction", "payload and friction"];
/// The residual of the robot's own description.
const DESCRIBED: &str = "described";

/// What defines the residual of a cell. A robot's hash is that of its rigid bodies, so its own residuals are written out as its file has them.
#[derive(Serialize, Deserialize)]
struct Params {
    residual: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    residuals: Option<Value>,
}

impl Params {
    fn of(robot: &Robot, residual: &str) -> Self {
        let written = || neutral::to_string(&robot.description).ok().and_then(|text| serde_json::from_str::<Value>(&text).ok());
        let residuals = (residual == DESCRIBED).then(|| written().map_or(Value::Null, |file| file["residuals"].clone()));
        Self { residual: residual.into(), residuals }
    }
}

/// A cell per engine, robot, residual and quantity, by the engine's usual method.
pub(super) fn plan(context: &Context) -> Vec<Cell> {
    let mut cells = Vec::new();
    for robot in context.robots.iter().filter(|robot| robot.takes(STUDY)) {
        for engine in context.engines {
            for quantity in [Quantity::InverseDynamics, Quantity::ForwardDynamics] {
                if let Some(method) = engine.methods(quantity).first() {
                    let of = |residual| {
                        Cell::new(STUDY, robot, engine.identity(), quantity.name(), method.as_str(), Params::of(robot, residual))
                    };
                    cells.extend(RESIDUALS.map(of));
                    cells.extend((!robot.description.residuals.is_empty()).then(|| of(DESCRIBED)));
                }
            }
        }
    }
    cells
}

/// The residual of a robot by its name.
fn residual(robot: &Robot, name: &str) -> Result<Box<dyn Residual>, NoAnswer> {
    let nv = robot.states.nv;
    let friction = || -> Result<[Box<dyn Residual>; 2], NoAnswer> {
        let coulomb = SmoothCoulomb::new(vec![0.5; nv], vec![0.1; nv]).map_err(failed)?;
        Ok([Box::new(Viscous::new(vec![0.3; nv]).map_err(failed)?), Box::new(coulomb)])
    };
    Ok(match name {
        "zero" => Box::new(Zero::new(nv)),
        DESCRIBED => Box::new(Described::of(&robot.description).map_err(failed)?),
        "friction" => Box::new(Sum::new(nv, friction()?.into()).map_err(failed)?),
        _ => {
            let last = robot.description.bodies.len().saturating_sub(1);
            let payload = Payload::new(&robot.description, last, 0.4, [0.02, -0.03, 0.05], [0.0; 6]).map_err(failed)?;
            let [viscous, coulomb] = friction()?;
            Box::new(Sum::new(nv, vec![Box::new(payload), viscous, coulomb]).map_err(failed)?)
        }
    })
}

/// Of zero: how many numbers have other bits. Of others: the error of each state.
pub(super) fn evaluate(asked: &Asked, robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
    let (engine, quantity, cell) = (asked.engine()?, asked.quantity()?, asked.cell);
    let name = cell.params::<Params>()?.residual;
    let residual = residual(robot, &name)?;
    let found = answer(&WithResidual::new(engine, residual.as_ref()), robot, quantity, &cell.method)?;
    if name == "zero" {
        let nominal = answer(engine, robot, quantity, &cell.method)?;
        return Ok(vec![nominal.iter().zip(&found).filter(|(a, b)| a.to_bits() != b.to_bits()).count() as f64]);
    }
    let (states, nv) = (&robot.states, robot.states.nv);
    let at = robot.magnitudes();
    let each = found.chunks_exact(nv).enumerate();
    if quantity == Quantity::InverseDynamics {
        let error = |(k, tau): (usize, &[f64])| {
            let state = State::new(states.q(k), states.v(k), states.a(k));
            let r = residual.value(&state).map_err(failed)?;
            let mut due = inverse_dynamics(&robot.model, states.q(k), states.v(k), states.a(k)).map_err(failed)?;
            due.iter_mut().zip(&r).for_each(|(due, r)| *due += r);
            // Terms of r count as terms of the nominal forces do.
            let mut own = at[k].clone();
            own.joint_force.iter_mut().zip(&r).for_each(|(sum, r)| *sum += r.abs());
            Ok(scaled_error(robot, quantity, &own, &due, tau))
        };
        return each.map(error).collect();
    }
    // a solves the nominal equations under τ − r(q, v, a): so r is taken at the answer, and the backward error is that of forward dynamics.
    let mut under = states.clone();
    for (k, a) in each.clone() {
        let r = residual.value(&State::new(states.q(k), states.v(k), a)).map_err(failed)?;
        under.tau[k * nv..(k + 1) * nv].iter_mut().zip(&r).for_each(|(tau, r)| *tau -= r);
    }
    let robot = robot.clone().at(under);
    let scales = ForwardScale::all(&robot, &at);
    Ok(each.map(|(k, a)| scales[k].backward_error(a)).collect())
}

pub(super) fn rows(context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
    let of = |(cell, outcome): &Finished| {
        let blank = Row { unit: "1".into(), ..row(cell, robot) };
        match outcome.answer() {
            Ok(&[changed]) if cell.params().is_ok_and(|params: Params| params.residual == "zero") => {
                let row = Row { metric: "changed_bits".into(), reference: cell.engine.clone(), ..blank };
                context.gates.explain(row.gated(changed, Relation::Eq, 0.0))
            }
            Ok(errors) => {
                let inverse = cell.quantity == Quantity::InverseDynamics.name();
                let metric = if inverse { "corrected_scaled" } else { "corrected_backward" };
                let row = Row { metric: metric.into(), reference: OWN.into(), ..blank };
                context.gates.judge(row, errors.iter().copied().fold(0.0, worst), 1.0)
            }
            Err(no_answer) => context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip)),
        }
    };
    finished.iter().map(of).collect()
}
