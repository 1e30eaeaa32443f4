//! Merging shards: which are taken, which are refused and why, what is missing.

use super::{Plan, SHARD_NAME, Shard, ShardError, ShardFile};
use crate::{Entries, HarnessError, OUTCOMES_NAME, run};
use featherbench_results::atomic_write_with;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// A shard whose files are whole.
#[derive(Debug)]
pub struct Part {
    /// Its folder.
    pub folder: PathBuf,
    /// What it is.
    pub file: ShardFile,
    entries: Entries,
}

impl Part {
    /// Opens a shard, and checks every byte of it.
    ///
    /// # Errors
    /// [`ShardError`] when the folder is no shard, or is unfinished, damaged or of another version.
    pub fn open(folder: &Path) -> Result<Self, ShardError> {
        let foreign = |what: &str| Err(ShardError::Foreign { path: folder.to_owned(), what: what.into() });
        let (path, outcomes) = (folder.join(SHARD_NAME), folder.join(OUTCOMES_NAME));
        if !folder.is_dir() {
            return foreign("there is no such folder");
        }
        if !path.is_file() {
            match run::shard_of(folder) {
                Ok(Some(shard)) => return Err(ShardError::Unfinished { path: folder.to_owned(), shard }),
                Ok(None) => {}
                Err(error) => return foreign(&format!("it has no shard.json, and {error}")),
            }
            return foreign(if folder.join(featherbench_results::RUN_NAME).is_file() {
                "it is a whole run"
            } else {
                "it has no shard.json"
            });
        }
        let damaged = |path: &Path, what: String| ShardError::Damaged { path: path.to_owned(), what };
        let bytes = std::fs::read(&path).map_err(|error| damaged(&path, error.to_string()))?;
        let file = ShardFile::parse(&bytes, &path)?;
        file.check(folder)?;
        let entries = Entries::open(folder).map_err(|error| damaged(&outcomes, error.to_string()))?;
        if let Some(lost) = entries.lost() {
            return Err(damaged(&outcomes, format!("entry {}: {}", lost.entry, lost.what)));
        }
        if let Some(id) = file.cells.iter().find(|id| !entries.contains(id)) {
            return Err(damaged(&outcomes, format!("it has no outcome of the cell {id}")));
        }
        if entries.cells().count() != file.cells.len() {
            return Err(damaged(&outcomes, format!("it has outcomes of cells that {SHARD_NAME} does not name")));
        }
        if file.shard.parse::<Shard>().is_err() {
            return Err(damaged(&path, format!("'{}' is no shard", file.shard)));
        }
        Ok(Self { folder: folder.to_owned(), file, entries })
    }

    /// Its outcomes.
    pub(crate) fn into_entries(self) -> Entries {
        self.entries
    }
}

/// Shards that fit together, and what is wrong with the others.
#[derive(Debug, Default)]
pub struct Merge {
    /// The shards that are taken.
    pub parts: Vec<Part>,
    /// Why each of the others is refused.
    pub refused: Vec<ShardError>,
    /// The cells of the plan that no shard has, by their paths.
    pub missing: Vec<String>,
}

impl Merge {
    /// Takes the shards of a plan in their order; one that does not fit to the plan, to this program or to those before it is refused.
    ///
    /// `now` are the facts that all must share with this program; with `mixed` they may differ.
    pub fn of(parts: Vec<Part>, plan: &Plan, now: &BTreeMap<String, String>, mixed: bool) -> Self {
        let planned: HashSet<&str> = plan.cells.iter().map(|planned| planned.id.as_str()).collect();
        // By cell, the place of its shard among those that are taken.
        let mut owners: HashMap<String, usize> = HashMap::new();
        let mut merge = Self::default();
        for part in parts {
            match merge.complaint(&part, &planned, &owners, now, mixed) {
                Some(complaint) => merge.refused.push(complaint),
                None => {
                    owners.extend(part.file.cells.iter().map(|id| (id.clone(), merge.parts.len())));
                    merge.parts.push(part);
                }
            }
        }
        merge.missing = plan.cells.iter().filter(|planned| !owners.contains_key(&planned.id)).map(|planned| planned.cell.path()).collect();
        merge
    }

    /// What is wrong with a shard beside those that are taken.
    fn complaint(
        &self,
        part: &Part,
        planned: &HashSet<&str>,
        owners: &HashMap<String, usize>,
        now: &BTreeMap<String, String>,
        mixed: bool,
    ) -> Option<ShardError> {
        let path = || part.folder.clone();
        let then = &part.file.fingerprint;
        if let Some(what) = now.keys().chain(then.keys()).find(|what| then.get(*what) != now.get(*what)).filter(|_| !mixed) {
            let [then, now] = [then, now].map(|side| side.get(what).map_or("none", String::as_str).to_owned());
            return Some(ShardError::Mixed { path: path(), what: what.clone(), then, now });
        }
        let mut strangers = part.file.cells.iter().filter(|id| !planned.contains(id.as_str()));
        if let Some(first) = strangers.next() {
            return Some(ShardError::Stranger { path: path(), count: 1 + strangers.count(), first: first.clone() });
        }
        let mut doubles = part.file.cells.iter().filter_map(|id| Some((id, *owners.get(id)?)));
        let (first, owner) = doubles.next()?;
        let other = self.parts[owner].folder.clone();
        Some(ShardError::Duplicate { path: path(), other, count: 1 + doubles.count(), first: first.clone() })
    }

    /// The numbers of the shards that are not among those taken, if all were cut alike: `3/7`.
    pub fn absent(&self) -> Vec<String> {
        let shards: Vec<Shard> = self.parts.iter().filter_map(|part| part.file.shard.parse().ok()).collect();
        let Some(of) = shards.first().map(|shard| shard.of()) else { return Vec::new() };
        if shards.iter().any(|shard| shard.of() != of) {
            return Vec::new();
        }
        let there: BTreeSet<usize> = shards.iter().map(|shard| shard.number()).collect();
        (1..=of).filter(|number| !there.contains(number)).map(|number| format!("{number}/{of}")).collect()
    }

    /// Writes the outcomes of all shards as the file of one run, in the order of the plan: one entry is in memory at a time.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn write(&self, plan: &Plan, folder: &Path) -> Result<(), HarnessError> {
        let path = folder.join(OUTCOMES_NAME);
        let mut failed = None;
        let written = atomic_write_with(&path, |out| {
            for planned in &plan.cells {
                let Some(part) = self.parts.iter().find(|part| part.entries.contains(&planned.id)) else { continue };
                match part.entries.bytes(&planned.id) {
                    Ok(bytes) => out.write_all(&bytes.unwrap_or_default())?,
                    Err(error) => {
                        failed = Some(error);
                        return Err(std::io::Error::other("a shard cannot be read"));
                    }
                }
            }
            Ok(())
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(written?),
        }
    }
}
