//! The table of a comparison in the terminal, from its records alone.

use crate::compare::outcome::{neutral, params};
use ::featherbench_results::{Row, Verdict};
use featherbench_bench::{Engine, OWN, Robot};
use featherbench_comparison::import::{Answer, LARGEST, repairs};
use featherbench_report::numbers::aligned;
use serde_json::Value;
use std::collections::BTreeMap;

/// Differences that are listed of one engine; the report has them all.
const LISTED: usize = 12;

/// The columns of the answers.
const HEAD: [&str; 6] = ["robot", "engine", "loads as written", "same M and τ", "largest change", "what to do"];

/// The answer of each engine on each robot, in one line.
pub fn answers(answers: &[Answer]) -> String {
    let line = |answer: &Answer| {
        let change = answer.largest.as_ref().map_or_else(
            || "–".to_owned(),
            |largest| {
                let effect = largest.effect().map_or_else(String::new, |effect| format!(" by {effect:.1e}"));
                format!("{}{effect}", largest.place())
            },
        );
        [answer.robot.clone(), answer.engine.clone(), answer.loads.name().into(), answer.same_word().into(), change, answer.advice.clone()]
    };
    let lines: Vec<[String; 6]> = std::iter::once(HEAD.map(str::to_owned)).chain(answers.iter().map(line)).collect();
    aligned(&lines, &[0, 1, 2, 3, 4, 5]).into_iter().map(|line| line + "\n").collect()
}

/// What each engine makes of a robot, as text.
pub fn of(robot: &Robot, remarks: &[String], engines: &[&dyn Engine], records: &[Row], explain: bool) -> String {
    let states = &robot.states;
    let reference = records.iter().find(|row| row.study == "import" && row.robot == robot.name).map_or(OWN, |row| &row.reference);
    let reference = if reference == OWN { "featherbench's own reading".to_owned() } else { format!("the reading of {reference}") };
    let mut text = format!("\n{} ({}, {} bodies, {} dofs), against {reference}\n", robot.name, robot.base(), states.bodies, states.nv);
    text += &unread(robot, engines, records);
    for remark in remarks {
        text += &format!("  not compared: {remark}\n");
    }
    for engine in engines.iter().filter(|engine| engine.identity().name != OWN) {
        let identity = engine.identity();
        let rows: Vec<&Row> = records.iter().filter(|row| row.robot == robot.name && row.engine == identity.name).collect();
        text += &format!("\n  {} {}\n", identity.name, identity.version);
        let computed = neutral(&rows).map_or_else(
            || rows.iter().find(|row| row.study == "agreement" && row.value.is_none()).map_or("no answer".into(), |row| row.reason.clone()),
            |error| format!("id, bias and M agree to {error:.1e}"),
        );
        text += &format!("    one neutral model   {computed}\n");
        let rows: Vec<&Row> = rows.into_iter().filter(|row| row.study == "import").collect();
        text += &as_read(&rows);
        if explain {
            text += &refuted(&rows);
        }
    }
    text
}

/// The hypotheses about the whole file that an engine's numbers refute.
fn refuted(rows: &[&Row]) -> String {
    let params = rows.iter().find(|row| row.metric == "differences").map_or(Value::Null, |row| params(row));
    let refuted = params["refuted"].as_array().into_iter().flatten().filter_map(Value::as_str);
    refuted.map(|text| format!("      refuted: {text}\n")).collect()
}

/// The engines that reject the file as it is written, and what was repaired to go on. It is told first: an engine that imports the file as
/// written is not the one at fault.
fn unread(robot: &Robot, engines: &[&dyn Engine], records: &[Row]) -> String {
    let mut text = String::new();
    for name in engines.iter().map(|engine| &engine.identity().name) {
        let read = records.iter().find(|row| row.robot == robot.name && row.engine == *name && row.metric == "differences");
        let Some(row) = read.filter(|row| row.study == "import") else { continue };
        if row.value.is_none() {
            let how = if row.verdict == Verdict::Skip { "does not read the file" } else { "refuses the file" };
            text += &format!("  {name} {how}: {}\n", row.reason);
        }
        for repair in repairs(row) {
            text += &format!("  {name} refuses the file as written; repaired to go on: {repair}\n");
        }
    }
    text
}

