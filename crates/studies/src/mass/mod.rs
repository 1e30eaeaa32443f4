//! Mass: the mass of each robot, by our kernels.

pub(crate) mod section;

use crate::{Setup, row};
use featherbench_bench::{Cell, Context, Finished, HarnessError, NoAnswer, NoSettings, OWN, Outcome, Robot, Study};
use featherbench_results::{Row, Verdict};
use serde_json::json;

/// The study of masses.
struct Mass;

/// The study, if the suite asks for it.
pub(crate) fn of_suite(setup: &Setup) -> Result<Option<Box<dyn Study>>, HarnessError> {
    Ok(setup.suite.settings::<NoSettings>("mass")?.map(|_| Box::new(Mass) as _))
}

impl Study for Mass {
    fn name(&self) -> &'static str {
        "mass"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let Some(engine) = context.engine(OWN) else { return Vec::new() };
        let cell = |robot: &Robot| Cell {
            study: self.name().into(),
            robot: robot.name.clone(),
            robot_hash: robot.hash.clone(),
            params: json!({}),
            engine: engine.identity().name.clone(),
            version: engine.identity().version.clone(),
            method: "sum".into(),
            quantity: "mass".into(),
            scalar: "f64".into(),
        };
        context.robots.iter().filter(|robot| robot.takes(self.name())).map(cell).collect()
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let mass = |robot: &Robot| vec![robot.description.bodies.iter().map(|body| body.mass).sum()];
        context.robot(&cell.robot).map(mass).ok_or_else(|| NoAnswer::Failed("there is no robot of this cell".into())).into()
    }

    fn compare(&self, _: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let of = |(cell, outcome): &Finished| {
            let blank = Row { metric: "sum".into(), unit: "kg".into(), ..row(cell, robot) };
            match outcome.answer() {
                Ok(values) => blank.informed(values[0]),
                Err(no_answer) => blank.without_value(Verdict::Error, no_answer.to_string()),
            }
        };
        finished.iter().map(of).collect()
    }
}
