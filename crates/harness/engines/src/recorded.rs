//! An engine that repeats the recorded answers of an oracle: `datasets/recorded/MODEL.recording`.
//!
//! A recording is about one robot and has the answers of every engine. It is a sequence of parts. Each part is a line of JSON with the
//! number of raw bytes that follow it. The parts are:
//! - the robot and the states;
//! - for each engine its identity, then its outcomes one by one;
//! - the number of parts.
//!
//! The first answer to a quantity is stored as plain doubles. Later ones are stored as their distances from it in units in the last place:
//! exact, and an eighth of the size. The last line is the checksum of all bytes before it. So a file in which one bit differs is an error.

use crate::coding::{delta, from_delta, from_plain, plain};
use featherbench_bench::{Engine, Evaluation, Identity, NoAnswer, Outcome, Quantity, Robot};
use featherbench_model::Topology;
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Why recorded answers cannot be used.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is damaged, or about another robot.
    #[error("{path}: {what}; record it again with `featherbench record`")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
}

/// The engines' answers about one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The engines, in the order in which they were asked.
    pub engines: Vec<EngineRecording>,
}

/// The answers of one engine about one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct EngineRecording {
    /// The identity of the engine.
    pub identity: Identity,
    /// The outcomes by quantity and method.
    pub outcomes: Vec<(Quantity, String, Outcome)>,
}

/// Version of the format of recordings.
const FORMAT: u64 = 2;

/// File name of a robot's recording.
pub fn recording_name(model: &str) -> String {
    format!("{model}.recording")
}

impl Recording {
    /// The recording as bytes.
    pub fn to_bytes(&self, robot: &Robot) -> Vec<u8> {
        let mut writer = Writer { bytes: Vec::new(), parts: 0 };
        let head = json!({"recording": FORMAT, "model": robot.name, "robot": robot.hash, "states": robot.states.count()});
        writer.part(head, &plain(&states(robot)));
        let topology = &robot.model.topology;
        let mut bases: HashMap<Quantity, Vec<f64>> = HashMap::new();
        for engine in &self.engines {
            let Identity { name, version, build, .. } = &engine.identity;
            writer.part(json!({"engine": name, "version": version, "build": build}), &[]);
            for (quantity, method, outcome) in &engine.outcomes {
                let header =
                    |status: &str, reason: &str| json!({"quantity": quantity.name(), "method": method, "status": status, "reason": reason});
                match outcome {
                    Outcome::NoAnswer(NoAnswer::NotOffered(reason)) => writer.part(header("unsupported", reason), &[]),
                    Outcome::NoAnswer(NoAnswer::Failed(reason)) => writer.part(header("error", reason), &[]),
                    Outcome::Text(_) => writer.part(header("unsupported", "texts are not recorded"), &[]),
                    Outcome::Values(values) => {
                        let base = bases.get(quantity).filter(|base| base.len() == values.len());
                        let mut header = header("ok", "");
                        header["coding"] = if base.is_some() { "delta" } else { "plain" }.into();
                        writer.part(header, &encode(*quantity, values, base.map(Vec::as_slice), topology));
                        bases.entry(*quantity).or_insert_with(|| values.clone());
                    }
                }
            }
        }
        let parts = writer.parts;
        writer.part(json!({"end": parts}), &[]);
        featherbench_results::seal(&mut writer.bytes);
        writer.bytes
    }

    /// Reads the recording of a robot.
    ///
    /// # Errors
    /// [`RecordingError`], when the file is missing, truncated, damaged, or about another robot or other states.
    pub fn read(path: &Path, robot: &Robot) -> Result<Self, RecordingError> {
        let bytes = std::fs::read(path).map_err(|source| RecordingError::Io { path: path.to_owned(), source })?;
        Self::from_bytes(&bytes, robot).map_err(|what| RecordingError::Damaged { path: path.to_owned(), what })
    }