fn as_read(rows: &[&Row]) -> String {
    let value =
        |metric: &str, quantity: &str| rows.iter().find(|row| row.metric == metric && row.quantity == quantity).and_then(|row| row.value);
    let Some(read) = rows.iter().find(|row| row.metric == "differences") else { return String::new() };
    let Some(count) = read.value else { return format!("    the file as read    not read: {}\n", read.reason) };
    let differences: Vec<(&Row, Value)> = rows.iter().filter(|row| row.metric == "difference").map(|row| (*row, params(row))).collect();
    let felt: Vec<&(&Row, Value)> = differences.iter().filter(|(_, params)| params["weight"] != "information").collect();
    let classes = params(read);
    let class = |name: &str| classes[name].as_u64().unwrap_or(0);
    let counted = [
        ("physics", "change the physics"),
        ("pose", "displace it in the world, with the same M and τ"),
        ("unfelt", "show in neither M nor τ of this robot"),
        ("rounding", "are rounding"),
        ("not_read", "are not read or carried otherwise"),
    ];
    let counted: Vec<String> =
        counted.into_iter().filter(|(name, _)| class(name) > 0).map(|(name, words)| format!("{} {words}", class(name))).collect();
    let mut text = match count as u64 {
        0 => "    the file as read    alike".to_owned(),
        1 => format!("    the file as read    differs in one place: {}", counted.join(", ")),
        many => format!("    the file as read    differs in {many} places: {}", counted.join(", ")),
    };
    if let (Some(id), Some(mass)) = (value("as_read", "id"), value("as_read", "mass_matrix")) {
        text += &format!(" (id off by {id:.1e}, M by {mass:.1e})");
    }
    text += "\n";
    // The gravest first: what changes the mass matrix or the torques most.
    let (mut ranked, carried): (Vec<_>, Vec<_>) = felt.into_iter().partition(|(_, params)| params["weight"] == "dynamics");
    let effect = |params: &Value| params["mass_matrix"].as_f64().unwrap_or(f64::MAX).max(params["id"].as_f64().unwrap_or(f64::MAX));
    ranked.sort_by(|(_, a), (_, b)| effect(b).total_cmp(&effect(a)));
    for (row, params) in ranked.iter().take(LISTED) {
        text += &line(row, params);
    }
    if ranked.len() > LISTED {
        text += &format!("      … and {} more, in the report\n", ranked.len() - LISTED);
    }
    text += &together(carried.iter().copied());
    let told: Vec<&(&Row, Value)> = differences.iter().filter(|(_, params)| params["weight"] == "information").collect();
    for (_, params) in told.iter().filter(|(row, _)| row.quantity == "dof_order") {
        text += &format!("      other order of joints: {} where the file has {}\n", some(&params["theirs"]), some(&params["ours"]));
    }
    text += &tied(&classes);
    for note in classes["notes"].as_array().into_iter().flatten().filter(|note| note["cause"] == "bad_value") {
        text += &format!("      a bad value of the file: {}\n", note["text"].as_str().unwrap_or_default());
    }
    text += &together(told.iter().copied().filter(|(row, _)| row.quantity == "limits"));
    if rows.iter().all(|row| !["id", "mass_matrix"].contains(&row.quantity.as_str())) {
        return text + &format!("    replayed            not asked: the limit is {LARGEST} dofs\n");
    }
    text + &explained(rows)
}

/// What the engine makes of joints that mimic others and that it ties as written, one line for each way.
fn tied(params: &Value) -> String {
    let mut ways: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for note in params["notes"].as_array().into_iter().flatten().filter(|note| note["cause"] == "mimic") {
        ways.entry(note["text"].as_str().unwrap_or_default()).or_default().push(note["about"].as_str().unwrap_or_default());
    }
    ways.iter().map(|(way, joints)| format!("      mimic {}: {way}\n", joints.join(", "))).collect()
}

fn line(row: &Row, params: &Value) -> String {
    let body = if row.body.is_empty() { "the robot" } else { &row.body };
    let number = |key: &str| params[key].as_f64().map_or("–".to_owned(), |error| format!("{error:.1e}"));
    let effect = format!("id {}, M {}", number("id"), number("mass_matrix"));
    let cause = params["cause"].as_str().unwrap_or_default().replace('_', " ");
    let cause = if cause == "number" { String::new() } else { format!(" [{cause}]") };
    let mut text = format!(
        "      {body}: {}{cause}: {} instead of {} ({effect})\n",
        row.quantity.replace('_', " "),
        some(&params["theirs"]),
        some(&params["ours"])
    );
    if let Some(account) = params["account"].as_str() {
        text += &format!("        {account}\n");
    } else if params["cause"] == "number" {
        text += "        no cause is known that gives this number\n";
    }
    if let Some(note) = params["note"].as_str() {
        text += &format!("        its parser: {note}\n");
    }
    text
}

/// What enters an engine's own simulation alone, one line for each field and cause, with the joints by name.
fn together<'a>(carried: impl Iterator<Item = &'a (&'a Row, Value)>) -> String {
    let mut groups: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for (row, params) in carried {
        let joint = params["joint"].as_str().unwrap_or(&row.body);
        let change = format!("{joint} ({} instead of {})", some(&params["theirs"]), some(&params["ours"]));
        groups.entry((&row.quantity, params["cause"].as_str().unwrap_or_default())).or_default().push(change);
    }
    let line = |((field, cause), bodies): (&(&str, &str), &Vec<String>)| {
        let cause = if *cause == "unsupported" { "not read" } else { "read otherwise" };
        let beyond = if bodies.len() > 3 { format!(", … ({} in all)", bodies.len()) } else { String::new() };
        let field = if *field == "limits" { "limits of position" } else { field };
        format!("      {field} {cause}: {}{beyond}; no part of id and M\n", bodies.iter().take(3).cloned().collect::<Vec<_>>().join(", "))
    };
    groups.iter().map(line).collect()
}

/// A text of the parameters, cut where a line ends.
fn some(value: &Value) -> String {
    const LONGEST: usize = 100;
    let text = value.as_str().unwrap_or_default();
    if text.chars().count() <= LONGEST { text.to_owned() } else { text.chars().take(LONGEST).chain(" …".chars()).collect() }
}

fn explained(rows: &[&Row]) -> String {
    let Some(row) = rows.iter().find(|row| row.metric == "unexplained") else { return String::new() };
    let params = params(row);
    match row.value {
        None => format!("    replayed            {}\n", row.reason),
        Some(0.0) => "    replayed            our kernels on what it read give its answers: nothing is left unexplained\n".into(),
        Some(_) => {
            let mut text = "    replayed            unexplained: it computes something else than what it says to have read\n".to_owned();
            for tree in params["unexplained"].as_array().into_iter().flatten() {
                let bodies: Vec<&str> = tree["bodies"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
                let quantity = tree["quantity"].as_str().unwrap_or_default();
                text += &format!("      {quantity} off by {} in the sub-tree {}\n", tree["error"], bodies.join(", "));
            }
            text
        }
    }
}
