//! Checksums: they show whether a file was damaged after it was written.
//!
//! A file of our own format is *sealed*: its last line is the checksum of all bytes before it. Files for other programs are not changed.
//! `checksums.txt` in their folder has their checksums in the form of `b3sum`, so that `b3sum --check checksums.txt` reads it too.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use crate::ResultsError;
use crate::disk::{atomic_write, read_bytes};

/// Name of the file of checksums in a folder.
pub const CHECKSUMS_NAME: &str = "checksums.txt";

/// The BLAKE3 hash of some bytes: 64 hexadecimal digits in lower case.
pub fn checksum(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Why there is no run in a folder that has no checksums, finished or not.
fn no_run(folder: &Path) -> Option<&'static str> {
    if !folder.exists() {
        return Some("there is no such folder");
    }
    let mut entries = std::fs::read_dir(folder).ok()?;
    entries.next().is_none().then_some("the folder is empty")
}

/// The checksum of a file, which need not fit into the memory.
///
/// # Errors
/// [`ResultsError::Io`] when it cannot be read.
pub fn checksum_of(path: &Path) -> Result<String, ResultsError> {
    let io = |source| ResultsError::Io { path: path.to_owned(), source };
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(std::fs::File::open(path).map_err(io)?).map_err(io)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Ends a file with the line that holds the checksum of all bytes before it.
pub fn seal(bytes: &mut Vec<u8>) {
    let line = last_line(bytes);
    bytes.extend(line.into_bytes());
}

/// The bytes before the last line, when that line is their checksum.
pub fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (body, line) = bytes.split_at_checked(bytes.len().checked_sub(last_line(b"").len())?)?;
    (last_line(body).as_bytes() == line).then_some(body)
}

/// The last line of a sealed file; its length does not depend on the bytes.
fn last_line(body: &[u8]) -> String {
    format!("{{\"blake3\":\"{}\"}}\n", checksum(body))
}

/// The checksums of some files of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checksums {
    folder: PathBuf,
    by_name: BTreeMap<String, String>,
}

impl Checksums {
    /// The present checksums of files.
    ///
    /// # Errors
    /// [`ResultsError::Io`] when one of the files cannot be read.
    pub fn of(folder: &Path, names: &[&str]) -> Result<Self, ResultsError> {
        let one = |name: &&str| Ok(((*name).to_owned(), checksum_of(&folder.join(name))?));
        Ok(Self { folder: folder.to_owned(), by_name: names.iter().map(one).collect::<Result<_, ResultsError>>()? })
    }

    /// Writes `checksums.txt`, in one step.
    ///
    /// # Errors
    /// [`ResultsError::Io`].
    pub fn write(&self) -> Result<(), ResultsError> {
        atomic_write(&self.path(), self.to_text().as_bytes())
    }

    /// Reads the `checksums.txt` of a folder.
    ///
    /// # Errors
    /// [`ResultsError::Unfinished`] when there is none; [`ResultsError::Damaged`], with its line, when it is not in the form that
    /// [`write`](Self::write) gives it.
    pub fn read(folder: &Path) -> Result<Self, ResultsError> {
        let path = folder.join(CHECKSUMS_NAME);
        let bytes = read_bytes(&path).map_err(|error| match error {
            ResultsError::Io { source, path } if source.kind() == io::ErrorKind::NotFound => match no_run(folder) {
                Some(what) => ResultsError::NoRun { folder: folder.to_owned(), what },
                None => ResultsError::Unfinished { path },
            },
            ResultsError::Io { .. } if folder.is_file() => ResultsError::NoRun { folder: folder.to_owned(), what: "it is a file" },
            other => other,
        })?;
        let damaged = |line: usize| ResultsError::Damaged {
            path: path.clone(),
            line: line as u64 + 1,
            what: "the line is not a checksum, two blanks and a name, sorted by name".into(),
        };
        let text = String::from_utf8(bytes).map_err(|error| {
            let before = error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|&&byte| byte == b'\n');
            damaged(before.count())
        })?;
        let entry = |line: &str| line.split_once("  ").map(|(sum, name)| (name.to_owned(), sum.to_owned()));
        let sums = Self { folder: folder.to_owned(), by_name: text.lines().filter_map(entry).collect() };
        let written = sums.to_text();
        let is_sum = |sum: &String| sum.len() == 64 && sum.bytes().all(|c| c.is_ascii_digit() || (b'a'..=b'f').contains(&c));
        let bad = text.lines().position(|line| entry(line).is_none_or(|(_, sum)| !is_sum(&sum)));
        match bad.or_else(|| text.lines().zip(written.lines()).position(|(found, due)| found != due)) {
            Some(line) => Err(damaged(line)),
            None if text != written => Err(damaged(written.lines().count().saturating_sub(1))),
            None => Ok(sums),
        }
    }

    /// The names of the files, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.by_name.keys().map(String::as_str)
    }

    /// The bytes of a file with the right checksum.
    ///
    /// # Errors
    /// [`ResultsError::Unlisted`] when its checksum is not known, [`ResultsError::Checksum`] when it is different, and
    /// [`ResultsError::Io`].
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>, ResultsError> {
        self.whole(name, read_bytes, |bytes| checksum(bytes))
    }

    /// Checks a file, which need not fit into the memory.
    ///
    /// # Errors
    /// As [`bytes`](Self::bytes).
    pub fn check(&self, name: &str) -> Result<(), ResultsError> {
        self.whole(name, checksum_of, String::clone).map(drop)
    }

    fn whole<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Path) -> Result<T, ResultsError>,
        sum: impl FnOnce(&T) -> String,
    ) -> Result<T, ResultsError> {
        let (path, sums) = (self.folder.join(name), self.path());
        let Some(due) = self.by_name.get(name) else { return Err(ResultsError::Unlisted { sums, name: name.to_owned() }) };
        let found = match read(&path) {
            Err(ResultsError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                return Err(ResultsError::Absent { sums, path });
            }
            other => other?,
        };
        if sum(&found) == *due { Ok(found) } else { Err(ResultsError::Checksum { path, sums }) }
    }

    fn path(&self) -> PathBuf {
        self.folder.join(CHECKSUMS_NAME)
    }

    fn to_text(&self) -> String {
        self.by_name.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect()
    }
}
