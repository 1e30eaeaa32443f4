//! `fingerprint.json`: the facts that a resumed run must share with the run that it continues.

use crate::HarnessError;
use featherbench_results::{atomic_write, seal, unsealed};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the file in a run's folder. It is the first one that is written there.
pub const FINGERPRINT_NAME: &str = "fingerprint.json";

/// The fact in it that says which shard a folder is of.
pub(crate) const SHARD: &str = "shard";

/// Facts by name.
pub(crate) type Facts = BTreeMap<String, String>;

/// Writes the facts, sealed, in one step.
pub(crate) fn write(folder: &Path, facts: &Facts) -> Result<(), HarnessError> {
    let path = folder.join(FINGERPRINT_NAME);
    let mut bytes = serde_json::to_string_pretty(facts).map_err(|error| HarnessError::io(&path, error.into()))?.into_bytes();
    bytes.push(b'\n');
    seal(&mut bytes);
    Ok(atomic_write(&path, &bytes)?)
}

/// Compares with the facts of the run that goes on.
pub(crate) fn compare(folder: &Path, now: &Facts) -> Result<(), HarnessError> {
    let then = read(folder)?;
    let Some(what) = then.keys().chain(now.keys()).find(|what| then.get(*what) != now.get(*what)) else { return Ok(()) };
    let [then, now] = [&then, now].map(|side| side.get(what).map_or("none", String::as_str).to_owned());
    Err(HarnessError::Mixed { path: folder.to_owned(), what: what.clone(), then, now })
}

/// The shard that was begun in a folder, if one was.
///
/// # Errors
/// [`HarnessError`] when the file is damaged.
pub fn shard_of(folder: &Path) -> Result<Option<String>, HarnessError> {
    if folder.join(FINGERPRINT_NAME).is_file() { Ok(read(folder)?.remove(SHARD)) } else { Ok(None) }
}

fn read(folder: &Path) -> Result<Facts, HarnessError> {
    let path = folder.join(FINGERPRINT_NAME);
    let bytes = std::fs::read(&path).map_err(|source| HarnessError::io(&path, source))?;
    let damaged = |what: String| HarnessError::Config { path: path.clone(), message: what };
    let body = unsealed(&bytes).ok_or_else(|| {
        damaged(
            "its last line is not the checksum of the others: it was damaged after it was written, or another version wrote it; \
             start a new run, or go on knowingly with --allow-mixed"
                .into(),
        )
    })?;
    serde_json::from_slice(body).map_err(|error| damaged(error.to_string()))
}
