//! The list of a report's files. When a report is written again, those of the older one that it no longer has are removed; other files stay.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use featherbench_results::{ResultsError, quick_write};

use crate::error::ReportError;

/// The name of the list in the report's folder: a path a line.
const NAME: &str = "report-files.txt";
/// The folders of a report. What a list names elsewhere is never removed: the run's own files are beside the report.
const FOLDERS: [&str; 6] = ["data", "engines", "figures", "robots", "sections", "studies"];

/// Removes the files of the older report that are not among these, and writes the list of these. Returns its name.
///
/// # Errors
/// [`ReportError`] if a file cannot be removed or written.
pub fn renew<'a>(out: &Path, files: impl Iterator<Item = &'a str>) -> Result<&'static str, ReportError> {
    let files: BTreeSet<&str> = files.collect();
    // Where capitals are small letters, a robot of another spelling has the same file.
    let kept: BTreeSet<String> = files.iter().map(|name| name.to_ascii_lowercase()).collect();
    let list = out.join(NAME);
    let before = std::fs::read_to_string(&list).unwrap_or_default();
    for name in before.lines().filter(|name| is_in_a_folder(name) && !kept.contains(&name.to_ascii_lowercase())) {
        let path = out.join(name);
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => return Err(ResultsError::Io { path, source }.into()),
            _ => {}
        }
    }
    quick_write(&list, files.iter().map(|name| format!("{name}\n")).collect::<String>().as_bytes())?;
    Ok(NAME)
}

/// Whether a name is that of a file in a folder of the report, and of no other place.
fn is_in_a_folder(name: &str) -> bool {
    let file = name.split_once('/').filter(|(folder, _)| FOLDERS.contains(folder)).map(|(_, file)| file);
    file.is_some_and(|file| !file.is_empty() && !file.starts_with('.') && !file.contains(['/', '\\']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_in_the_folders_of_a_report_are_removed() {
        for name in ["robots/panda.html", "data/robot-0.js"] {
            assert!(is_in_a_folder(name), "{name}");
        }
        for name in
            ["", "rows.csv", "robots", "robots/", "robots/..", "robots/../rows.csv", "robots/a\\b", "../robots/a", "/robots/a", "other/a"]
        {
            assert!(!is_in_a_folder(name), "{name}");
        }
    }
}
