//! What `featherbench compare` found, as JSON for programs. `compare --help` describes the fields.

use crate::compare::outcome::{neutral, params};
use crate::fail::Fail;
use ::featherbench_results::{Row, RunInfo};
use featherbench_bench::Robot;
use featherbench_comparison::import::{Answer, answers};
use serde_json::{Value, json};
use std::path::Path;

/// The whole comparison: its robots with the remarks on them, and the files that could not be compared.
pub fn json(info: &RunInfo, page: &Path, robots: &[(&Robot, &[String])], records: &[Row], bad: &[Fail]) -> Value {
    let answers = answers(records);
    let unmet: Vec<_> = info.expected.iter().filter(|condition| !condition.is_met()).collect();
    let missed = |what: &str, reason: &str, culprit: &_| json!({ "what": what, "reason": reason, "culprit": culprit });
    json!({
        "run": info.run,
        "suite": info.suite,
        "status": if unmet.is_empty() { "alike" } else { "differs" },
        "report": page.display().to_string(),
        "robots": robots.iter().map(|(robot, remarks)| of_robot(robot, remarks, &answers, records)).collect::<Vec<_>>(),
        "conditions": {
            "met": info.expected.len() - unmet.len(),
            "all": info.expected.len(),
            "unmet": unmet.iter().map(|condition| missed(&condition.what, &condition.reason, &json!(condition.culprit))).collect::<Vec<_>>(),
        },
        "refused": bad.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn of_robot(robot: &Robot, remarks: &[String], answers: &[Answer], records: &[Row]) -> Value {
    let reference = records.iter().find(|row| row.study == "import" && row.robot == robot.name).map(|row| &row.reference);
    let engines = answers.iter().filter(|answer| answer.robot == robot.name);
    json!({
        "robot": robot.name,
        "base": robot.base(),
        "bodies": robot.states.bodies,
        "nv": robot.states.nv,
        "reference": reference,
        "remarks": remarks,
        "engines": engines.map(|answer| of_engine(answer, records)).collect::<Vec<_>>(),
    })
}

fn of_engine(answer: &Answer, records: &[Row]) -> Value {
    let rows: Vec<&Row> = records.iter().filter(|row| row.robot == answer.robot && row.engine == answer.engine).collect();
    let refused = rows.iter().find(|row| row.study == "import" && row.metric == "differences" && row.value.is_none());
    let differences = rows.iter().filter(|row| row.study == "import" && row.metric == "difference");
    json!({
        "engine": answer.engine,
        "version": answer.version,
        "loads": answer.loads,
        "same": answer.same,
        "error": answer.error,
        "bound": answer.bound,
        "neutral": neutral(&rows),
        "largest": answer.largest,
        "advice": answer.advice,
        "reason": refused.map(|row| &row.reason),
        "differences": differences.map(|row| difference(row)).collect::<Vec<_>>(),
    })
}

fn difference(row: &Row) -> Value {
    let params = params(row);
    json!({
        "body": row.body,
        "field": row.quantity,
        "class": params["class"],
        "cause": params["cause"],
        "ours": params["ours"],
        "theirs": params["theirs"],
        "size": row.value,
        "id": params["id"],
        "mass_matrix": params["mass_matrix"],
        "note": params["note"],
    })
}
