//! Invariance: what must not change an answer, and does?
//!
//! A robot is described once more in a way that leaves it the same ([`changes`]). The engine answers about both, and the second answer is
//! turned back. Its distance from the first is measured per degree of freedom against the terms that are added to form the torque there. Four
//! of the five changes round nothing, so that an engine whose arithmetic is symmetric in them has the same bits.

mod changes;
pub(crate) mod section;
pub(crate) mod words;

use changes::{CHANGES, changed};
use featherbench_bench::measure::{ForwardScale, ratio, worst};
use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoAnswer, NoSettings, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::Rnea;
use featherbench_results::{ModelOrigin, Row, Verdict};
use featherbench_study::{Entry, answer, as_many, row, unanswered};
use serde_json::json;

/// The study of invariances.
pub struct Invariance;

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "invariance",
    make: |setup| setup.made("invariance", |_: NoSettings| Invariance),
    sections: section::sections,
    words: words::WORDS,
};

/// The robot as it is.
const ITSELF: &str = "none";
/// The method of a cell of an engine that offers nothing.
const NONE: &str = "none";
/// What is asked.
const QUANTITIES: [Quantity; 2] = [Quantity::InverseDynamics, Quantity::ForwardDynamics];

impl Study for Invariance {
    fn name(&self) -> &'static str {
        "invariance"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            for engine in context.engines {
                if QUANTITIES.iter().all(|&quantity| engine.methods(quantity).is_empty()) {
                    let params = json!({"change": CHANGES[0]});
                    cells.push(Cell::new(self.name(), robot, engine.identity(), QUANTITIES[0].name(), NONE, params));
                }
                for quantity in QUANTITIES {
                    let Some(method) = engine.methods(quantity).into_iter().next() else { continue };
                    let cell = |change: &str| {
                        let params = json!({"change": change});
                        Cell::new(self.name(), robot, engine.identity(), quantity.name(), method.clone(), params)
                    };
                    let can = |change: &&str| changed(&robot.description, change).is_some();
                    cells.extend(std::iter::once(ITSELF).chain(CHANGES.into_iter().filter(can)).map(cell));
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let answered = || {
            if asked.cell.method == NONE {
                return Err(NoAnswer::NotOffered("it answers none of the quantities that are asked".into()));
            }
            let (engine, robot) = (asked.engine()?, asked.robot()?);
            let quantity = asked.quantity()?;
            in_our_terms(engine, robot, quantity, &asked.cell.method, change_of(asked.cell))
        };
        answered().into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let itself = |cell: &Cell| {
            let same = |other: &Cell| (&other.engine, &other.quantity, change_of(other)) == (&cell.engine, &cell.quantity, ITSELF);
            finished.iter().find(|(other, _)| same(other)).and_then(|(_, outcome)| outcome.answer().ok())
        };
        let mut rows = Vec::new();
        for (cell, outcome) in finished.iter().filter(|(cell, _)| change_of(cell) != ITSELF) {
            let blank =
                Row { metric: "moved".into(), unit: "1".into(), reference: cell.engine.clone(), states: "all".into(), ..row(cell, robot) };
            let values = match outcome.answer() {
                Ok(values) => values,
                Err(no_answer) => {
                    rows.push(context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip)));
                    continue;
                }
            };
            // Without an answer about the robot itself the agreement study tells why.
            let Some(first) = itself(cell) else { continue };
            rows.push(match as_many(values.len(), first.len()) {
                Ok(()) => context.gates.judge(blank, distance(robot, &cell.quantity, first, values), 1.0),
                Err(no_answer) => context.gates.explain(unanswered(blank, &no_answer, Verdict::Error)),
            });
        }
        rows
    }
}

/// The change of a cell.
fn change_of(cell: &Cell) -> &str {
    cell.params["change"].as_str().unwrap_or_default()
}

/// An engine's answer about the changed robot, in terms of the first one.
fn in_our_terms(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str, change: &str) -> Result<Vec<f64>, NoAnswer> {
    if change == ITSELF {
        return answer(engine, robot, quantity, method);
    }
    let failed = |message: String| NoAnswer::Failed(message);
    let other = changed(&robot.description, change).ok_or_else(|| failed("this robot is not changed so".into()))?;
    let states = other.states(&robot.description, &robot.states);
    let made = Robot::new(&other.description, &robot.family, ModelOrigin::Generated, 1, 0).map_err(|error| failed(error.to_string()))?;
    let values = answer(engine, &made.at(states), quantity, method)?;
    Ok(other.back(&robot.description, &values, quantity == Quantity::InverseDynamics))
}

/// The largest distance of two answers over all states and degrees of freedom, in forces: accelerations are taken to the forces that make them.
/// It counts by the terms that are added to form the force there. So an acceleration that cancels to zero, and is rounding alone, counts little.
fn distance(robot: &Robot, quantity: &str, first: &[f64], second: &[f64]) -> f64 {
    let (nv, magnitudes) = (robot.states.nv, robot.magnitudes());
    let largest =
        |first: &[f64], second: &[f64], sizes: &[f64]| (0..nv).map(|i| ratio((first[i] - second[i]).abs(), sizes[i])).fold(0.0, worst);
    let states = first.chunks_exact(nv).zip(second.chunks_exact(nv));
    if quantity == Quantity::InverseDynamics.name() {
        return states.zip(&magnitudes).map(|((first, second), at)| largest(first, second, &at.joint_force)).fold(0.0, worst);
    }
    let mut rnea = Rnea::new(&robot.model.topology);
    let mut forces = |state: usize, a: &[f64]| {
        let mut tau = vec![f64::NAN; nv];
        // Where our kernel fails the forces stay NaN, which no gate passes.
        let _ = rnea.run(&robot.model, robot.states.q(state), robot.states.v(state), a, None, &mut tau);
        tau
    };
    let scales = ForwardScale::all(robot, &magnitudes);
    let mut far = 0.0;
    for (k, ((first, second), scale)) in states.zip(scales).enumerate() {
        far = worst(far, largest(&forces(k, first), &forces(k, second), &scale.terms(first)));
    }
    far
}
