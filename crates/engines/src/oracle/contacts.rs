//! Contact problems, solved by the engine behind an oracle: the operations `contact_problems` and `solve_contacts`.

use super::{Oracle, Session, shaped};
use featherbench_bench::{ContactProblems, ContactSolver, Evaluation, NoAnswer};
use featherbench_protocol::Block;
use serde_json::{Value, json};
use std::ops::Range;
use std::time::Duration;

impl ContactSolver for Oracle {
    fn contact_methods(&self) -> Vec<String> {
        self.contact_solvers.clone()
    }

    fn contact_relaxations(&self) -> Vec<String> {
        self.contact_relaxations.clone()
    }

    fn prepare_contacts<'a>(
        &'a self,
        problems: &'a ContactProblems,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let mut session = self.session()?;
        let (header, blocks) = request(problems);
        match session.ask(header, blocks) {
            Ok(_) => {
                let settings = json!({"op": "solve_contacts", "method": method, "tolerance": tolerance, "iterations": iterations});
                Ok(Box::new(Solving { oracle: self, session: Some(session), problems, settings, impulses: Vec::new() }))
            }
            Err(refusal) => {
                self.give_back(session);
                Err(refusal)
            }
        }
    }
}

/// The problems as a message.
pub(crate) fn request(problems: &ContactProblems) -> (Value, Vec<Block>) {
    let ContactProblems { count, contacts, delassus, free, friction } = problems;
    let (count, rows) = (*count, 3 * contacts);
    let block = |name: &str, shape: &[usize], data: &[f64]| Block { name: name.into(), shape: shape.into(), data: data.into() };
    let blocks = vec![
        block("delassus", &[count, rows, rows], delassus),
        block("free", &[count, rows], free),
        block("friction", &[count, *contacts], friction),
    ];
    (json!({"op": "contact_problems", "count": count, "contacts": contacts}), blocks)
}

/// A session that has the problems.
struct Solving<'a> {
    oracle: &'a Oracle,
    session: Option<Session>,
    problems: &'a ContactProblems,
    /// The question without its range.
    settings: Value,
    impulses: Vec<f64>,
}

impl Evaluation for Solving<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.clock(range).map(|_| ())
    }

    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
        let mut question = self.settings.clone();
        (question["first"], question["count"]) = (range.start.into(), range.len().into());
        let session = self.session.as_mut().ok_or_else(|| NoAnswer::Failed("the oracle has ended".into()))?;
        let answer = session.ask(question, Vec::new())?;
        self.impulses = shaped(&answer, "impulses", &[range.len().min(self.problems.count), 3 * self.problems.contacts])?;
        let nanoseconds = answer.header.get("nanoseconds").and_then(Value::as_f64).filter(|time| time.is_finite() && *time >= 0.0);
        let nanoseconds = nanoseconds.ok_or_else(|| NoAnswer::Failed("the oracle's answer has no nanoseconds".into()))?;
        Ok(Duration::from_secs_f64(nanoseconds * 1e-9))
    }

    fn together(&self) -> usize {
        self.problems.count
    }

    fn read(&self) -> &[f64] {
        &self.impulses
    }
}

impl Drop for Solving<'_> {
    fn drop(&mut self) {
        if let Some(session) = self.session.take() {
            self.oracle.give_back(session);
        }
    }
}
