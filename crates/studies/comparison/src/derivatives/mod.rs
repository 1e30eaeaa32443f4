//! Derivatives: ∂ID and ∂FD by q and v, the Coriolis matrix and the torque regressor of every engine, against the truth.
//!
//! The truth is dual numbers over double-double through our kernels ([`TrueDerivatives`]); a test compares these with differences in
//! double-double. An error is the largest scaled difference over the largest scaled entry (`featherbench_bench::measure`).
//! - A method's rows are the worst state of each case, and the median over the states.
//! - A method by finite differences (`difference…_EPS`) has no gate: its worst and median rows say what its step costs, with `eps` among
//!   the parameters.
//! - The derivatives of FD have the median of the conditioning bounds of the first states beside them. The median of the errors over these
//!   bounds is a row.
//!
//! An engine without a quantity has a row that says so.

pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::measure::{ForwardScale, ratio, scaled_error, worst};
use featherbench_bench::statistics::quantile_of;
use featherbench_bench::truth::TrueDerivatives;
use featherbench_bench::{
    Asked, Cell, Context, DENSE_LIMIT, Engine, Finished, NoAnswer, OWN, Outcome, Quantity, Robot, Study, derivative_floor,
};
use featherbench_results::{Row, Verdict, canonical_json};
use featherbench_robots::Case;
use featherbench_study::{Entry, row, unanswered};
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::json;

/// The study's name in rows.
pub(crate) const STUDY: &str = "derivatives";
/// The name of the reference in rows.
const TRUTH: &str = "truth";
/// The beginning of the names of methods by finite differences, and the sign before their step.
const DIFFERENCE: &str = "difference";
/// The method of an engine that does not have a quantity.
const NONE: &str = "none";
/// Above this size no conditioning bound is computed: it takes O(n³) runs of forward dynamics.
const FLOOR_DOFS: usize = 50;
/// The states that have a bound, from the first.
const FLOOR_STATES: usize = 5;
/// A derivative that is zero has no bound: what is left is rounding of the bound's own computation.
const NO_FLOOR: f64 = 1e-20;

/// The study of derivatives: the table `[derivatives]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Derivatives {
    /// Whether the suite's engines are asked beside ours. Recordings have no derivatives: a suite that runs without live engines says no.
    pub peers: bool,
    /// The most dofs of a robot.
    pub most_dofs: usize,
}

impl Default for Derivatives {
    fn default() -> Self {
        Self { peers: true, most_dofs: DENSE_LIMIT }
    }
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "derivatives",
    make: |setup| setup.made(STUDY, |study: Derivatives| study),
    sections: section::sections,
    words: words::WORDS,
};

impl Study for Derivatives {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        self.peers
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        let most = self.most_dofs.min(DENSE_LIMIT);
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name()) && robot.states.nv <= most) {
            let params = json!({"base": robot.base(), "joints": robot.joint_kinds(), "states": robot.states.count()});
            for engine in context.engines.iter().filter(|engine| self.peers || engine.identity().name == OWN) {
                for quantity in Quantity::DERIVATIVES {
                    let mut methods = engine.methods(quantity);
                    if methods.is_empty() {
                        methods.push(NONE.into());
                    }
                    let cell = |method| Cell::new(self.name(), robot, engine.identity(), quantity.name(), method, params.clone());
                    cells.extend(methods.into_iter().map(cell));
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let cell = asked.cell;
        if cell.method == NONE {
            return Outcome::NoAnswer(NoAnswer::NotOffered(format!("{} has no {}", cell.engine, cell.quantity)));
        }
        featherbench_study::evaluate(asked)
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let at = robot.magnitudes();
        let conditions: Vec<f64> = ForwardScale::all(robot, &at).iter().map(|scale| scale.condition).collect();
        let still = vec![1.0; at.len()];
        let mut rows = Vec::new();
        for quantity in Quantity::DERIVATIVES {
            let asked = || finished.iter().filter(|(cell, _)| cell.quantity == quantity.name());
            let truth = true_values(robot, quantity);
            let floors = floors(robot, quantity);
            let floor = (!floors.is_empty()).then(|| median(&floors.iter().map(|(_, floor)| *floor).collect::<Vec<_>>()));
            let growth = if is_forward(quantity) { &conditions } else { &still };
            for (cell, outcome) in asked() {
                let blank = Row { reference: TRUTH.into(), unit: "1".into(), states: "all".into(), floor, ..row(cell, robot) };
                let singular = || NoAnswer::Failed("M is singular: there is no true answer".into());
                match outcome.answer().and_then(|values| Ok((truth.as_ref().ok_or_else(singular)?, values))) {
                    Ok((truth, values)) => {
                        let states = values.chunks_exact(quantity.size(robot)).zip(truth).zip(&at);
                        let errors: Vec<f64> = states.map(|((value, truth), at)| scaled_error(robot, quantity, at, truth, value)).collect();
                        rows.extend(of_answer(context, robot, &blank, &errors, growth, &floors));
                    }
                    Err(no_answer) => rows.push(context.gates.explain(unanswered(blank, &no_answer, Verdict::Skip))),
                }
            }
        }
        rows
    }
}

/// The true values at every state; `None` where one does not exist.
fn true_values(robot: &Robot, quantity: Quantity) -> Option<Vec<Vec<f64>>> {
    let mut truth = TrueDerivatives::new(robot)?;
    (0..robot.states.count()).map(|k| truth.answer(robot, quantity, k)).collect()
}

/// The conditioning bounds at the first states, with their numbers, of a derivative of forward dynamics of a robot that is not too big.
fn floors(robot: &Robot, quantity: Quantity) -> Vec<(usize, f64)> {
    let count = if is_forward(quantity) && robot.states.nv <= FLOOR_DOFS { robot.states.count().min(FLOOR_STATES) } else { 0 };
    let bound = |state| Some((state, derivative_floor(robot, quantity, state)?));
    (0..count).into_par_iter().filter_map(bound).filter(|(_, floor)| *floor > NO_FLOOR).collect()
}

/// Whether it is a derivative of forward dynamics: its error may grow by the condition number of D^-½ M D^-½, as
/// `D^½ ∂FD D^-½ = (D^-½ M D^-½)⁻¹ D^-½ ∂ID D^-½` up to the sign.
fn is_forward(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::ForwardDynamicsDq | Quantity::ForwardDynamicsDv)
}

