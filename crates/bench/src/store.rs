//! The outcomes of a run on disk; a run resumes from them.

use crate::{Cell, HarnessError, NoAnswer, Outcome};
use featherbench_protocol::{Block, Message, MessageError};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Every finished cell's outcome, in memory and appended to `outcomes.bin` when it is known.
///
/// Each entry has a checksum of all its contents. A run that is killed leaves at most one incomplete entry at the end. No entry after an
/// incomplete or damaged one can be trusted: opening the store cuts off that entry and the rest of the file, and [`Self::lost`] reports it.
#[derive(Debug)]
pub struct OutcomeStore {
    path: PathBuf,
    lost: Option<Lost>,
    inner: Mutex<Inner>,
}

/// The part of a file of outcomes that could not be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// The file.
    pub path: PathBuf,
    /// The first entry that could not be used, counted from one.
    pub entry: u64,
    /// What is wrong with it.
    pub what: String,
    /// The bytes from the beginning of that entry to the end of the file.
    pub bytes: u64,
}

impl std::fmt::Display for Lost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { path, entry, what, bytes } = self;
        write!(f, "{}: entry {entry}: {what}; it and what stands behind it ({bytes} bytes) are not used", path.display())
    }
}

#[derive(Debug)]
struct Inner {
    file: File,
    outcomes: HashMap<String, Outcome>,
}

/// Name of the file in a run's folder.
pub const OUTCOMES_NAME: &str = "outcomes.bin";

impl OutcomeStore {
    /// Opens the store of a run's folder: reads the entries, and cuts off those that cannot be used.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub fn open(folder: &Path) -> Result<Self, HarnessError> {
        let path = folder.join(OUTCOMES_NAME);
        let io = |source| HarnessError::io(&path, source);
        let file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(io)?;
        let (mut file, Whole { outcomes, good, lost }) = read(file, &path)?;
        file.set_len(good).map_err(io)?;
        file.seek(std::io::SeekFrom::End(0)).map_err(io)?;
        Ok(Self { path, lost, inner: Mutex::new(Inner { file, outcomes }) })
    }

    /// The outcomes of a run's folder by cell, and the part of the file that cannot be used. The file is not changed.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn look(folder: &Path) -> Result<(HashMap<String, Outcome>, Option<Lost>), HarnessError> {
        let path = folder.join(OUTCOMES_NAME);
        let file = File::open(&path).map_err(|source| HarnessError::io(&path, source))?;
        let (_, Whole { outcomes, lost, .. }) = read(file, &path)?;
        Ok((outcomes, lost))
    }

    /// The part of the file that was cut off when it was opened: its cells are evaluated again.
    pub fn lost(&self) -> Option<&Lost> {
        self.lost.as_ref()
    }

    /// The outcome of a cell, if it is finished.
    pub fn get(&self, id: &str) -> Option<Outcome> {
        self.lock().outcomes.get(id).cloned()
    }

    /// Whether a cell is finished.
    pub fn contains(&self, id: &str) -> bool {
        self.lock().outcomes.contains_key(id)
    }

    /// Stores the outcome of a cell, first on disk.
    ///
    /// # Errors
    /// When it cannot be written to disk.
    pub fn insert(&self, cell: &Cell, outcome: Outcome) -> Result<(), HarnessError> {
        let id = cell.id();
        let entry = to_message(&id, cell, &outcome);
        let mut inner = self.lock();
        entry.write(&mut inner.file).map_err(|source| HarnessError::io(&self.path, source))?;
        inner.outcomes.insert(id, outcome);
        Ok(())
    }

    /// A panic elsewhere does not make the map wrong: an outcome is inserted completely or not at all.
    fn lock(&self) -> std::sync::MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The part of a file of outcomes that can be used.
struct Whole {
    outcomes: HashMap<String, Outcome>,
    /// Its length in bytes.
    good: u64,
    lost: Option<Lost>,
}

/// Reads entry after entry up to the first that is incomplete or damaged.
fn read<S: Read + Seek>(mut source: S, path: &Path) -> Result<(S, Whole), HarnessError> {
    let io = |source| HarnessError::io(path, source);
    let length = source.seek(std::io::SeekFrom::End(0)).map_err(io)?;
    source.rewind().map_err(io)?;
    let mut reader = BufReader::new(source);
    let (mut outcomes, mut good, mut entries) = (HashMap::new(), 0, 0);
    let what = loop {
        entries += 1;
        match Message::read(&mut reader) {
            Ok(None) => break None,
            Ok(Some(entry)) => match from_message(entry) {
                Ok((id, outcome)) => drop(outcomes.insert(id, outcome)),
                Err(what) => break Some(what),
            },
            Err(MessageError::Io(source)) => return Err(io(source)),
            Err(error @ (MessageError::Truncated | MessageError::Header(_))) => break Some(error.to_string()),
        }
        good = reader.stream_position().map_err(io)?;
    };
    let lost = what.map(|what| Lost { path: path.to_owned(), entry: entries, what, bytes: length.saturating_sub(good) });
    Ok((reader.into_inner(), Whole { outcomes, good, lost }))
}

