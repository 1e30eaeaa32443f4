//! Contact problems, solved by the engine behind an oracle: the operations `contact_problems` and `solve_contacts`, and `contact_steps` and
//! `solve_contact_steps` of a robot on its contacts.

use super::{Lent, Oracle, own_time, shaped};
use featherbench_bench::{ContactProblems, ContactSolver, ContactSteps, Evaluation, NoAnswer, StepMethod};
use featherbench_protocol::Block;
use serde_json::{Value, json};
use std::ops::Range;
use std::time::Duration;

impl ContactSolver for Oracle {
    fn contact_methods(&self) -> Vec<String> {
        self.hello.contact_solvers.clone()
    }

    fn contact_relaxations(&self) -> Vec<String> {
        self.hello.contact_relaxations.clone()
    }

    fn prepare_contacts<'a>(
        &'a self,
        problems: &'a ContactProblems,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let settings = json!({"op": "solve_contacts", "method": method, "tolerance": tolerance, "iterations": iterations});
        self.solving(Ok(request(problems)), settings, problems.count, problems.contacts)
    }

    fn contact_step_methods(&self) -> Vec<StepMethod> {
        self.hello.contact_steps()
    }

    fn prepare_contact_steps<'a>(
        &'a self,
        steps: &'a ContactSteps,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let settings = json!({"op": "solve_contact_steps", "method": method, "tolerance": tolerance, "iterations": iterations});
        self.solving(steps_request(steps), settings, steps.count, steps.bodies.len())
    }
}

impl Oracle {
    /// Sends problems, and makes a method ready for them.
    fn solving(
        &self,
        request: Result<(Value, Vec<Block>), NoAnswer>,
        settings: Value,
        count: usize,
        contacts: usize,
    ) -> Result<Box<dyn Evaluation + '_>, NoAnswer> {
        let (header, blocks) = request?;
        let mut session = self.session()?;
        session.ask(header, blocks)?;
        Ok(Box::new(Solving { session, count, contacts, settings, impulses: Vec::new() }))
    }
}

/// A robot on its contacts as a message.
pub(crate) fn steps_request(steps: &ContactSteps) -> Result<(Value, Vec<Block>), NoAnswer> {
    let ContactSteps { robot, dt, bodies, points, friction, count, q, v, tau } = steps;
    let line = featherbench_formats::neutral::to_line(robot).map_err(|error| NoAnswer::Failed(error.to_string()))?;
    let model: Value = serde_json::from_str(&line).map_err(|error| NoAnswer::Failed(error.to_string()))?;
    let (nq, nv, contacts) = (robot.nq(), robot.nv(), bodies.len());
    let blocks = vec![
        Block::new("points", &[contacts, 3], points),
        Block::new("friction", &[contacts], friction),
        Block::new("q", &[*count, nq], q),
        Block::new("v", &[*count, nv], v),
        Block::new("tau", &[*count, nv], tau),
    ];
    Ok((json!({"op": "contact_steps", "model": model, "dt": dt, "bodies": bodies, "count": count}), blocks))
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
    session: Lent<'a>,
    /// How many problems there are, and contacts in each.
    count: usize,
    contacts: usize,
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
        let answer = self.session.ask(question, Vec::new())?;
        self.impulses = shaped(&answer, "impulses", &[range.len().min(self.count), 3 * self.contacts])?;
        own_time(&answer)
    }

    fn together(&self) -> usize {
        self.count
    }

    fn read(&self) -> &[f64] {
        &self.impulses
    }
}
