//! What turned a gate red, in the forms that programs read: JUnit XML, Markdown, annotations of GitHub, JSON.
//!
//! Each form lists the new findings from the gravest, with the culprit first. What is known is counted only.

use featherbench_results::{Culprit, RunInfo};
use maud::{PreEscaped, html};
use serde_json::{Value, json};

use crate::findings::{Findings, Found, Status};

/// Known findings that the Markdown lists.
const KNOWN: usize = 10;

/// The name of a finding among others: `crane/id/rnea/gantry`, empty parts left out.
fn name(found: &Found) -> String {
    let Culprit { study, robot, engine, quantity, method } = &found.culprit;
    let parts: Vec<&str> =
        [engine, method, quantity, robot, study].into_iter().map(String::as_str).filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { found.gate.as_str().to_owned() } else { parts.join("/") }
}

/// A test case that fails.
pub struct Case {
    /// Its class.
    pub class: String,
    /// Its name.
    pub name: String,
    /// The kind of failure.
    pub kind: String,
    /// The failure in a few words.
    pub message: String,
    /// All of it.
    pub text: String,
}

/// One test case for each new finding, which fails, and one for each condition that is met.
pub fn junit(run: &RunInfo, findings: &Findings) -> String {
    let case = |found: &Found| Case {
        class: found.gate.as_str().into(),
        name: name(found),
        kind: found.level().into(),
        message: found.short(),
        text: format!("{}\n{}", found.sentence(), found.again),
    };
    junit_of(run, &findings.red().map(case).collect::<Vec<_>>())
}

/// The given test cases, which fail, and one for each condition that is met. Characters that XML cannot hold are left out.
pub fn junit_of(run: &RunInfo, failing: &[Case]) -> String {
    let met: Vec<_> = run.expected.iter().filter(|condition| condition.is_met()).collect();
    let body = html! {
        testsuites name="featherbench" {
            testsuite name=(run.suite) tests=(failing.len() + met.len()) failures=(failing.len()) timestamp=(run.started) {
                @for case in failing {
                    testcase classname=(case.class) name=(case.name) {
                        failure type=(case.kind) message=(case.message) { (case.text) }
                    }
                }
                @for condition in &met {
                    testcase classname=(condition.kind) name=(condition.what) {}
                }
            }
        }
    };
    let page = html! { (PreEscaped("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n")) (body) "\n" };
    page.into_string().chars().filter(|&c| c >= ' ' || matches!(c, '\n' | '\t')).collect()
}

/// A text in an annotation of GitHub.
pub fn escaped(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// A summary for a workflow's page.
pub fn markdown(run: &RunInfo, findings: &Findings) -> String {
    let (verdict, levels, extent) = (findings.verdict(), findings.levels(), findings.extent());
    let mut text = format!("### Suite {} {}\n\n{levels}.\n{extent}.\n", cell(&run.suite), cell(&verdict));
    let mut table = |title: &str, list: &[&Found]| {
        if list.is_empty() {
            return;
        }
        text +=
            &format!("\n#### {title}\n\n| level | engine | method | quantity | robot | finding | again |\n|---|---|---|---|---|---|---|\n");
        for found in list {
            let Culprit { robot, engine, method, .. } = &found.culprit;
            let again = if found.again.is_empty() { String::new() } else { format!("`{}`", cell(&found.again)) };
            let quantity = found.quantities.first().map_or("", String::as_str);
            let extent = if found.rows > 0 { format!("; {}", found.extent()) } else { String::new() };
            let cells = [found.level(), engine, method, quantity, robot].map(cell).join(" | ");
            text += &format!("| {cells} | {}{extent} | {again} |\n", cell(&found.size_words()));
        }
    };
    let (new, known): (Vec<&Found>, Vec<&Found>) = findings.found.iter().partition(|found| found.new);
    table("What turned the gate red", &new);
    table("Known", &known[..known.len().min(KNOWN)]);
    text
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// One `::error` line for each new finding: a workflow of GitHub shows it beside the change.
pub fn annotations(findings: &Findings) -> String {
    let title = |text: &str| escaped(text).replace(':', "%3A").replace(',', "%2C");
    findings
        .red()
        .map(|found| format!("::error title={}::{}\n", title(&format!("{}: {}", found.level(), found.who())), escaped(&found.sentence())))
        .collect()
}

/// Everything as JSON: the status, the counts and every finding.
pub fn json(run: &RunInfo, findings: &Findings) -> Value {
    let of = |found: &Found| {
        let row = found.worst;
        json!({
            "level": found.level(),
            "new": found.new,
            "gate": found.gate,
            "culprit": found.culprit,
            "quantities": found.quantities,
            "rows": found.rows,
            "robots": found.robots,
            "value": row.and_then(|row| row.value),
            "bound": row.and_then(|row| row.bound),
            "decades_beyond": row.and_then(|row| row.margin).map(|margin| -margin),
            "sentence": found.sentence(),
            "cause": found.cause,
            "again": found.again,
        })
    };
    json!({
        "run": run.run,
        "suite": run.suite,
        "status": match findings.status { Status::Passed => "passed", Status::Failed => "failed", Status::Empty => "empty" },
        "headline": findings.headline(),
        "rows": findings.tally.total(),
        "conditions": { "met": run.expected.iter().filter(|condition| condition.is_met()).count(), "all": run.expected.len() },
        "findings": findings.found.iter().map(of).collect::<Vec<_>>(),
    })
}