fn to_message(id: &str, cell: &Cell, outcome: &Outcome) -> Message {
    let (status, reason, blocks) = match outcome {
        Outcome::Values(values) => ("ok", "", vec![Block::new("value", &[values.len()], values)]),
        Outcome::Text(_) => ("text", "", Vec::new()),
        Outcome::NoAnswer(NoAnswer::NotOffered(reason)) => ("unsupported", reason.as_str(), Vec::new()),
        Outcome::NoAnswer(NoAnswer::Failed(reason)) => ("error", reason.as_str(), Vec::new()),
    };
    let mut header = json!({"cell": id, "path": cell.path(), "status": status, "reason": reason});
    if let Outcome::Text(text) = outcome {
        header["text"] = text.as_str().into();
    }
    let mut entry = Message::new(header, blocks);
    entry.header.insert(CHECKSUM.into(), featherbench_results::checksum(&entry.to_bytes()).into());
    entry
}

/// The key of an entry's checksum, which is that of its bytes without this key.
const CHECKSUM: &str = "blake3";

/// The cell and its outcome, or what is wrong with the entry.
fn from_message(mut entry: Message) -> Result<(String, Outcome), String> {
    let Some(Value::String(due)) = entry.header.remove(CHECKSUM) else { return Err("it has no checksum".into()) };
    if featherbench_results::checksum(&entry.to_bytes()) != due {
        return Err("its checksum is another one: it is damaged".into());
    }
    let id = entry.text("cell").to_owned();
    let reason = entry.text("reason").to_owned();
    let outcome = match entry.text("status") {
        "ok" => entry.blocks.pop().map(|block| Outcome::Values(block.data)),
        "text" => entry.header.get("text").and_then(Value::as_str).map(|text| Outcome::Text(text.to_owned())),
        "unsupported" => Some(Outcome::NoAnswer(NoAnswer::NotOffered(reason))),
        "error" => Some(Outcome::NoAnswer(NoAnswer::Failed(reason))),
        _ => None,
    };
    match outcome {
        Some(outcome) if !id.is_empty() => Ok((id, outcome)),
        _ => Err("it holds no outcome of a cell".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(method: &str) -> Cell {
        let text = |s: &str| s.to_owned();
        Cell {
            study: text("s"),
            robot: text("p"),
            robot_hash: text("h"),
            params: json!({}),
            engine: text("e"),
            version: text("1"),
            method: text(method),
            quantity: text("id"),
            scalar: text("f64"),
        }
    }

    #[test]
    fn reopening_keeps_whole_entries_and_cuts_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let store = OutcomeStore::open(folder.path()).unwrap();
        let values = Outcome::Values(vec![0.1, f64::MIN_POSITIVE, -3.0]);
        store.insert(&cell("a"), values.clone()).unwrap();
        store.insert(&cell("b"), Outcome::NoAnswer(NoAnswer::Failed("broken".into()))).unwrap();
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
    /// Outcomes of every kind.
    fn outcomes() -> Vec<(Cell, Outcome)> {
        vec![
            (cell("a"), Outcome::Values(vec![0.1, f64::NAN, -0.0])),
            (cell("b"), Outcome::NoAnswer(NoAnswer::Failed("it \"broke\"".into()))),
            (cell("c"), Outcome::Text("not \"this\"\n".repeat(40))),
            (cell("d"), Outcome::NoAnswer(NoAnswer::NotOffered("no such joint".into()))),
            (cell("e"), Outcome::Values(vec![1.5])),
        ]
    }

    /// The outcome of a cell with its numbers as bits.
    fn bits(outcome: &Outcome) -> String {
        format!("{outcome:?} {:?}", outcome.values().map(|values| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>()))
    }

    /// Every bit of a file: an outcome that is read is the one that was written; otherwise it is reported as lost.
    #[test]
    fn no_flipped_bit_makes_another_outcome() {
        let folder = tempfile::tempdir().unwrap();
        let store = OutcomeStore::open(folder.path()).unwrap();
        for (cell, outcome) in outcomes() {
            store.insert(&cell, outcome).unwrap();
        }
        let path = folder.path().join(OUTCOMES_NAME);
        let whole = std::fs::read(&path).unwrap();
        let written: HashMap<String, String> = outcomes().iter().map(|(cell, outcome)| (cell.id(), bits(outcome))).collect();
        assert_eq!(OutcomeStore::look(folder.path()).unwrap().0.len(), written.len());
        let mut discarded = 0;
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                let (_, Whole { outcomes: found, lost, .. }) = read(std::io::Cursor::new(damaged), &path).unwrap();
                for (id, outcome) in &found {
                    assert_eq!(written.get(id), Some(&bits(outcome)), "bit {bit} of byte {at}");
                }
                assert_eq!(found.len() < written.len(), lost.is_some(), "bit {bit} of byte {at}");
                if let Some(lost) = lost {
                    let message = lost.to_string();
                    assert!(message.contains(OUTCOMES_NAME) && message.contains(&format!("entry {}:", found.len() + 1)), "{message}");
                    discarded += 1;
                }
            }
        }
        assert!(discarded == 8 * whole.len() && whole.len() > 1000, "{discarded} of {}", 8 * whole.len());
    }
}
