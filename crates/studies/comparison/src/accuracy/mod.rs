//! Accuracy: the distance of each engine and method from the truth, which says which engine is right.
//!
//! The reference is the answer in double-double arithmetic ([`featherbench_bench::truth`]), not an engine. The quartiles are over the
//! states.
//! - Inverse dynamics and M have the unit-free measures of the agreement study.
//! - Forward dynamics has the kinetic-energy norm, against the bound that a backward stable method keeps.
//! - Forward dynamics also has the 2-norm, for the comparison with published tables, with the conditioning bound beside it.
//!
//! When the best answers of several engines all have the same error, the accuracy of the reference may be the limit. A row per robot gives
//! the number of engines that are limited by the reference (`limited_by_the_reference`).

pub mod section;
pub(crate) mod words;

use featherbench_bench::measure::{ForwardScale, scaled_error};
use featherbench_bench::truth::{Truth, TruthModel, conditioning_bound};
use featherbench_bench::{Asked, Cell, Context, DENSE_LIMIT, Engine, Finished, NoSettings, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::TreeSparse;
use featherbench_results::{Row, Verdict};
use featherbench_study::{Entry, row, unanswered};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The accuracy study, and the study `sweep`, which asks the same of drawn robots at one state each.
pub struct Accuracy {
    name: &'static str,
    /// The quantiles over the states that have rows.
    quantiles: &'static [(&'static str, f64)],
    /// Whether errors of several engines that are alike throw a suspicion on the reference. At a single state they are alike by chance.
    suspects: bool,
}

impl Accuracy {
    /// The accuracy study.
    pub const STATES: Self = Self {
        name: "accuracy",
        quantiles: &[("error_q1", 0.25), ("error_median", 0.5), ("error_q3", 0.75), ("error_worst", 1.0)],
        suspects: true,
    };
    /// The same of drawn robots. Their quantiles are over the robots: the report takes them from the rows.
    pub const SWEEP: Self = Self { name: "sweep", quantiles: &[("error_worst", 1.0)], suspects: false };
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "accuracy",
    make: |setup| setup.made("accuracy", |_: NoSettings| Accuracy::STATES),
    sections: section::sections,
    words: words::WORDS,
};

/// The quantities that are compared with the truth.
const QUANTITIES: [Quantity; 5] = [
    Quantity::InverseDynamics,
    Quantity::MassMatrix,
    Quantity::MassMatrixProbe,
    Quantity::ForwardDynamics,
    Quantity::ForwardDynamicsSingle,
];
/// The parameters of a cell and its rows: at which levels the robot was drawn, if it was.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Params {
    base: String,
    states: usize,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) axes: BTreeMap<String, Value>,
}

/// The name of the reference in rows.
const TRUTH: &str = "truth";
/// The conditioning bound hardly depends on the state. Its median over a few is enough, and each costs O(n²).
const FLOOR_STATES: usize = 3;
/// Above this size no conditioning bound is computed.
const FLOOR_DOFS: usize = 300;

