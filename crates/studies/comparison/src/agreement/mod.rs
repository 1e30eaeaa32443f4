//! Agreement: the same model in every engine, every quantity by every method, against our own kernels.
//!
//! The reference is our f64, and each row says so; the accuracy study compares with the truth instead. Rows with another engine as
//! `reference` compare engines with each other. So a reader can see which engine differs from all others.

mod factor;
mod over_best;
pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::measure::{ForwardScale, Magnitudes, scaled_error, worst};
use featherbench_bench::{Asked, Cell, Context, DENSE_LIMIT, Engine, Finished, NoSettings, OWN, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::Rnea;
use featherbench_model::Model;
use featherbench_results::{Row, Verdict};
use featherbench_robots::Case;
use featherbench_study::{Entry, row, unanswered};
use over_best::over_best;
use serde::{Deserialize, Serialize};

/// The engine that all others are compared with.
const REFERENCE: &str = OWN;

/// The quantities that every engine is asked for.
pub(crate) const QUANTITIES: [Quantity; 16] = [
    Quantity::Readback,
    Quantity::InverseDynamics,
    Quantity::InverseDynamicsWrench,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::MassMatrixProbe,
    Quantity::ForwardDynamics,
    Quantity::KineticEnergy,
    Quantity::PotentialEnergy,
    Quantity::CenterOfMass,
    Quantity::Momentum,
    Quantity::BodyPlacement,
    Quantity::BodyVelocity,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::BodyJacobians,
];

/// The agreement study.
pub struct Agreement;

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "agreement",
    make: |setup| setup.made("agreement", |_: NoSettings| Agreement),
    sections: section::sections,
    words: words::WORDS,
};

impl Study for Agreement {
    fn name(&self) -> &'static str {
        "agreement"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        true
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            for engine in context.engines {
                for quantity in QUANTITIES.into_iter().filter(|&quantity| asked(robot, quantity)) {
                    let methods = engine.methods(quantity);
                    cells.extend(methods.into_iter().map(|method| cell(robot, engine.as_ref(), quantity, method)));
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        featherbench_study::evaluate(asked)
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let at = robot.magnitudes();
        let forward = ForwardScale::all(robot, &at);
        let comparison = Comparison { context, robot, finished, at, forward };
        let mut rows = comparison.conditioning();
        for item in finished {
            rows.extend(comparison.rows(item));
        }
        rows.extend(comparison.pairs());
        rows.extend(comparison.on_readback());
        rows.extend(over_best(REFERENCE, robot, finished, &comparison.at, &comparison.forward));
        rows
    }
}

/// Whether a quantity is asked of a robot: the whole mass matrix of small robots, a probe of big ones.
pub(crate) fn asked(robot: &Robot, quantity: Quantity) -> bool {
    let big = robot.states.nv > DENSE_LIMIT;
    match quantity {
        Quantity::MassMatrix => !big,
        Quantity::MassMatrixProbe => big,
        _ => true,
    }
}

/// The parameters of a cell and its rows.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Params {
    base: String,
    joints: Vec<String>,
    states: usize,
}

fn cell(robot: &Robot, engine: &dyn Engine, quantity: Quantity, method: String) -> Cell {
    let joints = robot.joint_kinds().into_iter().map(str::to_owned).collect();
    let params = Params { base: robot.base().into(), joints, states: robot.asked(quantity) };
    Cell::new("agreement", robot, engine.identity(), quantity.name(), method, params)
}

struct Comparison<'a> {
    context: &'a Context<'a>,
    robot: &'a Robot,
    finished: &'a [Finished],
    at: Vec<Magnitudes>,
    forward: Vec<ForwardScale<'a>>,
}

