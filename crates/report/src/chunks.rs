//! Data of the page as scripts: a page under `file://` may run a script beside it, but not read a file.

use std::collections::BTreeMap;

use featherbench_results::{COLUMNS, Row, Verdict};
use serde::Serialize;

use crate::ReportError;
use crate::overview::Overview;

/// The chunk with every row that did not pass.
pub const UNPASSED: &str = "unpassed";

/// A file's name in the report's folder, and its bytes.
type NamedFile = (String, Vec<u8>);

/// One call, `featherbench.chunk("name",{…});`, whose second argument is plain JSON.
///
/// Characters that could end a script element or a line are written as escapes, so that no name of a model can become markup.
pub fn script(name: &str, data: &impl Serialize) -> Result<Vec<u8>, ReportError> {
    let json = serde_json::to_string(data)?;
    let mut text = String::with_capacity(json.len() + 64);
    text.push_str("featherbench.chunk(\"");
    text.push_str(name);
    text.push_str("\",");
    for character in json.chars() {
        match character {
            '<' => text.push_str("\\u003c"),
            '>' => text.push_str("\\u003e"),
            '&' => text.push_str("\\u0026"),
            '\u{2028}' => text.push_str("\\u2028"),
            '\u{2029}' => text.push_str("\\u2029"),
            other => text.push(other),
        }
    }
    text.push_str(");\n");
    Ok(text.into_bytes())
}

/// Whether a row belongs to the list of those that did not pass.
pub fn is_unpassed(row: &Row) -> bool {
    !matches!(row.verdict, Verdict::Pass | Verdict::Info)
}

/// All rows: a chunk per model, one per study for rows without a model, and one with every row that did not pass.
pub fn rows(overview: &Overview, records: &[Row]) -> Result<Vec<NamedFile>, ReportError> {
    let mut chunks: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    // A model without rows has a chunk too: a click on it must show that there are none.
    for model in 0..overview.models.len() {
        chunks.insert(format!("model-{model}"), Vec::new());
    }
    chunks.insert(UNPASSED.to_owned(), records.iter().filter(|row| is_unpassed(row)).collect());
    for row in records {
        chunks.entry(overview.chunk_of(row)).or_default().push(row);
    }
    chunks.iter().map(|(name, rows)| Ok((format!("data/{name}.js"), script(name, &Table::of(rows)?)?))).collect()
}

/// Rows as arrays: the names of the columns are given once.
#[derive(Serialize)]
struct Table {
    columns: Vec<&'static str>,
    rows: Vec<Vec<serde_json::Value>>,
}

impl Table {
    fn of(records: &[&Row]) -> Result<Self, ReportError> {
        let columns: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
        let row = |record: &&Row| -> Result<Vec<serde_json::Value>, ReportError> {
            let mut fields = serde_json::to_value(record)?;
            Ok(columns.iter().map(|&name| fields[name].take()).collect())
        };
        let rows = records.iter().map(row).collect::<Result<_, _>>()?;
        Ok(Self { columns, rows })
    }
}
