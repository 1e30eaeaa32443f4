//! `journal.jsonl`: what was started in a folder, one line of JSON each.
//!
//! The file grows, so each line has its own checksum: that of all bytes before the line and of the line without it. So no line can be altered,
//! taken out or put elsewhere unseen. Lines that are missing at the end are seen by who knows a checksum of one.

use featherbench_results::{ResultsError, checksum};
use serde_json::{Map, Value};
use std::fs::OpenOptions;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

/// Name of the file in a folder.
pub const JOURNAL_NAME: &str = "journal.jsonl";

/// The key of a line's checksum.
const CHECKSUM: &str = "blake3";

/// Appends a line. A last line without an end is what a killed process left: it is cut off.
///
/// # Errors
/// When the file cannot be read or written.
pub fn append<'a>(folder: &Path, line: impl IntoIterator<Item = (&'a str, Value)>) -> Result<(), ResultsError> {
    let line = line.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    let path = folder.join(JOURNAL_NAME);
    let io = |source| ResultsError::Io { path: path.clone(), source };
    let mut file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(io)?;
    let mut before = Vec::new();
    std::io::Read::read_to_end(&mut file, &mut before).map_err(io)?;
    before.truncate(before.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
    file.set_len(before.len() as u64).map_err(io)?;
    file.seek(SeekFrom::End(0)).map_err(io)?;
    file.write_all(signed(&before, line).as_bytes()).map_err(io)
}

/// The checksums of the lines, or the first line that is damaged, counted from one.
pub(crate) fn checked(journal: &[u8]) -> Result<Vec<String>, usize> {
    let (mut at, mut sums) = (0, Vec::new());
    for line in journal.split_inclusive(|byte| *byte == b'\n') {
        let number = sums.len() + 1;
        let mut read: Map<String, Value> = serde_json::from_slice(line).map_err(|_| number)?;
        let Some(Value::String(sum)) = read.remove(CHECKSUM) else { return Err(number) };
        if signed(&journal[..at], read).as_bytes() != line {
            return Err(number);
        }
        at += line.len();
        sums.push(sum);
    }
    Ok(sums)
}

/// A line with its checksum and its end.
fn signed(before: &[u8], mut line: Map<String, Value>) -> String {
    let sum = checksum(&[before, Value::Object(line.clone()).to_string().as_bytes()].concat());
    line.insert(CHECKSUM.into(), sum.into());
    format!("{}\n", Value::Object(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn line(number: usize) -> [(&'static str, Value); 3] {
        [("process", json!(number)), ("time", json!("2026-11-28T09:00:00Z")), ("cells", json!([number, 2]))]
    }

    #[test]
    fn every_flipped_bit_and_every_line_that_is_gone_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        (1..=3).for_each(|number| append(folder.path(), line(number)).unwrap());
        let path = folder.path().join(JOURNAL_NAME);
        let whole = std::fs::read(&path).unwrap();
        let sums = checked(&whole).unwrap();
        assert_eq!(sums.len(), 3);
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                assert!(checked(&damaged).is_err(), "bit {bit} of byte {at}");
            }
            // Cut at the end of a line, the rest is good, and lacks the last checksum.
            let good = checked(&whole[..at]).is_ok_and(|found| found.len() < 3 && sums.starts_with(&found));
            assert_eq!(good, at == 0 || whole[at - 1] == b'\n', "cut at {at}");
        }
        let lines: Vec<&[u8]> = whole.split_inclusive(|byte| *byte == b'\n').collect();
        assert_eq!(checked(&[lines[0], lines[2]].concat()), Err(2));
        // A killed process leaves a part of a line.
        std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
        append(folder.path(), line(4)).unwrap();
        assert_eq!(checked(&std::fs::read(&path).unwrap()).unwrap()[..2], sums[..2]);
    }
}