    /// The recording of a robot in bytes.
    ///
    /// # Errors
    /// What is truncated, damaged, or about another robot or other states, in words.
    pub fn from_bytes(bytes: &[u8], robot: &Robot) -> Result<Self, String> {
        let body = featherbench_results::unsealed(bytes);
        let body = body.ok_or("its last line is not the checksum of the bytes before it: the file is truncated or damaged")?;
        let mut reader = Reader { bytes: body, parts: 0 };
        let (head, raw) = reader.part()?;
        if head["recording"].as_u64() != Some(FORMAT) {
            return Err(format!("it is a recording of format {}, this program reads format {FORMAT}", head["recording"]));
        }
        let recorded = from_plain(raw).ok_or("the states are damaged")?;
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        if head["robot"] != robot.hash.as_str() || bits(&recorded) != bits(&states(robot)) {
            return Err(format!("it was recorded for another version of '{}' or of its states", robot.name));
        }
        let mut engines: Vec<EngineRecording> = Vec::new();
        let mut bases: HashMap<Quantity, Vec<f64>> = HashMap::new();
        loop {
            let (header, raw) = reader.part()?;
            if let Some(end) = header["end"].as_u64() {
                // The last part does not count itself.
                return match end + 1 == reader.parts {
                    true if reader.bytes.is_empty() => Ok(Self { engines }),
                    true => Err(format!("{} bytes stand behind the end", reader.bytes.len())),
                    false => Err("parts are missing".into()),
                };
            }
            if header["engine"].is_string() {
                engines.push(EngineRecording { identity: identity(&header)?, outcomes: Vec::new() });
                continue;
            }
            let engine = engines.last_mut().ok_or("an outcome comes before its engine")?;
            let word = |key: &str| header[key].as_str().unwrap_or_default();
            let quantity = Quantity::parse(word("quantity")).ok_or("an outcome names no quantity")?;
            let reason = word("reason").to_owned();
            let outcome = match word("status") {
                "unsupported" => Outcome::NoAnswer(NoAnswer::NotOffered(reason)),
                "error" => Outcome::NoAnswer(NoAnswer::Failed(reason)),
                _ => {
                    let base = match word("coding") {
                        "delta" => bases.get(&quantity).map(Vec::as_slice),
                        _ => None,
                    };
                    let values = decode(quantity, raw, base, &robot.model.topology);
                    let values = values.ok_or_else(|| format!("the values of {} are damaged", quantity.name()))?;
                    bases.entry(quantity).or_insert_with(|| values.clone());
                    Outcome::Values(values)
                }
            };
            engine.outcomes.push((quantity, word("method").to_owned(), outcome));
        }
    }

    /// The answers of an engine.
    pub fn engine(&self, name: &str) -> Option<&EngineRecording> {
        self.engines.iter().find(|engine| engine.identity.name == name)
    }
}

struct Writer {
    bytes: Vec<u8>,
    parts: u64,
}

