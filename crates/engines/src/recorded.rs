//! A subject that plays back what an oracle answered: `datasets/recorded/ENGINE/MODEL.frames`.
//!
//! The first frame tells who answered about which robot and carries the states; each further frame is one outcome; the last says how
//! many there were, so that a truncated file is known as such.

use harness::frame::{Block, Frame, FrameError};
use harness::{Identity, Outcome, Prepared, Problem, Quantity, Refusal, Subject};
use model::StateBatch;
use record::EngineSource;
use serde_json::json;
use std::collections::{BTreeMap, HashMap};
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why recorded answers cannot be used.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is damaged.
    #[error("{path}: {what}; record it again with `featherbench record`")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
}

/// What one engine answered about one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Who answered.
    pub identity: Identity,
    /// The robot's name.
    pub model: String,
    /// The problem's content hash.
    pub problem_hash: String,
    /// The states: blocks q, v, a, tau, wrench.
    pub states: Vec<Block>,
    /// The outcomes by quantity and method, in the order of the engine's methods.
    pub outcomes: Vec<(Quantity, String, Outcome)>,
}

/// The states as they stand in a recording.
fn state_blocks(states: &StateBatch) -> Vec<Block> {
    let (count, nv) = (states.count(), states.nv);
    vec![
        Block::new("q", &[count, states.nq], &states.q),
        Block::new("v", &[count, nv], &states.v),
        Block::new("a", &[count, nv], &states.a),
        Block::new("tau", &[count, nv], &states.tau),
        Block::new("wrench", &[count, states.bodies, 6], &states.wrench),
    ]
}

impl Recording {
    /// The recording of these outcomes.
    pub fn new(identity: &Identity, problem: &Problem, outcomes: Vec<(Quantity, String, Outcome)>) -> Self {
        let (model, problem_hash) = (problem.name.clone(), problem.hash.clone());
        Self { identity: identity.clone(), model, problem_hash, states: state_blocks(&problem.states), outcomes }
    }

    /// The recording as bytes. A dense mass matrix that is symmetric to the bit is kept as its lower triangle.
    pub fn to_bytes(&self, problem: &Problem) -> Vec<u8> {
        let nv = problem.model.topology.nv();
        let Identity { name, version, build, .. } = &self.identity;
        let head = json!({"engine": name, "version": version, "build": build, "model": self.model, "problem": self.problem_hash});
        let mut bytes = Frame::new(head, self.states.clone()).to_bytes();
        for (quantity, method, outcome) in &self.outcomes {
            let (status, reason, blocks) = match outcome {
                Outcome::Values(values) if *quantity == Quantity::MassMatrix && unpack(&pack(values, nv), nv).as_ref() == Some(values) => {
                    let packed = pack(values, nv);
                    ("ok", String::new(), vec![Block::new("lower", &[packed.len()], &packed)])
                }
                Outcome::Values(values) => ("ok", String::new(), vec![Block::new("value", &[values.len()], values)]),
                Outcome::Refused(Refusal::Unsupported(reason)) => ("unsupported", reason.clone(), Vec::new()),
                Outcome::Refused(Refusal::Failed(reason)) => ("error", reason.clone(), Vec::new()),
            };
            let header = json!({"quantity": quantity.name(), "method": method, "status": status, "reason": reason});
            bytes.extend(Frame::new(header, blocks).to_bytes());
        }
        bytes.extend(Frame::new(json!({"end": self.outcomes.len()}), Vec::new()).to_bytes());
        bytes
    }

    /// Reads a recording about a problem.
    ///
    /// # Errors
    /// [`RecordError`], when the file is missing, truncated, damaged, or about another robot or other states.
    pub fn read(path: &Path, problem: &Problem) -> Result<Self, RecordError> {
        let file = std::fs::File::open(path).map_err(|source| RecordError::Io { path: path.to_owned(), source })?;
        let mut reader = BufReader::new(file);
        let damaged = |what: String| RecordError::Damaged { path: path.to_owned(), what };
        let mut next = || match Frame::read(&mut reader) {
            Ok(Some(frame)) => Ok(frame),
            Ok(None) => Err(damaged("the file is truncated".into())),
            Err(FrameError::Io(source)) => Err(RecordError::Io { path: path.to_owned(), source }),
            Err(error) => Err(damaged(error.to_string())),
        };
        let head = next()?;
        if head.text("problem") != problem.hash || !same_bits(&head.blocks, &state_blocks(&problem.states)) {
            return Err(damaged(format!("it was recorded for another version of '{}' or of its states", problem.name)));
        }
        let build = head.header.get("build").cloned().unwrap_or_else(|| json!({}));
        let identity = Identity {
            name: head.text("engine").to_owned(),
            version: head.text("version").to_owned(),
            source: EngineSource::Recorded,
            build: serde_json::from_value(build).map_err(|error| damaged(format!("build: {error}")))?,
        };
        let mut outcomes = Vec::new();
        loop {
            let frame = next()?;
            if let Some(end) = frame.header.get("end") {
                if end.as_u64() != Some(outcomes.len() as u64) {
                    return Err(damaged(format!("{} of {end} outcomes are there", outcomes.len())));
                }
                let (model, problem_hash) = (problem.name.clone(), problem.hash.clone());
                return Ok(Self { identity, model, problem_hash, states: head.blocks, outcomes });
            }
            let quantity = Quantity::parse(frame.text("quantity")).ok_or_else(|| damaged("an outcome names no quantity".into()))?;
            let reason = frame.text("reason").to_owned();
            let outcome = match (frame.text("status"), frame.block("value"), frame.block("lower")) {
                ("ok", Some(block), _) => Outcome::Values(block.data.clone()),
                ("ok", None, Some(block)) => Outcome::Values(unpack(&block.data, problem.model.topology.nv()).ok_or_else(|| damaged("M has a wrong length".into()))?),
                ("unsupported", ..) => Outcome::Refused(Refusal::Unsupported(reason)),
                ("error", ..) => Outcome::Refused(Refusal::Failed(reason)),
                _ => return Err(damaged(format!("an outcome of {} has no values", quantity.name()))),
            };
            outcomes.push((quantity, frame.text("method").to_owned(), outcome));
        }
    }
}