impl Study for Accuracy {
    fn name(&self) -> &'static str {
        self.name
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
            let big = robot.states.nv > DENSE_LIMIT;
            let params = Params { base: robot.base().into(), states: robot.states.count(), axes: robot.axes.clone() };
            for engine in context.engines {
                let identity = engine.identity();
                for quantity in QUANTITIES {
                    let other_form = if big { Quantity::MassMatrix } else { Quantity::MassMatrixProbe };
                    if quantity == other_form {
                        continue;
                    }
                    let scalar = if quantity.precision() == "f32" { "f32" } else { identity.scalar() };
                    cells.extend(engine.methods(quantity).into_iter().map(|method| Cell {
                        scalar: scalar.into(),
                        ..Cell::new(self.name(), robot, identity, quantity.name(), method, &params)
                    }));
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        featherbench_study::evaluate(asked)
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let model = TruthModel::new(robot);
        let truth: Option<Vec<Truth>> = (0..robot.states.count()).map(|k| model.as_ref()?.at(robot, k)).collect();
        let Some(truth) = truth else {
            let unknown = |(cell, _): &Finished| row(cell, robot).without_value(Verdict::Error, "there is no truth for this robot");
            return finished.iter().map(unknown).collect();
        };
        let at = robot.magnitudes();
        let forward = ForwardScale::all(robot, &at);
        let floors = if robot.states.nv <= FLOOR_DOFS { robot.states.count().min(FLOOR_STATES) } else { 0 };
        let floors: Vec<f64> = (0..floors).map(|k| conditioning_bound(robot, k).unwrap_or(f64::NAN)).collect();
        let floor = median(&mut floors.iter().copied().filter(|floor| floor.is_finite()).collect::<Vec<_>>());

        let (mut rows, mut medians) = (Vec::new(), Vec::new());
        for (cell, outcome) in finished {
            let blank = Row { reference: TRUTH.into(), unit: "1".into(), states: "all".into(), ..row(cell, robot) };
            let (values, quantity) = match outcome.answer().and_then(|values| Ok((values, Asked::of(context, cell).quantity()?))) {
                Ok(answered) => answered,
                Err(no_answer) => {
                    rows.push(context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip)));
                    continue;
                }
            };
            if matches!(quantity, Quantity::ForwardDynamics | Quantity::ForwardDynamicsSingle) {
                let answers = values.chunks_exact(robot.states.nv).zip(&truth).zip(&forward);
                let Some(errors) = answers
                    .map(|((a, truth), scale)| Some(forward_errors(a, truth.forward_dynamics.as_ref()?, scale)))
                    .collect::<Option<Vec<_>>>()
                else {
                    rows.push(context.gates.explain(blank.without_value(Verdict::Error, "M is singular: there is no true answer")));
                    continue;
                };
                if let Some(worst) = most_off(&errors) {
                    let row = Row { metric: "true_forward".into(), floor, ..blank.clone() };
                    rows.push(context.gates.judge(row, worst.energy, worst.bound));
                }
                let mut plain: Vec<f64> = errors.iter().map(|error| error.plain).collect();
                let blank = Row { floor, ..blank };
                if quantity == Quantity::ForwardDynamics {
                    rows.extend(over_floor(context, &blank, &plain, &floors));
                    let mut residuals: Vec<f64> =
                        values.chunks_exact(robot.states.nv).zip(&forward).map(|(a, scale)| scale.residual(a)).collect();
                    let typical = median(&mut residuals);
                    rows.extend(typical.map(|residual| Row { metric: "residual_median".into(), ..blank.clone() }.informed(residual)));
                }
                rows.extend(self.quantiles(context, &blank, &mut plain));
                if quantity == Quantity::ForwardDynamics {
                    medians.extend(median(&mut plain).map(|error| (cell.engine.clone(), error)));
                }
            } else {
                let size = quantity.size(robot);
                let answers = values.chunks_exact(size).zip(&truth).zip(&at);
                let mut errors: Vec<f64> = answers
                    .map(|((value, truth), at)| scaled_error(robot, quantity, at, &true_value(robot, quantity, truth), value))
                    .collect();
                let worst = errors.iter().copied().fold(0.0, featherbench_bench::measure::worst);
                rows.push(context.gates.judge(Row { metric: "true".into(), ..blank.clone() }, worst, 1.0));
                rows.extend(self.quantiles(context, &blank, &mut errors));
            }
        }
        let standing = self.suspects.then(|| limited_by_the_reference(&medians, floor)).flatten();
        if let (Some((cell, _)), Some(standing)) = (finished.first(), standing) {
            let row = Row { engine: "all".into(), engine_version: String::new(), method: String::new(), ..row(cell, robot) };
            let row = Row {
                quantity: "fd".into(),
                metric: "limited_by_the_reference".into(),
                unit: "1".into(),
                states: "all".into(),
                floor,
                ..row
            };
            rows.push(row.informed(standing as f64));
        }
        rows
    }
}

impl Accuracy {
    /// The quantiles of the errors, as measured rows. A row with a gate is judged.
    fn quantiles(&self, context: &Context, blank: &Row, errors: &mut [f64]) -> Vec<Row> {
        sort(errors);
        let of = |&(metric, fraction): &(&str, f64)| {
            let row = Row { metric: metric.into(), ..blank.clone() };
            context.gates.judge(row, featherbench_bench::statistics::quantile(errors, fraction), 1.0)
        };
        self.quantiles.iter().map(of).collect()
    }
}

/// The errors of one forward-dynamics answer.
struct ForwardErrors {
    /// In the kinetic-energy norm.
    energy: f64,
    /// The bound for a backward error of one, in that norm.
    bound: f64,
    /// In the 2-norm.
    plain: f64,
}

/// The error with the largest ratio to its bound; a NaN counts as larger than any.
fn most_off(errors: &[ForwardErrors]) -> Option<&ForwardErrors> {
    let share = |error: &ForwardErrors| error.energy / error.bound;
    errors.iter().reduce(|a, b| if share(a).is_nan() || share(a) >= share(b) { a } else { b })
}

/// Sorts errors. If one is NaN, all become NaN: a NaN has a sign, and its total order may put it below all numbers.
fn sort(errors: &mut [f64]) {
    if errors.iter().any(|error| error.is_nan()) {
        errors.fill(f64::NAN);
    }
    errors.sort_unstable_by(f64::total_cmp);
}

