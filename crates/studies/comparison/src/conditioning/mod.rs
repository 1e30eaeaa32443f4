//! Conditioning: the growth of κ(M) with the length of a chain, raw and scaled, and how little it says.
//!
//! The condition numbers of M and of D^-½ M D^-½ (D = diag M) at the straight configuration, by eigenvalues. The local exponent is
//! `log₂(κ(n)/κ(n/2))`, against the robot of the same family with half the dofs, if the suite has it. For the straight chain κ grows as n⁴
//! (Featherstone 2004). The conditioning bound of forward dynamics is beside it, and does not grow.
//!
//! A robot with a floating base is partitioned instead: `floating_base.rs`.

mod floating_base;
pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::truth::conditioning_bound;
use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, NoSettings, OWN, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::mass_matrix;
use featherbench_results::{Row, Verdict};
use featherbench_study::{Entry, row};
use nalgebra::DMatrix;
use serde_json::json;

/// The conditioning study.
pub struct Conditioning;

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "conditioning",
    make: |setup| setup.made("conditioning", |_: NoSettings| Conditioning),
    sections: section::sections,
    words: words::WORDS,
};

/// Eigenvalues of larger matrices take minutes.
const MOST_DOFS: usize = 600;

impl Study for Conditioning {
    fn name(&self) -> &'static str {
        "conditioning"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let Some(featherbench) = context.engine(OWN) else { return Vec::new() };
        let robots = context.robots.iter().filter(|robot| robot.takes(self.name()) && robot.states.nv <= MOST_DOFS);
        let cell = |robot: &Robot| {
            let (method, params) = if floating_base::takes(robot) {
                (floating_base::METHOD, json!({"states": floating_base::STATES}))
            } else {
                ("eigenvalues", json!({"configuration": "straight"}))
            };
            Cell::new(self.name(), robot, featherbench.identity(), Quantity::MassMatrix.name(), method, params)
        };
        robots.map(cell).collect()
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let numbers = |robot: &Robot| {
            if asked.cell.method == floating_base::METHOD {
                return floating_base::numbers(robot).map_err(NoAnswer::Failed);
            }
            conditions(robot).ok_or_else(|| NoAnswer::Failed("M is singular at the straight configuration".into()))
        };
        asked.robot().and_then(numbers).into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let half = context.robots.iter().find(|other| {
            other.takes(self.name())
                && other.family == robot.family
                && 2 * other.states.nv == robot.states.nv
                && other.base() == robot.base()
        });
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            if cell.method == floating_base::METHOD {
                rows.extend(floating_base::rows(context, robot, cell, outcome));
                continue;
            }
            let blank = Row { states: "straight".into(), unit: "1".into(), ..row(cell, robot) };
            let Some(&[raw, scaled]) = outcome.values() else {
                rows.push(blank.without_value(Verdict::Error, "there is no condition number"));
                continue;
            };
            let floor = conditioning_bound(robot, 0).filter(|floor| floor.is_finite());
            rows.push(Row { metric: "kappa".into(), floor, ..blank.clone() }.informed(raw));
            rows.push(Row { metric: "kappa_scaled".into(), floor, ..blank.clone() }.informed(scaled));
            if let Some([half_raw, half_scaled]) = half.and_then(conditions).as_deref() {
                for (metric, ratio) in [("kappa_exponent", raw / half_raw), ("kappa_scaled_exponent", scaled / half_scaled)] {
                    rows.push(Row { metric: metric.into(), ..blank.clone() }.informed(ratio.log2()));
                }
                let row = Row { metric: "kappa_off_quartic".into(), ..blank.clone() };
                rows.push(context.gates.judge(row, ((raw / half_raw).log2() - 4.0).abs(), 1.0));
            }
        }
        rows
    }
}

/// κ(M) and κ(D^-½ M D^-½) at q = 0.
fn conditions(robot: &Robot) -> Option<Vec<f64>> {
    let model = &robot.model;
    let mut q = vec![0.0; model.topology.nq()];
    for joint in model.topology.joints() {
        // A quaternion's scalar part is its last number.
        if joint.kind.nq() != joint.kind.nv() {
            q[joint.q + joint.kind.nq() - 1] = 1.0;
        }
    }
    let mass: DMatrix<f64> = mass_matrix(model, &q).ok()?.to_dense();
    let scaled = scaled_to_unit_diagonal(&mass);
    let conditions = vec![condition(mass), condition(scaled)];
    conditions.iter().all(|condition| condition.is_finite() && *condition > 0.0).then_some(conditions)
}

/// D^-½ M D^-½ with D = diag M.
fn scaled_to_unit_diagonal(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / (matrix[(i, i)] * matrix[(j, j)]).sqrt())
}

/// The largest eigenvalue over the smallest.
fn condition(matrix: DMatrix<f64>) -> f64 {
    let eigenvalues = matrix.symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}