fn same_bits(a: &[Block], b: &[Block]) -> bool {
    let bits = |blocks: &[Block]| blocks.iter().flat_map(|block| block.data.iter().map(|x| x.to_bits()).collect::<Vec<_>>()).collect::<Vec<_>>();
    bits(a) == bits(b)
}

fn pack(matrices: &[f64], n: usize) -> Vec<f64> {
    matrices.chunks_exact(n * n).flat_map(|m| (0..n).flat_map(|i| m[i * n..=i * n + i].to_vec()).collect::<Vec<_>>()).collect()
}

fn unpack(packed: &[f64], n: usize) -> Option<Vec<f64>> {
    let triangle = n * (n + 1) / 2;
    if triangle == 0 || packed.len() % triangle != 0 {
        return None;
    }
    let mut matrices = vec![0.0; packed.len() / triangle * n * n];
    for (m, lower) in matrices.chunks_exact_mut(n * n).zip(packed.chunks_exact(triangle)) {
        let mut entries = lower.iter();
        for i in 0..n {
            for (j, &entry) in (0..=i).zip(&mut entries) {
                m[i * n + j] = entry;
                m[j * n + i] = entry;
            }
        }
    }
    Some(matrices)
}

/// An engine whose answers were recorded.
pub struct Recorded {
    identity: Identity,
    methods: BTreeMap<Quantity, Vec<String>>,
    recordings: HashMap<String, Result<Recording, String>>,
}

impl Recorded {
    /// Reads an engine's answers about these problems from `folder/ENGINE/`.
    ///
    /// A robot whose file is missing or damaged is an error row of that robot; only when no file at all can be read there is no such
    /// subject.
    ///
    /// # Errors
    /// The first [`RecordError`], when no robot has a recording.
    pub fn open(folder: &Path, engine: &str, problems: &[&Problem]) -> Result<Self, RecordError> {
        let mut recordings = HashMap::new();
        let mut methods: BTreeMap<Quantity, Vec<String>> = BTreeMap::new();
        let (mut identity, mut first_error) = (None, None);
        for problem in problems {
            let path = folder.join(engine).join(format!("{}.frames", problem.name));
            let recording = match Recording::read(&path, problem) {
                Ok(recording) => {
                    for (quantity, method, _) in &recording.outcomes {
                        let known = methods.entry(*quantity).or_default();
                        if !known.contains(method) {
                            known.push(method.clone());
                        }
                    }
                    identity.get_or_insert_with(|| recording.identity.clone());
                    Ok(recording)
                }
                Err(error) => {
                    let message = error.to_string();
                    first_error.get_or_insert(error);
                    Err(message)
                }
            };
            recordings.insert(problem.name.clone(), recording);
        }
        match (identity, first_error) {
            (Some(identity), _) => Ok(Self { identity, methods, recordings }),
            (None, Some(error)) => Err(error),
            (None, None) => Err(RecordError::Damaged { path: folder.join(engine), what: "no robot was asked about".into() }),
        }
    }

    /// The recording of a robot.
    pub fn recording(&self, model: &str) -> Option<&Recording> {
        self.recordings.get(model)?.as_ref().ok()
    }
}

impl Subject for Recorded {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.methods.get(&quantity).cloned().unwrap_or_default()
    }

    fn prepare<'a>(
        &'a self,
        problem: &'a Problem,
        quantity: Quantity,
        method: &str,
        _states: &'a StateBatch,
    ) -> Result<Box<dyn Prepared + 'a>, Refusal> {
        let recording = match self.recordings.get(&problem.name) {
            Some(Ok(recording)) => recording,
            Some(Err(message)) => return Err(Refusal::Failed(message.clone())),
            None => return Err(Refusal::Failed(format!("nothing was recorded about '{}'", problem.name))),
        };
        let outcome = recording.outcomes.iter().find(|(q, m, _)| *q == quantity && m == method).map(|(_, _, outcome)| outcome);
        match outcome {
            Some(Outcome::Values(values)) => {
                let size = quantity.size(problem);
                Ok(Box::new(Played { values, size, range: 0..0 }))
            }
            Some(Outcome::Refused(refusal)) => Err(refusal.clone()),
            None => Err(Refusal::Failed(format!("{} by {method} was not recorded", quantity.name()))),
        }
    }
}

struct Played<'a> {
    values: &'a [f64],
    size: usize,
    range: Range<usize>,
}

impl Prepared for Played<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), Refusal> {
        if range.end * self.size > self.values.len() {
            return Err(Refusal::Failed(format!("{} numbers were recorded, {} are due", self.values.len(), range.end * self.size)));
        }
        self.range = range;
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values[self.range.start * self.size..self.range.end * self.size]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_a_symmetric_matrix_loses_nothing() {
        let m = [1.0, 2.0, 3.0, 2.0, 5.0, 6.0, 3.0, 6.0, 9.0];
        let two = [m, m.map(|x| -x)].concat();
        assert_eq!(unpack(&pack(&two, 3), 3), Some(two));
        assert_eq!(unpack(&[1.0; 5], 3), None);
    }
}