impl Writer {
    fn part(&mut self, mut header: Value, raw: &[u8]) {
        header["bytes"] = raw.len().into();
        self.bytes.extend(header.to_string().into_bytes());
        self.bytes.push(b'\n');
        self.bytes.extend(raw);
        self.parts += 1;
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    parts: u64,
}

impl<'a> Reader<'a> {
    fn part(&mut self) -> Result<(Value, &'a [u8]), String> {
        let truncated = || "the file is truncated".to_owned();
        let end = self.bytes.iter().position(|&byte| byte == b'\n').ok_or_else(truncated)?;
        let header: Value = serde_json::from_slice(&self.bytes[..end]).map_err(|error| format!("part {}: {error}", self.parts))?;
        let length = header["bytes"].as_u64().and_then(|length| usize::try_from(length).ok());
        let length = length.ok_or_else(|| format!("part {}: no number of bytes", self.parts))?;
        let rest = &self.bytes[end + 1..];
        let raw = rest.get(..length).ok_or_else(truncated)?;
        self.bytes = &rest[length..];
        self.parts += 1;
        Ok((header, raw))
    }
}

fn identity(header: &Value) -> Result<Identity, String> {
    let text = |key: &str| header[key].as_str().unwrap_or_default().to_owned();
    let build = serde_json::from_value(header["build"].clone()).map_err(|error| format!("build: {error}"))?;
    Ok(Identity { name: text("engine"), version: text("version"), source: EngineSource::Recorded, build })
}

/// The numbers of a batch that every engine is asked about: q, v, a, tau, and the wrenches of the states that `id_wrench` takes.
fn states(robot: &Robot) -> Vec<f64> {
    let states = &robot.states;
    let wrenched = robot.asked(Quantity::InverseDynamicsWrench) * 6 * states.bodies;
    let parts: [&[f64]; 5] = [&states.q, &states.v, &states.a, &states.tau, &states.wrench[..wrenched]];
    parts.concat()
}

/// The tree-sparse entries of dense mass matrices.
fn pack(matrices: &[f64], topology: &Topology) -> Vec<f64> {
    let n = topology.nv();
    let row = |m: &[f64], i: usize| topology.row_dofs(i).iter().map(|&j| m[i * n + j]).collect::<Vec<_>>();
    matrices.chunks_exact(n * n).flat_map(|m| (0..n).flat_map(|i| row(m, i)).collect::<Vec<_>>()).collect()
}

/// The bytes of an answer, by its distance from a base if there is one.
///
/// A mass matrix has two parts. First come the tree-sparse entries, after their length in bytes. Then come the distances of all entries
/// from those of the symmetric matrix that these entries make; most of these distances are zero.
fn encode(quantity: Quantity, values: &[f64], base: Option<&[f64]>, topology: &Topology) -> Vec<u8> {
    let code = |values: &[f64], base: Option<&[f64]>| base.map_or_else(|| plain(values), |base| delta(values, base));
    if quantity != Quantity::MassMatrix {
        return code(values, base);
    }
    let packed = pack(values, topology);
    let sparse = code(&packed, base.map(|base| pack(base, topology)).as_deref());
    let rest = delta(values, &unpack(&packed, topology));
    [&(sparse.len() as u64).to_le_bytes()[..], &sparse, &rest].concat()
}

/// The values of [`encode`]'s bytes, or `None` when these are damaged.
fn decode(quantity: Quantity, raw: &[u8], base: Option<&[f64]>, topology: &Topology) -> Option<Vec<f64>> {
    let parse = |raw: &[u8], base: Option<&[f64]>| base.map_or_else(|| from_plain(raw), |base| from_delta(raw, base));
    if quantity != Quantity::MassMatrix {
        return parse(raw, base);
    }
    let (length, raw) = raw.split_first_chunk::<8>()?;
    let (sparse, rest) = raw.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    let packed = parse(sparse, base.map(|base| pack(base, topology)).as_deref())?;
    from_delta(rest, &unpack(&packed, topology))
}

/// Dense symmetric matrices of their tree-sparse entries.
fn unpack(packed: &[f64], topology: &Topology) -> Vec<f64> {
    let n = topology.nv();
    let mut matrices = vec![0.0; packed.len() / topology.stored().max(1) * n * n];
    for (m, entries) in matrices.chunks_exact_mut(n * n).zip(packed.chunks_exact(topology.stored())) {
        for i in 0..n {
            for (&j, &entry) in topology.row_dofs(i).iter().zip(&entries[topology.row(i)]) {
                m[i * n + j] = entry;
                m[j * n + i] = entry;
            }
        }
    }
    matrices
}

/// The recordings of a suite's robots, by name.
pub type Recordings = BTreeMap<String, Result<Recording, String>>;

/// Reads the recordings of robots from a folder. A missing or damaged file becomes the reason of that robot, and not an error of the
/// function.
pub fn read_recordings(folder: &Path, robots: &[&Robot]) -> Recordings {
    let read = |robot: &Robot| Recording::read(&folder.join(recording_name(&robot.name)), robot).map_err(|error| error.to_string());
    robots.iter().map(|robot| (robot.name.clone(), read(robot))).collect()
}

/// An engine whose answers were recorded.
pub struct Recorded {
    identity: Identity,
    methods: BTreeMap<Quantity, Vec<String>>,
    recordings: Arc<Recordings>,
}

impl Recorded {
    /// The engine of this name in a set of recordings.
    ///
    /// # Errors
    /// Why there is none: no recording can be read, none has answers of the engine, or they come from several versions of it.
    pub fn new(recordings: &Arc<Recordings>, engine: &str) -> Result<Self, String> {
        let mut methods: BTreeMap<Quantity, Vec<String>> = BTreeMap::new();
        let mut identity: Option<Identity> = None;
        for recording in recordings.values().flatten().filter_map(|recording| recording.engine(engine)) {
            let (first, version) = (identity.get_or_insert_with(|| recording.identity.clone()), &recording.identity.version);
            if first.version != *version {
                let versions = format!("{} and {version}", first.version);
                return Err(format!("answers of {engine} were recorded from its versions {versions}; record them all with one"));
            }
            for (quantity, method, _) in &recording.outcomes {
                let known = methods.entry(*quantity).or_default();
                if !known.contains(method) {
                    known.push(method.clone());
                }
            }
        }
        let first_error = recordings.values().find_map(|recording| recording.as_ref().err());
        let identity = identity.ok_or_else(|| first_error.cloned().unwrap_or_else(|| format!("no answers of {engine} were recorded")))?;
        Ok(Self { identity, methods, recordings: Arc::clone(recordings) })
    }
}

impl Engine for Recorded {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.methods.get(&quantity).cloned().unwrap_or_default()
    }

    /// Recorded answers have no time.
    fn timed(&self, _: Quantity) -> Vec<String> {
        Vec::new()
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        _states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let recording = match self.recordings.get(&robot.name) {
            Some(Ok(recording)) => recording,
            Some(Err(message)) => return Err(NoAnswer::Failed(message.clone())),
            None => return Err(NoAnswer::Failed(format!("nothing was recorded about '{}'", robot.name))),
        };
        let outcomes = recording.engine(&self.identity.name).map(|engine| &engine.outcomes).into_iter().flatten();
        match outcomes.into_iter().find(|(q, m, _)| *q == quantity && m == method) {
            Some((_, _, Outcome::Values(values))) => Ok(Box::new(Played { values, size: quantity.size(robot), range: 0..0 })),
            Some((_, _, Outcome::NoAnswer(refusal))) => Err(refusal.clone()),
            Some((_, _, Outcome::Text(_))) | None => Err(NoAnswer::Failed(format!("{} by {method} was not recorded", quantity.name()))),
        }
    }
}

struct Played<'a> {
    values: &'a [f64],
    size: usize,
    range: Range<usize>,
}

impl Evaluation for Played<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        if range.end * self.size > self.values.len() {
            return Err(NoAnswer::Failed(format!("{} numbers were recorded, {} are due", self.values.len(), range.end * self.size)));
        }
        self.range = range;
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values[self.range.start * self.size..self.range.end * self.size]
    }
}
