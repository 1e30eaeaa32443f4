//! Witnesses: the same samples through another engine's torque regressor, and what least squares make of it.

use super::{STUDY, failed, largest};
use featherbench_bench::{Asked, Cell, Context, Engine, NoAnswer, OWN, Outcome, Quantity, Robot};
use featherbench_identification::{Arm, Base, Information, Scenario, Stacking, Terms, ordinary};
use featherbench_results::{ModelOrigin, Row, Verdict};
use featherbench_robots::StateBatch;
use featherbench_study::{as_many, case_row, unanswered};
use nalgebra::{DMatrix, DVector};
use serde_json::json;

const QUANTITY: &str = "witness";
/// The rows of a cell: the regressor, entry by entry over its largest, and the base parameters over their largest.
const METRICS: [&str; 2] = ["regressor_difference", "parameter_difference"];

fn arms() -> [Arm; 2] {
    [Arm::puma560(), Arm::panda()]
}

pub(super) fn plan(context: &Context) -> Vec<Cell> {
    let engines = context.engines.iter().filter(|engine| engine.identity().name != OWN);
    let cells = engines.flat_map(|engine| {
        let identity = engine.identity().clone();
        let methods = engine.methods(Quantity::TorqueRegressor);
        methods.into_iter().flat_map(move |method| {
            let identity = identity.clone();
            arms().map(|arm| {
                let params = json!({"case": {"joints": arm.joints}, "seed": context.seed});
                Cell::of_case(STUDY, &arm.name, (&identity.name, &identity.version), QUANTITY, &method, params)
            })
        })
    });
    cells.collect()
}

pub(super) fn is_of(cell: &Cell) -> bool {
    cell.quantity == QUANTITY
}

pub(super) fn evaluate(asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
    let (engine, cell) = (asked.engine()?, asked.cell);
    let arm = arms().into_iter().find(|arm| arm.name == cell.robot).ok_or_else(|| NoAnswer::Failed("there is no such arm".into()))?;
    let scenario = Scenario::of(&arm, Terms::NONE, 80).map_err(failed)?;
    let linear = &scenario.linear;
    let robot = Robot::new(linear.description(), "arm", ModelOrigin::Generated, 1, asked.context.seed).map_err(failed)?;
    let theirs = regressor(engine, &robot, &cell.method, &scenario)?;
    let ours = own(&scenario)?;
    let matrix_difference = largest(theirs.iter().zip(&ours).map(|(a, b)| a - b)) / largest(ours.iter().copied());
    let found = ordinary(linear, &scenario.fitted).map_err(failed)?;
    let matrix = DMatrix::from_row_slice(scenario.fitted.tau.len(), linear.unknowns().len(), &theirs);
    let tau = DVector::from_column_slice(&scenario.fitted.tau);
    // Their regressor, our choice of base parameters.
    let base: Base = Base::of(&Information::of(linear, &scenario.fitted, &Stacking::plain(linear)).map_err(failed)?).map_err(failed)?;
    let solved = matrix.select_columns(&base.independent).svd(true, true).solve(&tau, 0.0).map_err(failed)?;
    let parameters = largest(solved.iter().zip(&found.beta).map(|(a, b)| a - b)) / largest(found.beta.iter().copied());
    Ok(vec![matrix_difference, parameters])
}

/// The engine's regressors of the samples, state after state, row after row.
fn regressor(engine: &dyn Engine, robot: &Robot, method: &str, scenario: &Scenario) -> Result<Vec<f64>, NoAnswer> {
    let (samples, nv) = (&scenario.fitted, robot.model.topology.nv());
    let count = samples.count();
    let bodies = robot.model.described.len();
    let states = StateBatch {
        cases: vec![featherbench_robots::Case::Random; count],
        q: samples.q.clone(),
        v: samples.v.clone(),
        a: samples.a.clone(),
        tau: samples.tau.clone(),
        wrench: vec![0.0; count * bodies * 6],
        ..robot.states.clone()
    };
    let mut evaluation = engine.prepare(robot, Quantity::TorqueRegressor, method, &states)?;
    evaluation.run(0..count)?;
    let values = evaluation.read();
    as_many(values.len(), count * nv * bodies * 10)?;
    Ok(values.to_vec())
}

fn own(scenario: &Scenario) -> Result<Vec<f64>, NoAnswer> {
    let linear = &scenario.linear;
    let mut rows = featherbench_identification::Rows::new(linear);
    let mut values = Vec::new();
    for k in 0..scenario.fitted.count() {
        let (q, v, a) = scenario.fitted.state(linear, k);
        let block = rows.at(linear, q, v, a).map_err(failed)?;
        values.extend(block.transpose().iter());
    }
    Ok(values)
}

pub(super) fn rows(context: &Context, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let blank = Row { reference: OWN.into(), ..case_row(cell) };
    match outcome.answer().and_then(|values| as_many(values.len(), METRICS.len()).map(|()| values)) {
        Ok(values) => {
            let row = |(metric, &value): (&&str, &f64)| {
                context.gates.judge(Row { metric: (*metric).into(), unit: "1".into(), ..blank.clone() }, value, 1.0)
            };
            METRICS.iter().zip(values).map(row).collect()
        }
        Err(no_answer) => vec![unanswered(blank, &no_answer, Verdict::Info)],
    }
}
