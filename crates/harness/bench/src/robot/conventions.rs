//! The list of conventions, `oracles/conventions.toml`: what each engine does, what we do, the conversion, and the test of it.

use crate::HarnessError;
use featherbench_results::Convention;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ledger {
    /// What we do, by topic.
    ours: BTreeMap<String, String>,
    convention: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    engine: String,
    topic: String,
    theirs: String,
    conversion: String,
    test: String,
}

/// Reads the list, in its order.
///
/// # Errors
/// [`HarnessError`], naming file, line and key. A row whose topic has no entry in `[ours]` is an error, and so is an entry without a row.
pub fn read(path: &Path) -> Result<Vec<Convention>, HarnessError> {
    let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
    let wrong = |message: String| HarnessError::Config { path: path.to_owned(), message };
    let ledger: Ledger = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if let Some(idle) = ledger.ours.keys().find(|topic| ledger.convention.iter().all(|row| row.topic != **topic)) {
        return Err(wrong(format!("ours: no [[convention]] is about '{idle}'")));
    }
    let complete = |Row { engine, topic, theirs, conversion, test }: Row| {
        let ours = ledger.ours.get(&topic).cloned();
        let ours = ours.ok_or_else(|| wrong(format!("[[convention]] of {engine}: '{topic}' has no entry in [ours]")))?;
        Ok(Convention { engine, topic, theirs, ours, conversion, test })
    };
    ledger.convention.into_iter().map(complete).collect()
}

/// The list as tables in Markdown, one for each engine, as in `CONVENTIONS.md`.
pub fn markdown(conventions: &[Convention]) -> String {
    let mut text = String::new();
    let mut engine = "";
    for row in conventions {
        if row.engine != engine {
            engine = &row.engine;
            text += &format!("\n### {engine}\n| | the engine | ours | converted by | held by |\n|---|---|---|---|---|\n");
        }
        let Convention { topic, theirs, ours, conversion, test, .. } = row;
        text += &format!("| {topic} | {theirs} | {ours} | {conversion} | `{test}` |\n");
    }
    text
}
