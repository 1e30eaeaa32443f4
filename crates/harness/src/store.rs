//! The outcomes of a run on disk: what makes it resumable.

use crate::frame::{Block, Frame, FrameError};
use crate::{Cell, HarnessError, Outcome, Reading, ReadingNote, Refusal};
use formats::neutral;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Every finished cell's outcome, in memory and appended to `outcomes.frames` as it comes.
///
/// A run that is killed leaves at most one incomplete frame at the end; opening the store again cuts it off.
#[derive(Debug)]
pub struct OutcomeStore {
    path: PathBuf,
    inner: Mutex<Inner>,
}

#[derive(Debug)]
struct Inner {
    file: File,
    outcomes: HashMap<String, Outcome>,
}

/// Name of the file in a run's folder.
pub const OUTCOMES_NAME: &str = "outcomes.frames";

impl OutcomeStore {
    /// Opens the store of a run's folder, reading what is there.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub fn open(folder: &Path) -> Result<Self, HarnessError> {
        let path = folder.join(OUTCOMES_NAME);
        let io = |source| HarnessError::io(&path, source);
        let file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(io)?;
        let mut reader = BufReader::new(file);
        let mut outcomes = HashMap::new();
        let mut good = 0;
        // A frame that is cut off or damaged ends what can be trusted: cells after it are evaluated again.
        loop {
            match Frame::read(&mut reader) {
                Ok(Some(frame)) => {
                    let Some((id, outcome)) = from_frame(frame) else { break };
                    outcomes.insert(id, outcome);
                    good = reader.stream_position().map_err(io)?;
                }
                Err(FrameError::Io(source)) => return Err(HarnessError::io(&path, source)),
                Ok(None) | Err(FrameError::Truncated | FrameError::Header(_)) => break,
            }
        }
        let mut file = reader.into_inner();
        file.set_len(good).map_err(io)?;
        file.seek(std::io::SeekFrom::End(0)).map_err(io)?;
        Ok(Self { path, inner: Mutex::new(Inner { file, outcomes }) })
    }

    /// The outcome of a cell, if it is finished.
    pub fn get(&self, id: &str) -> Option<Outcome> {
        self.lock().outcomes.get(id).cloned()
    }

    /// Whether a cell is finished.
    pub fn contains(&self, id: &str) -> bool {
        self.lock().outcomes.contains_key(id)
    }

    /// Keeps the outcome of a cell, on disk first.
    ///
    /// # Errors
    /// When the disk refuses it.
    pub fn insert(&self, cell: &Cell, outcome: Outcome) -> Result<(), HarnessError> {
        let id = cell.id();
        let frame = to_frame(&id, cell, &outcome);
        let mut inner = self.lock();
        frame.write(&mut inner.file).map_err(|source| HarnessError::io(&self.path, source))?;
        inner.outcomes.insert(id, outcome);
        Ok(())
    }

    /// A panic elsewhere does not make the map wrong: an outcome is inserted whole or not at all.
    fn lock(&self) -> std::sync::MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn to_frame(id: &str, cell: &Cell, outcome: &Outcome) -> Frame {
    let (status, reason, blocks) = match outcome {
        Outcome::Values(values) => ("ok", "", vec![Block::new("value", &[values.len()], values)]),
        Outcome::Reading(reading) => {
            let shape = [reading.keyframes.len(), reading.description.nq()];
            ("read", "", vec![Block::new("keyframes", &shape, &reading.keyframes.concat())])
        }
        Outcome::Refused(Refusal::Unsupported(reason)) => ("unsupported", reason.as_str(), Vec::new()),
        Outcome::Refused(Refusal::Failed(reason)) => ("error", reason.as_str(), Vec::new()),
    };
    let mut header = json!({"cell": id, "path": cell.path(), "status": status, "reason": reason});
    if let Outcome::Reading(reading) = outcome {
        header["reading"] = written(reading);
    }
    Frame::new(header, blocks)
}

/// A reading as JSON: the description's text, and the notes.
fn written(reading: &Reading) -> Value {
    let note = |note: &ReadingNote| json!({"cause": note.cause, "subject": note.subject, "text": note.text, "numbers": note.numbers});
    // A description that is no robot has no text, and reads back as a damaged frame: its cell is asked again.
    let model = neutral::to_string(&reading.description).unwrap_or_default();
    let written = reading.written.as_ref().map(|written| neutral::to_string(written).unwrap_or_default());
    json!({"model": model, "written": written, "notes": reading.notes.iter().map(note).collect::<Vec<_>>()})
}

fn reading(value: &Value, keyframes: &Block) -> Option<Reading> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let note = |note: &Value| {
        let numbers = note["numbers"].as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
        Some(ReadingNote { cause: text(&note["cause"])?, subject: text(&note["subject"]), text: text(&note["text"])?, numbers })
    };
    let description = neutral::parse(value["model"].as_str()?, OUTCOMES_NAME).ok()?;
    let keyframes = keyframes.data.chunks_exact(description.nq().max(1)).map(<[f64]>::to_vec).collect();
    let written = match value["written"].as_str() {
        Some(text) => Some(neutral::parse(text, OUTCOMES_NAME).ok()?),
        None => None,
    };
    Some(Reading { description, notes: value["notes"].as_array()?.iter().map(note).collect::<Option<_>>()?, keyframes, written })
}

fn from_frame(mut frame: Frame) -> Option<(String, Outcome)> {
    let id = frame.text("cell").to_owned();
    let reason = frame.text("reason").to_owned();
    let outcome = match frame.text("status") {
        "ok" => Outcome::Values(frame.blocks.pop()?.data),
        "read" => Outcome::Reading(Box::new(reading(frame.header.get("reading")?, frame.block("keyframes")?)?)),
        "unsupported" => Outcome::Refused(Refusal::Unsupported(reason)),
        "error" => Outcome::Refused(Refusal::Failed(reason)),
        _ => return None,
    };
    (!id.is_empty()).then_some((id, outcome))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(method: &str) -> Cell {
        let text = |s: &str| s.to_owned();
        Cell {
            study: text("s"),
            problem: text("p"),
            problem_hash: text("h"),
            params: json!({}),
            subject: text("e"),
            version: text("1"),
            method: text(method),
            quantity: text("id"),
            scalar: text("f64"),
        }
    }

    #[test]
    fn reopening_keeps_whole_frames_and_cuts_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let store = OutcomeStore::open(folder.path()).unwrap();
        let values = Outcome::Values(vec![0.1, f64::MIN_POSITIVE, -3.0]);
        store.insert(&cell("a"), values.clone()).unwrap();
        store.insert(&cell("b"), Outcome::Refused(Refusal::Failed("broken".into()))).unwrap();
        drop(store);

        let path = folder.path().join(OUTCOMES_NAME);
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let store = OutcomeStore::open(folder.path()).unwrap();
            if let Some(found) = store.get(&cell("a").id()) {
                assert_eq!(found, values);
            }
            store.insert(&cell("c"), values.clone()).unwrap();
            drop(store);
            let again = OutcomeStore::open(folder.path()).unwrap();
            assert_eq!(again.get(&cell("c").id()), Some(values.clone()), "appended after a cut at {cut}");
        }
    }
}
