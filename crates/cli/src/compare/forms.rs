//! What a comparison found, in the forms that a robot's repository reads: JUnit XML, SARIF and annotations of GitHub, each with file and line.

use crate::compare::outcome::params;
use ::featherbench_results::{Row, RunInfo};
use featherbench_bench::Robot;
use featherbench_report::forms::{Case, escaped, junit_of};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Classes of differences that make the exit code; with `--strict` all do.
const GRAVE: [&str; 2] = ["physics", "pose"];

/// A difference, or a file that an engine refuses.
pub struct Found {
    /// The engine.
    engine: String,
    /// What differs: a field of a description, or `file`.
    field: String,
    /// The body.
    body: String,
    /// A sentence.
    text: String,
    /// The robot's file.
    file: String,
    /// The line of the body in it; the first if it is not found there.
    line: usize,
}

/// What is told of a comparison, in the order of its rows.
pub fn found(robots: &[Robot], records: &[Row], strict: bool) -> Vec<Found> {
    let texts: BTreeMap<&str, (String, String)> = robots
        .iter()
        .filter_map(|robot| {
            let path = &robot.file.as_ref()?.path;
            Some((robot.name.as_str(), (path.display().to_string(), std::fs::read_to_string(path).unwrap_or_default())))
        })
        .collect();
    let of = |row: &Row| {
        let (file, text) = texts.get(row.robot.as_str())?;
        let params = params(row);
        let class = params["class"].as_str().unwrap_or_default();
        let told = match row.metric.as_str() {
            "difference" if strict || GRAVE.contains(&class) => difference(row, &params),
            "differences" if row.value.is_none() => format!("{} does not read the file: {}", row.engine, row.reason),
            _ => return None,
        };
        let field = if row.quantity.is_empty() { "file".to_owned() } else { row.quantity.clone() };
        let line = line_of(text, &row.body).unwrap_or(1);
        Some(Found { engine: row.engine.clone(), field, body: row.body.clone(), text: told, file: file.clone(), line })
    };
    records.iter().filter(|row| row.study == "import").filter_map(of).collect()
}

fn difference(row: &Row, params: &Value) -> String {
    let text = |name: &str| params[name].as_str().map_or_else(|| params[name].to_string(), str::to_owned);
    let note = params["note"].as_str().filter(|note| !note.is_empty()).map_or_else(String::new, |note| format!(". {note}"));
    let (field, body) = (row.quantity.replace('_', " "), if row.body.is_empty() { "the robot" } else { &row.body });
    format!("{} reads the {field} of {body} as {}, not {} ({}){note}", row.engine, text("theirs"), text("ours"), text("cause"))
}

/// The line of the element with a name, from one on.
fn line_of(text: &str, name: &str) -> Option<usize> {
    // A body of a chain is called by its link and its joint.
    let names: Vec<String> = name.split('/').flat_map(|name| [format!("name=\"{name}\""), format!("name='{name}'")]).collect();
    let has = |line: &str| !name.is_empty() && names.iter().any(|name| line.contains(name.as_str()));
    text.lines().position(has).map(|index| index + 1)
}

/// A failing test case for each thing that was found, and a passing one for each condition that is met.
pub fn junit(run: &RunInfo, list: &[Found]) -> String {
    let case = |found: &Found| Case {
        class: found.engine.clone(),
        name: format!("{}: {} {}", found.file, found.body, found.field),
        kind: found.field.clone(),
        message: found.text.clone(),
        text: format!("{}:{}: {}", found.file, found.line, found.text),
    };
    junit_of(run, &list.iter().map(case).collect::<Vec<_>>())
}

/// The static analysis results interchange format, 2.1.0.
pub fn sarif(list: &[Found]) -> Value {
    let rules: BTreeMap<&str, Value> = list.iter().map(|found| (found.field.as_str(), json!({ "id": found.field }))).collect();
    let result = |found: &Found| {
        json!({
            "ruleId": found.field,
            "level": "error",
            "message": { "text": found.text },
            "locations": [{ "physicalLocation": {
                "artifactLocation": { "uri": found.file },
                "region": { "startLine": found.line },
            } }],
        })
    };
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "featherbench",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules.into_values().collect::<Vec<_>>(),
            } },
            "results": list.iter().map(result).collect::<Vec<_>>(),
        }],
    })
}

/// One `::error` line for each: a workflow of GitHub shows it beside the line of the file.
pub fn annotations(list: &[Found]) -> String {
    let property = |text: &str| escaped(text).replace(':', "%3A").replace(',', "%2C");
    let line = |found: &Found| {
        let title = property(&format!("{}: {}", found.engine, found.field));
        format!("::error file={},line={},title={title}::{}\n", property(&found.file), found.line, escaped(&found.text))
    };
    list.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_found_by_its_name_in_either_quotes() {
        let text = "<robot>\n<link name='a'/>\n <link name=\"ab\"/>\n</robot>";
        assert_eq!((line_of(text, "ab"), line_of(text, "a"), line_of(text, "c"), line_of(text, "")), (Some(3), Some(2), None, None));
        assert_eq!(line_of(text, "ab/hinge"), Some(3));
    }
}
