//! The times that other machines recorded: `datasets/speed/MACHINE/ranking.json`, which `report --json` of a run of the suite `timing` prints.

use crate::fail::Fail;
use crate::root::Root;
use ::featherbench_results::Ranking;

/// The name of the file in each machine's folder.
const NAME: &str = "ranking.json";

/// Reads them, in the order of their folders' names; the project may have none.
///
/// # Errors
/// When a file cannot be read or is no ranking.
pub fn recorded(root: &Root) -> Result<Vec<Ranking>, Fail> {
    let folder = root.speed();
    let Ok(entries) = std::fs::read_dir(&folder) else { return Ok(Vec::new()) };
    let mut files: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path().join(NAME))).filter(|file| file.is_file()).collect();
    files.sort_unstable();
    let read = |file: &std::path::PathBuf| {
        let wrong = |what: String| Fail::input(format!("{}: {what}; ci/speed makes it again", file.display()));
        let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
    };
    files.iter().map(read).collect()
}
