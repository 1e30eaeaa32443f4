//! Least squares under semidefinite conditions, solved by the engine behind an oracle: the operation `semidefinite_least_squares`.

use super::{Oracle, own_time, shaped};
use featherbench_bench::{NoAnswer, SemidefiniteProblem, SemidefiniteSolution, SemidefiniteSolver};
use featherbench_protocol::Block;
use serde_json::{Value, json};

impl SemidefiniteSolver for Oracle {
    fn semidefinite_methods(&self) -> Vec<String> {
        self.hello.semidefinite_least_squares.clone()
    }

    fn semidefinite_least_squares(
        &self,
        problem: &SemidefiniteProblem,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<SemidefiniteSolution, NoAnswer> {
        let (header, blocks) = request(problem, method, tolerance, iterations);
        let answer = self.session()?.ask(header, blocks)?;
        let lost = |what: &str| NoAnswer::Failed(format!("the oracle's answer has no {what}"));
        Ok(SemidefiniteSolution {
            x: shaped(&answer, "x", &[problem.unknowns])?,
            multipliers: shaped(&answer, "multipliers", &[problem.bodies(), 16])?,
            converged: answer.header.get("converged").and_then(Value::as_bool).ok_or_else(|| lost("converged"))?,
            status: answer.text("solver_status").to_owned(),
            iterations: answer.header.get("iterations").and_then(Value::as_u64).ok_or_else(|| lost("iterations"))?,
            time: own_time(&answer)?,
        })
    }
}

/// The problem as a message.
pub(crate) fn request(problem: &SemidefiniteProblem, method: &str, tolerance: f64, iterations: usize) -> (Value, Vec<Block>) {
    let SemidefiniteProblem { unknowns, matrix, target, maps } = problem;
    let blocks = vec![
        Block::new("a", &[target.len(), *unknowns], matrix),
        Block::new("b", &[target.len()], target),
        Block::new("maps", &[problem.bodies(), 16, unknowns + 1], maps),
    ];
    (json!({"op": "semidefinite_least_squares", "method": method, "tolerance": tolerance, "iterations": iterations}), blocks)
}
