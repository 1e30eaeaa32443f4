//! Data of the page as scripts: a page under `file://` may run a script beside it, but not read a file.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{COLUMNS, Row, RunInfo, Severity, Verdict};
use serde::Serialize;

use crate::error::ReportError;
use crate::overview::{Overview, robot_chunk};
use crate::parts::{self, Piece};
use crate::section::Section;

/// The chunk with every row that did not pass.
pub const UNPASSED: &str = "unpassed";

/// The chunk with every time and what is made of times, of all robots: the rows with a cache regime.
pub const TIMES: &str = "times";

/// A file's name in the report's folder, and its bytes.
pub type NamedFile = (String, Vec<u8>);

/// The words of the run.
pub fn overview(overview: &Overview) -> Result<Vec<u8>, ReportError> {
    Ok(script("overview", &serde_json::to_string(overview)?))
}

/// The data of all sections, by their anchors.
pub fn figures(sections: &[Section]) -> Result<Vec<u8>, ReportError> {
    let mut parts = Vec::new();
    for section in sections {
        match &section.data {
            None => {}
            Some(Ok(json)) => parts.push(format!("{}:{json}", serde_json::to_string(section.anchor)?)),
            Some(Err(error)) => return Err(<serde_json::Error as serde::ser::Error>::custom(format!("{}: {error}", section.anchor)).into()),
        }
    }
    Ok(script("figures", &format!("{{{}}}", parts.join(","))))
}

/// The data of all figures for papers.
pub fn figure_data(json: &str) -> NamedFile {
    ("data/figure-data.js".to_owned(), script("figure-data", json))
}

/// The markup of a piece that the first page leaves out. It is a file of its own, so that its angle brackets end no element and stay as they
/// are; as escapes they would be half of it.
pub fn piece(piece: &Piece) -> Result<NamedFile, ReportError> {
    let json = serde_json::to_string(&piece.body.0)?;
    let json = json.replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029");
    let text = format!("featherbench.chunk(\"part-{}\",{json});\n", piece.name);
    Ok((format!("{}/{}.js", parts::FOLDER, piece.name), text.into_bytes()))
}

/// One call, `featherbench.chunk("name",{…});`, whose second argument is plain JSON.
///
/// Characters that could end a script element or a line are written as escapes, so that no name of a robot can become markup.
fn script(name: &str, json: &str) -> Vec<u8> {
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
    text.into_bytes()
}

/// Whether a row belongs to the list of those that did not pass.
pub fn is_unpassed(row: &Row) -> bool {
    !matches!(row.verdict, Verdict::Pass | Verdict::Info)
}

/// All rows: a chunk per robot, one per study for rows without a robot, one with every row that did not pass, and one
/// with every time.
pub fn rows<'a>(run: &'a RunInfo, overview: &Overview, rows: &'a [Row]) -> impl Iterator<Item = Result<NamedFile, ReportError>> + use<'a> {
    let mut chunks: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    // A robot without rows has a chunk too: a click on it must show that there are none.
    for robot in 0..overview.robots.len() {
        chunks.insert(robot_chunk(robot), Vec::new());
    }
    chunks.insert(UNPASSED.to_owned(), rows.iter().filter(|row| is_unpassed(row)).collect());
    chunks.insert(TIMES.to_owned(), rows.iter().filter(|row| !row.cache.is_empty()).collect());
    for row in rows {
        chunks.entry(overview.chunk_of(row)).or_default().push(row);
    }
    chunks.into_iter().map(|(name, rows)| Ok((format!("data/{name}.js"), script(&name, &serde_json::to_string(&Table::of(run, &rows)?)?))))
}

/// Rows as arrays: the names of the columns are given once.
#[derive(Serialize)]
struct Table {
    columns: Vec<&'static str>,
    rows: Vec<Vec<serde_json::Value>>,
    /// The level of each row that has one, by its place.
    levels: BTreeMap<usize, &'static str>,
    /// The command that makes rows again, by `study/robot`.
    again: BTreeMap<String, String>,
}

impl Table {
    fn of(run: &RunInfo, rows: &[&Row]) -> Result<Self, ReportError> {
        let columns: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
        let row = |row: &&Row| -> Result<Vec<serde_json::Value>, ReportError> {
            let mut fields = serde_json::to_value(row)?;
            Ok(columns.iter().map(|&name| fields[name].take()).collect())
        };
        let levels = rows.iter().enumerate().filter_map(|(place, row)| Some((place, Severity::of(row)?.as_str()))).collect();
        let pairs: BTreeSet<(&str, &str)> = rows.iter().map(|row| (row.study.as_str(), row.robot.as_str())).collect();
        // A run without a command of its own has none for its rows.
        let again = pairs.into_iter().filter_map(|(study, robot)| Some((format!("{study}/{robot}"), run.again(study, robot).ok()?)));
        let (rows, again) = (rows.iter().map(row).collect::<Result<_, _>>()?, again.collect());
        Ok(Self { columns, rows, levels, again })
    }
}
