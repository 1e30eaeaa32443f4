//! Conditioning: how κ(M) grows with the length of a chain, raw and scaled, and how little it says.
//!
//! κ of M and of D^-½ M D^-½ (D = diag M) at the straight configuration, by eigenvalues; local exponents `log₂(κ(n)/κ(n/2))` against the robot of
//! the same family with half the dofs, where the suite has it. For the straight chain κ grows as n⁴ (Featherstone 2004); the structured floor
//! of forward dynamics stands beside it and does not grow.

use crate::row;
use featherbench_bench::truth::structured_floor;
use featherbench_bench::{Cell, Context, Finished, Outcome, Problem, Quantity, Refusal, Study};
use featherbench_dynamics::mass_matrix;
use featherbench_results::{Record, Verdict};
use nalgebra::DMatrix;
use serde_json::json;

/// The conditioning study.
pub struct Conditioning;

/// Eigenvalues of bigger matrices take minutes.
const MOST_DOFS: usize = 600;

impl Study for Conditioning {
    fn name(&self) -> &'static str {
        "conditioning"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let Some(native) = context.subject("native") else { return Vec::new() };
        let problems = context.problems.iter().filter(|problem| problem.takes(self.name()) && problem.states.nv <= MOST_DOFS);
        let cell = |problem: &Problem| Cell {
            study: self.name().into(),
            problem: problem.name.clone(),
            problem_hash: problem.hash.clone(),
            params: json!({"configuration": "straight"}),
            subject: native.identity().name.clone(),
            version: native.identity().version.clone(),
            method: "eigenvalues".into(),
            quantity: Quantity::MassMatrix.name().into(),
            scalar: "f64".into(),
        };
        problems.map(cell).collect()
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let problem = context.problem(&cell.problem).ok_or_else(|| Refusal::Failed("there is no problem of this cell".into()));
        problem
            .and_then(|problem| conditions(problem).ok_or_else(|| Refusal::Failed("M is singular at the straight configuration".into())))
            .into()
    }

    fn compare(&self, context: &Context, problem: &Problem, finished: &[Finished]) -> Vec<Record> {
        let half = context.problems.iter().find(|other| {
            other.takes(self.name())
                && other.family == problem.family
                && 2 * other.states.nv == problem.states.nv
                && other.base() == problem.base()
        });
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            let blank = Record { case: "straight".into(), unit: "1".into(), ..row(cell, problem) };
            let Some(&[raw, scaled]) = outcome.values() else {
                rows.push(blank.without_value(Verdict::Error, "there is no condition number"));
                continue;
            };
            let floor = structured_floor(problem, 0).filter(|floor| floor.is_finite());
            rows.push(Record { metric: "kappa".into(), floor, ..blank.clone() }.informed(raw));
            rows.push(Record { metric: "kappa_scaled".into(), floor, ..blank.clone() }.informed(scaled));
            if let Some([half_raw, half_scaled]) = half.and_then(conditions).as_deref() {
                for (metric, ratio) in [("kappa_exponent", raw / half_raw), ("kappa_scaled_exponent", scaled / half_scaled)] {
                    rows.push(Record { metric: metric.into(), ..blank.clone() }.informed(ratio.log2()));
                }
                let row = Record { metric: "kappa_off_quartic".into(), ..blank.clone() };
                rows.push(context.gates.judge(row, ((raw / half_raw).log2() - 4.0).abs(), 1.0));
            }
        }
        rows
    }
}

/// κ(M) and κ(D^-½ M D^-½) at q = 0.
fn conditions(problem: &Problem) -> Option<Vec<f64>> {
    let model = &problem.model;
    let mut q = vec![0.0; model.topology.nq()];
    for joint in model.topology.joints() {
        // A quaternion's scalar part is its last number.
        if joint.kind.nq() != joint.kind.nv() {
            q[joint.q + joint.kind.nq() - 1] = 1.0;
        }
    }
    let mass: DMatrix<f64> = mass_matrix(model, &q).ok()?.to_dense();
    let n = mass.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (mass[(i, i)] * mass[(j, j)]).sqrt());
    let condition = |m: DMatrix<f64>| {
        let eigenvalues = m.symmetric_eigenvalues();
        eigenvalues.max() / eigenvalues.min()
    };
    let conditions = vec![condition(mass), condition(scaled)];
    conditions.iter().all(|condition| condition.is_finite() && *condition > 0.0).then_some(conditions)
}