impl Comparison<'_> {
    /// Our answer by the usual method.
    fn reference(&self, quantity: Quantity) -> Option<&Finished> {
        self.finished.iter().find(|(cell, _)| cell.engine == REFERENCE && cell.quantity == quantity.name())
    }

    /// The condition numbers of M per case. The worst state shows how much an error may grow.
    fn conditioning(&self) -> Vec<Row> {
        let Some((cell, _)) = self.reference(Quantity::ForwardDynamics) else { return Vec::new() };
        let per_state: Vec<f64> = self.forward.iter().map(|scale| scale.condition).collect();
        self.per_case(&per_state)
            .into_iter()
            .map(|(case, value, _)| {
                let row = Row { states: case.name().into(), metric: "kappa_scaled".into(), unit: "1".into(), ..row(cell, self.robot) };
                self.context.gates.explain(row.informed(value))
            })
            .collect()
    }

    /// The rows of one finished cell.
    fn rows(&self, (cell, outcome): &Finished) -> Vec<Row> {
        let Some(quantity) = Quantity::parse(&cell.quantity) else { return Vec::new() };
        let values = match outcome {
            Outcome::Values(values) => values,
            Outcome::Text(_) => return Vec::new(),
            Outcome::NoAnswer(no_answer) => {
                let row = Row { reference: REFERENCE.into(), ..row(cell, self.robot) };
                return vec![self.context.gates.explain(unanswered(row, no_answer, Verdict::Skip))];
            }
        };
        if quantity == Quantity::ForwardDynamics {
            return self.forward_rows(cell, values);
        }
        let itself = self.reference(quantity).is_some_and(|(reference, _)| reference == cell);
        if itself {
            return Vec::new();
        }
        let errors = match self.reference(quantity).map(|(_, outcome)| outcome.values()) {
            Some(Some(reference)) => self.errors(quantity, reference, values),
            _ if quantity == Quantity::Readback => self.errors(quantity, &self.robot.readback(), values),
            _ => return vec![row(cell, self.robot).without_value(Verdict::Error, "our reference has no value")],
        };
        let rows = self.judged(cell, "scaled", &errors, None);
        let wrong = rows.iter().any(|row| row.verdict == Verdict::Fail);
        let reference = self.reference(quantity).and_then(|(_, outcome)| outcome.values());
        match reference.filter(|_| wrong).and_then(|reference| factor::excess(reference, values, quantity.size(self.robot))) {
            Some(excess) => {
                let told = |row: Row| if row.verdict == Verdict::Fail { row.with_param("excess", excess.into()) } else { row };
                rows.into_iter().map(told).collect()
            }
            None => rows,
        }
    }

    /// Backward error by our inverse dynamics, and forward error in the kinetic-energy norm.
    fn forward_rows(&self, cell: &Cell, values: &[f64]) -> Vec<Row> {
        let states = values.chunks_exact(self.robot.states.nv);
        let backward: Vec<f64> = states.clone().zip(&self.forward).map(|(a, scale)| scale.backward_error(a)).collect();
        let mut rows = self.judged(cell, "backward", &backward, None);
        if let Some((reference, outcome)) = self.reference(Quantity::ForwardDynamics).filter(|(reference, _)| reference != cell) {
            let Some(reference_values) = outcome.values() else {
                let reason = format!("our reference {} has no value", reference.method);
                rows.push(self.context.gates.explain(row(cell, self.robot).without_value(Verdict::Error, reason)));
                return rows;
            };
            let pairs = states.zip(reference_values.chunks_exact(self.robot.states.nv)).zip(&self.forward);
            let forward: Vec<f64> = pairs.map(|((a, reference), scale)| scale.forward_error(reference, a)).collect();
            let amplification: Vec<f64> = self.forward.iter().map(|scale| scale.amplification).collect();
            rows.extend(self.judged(cell, "forward", &forward, Some(&amplification)));
        }
        rows
    }

    /// The scaled error at each state.
    fn errors(&self, quantity: Quantity, reference: &[f64], values: &[f64]) -> Vec<f64> {
        let size = quantity.size(self.robot);
        let states = reference.chunks_exact(size).zip(values.chunks_exact(size)).zip(&self.at);
        states.map(|((reference, value), at)| scaled_error(self.robot, quantity, at, reference, value)).collect()
    }

    /// One judged row per case: its worst state, the one nearest to its bound where bounds differ.
    fn judged(&self, cell: &Cell, metric: &str, errors: &[f64], amplification: Option<&[f64]>) -> Vec<Row> {
        let relative: Vec<f64> = match amplification {
            Some(amplification) => {
                errors.iter().zip(amplification).map(|(error, growth)| featherbench_bench::measure::ratio(*error, *growth)).collect()
            }
            None => errors.to_vec(),
        };
        self.per_case(&relative)
            .into_iter()
            .map(|(case, _, state)| {
                let row = Row {
                    states: case.name().into(),
                    metric: metric.into(),
                    unit: "1".into(),
                    reference: if metric == "backward" { "featherbench id".into() } else { REFERENCE.into() },
                    ..row(cell, self.robot)
                };
                self.context.gates.judge(row, errors[state], amplification.map_or(1.0, |growth| growth[state]))
            })
            .collect()
    }

    /// The worst value of each case and its state, in the order of first appearance. A NaN is the worst of all.
    fn per_case(&self, values: &[f64]) -> Vec<(Case, f64, usize)> {
        let mut cases: Vec<(Case, f64, usize)> = Vec::new();
        for (state, (&case, &value)) in self.robot.states.cases.iter().zip(values).enumerate() {
            match cases.iter_mut().find(|(known, ..)| *known == case) {
                None => cases.push((case, value, state)),
                Some((_, found, at)) => {
                    if value.is_nan() || value > *found {
                        (*found, *at) = (worst(*found, value), state);
                    }
                }
            }
        }
        cases
    }

    /// Engines against each other: the worst state of each pair's usual methods.
    fn pairs(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        for quantity in QUANTITIES.into_iter().filter(|&quantity| quantity != Quantity::Readback) {
            let mut usual: Vec<&Finished> = Vec::new();
            for item in self.finished.iter().filter(|(cell, _)| cell.quantity == quantity.name()) {
                if usual.iter().all(|(cell, _)| cell.engine != item.0.engine) {
                    usual.push(item);
                }
            }
            for (i, (cell, outcome)) in usual.iter().enumerate() {
                for (other, other_outcome) in &usual[..i] {
                    if let (Some(values), Some(others)) = (outcome.values(), other_outcome.values()) {
                        let errors = if quantity == Quantity::ForwardDynamics {
                            self.forward_differences(others, values)
                        } else {
                            self.errors(quantity, others, values)
                        };
                        let row = Row {
                            states: "all".into(),
                            metric: "pairwise".into(),
                            unit: "1".into(),
                            reference: other.engine.clone(),
                            ..row(cell, self.robot)
                        };
                        rows.push(self.context.gates.explain(row.informed(errors.into_iter().fold(0.0, worst))));
                    }
                }
            }
        }
        rows
    }

    /// Each engine's inverse dynamics against ours *on the model that it read back*: what is left is the algorithm's.
    fn on_readback(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        for (built, outcome) in
            self.finished.iter().filter(|(cell, _)| cell.quantity == Quantity::Readback.name() && cell.engine != REFERENCE)
        {
            let usual =
                self.finished.iter().find(|(cell, _)| cell.engine == built.engine && cell.quantity == Quantity::InverseDynamics.name());
            let (Some(readback), Some((cell, answered))) = (outcome.values(), usual) else { continue };
            let (Some(values), Some(ours)) = (answered.values(), self.inverse_dynamics_of(readback)) else { continue };
            let errors = self.errors(Quantity::InverseDynamics, &ours, values);
            let row = Row {
                states: "all".into(),
                metric: "scaled_on_readback".into(),
                unit: "1".into(),
                reference: "featherbench on the model read back".into(),
                ..row(cell, self.robot)
            };
            rows.push(self.context.gates.explain(row.informed(errors.into_iter().fold(0.0, worst))));
        }
        rows
    }

    /// Our inverse dynamics at every state, of the robot with these inertias and placements.
    fn inverse_dynamics_of(&self, readback: &[f64]) -> Option<Vec<f64>> {
        let mut description = self.robot.description.clone();
        for (body, numbers) in description.bodies.iter_mut().zip(readback.chunks_exact(22)) {
            body.mass = numbers[0];
            body.com.copy_from_slice(&numbers[1..4]);
            body.inertia.copy_from_slice(&numbers[4..10]);
            body.joint.placement.rotation.copy_from_slice(&numbers[10..19]);
            body.joint.placement.translation.copy_from_slice(&numbers[19..22]);
        }
        let model = Model::<f64>::build(&description).ok()?;
        let states = &self.robot.states;
        let mut rnea = Rnea::new(&model.topology);
        let mut all = vec![0.0; states.count() * states.nv];
        for (k, tau) in all.chunks_exact_mut(states.nv).enumerate() {
            rnea.run(&model, states.q(k), states.v(k), states.a(k), None, tau).ok()?;
        }
        Some(all)
    }

    fn forward_differences(&self, reference: &[f64], values: &[f64]) -> Vec<f64> {
        let nv = self.robot.states.nv;
        let states = reference.chunks_exact(nv).zip(values.chunks_exact(nv)).zip(&self.forward);
        states.map(|((reference, value), scale)| scale.forward_error(reference, value)).collect()
    }
}
