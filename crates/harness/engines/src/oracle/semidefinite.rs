//! Least squares under semidefinite conditions, solved by the engine behind an oracle: the operation `semidefinite_least_squares`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, SemidefiniteProblem, SemidefiniteSolution, SemidefiniteSolver};
use featherbench_protocol::Block;
use serde_json::{Value, json};
use std::time::Duration;

impl SemidefiniteSolver for Oracle {
    fn semidefinite_methods(&self) -> Vec<String> {
        self.semidefinite.clone()
    }

    fn semidefinite_least_squares(
        &self,
        problem: &SemidefiniteProblem,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<SemidefiniteSolution, NoAnswer> {
        let (header, blocks) = request(problem, method, tolerance, iterations);
        let mut session = self.session()?;
        let answer = session.ask(header, blocks);
        self.give_back(session);
        let answer = answer?;
        let lost = |what: &str| NoAnswer::Failed(format!("the oracle's answer has no {what}"));
        let time = answer.header.get("nanoseconds").and_then(Value::as_f64).filter(|time| time.is_finite() && *time >= 0.0);
        Ok(SemidefiniteSolution {
            x: shaped(&answer, "x", &[problem.unknowns])?,
            multipliers: shaped(&answer, "multipliers", &[problem.bodies(), 16])?,
            converged: answer.header.get("converged").and_then(Value::as_bool).ok_or_else(|| lost("converged"))?,
            status: answer.text("solver_status").to_owned(),
            iterations: answer.header.get("iterations").and_then(Value::as_u64).ok_or_else(|| lost("iterations"))?,
            time: Duration::from_secs_f64(time.ok_or_else(|| lost("nanoseconds"))? * 1e-9),
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
