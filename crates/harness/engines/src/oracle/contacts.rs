//! Contact problems, solved by the engine behind an oracle: the operations `contact_problems` and `solve_contacts`, and `contact_steps` and
//! `solve_contact_steps` of a robot on its contacts.

use super::{Oracle, Session, shaped};
use featherbench_bench::{ContactProblems, ContactSolver, ContactSteps, Evaluation, NoAnswer, StepMethod};
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
        let settings = json!({"op": "solve_contacts", "method": method, "tolerance": tolerance, "iterations": iterations});
        self.solving(Ok(request(problems)), settings, problems.count, problems.contacts)
    }

    fn contact_step_methods(&self) -> Vec<StepMethod> {
        self.contact_steps.clone()
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
        match session.ask(header, blocks) {
            Ok(_) => Ok(Box::new(Solving { oracle: self, session: Some(session), count, contacts, settings, impulses: Vec::new() })),
            Err(refusal) => {
                self.give_back(session);
                Err(refusal)
            }
        }
    }
}

/// What the part of `hello` about steps on contacts offers.
///
/// # Errors
/// A sentence, when it is no object of objects, or one names no `limit` among them.
pub(crate) fn steps_offered(offered: Option<&Value>) -> Result<Vec<StepMethod>, String> {
    let Some(offered) = offered else { return Ok(Vec::new()) };
    let wrong = || "`contact_steps` is no object: method → object of settings with `time` and `limit`, one of the methods".to_owned();
    let object = offered.as_object().ok_or_else(wrong)?;
    let method = |(name, settings): (&String, &Value)| {
        let limit = settings["limit"].as_str().is_some_and(|limit| object.contains_key(limit));
        let right = !name.is_empty() && settings["time"].is_string() && limit;
        right.then(|| StepMethod { name: name.clone(), settings: settings.clone() }).ok_or_else(wrong)
    };
    object.iter().map(method).collect()
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
    oracle: &'a Oracle,
    session: Option<Session>,
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
        let session = self.session.as_mut().ok_or_else(|| NoAnswer::Failed("the oracle has ended".into()))?;
        let answer = session.ask(question, Vec::new())?;
        self.impulses = shaped(&answer, "impulses", &[range.len().min(self.count), 3 * self.contacts])?;
        let nanoseconds = answer.header.get("nanoseconds").and_then(Value::as_f64).filter(|time| time.is_finite() && *time >= 0.0);
        let nanoseconds = nanoseconds.ok_or_else(|| NoAnswer::Failed("the oracle's answer has no nanoseconds".into()))?;
        Ok(Duration::from_secs_f64(nanoseconds * 1e-9))
    }

    fn together(&self) -> usize {
        self.count
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offer_names_its_time_and_its_limit() {
        assert_eq!(steps_offered(None).unwrap(), Vec::new());
        let good = json!({"newton": {"time": "all", "limit": "newton"}, "sweeps": {"time": "all", "limit": "newton", "impedance": 0.9}});
        let offered = steps_offered(Some(&good)).unwrap();
        assert_eq!(offered.iter().map(|method| method.name.as_str()).collect::<Vec<_>>(), ["newton", "sweeps"]);
        assert_eq!(offered[1].settings["impedance"], 0.9);
        for wrong in [
            json!(["newton"]),
            json!({"newton": 1}),
            json!({"newton": {"limit": "newton"}}),
            json!({"newton": {"time": "all"}}),
            json!({"newton": {"time": "all", "limit": "other"}}),
            json!({"": {"time": "all", "limit": ""}}),
        ] {
            assert!(steps_offered(Some(&wrong)).unwrap_err().contains("contact_steps"), "{wrong}");
        }
    }
}
