//! The outcomes of a run on disk; a run resumes from them.

use crate::run::entries::{Entries, Place, to_message};
use crate::{Cell, HarnessError, Lost, Outcome};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Every finished cell's outcome in `outcomes.bin`, appended when it is known. In memory is only where each is in the file: the outcomes of a
/// large run are larger than the memory.
///
/// Each entry has a checksum of all its contents. A run that is killed leaves at most one incomplete entry at the end. No entry after an
/// incomplete or damaged one can be trusted: opening the store cuts off that entry and the rest of the file, and [`Self::lost`] reports it.
#[derive(Debug)]
pub struct OutcomeStore {
    path: PathBuf,
    lost: Option<Lost>,
    /// The same file, for reading at a place while another thread appends.
    reader: File,
    inner: Mutex<Inner>,
}

#[derive(Debug)]
struct Inner {
    file: File,
    /// The end of the last entry.
    end: u64,
    places: HashMap<String, Place>,
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
        let mut file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(io)?;
        let Entries { file: reader, places, good, lost, .. } = Entries::of(file.try_clone().map_err(io)?, &path)?;
        file.set_len(good).map_err(io)?;
        file.seek(std::io::SeekFrom::Start(good)).map_err(io)?;
        Ok(Self { path, lost, reader, inner: Mutex::new(Inner { file, end: good, places }) })
    }

    /// The part of the file that was cut off when it was opened: its cells are evaluated again.
    pub fn lost(&self) -> Option<&Lost> {
        self.lost.as_ref()
    }

    /// The outcome of a cell, if it is finished.
    ///
    /// # Errors
    /// When the file cannot be read, or was damaged since its entry was written.
    pub fn get(&self, id: &str) -> Result<Option<Outcome>, HarnessError> {
        let place = self.lock().places.get(id).copied();
        place.map(|place| place.outcome(&self.reader, &self.path)).transpose()
    }

    /// Whether a cell is finished.
    pub fn contains(&self, id: &str) -> bool {
        self.lock().places.contains_key(id)
    }

    /// Stores the outcome of a cell.
    ///
    /// # Errors
    /// When it cannot be written to disk.
    pub fn insert(&self, cell: &Cell, outcome: &Outcome) -> Result<(), HarnessError> {
        self.append(cell, outcome, None)
    }

    /// Stores the outcome of a cell, and how long it took: plans of later runs estimate by it.
    ///
    /// # Errors
    /// When it cannot be written to disk.
    pub fn insert_after(&self, cell: &Cell, outcome: &Outcome, took: Duration) -> Result<(), HarnessError> {
        self.append(cell, outcome, Some(took.as_secs_f64()))
    }

    fn append(&self, cell: &Cell, outcome: &Outcome, seconds: Option<f64>) -> Result<(), HarnessError> {
        let id = cell.id();
        let bytes = to_message(&id, cell, outcome, seconds).to_bytes();
        let mut inner = self.lock();
        inner.file.write_all(&bytes).map_err(|source| HarnessError::io(&self.path, source))?;
        let place = Place { at: inner.end, length: bytes.len() as u64, seconds };
        inner.end += place.length;
        inner.places.insert(id, place);
        Ok(())
    }

    /// A panic elsewhere does not make the map wrong: a place is inserted completely or not at all.
    fn lock(&self) -> std::sync::MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoAnswer;
    use serde_json::json;

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
        store.insert(&cell("a"), &values).unwrap();
        store.insert(&cell("b"), &Outcome::NoAnswer(NoAnswer::Failed("broken".into()))).unwrap();
        drop(store);

        let path = folder.path().join(OUTCOMES_NAME);
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let store = OutcomeStore::open(folder.path()).unwrap();
            if let Some(found) = store.get(&cell("a").id()).unwrap() {
                assert_eq!(found, values);
            }
            store.insert(&cell("c"), &values).unwrap();
            drop(store);
            let again = OutcomeStore::open(folder.path()).unwrap();
            assert_eq!(again.get(&cell("c").id()).unwrap(), Some(values.clone()), "appended after a cut at {cut}");
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
            store.insert_after(&cell, &outcome, Duration::from_millis(3)).unwrap();
        }
        let path = folder.path().join(OUTCOMES_NAME);
        let whole = std::fs::read(&path).unwrap();
        let written: HashMap<String, String> = outcomes().iter().map(|(cell, outcome)| (cell.id(), bits(outcome))).collect();
        assert_eq!(Entries::whole(folder.path()).unwrap().cells().count(), written.len());
        let (mut discarded, scratch) = (0, folder.path().join("damaged"));
        let (mut file, kept) = (File::create_new(&scratch).unwrap(), File::open(&scratch).unwrap());
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                file.rewind().unwrap();
                file.write_all(&damaged).unwrap();
                let entries = Entries::of(kept.try_clone().unwrap(), &path).unwrap();
                for id in entries.places.keys() {
                    let outcome = entries.outcome(id).unwrap().unwrap();
                    assert_eq!(written.get(id), Some(&bits(&outcome)), "bit {bit} of byte {at}");
                }
                let (found, lost) = (&entries.places, &entries.lost);
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
