//! Reading a file of outcomes: where each entry is, and what it holds.

use crate::shard::{Part, SHARD_NAME};
use crate::{Cell, HarnessError, NoAnswer, OUTCOMES_NAME, Outcome};
use featherbench_protocol::{Block, Message, MessageError};
use featherbench_results::{CHECKSUMS_NAME, Checksums, RUN_NAME, RunInfo};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

/// The entries of a file of outcomes that can be used: in memory is where each is, not what it holds.
#[derive(Debug)]
pub struct Entries {
    pub(crate) path: PathBuf,
    pub(crate) file: File,
    pub(crate) places: HashMap<String, Place>,
    /// The length in bytes of the part that can be used.
    pub(crate) good: u64,
    pub(crate) lost: Option<Lost>,
}

/// Where an entry is in its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub at: u64,
    pub length: u64,
    /// How long its cell took, if that was kept.
    pub seconds: Option<f64>,
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

impl Entries {
    /// Opens the outcomes of a run's folder. The file is not changed.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn open(folder: &Path) -> Result<Self, HarnessError> {
        let path = folder.join(OUTCOMES_NAME);
        let file = File::open(&path).map_err(|source| HarnessError::io(&path, source))?;
        Self::of(file, &path)
    }

    /// Opens the outcomes of a finished run or shard, or of one that goes on, as far as they are good to the last byte.
    ///
    /// # Errors
    /// When the file cannot be read, lacks a part, or is damaged.
    pub fn whole(folder: &Path) -> Result<Self, HarnessError> {
        if folder.join(SHARD_NAME).is_file() {
            let part = Part::open(folder).map_err(|error| HarnessError::Config { path: folder.to_owned(), message: error.to_string() })?;
            return Ok(part.into_entries());
        }
        if folder.join(CHECKSUMS_NAME).is_file() {
            let sums = Checksums::read(folder)?;
            // An older version had no checksum of it; each entry has its own.
            if sums.names().any(|name| name == OUTCOMES_NAME) || RunInfo::read(&folder.join(RUN_NAME))?.has_file(OUTCOMES_NAME) {
                sums.check(OUTCOMES_NAME)?;
            }
        }
        let entries = Self::open(folder)?;
        match entries.lost() {
            Some(lost) => Err(HarnessError::Config { path: lost.path.clone(), message: format!("entry {}: {}", lost.entry, lost.what) }),
            None => Ok(entries),
        }
    }

    /// Reads entry after entry up to the first that is incomplete or damaged.
    pub(crate) fn of(mut file: File, path: &Path) -> Result<Self, HarnessError> {
        let io = |source| HarnessError::io(path, source);
        let length = file.seek(SeekFrom::End(0)).map_err(io)?;
        file.rewind().map_err(io)?;
        let mut reader = Kept { inner: BufReader::with_capacity(1 << 16, &file), bytes: Vec::new() };
        let (mut places, mut good, mut entries) = (HashMap::new(), 0, 0);
        let what = loop {
            entries += 1;
            reader.bytes.clear();
            match Message::read(&mut reader) {
                Ok(None) => break None,
                Ok(Some(entry)) => {
                    let seconds = entry.header.get(SECONDS).and_then(Value::as_f64);
                    let length = reader.bytes.len() as u64;
                    match from_message(entry, &reader.bytes) {
                        Ok((id, _)) => drop(places.insert(id, Place { at: good, length, seconds })),
                        Err(what) => break Some(what),
                    }
                    good += length;
                }
                Err(MessageError::Io(source)) => return Err(io(source)),
                Err(error @ (MessageError::Truncated | MessageError::Header(_))) => break Some(error.to_string()),
            }
        };
        let lost = what.map(|what| Lost { path: path.to_owned(), entry: entries, what, bytes: length.saturating_sub(good) });
        Ok(Self { path: path.to_owned(), file, places, good, lost })
    }

    /// The part of the file that cannot be used.
    pub fn lost(&self) -> Option<&Lost> {
        self.lost.as_ref()
    }

    /// The cells that have an entry, in no order.
    pub fn cells(&self) -> impl Iterator<Item = &str> {
        self.places.keys().map(String::as_str)
    }

    /// Whether a cell has an entry.
    pub fn contains(&self, id: &str) -> bool {
        self.places.contains_key(id)
    }

    /// How long a cell took, if that was kept.
    pub fn seconds(&self, id: &str) -> Option<f64> {
        self.places.get(id)?.seconds
    }

    /// The outcome of a cell.
    ///
    /// # Errors
    /// When the file cannot be read, or was damaged since it was opened.
    pub fn outcome(&self, id: &str) -> Result<Option<Outcome>, HarnessError> {
        self.places.get(id).map(|place| place.outcome(&self.file, &self.path)).transpose()
    }

    /// The entry of a cell as it is in the file.
    pub(crate) fn bytes(&self, id: &str) -> Result<Option<Vec<u8>>, HarnessError> {
        self.places.get(id).map(|place| place.bytes(&self.file, &self.path)).transpose()
    }
}

impl Place {
    fn bytes(self, file: &File, path: &Path) -> Result<Vec<u8>, HarnessError> {
        let mut bytes = vec![0; usize::try_from(self.length).unwrap_or(usize::MAX)];
        file.read_exact_at(&mut bytes, self.at).map_err(|source| HarnessError::io(path, source))?;
        Ok(bytes)
    }

    /// The outcome at this place.
    pub(crate) fn outcome(self, file: &File, path: &Path) -> Result<Outcome, HarnessError> {
        let bytes = self.bytes(file, path)?;
        let damaged =
            |what: String| HarnessError::io(path, io::Error::new(io::ErrorKind::InvalidData, format!("byte {}: {what}", self.at)));
        let entry = Message::read(&mut bytes.as_slice()).map_err(|error| damaged(error.to_string()))?;
        let entry = entry.ok_or_else(|| damaged("there is no entry".into()))?;
        from_message(entry, &bytes).map(|(_, outcome)| outcome).map_err(damaged)
    }
}

/// A reader that keeps what was taken from it.
struct Kept<R> {
    inner: BufReader<R>,
    bytes: Vec<u8>,
}

impl<R: Read> Read for Kept<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.bytes.extend_from_slice(&buffer[..count]);
        Ok(count)
    }
}

impl<R: Read> io::BufRead for Kept<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.bytes.extend(self.inner.buffer().iter().take(count));
        self.inner.consume(count);
    }
}

/// The key of the time that a cell took.
const SECONDS: &str = "seconds";

/// The entry of a cell.
pub(crate) fn to_message(id: &str, cell: &Cell, outcome: &Outcome, seconds: Option<f64>) -> Message {
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
    if let Some(seconds) = seconds {
        header[SECONDS] = seconds.into();
    }
    let mut entry = Message::new(header, blocks);
    entry.header.insert(CHECKSUM.into(), featherbench_results::checksum(&entry.to_bytes()).into());
    entry
}

/// The key of an entry's checksum, which is that of its bytes without this key.
const CHECKSUM: &str = "blake3";

/// The cell and its outcome, or what is wrong with the entry, whose bytes these are.
pub(crate) fn from_message(mut entry: Message, bytes: &[u8]) -> Result<(String, Outcome), String> {
    // JSON has several spellings of a value, and the checksum is that of one: 1E-5 for 1e-5 is damage that it does not see.
    if entry.to_bytes() != bytes {
        return Err("it is spelled in another way: it is damaged".into());
    }
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
