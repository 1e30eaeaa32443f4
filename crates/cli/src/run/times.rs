//! The times that other machines recorded: `datasets/speed/MACHINE/times.json`, which `ci/speed` makes of a run of the suite `timing`.

use crate::fail::Fail;
use crate::root::Root;
use ::featherbench_results::RecordedTimes;

/// The name of the file in each machine's folder.
const NAME: &str = "times.json";

/// Reads them, in the order of their folders' names; the project may have none.
///
/// # Errors
/// When a file cannot be read or has something else.
pub fn recorded(root: &Root) -> Result<Vec<RecordedTimes>, Fail> {
    let Ok(entries) = std::fs::read_dir(root.speed()) else { return Ok(Vec::new()) };
    let mut files: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path().join(NAME))).filter(|file| file.is_file()).collect();
    files.sort_unstable();
    let mut all = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).map_err(|error| Fail::input(format!("{}: {error}", file.display())))?;
        all.extend(RecordedTimes::parse(&file, &text).map_err(|error| Fail::input(format!("{error}; ci/speed makes it again")))?);
    }
    Ok(all)
}