/// The rows of one method's errors at each state, which may grow there by these factors.
fn of_answer(context: &Context, robot: &Robot, blank: &Row, errors: &[f64], growth: &[f64], floors: &[(usize, f64)]) -> Vec<Row> {
    if let Some(eps) = step(&blank.method) {
        let params = canonical_json(&json!({"eps": eps, "base": robot.base(), "joints": robot.joint_kinds()}));
        let largest = errors.iter().copied().fold(0.0, worst);
        let told = [("difference_worst", largest), ("difference_median", median(errors))];
        let of = |(metric, value): (&str, f64)| {
            let row = Row { metric: metric.into(), params: params.clone(), ..blank.clone() };
            context.gates.judge(row, value, 1.0)
        };
        return told.map(of).into();
    }
    let mut rows = Vec::new();
    for (case, state) in per_case(robot, errors, growth) {
        let row = Row { metric: "true".into(), states: case.name().into(), ..blank.clone() };
        rows.push(context.gates.judge(row, errors[state], growth[state]));
    }
    rows.push(context.gates.judge(Row { metric: "error_median".into(), ..blank.clone() }, median(errors), 1.0));
    if !floors.is_empty() {
        let over: Vec<f64> = floors.iter().map(|&(state, floor)| ratio(errors[state], floor)).collect();
        rows.push(context.gates.judge(Row { metric: "error_over_floor".into(), ..blank.clone() }, median(&over), 1.0));
    }
    rows
}

/// The step of a method by finite differences: the number after its last `_`.
fn step(method: &str) -> Option<f64> {
    method.strip_prefix(DIFFERENCE)?.rsplit('_').next()?.parse().ok().filter(|eps: &f64| *eps > 0.0)
}

/// The state of each case whose error is the largest for its growth, in the order of first appearance. A NaN is the largest of all.
fn per_case(robot: &Robot, errors: &[f64], growth: &[f64]) -> Vec<(Case, usize)> {
    let share = |state: usize| ratio(errors[state], growth[state]);
    let mut cases: Vec<(Case, usize)> = Vec::new();
    for (state, &case) in robot.states.cases.iter().enumerate() {
        match cases.iter_mut().find(|(known, _)| *known == case) {
            None => cases.push((case, state)),
            Some((_, found)) if share(state).is_nan() || share(state) > share(*found) => *found = state,
            Some(_) => {}
        }
    }
    cases
}

/// The median; NaN if one of them is.
fn median(errors: &[f64]) -> f64 {
    if errors.iter().any(|error| error.is_nan()) { f64::NAN } else { quantile_of(errors, 0.5) }
}

#[cfg(test)]
mod tests {
    use super::{median, step};

    #[test]
    fn the_step_is_in_the_method() {
        assert_eq!([step("difference_1e-6"), step("difference_centred_1e-9")], [Some(1e-6), Some(1e-9)]);
        assert_eq!([step("dual"), step("difference"), step("difference_centred"), step("difference_-1")], [None; 4]);
    }

    #[test]
    fn a_lost_error_makes_the_median_none() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert!(median(&[3.0, f64::NAN, 2.0]).is_nan() && median(&[]).is_nan());
    }
}