fn forward_errors(a: &[f64], truth: &[f64], scale: &ForwardScale) -> ForwardErrors {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    let plain = featherbench_bench::measure::ratio(norm(&mut a.iter().zip(truth).map(|(a, t)| a - t)), norm(&mut truth.iter().copied()));
    // The truth has no backward error: half of the amplification for two answers.
    ForwardErrors { energy: scale.forward_error(truth, a), bound: 0.5 * scale.amplification, plain }
}

fn true_value(robot: &Robot, quantity: Quantity, truth: &Truth) -> Vec<f64> {
    let n = robot.states.nv;
    match quantity {
        Quantity::MassMatrix => (0..n * n).map(|entry| truth.mass.get(entry / n, entry % n)).collect(),
        Quantity::MassMatrixProbe => probe(&truth.mass, &robot.probe()),
        _ => truth.inverse_dynamics.clone(),
    }
}

/// Products with the four vectors, diagonal and last row of M.
fn probe(mass: &TreeSparse<f64>, vectors: &[f64]) -> Vec<f64> {
    let n = mass.size();
    let mut values = vec![f64::NAN; 4 * n];
    for (x, y) in vectors.chunks_exact(n).zip(values.chunks_exact_mut(n)) {
        if mass.mul(x, y).is_err() {
            y.fill(f64::NAN);
        }
    }
    values.extend(mass.diagonal());
    values.extend((0..n).map(|j| mass.get(n - 1, j)));
    values
}

/// The largest ratio of an error to the conditioning bound of its state: what the algorithm adds to the effect of rounding the inputs.
fn over_floor(context: &Context, blank: &Row, errors: &[f64], floors: &[f64]) -> Option<Row> {
    let pairs = errors.iter().zip(floors).filter(|(_, floor)| floor.is_finite());
    let worst =
        pairs.map(|(error, floor)| featherbench_bench::measure::ratio(*error, *floor)).reduce(featherbench_bench::measure::worst)?;
    let row = Row { metric: "error_over_floor".into(), ..blank.clone() };
    Some(context.gates.judge(row, worst, 1.0))
}

fn median(values: &mut [f64]) -> Option<f64> {
    sort(values);
    (!values.is_empty()).then(|| featherbench_bench::statistics::quantile(values, 0.5))
}

/// The number of engines whose smallest error e is within a factor of two of the smallest of all, e ≤ 2·e_min. `None` unless there are at
/// least three, and e_min > 64·max(ε, conditioning bound). Several engines at one error are no coincidence: then the reference is the
/// suspect.
fn limited_by_the_reference(errors: &[(String, f64)], floor: Option<f64>) -> Option<usize> {
    let mut best: Vec<(&str, f64)> = Vec::new();
    for (engine, error) in errors {
        match best.iter_mut().find(|(known, _)| known == engine) {
            Some((_, least)) => *least = least.min(*error),
            None => best.push((engine, *error)),
        }
    }
    let least = best.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
    let above_rounding = least > 64.0 * floor.unwrap_or(0.0).max(f64::EPSILON);
    let standing = best.iter().filter(|(_, error)| *error <= 2.0 * least).count();
    (above_rounding && standing >= 3).then_some(standing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_that_go_flat_together_are_limited_by_the_reference() {
        let errors =
            |values: [f64; 3]| ["a", "b", "c"].into_iter().zip(values).map(|(name, error)| (name.to_owned(), error)).collect::<Vec<_>>();
        assert_eq!(
            limited_by_the_reference(&errors([1.0e-11, 1.1e-11, 1.5e-11]), Some(2e-16)),
            Some(3),
            "three engines at the error of the reference"
        );
        assert_eq!(limited_by_the_reference(&errors([1e-15, 1e-12, 1e-9]), Some(2e-16)), None, "each where its algorithm puts it");
        assert_eq!(limited_by_the_reference(&errors([3e-16, 3e-16, 3e-16]), Some(2e-16)), None, "all at the floor: nothing is wrong");
    }

    /// On x86 the NaN of 0/0 and ∞ − ∞ is negative, and below all numbers in the total order.
    #[test]
    fn an_answer_that_is_no_number_is_the_worst() {
        let answers = |energies: [f64; 3]| energies.map(|energy| ForwardErrors { energy, bound: 2.0, plain: energy });
        assert_eq!(most_off(&answers([1.0, 3.0, 2.0])).unwrap().energy, 3.0);
        assert!(most_off(&[]).is_none());
        for lost in [f64::NAN, -f64::NAN] {
            for place in 0..3 {
                let mut energies = [1.0, 3.0, 2.0];
                energies[place] = lost;
                assert!(most_off(&answers(energies)).unwrap().energy.is_nan(), "at {place}");
                assert!(median(&mut energies).unwrap().is_nan(), "at {place}");
                assert!(energies.iter().all(|error| error.is_nan()), "no quartile is a number");
            }
        }
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
    }
}
