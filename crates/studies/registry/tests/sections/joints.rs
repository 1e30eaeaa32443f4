//! The joint matrix: the cells from a run's rows of `joints-*` robots, and that it appears only with such rows.

use featherbench_results::{Relation, Row, RunInfo, Verdict};
use serde_json::Value;

use super::report;

fn row(engine: &str, model: &str, joint: &str, quantity: &str, method: &str) -> Row {
    Row {
        study: "agreement".into(),
        family: "joints".into(),
        engine: engine.into(),
        robot: model.into(),
        quantity: quantity.into(),
        method: method.into(),
        metric: "scaled".into(),
        states: "random".into(),
        reference: "featherbench".into(),
        params: format!(r#"{{"base":"free","joints":["free","{joint}","revolute"]}}"#),
        ..Row::default()
    }
}

fn rows() -> Vec<Row> {
    let judged = |row: Row, value: f64| row.gated(value, Relation::Le, 1e-14);
    vec![
        judged(row("pinocchio", "joints-planar-free", "planar", "id", "rnea"), 1e-16),
        judged(row("pinocchio", "joints-planar-free-single", "planar", "id", "rnea"), 1e-15),
        judged(row("pinocchio", "joints-planar-fixed", "planar", "id", "other"), 2e-15),
        row("pinocchio", "joints-planar-free-armature", "planar", "id", "rnea").without_value(Verdict::Skip, "known (body axes)"),
        judged(row("pinocchio", "joints-helical-free", "helical", "id", "rnea"), 3e-12).deviating("a cause"),
        row("mujoco", "joints-helical-free", "helical", "id", "inverse").without_value(Verdict::Skip, "MuJoCo has no helical joint"),
        row("mujoco", "joints-helical-free-armature", "helical", "id", "inverse")
            .without_value(Verdict::Skip, "MuJoCo has no helical joint"),
        row("mujoco", "joints-free-free", "free", "id", "inverse").without_value(Verdict::Skip, "must hang on the world"),
        judged(row("mujoco", "joints-free-fixed-single", "free", "id", "inverse"), 1e-15),
        judged(row("mujoco", "joints-planar-free", "planar", "id", "inverse"), 1e-11),
        row("mujoco", "joints-revolute-free", "revolute", "id", "inverse").without_value(Verdict::Error, "signal 11"),
        // None of these rows is another engine's answer about one joint.
        judged(row("featherbench", "joints-planar-free", "planar", "id", "rnea_packed"), 1e-16),
        judged(row("mujoco", "joints-common-free", "planar", "id", "inverse"), 1e-16),
        judged(row("mujoco", "humanoid", "revolute", "id", "inverse"), 1e-16),
        judged(Row { metric: "pairwise".into(), ..row("mujoco", "joints-planar-free", "planar", "id", "inverse") }, 1e-9),
        row("mujoco", "joints-planar-free", "planar", "id", "inverse").informed(1e-9),
    ]
}

/// The cell of a joint type: its state, deciding model and method, and how many robots answered and lack an answer.
fn cell(matrix: &Value, engine: usize, kind: &str, armature: bool) -> Option<(String, String, String, u64, usize)> {
    let shown = |row: &Value| row["kind"] == kind && row["armature"] == armature;
    let row = matrix["rows"].as_array()?.iter().position(shown)?;
    let cell = matrix["cells"].as_array()?.iter().find(|cell| cell["at"][0] == row && cell["at"][1] == engine)?;
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let lacking = cell["lacking"].as_array()?.len();
    Some((text(&cell["state"]), text(&cell["worst"][0]), text(&cell["worst"][3]), cell["robots"].as_u64()?, lacking))
}

/// The sentence about an engine.
fn sentence<'a>(section: &'a str, engine: &str) -> &'a str {
    let start = section.find(&format!("<b><a href=\"engines/{engine}.html\">{engine}</a></b>")).unwrap();
    &section[start..start + section[start..].find("</li>").unwrap()]
}

#[test]
fn cells_tell_agreement_deviation_and_what_is_not_offered() {
    let written = report(&RunInfo::default(), &rows());
    let matrix = &written.data("figures")["joints"];
    let kinds: Vec<(&str, bool)> = (matrix["rows"].as_array().unwrap().iter())
        .map(|row| (row["kind"].as_str().unwrap(), row["armature"].as_bool().unwrap()))
        .collect();
    assert_eq!(kinds, [("revolute", false), ("helical", false), ("helical", true), ("free", false), ("planar", false), ("planar", true)]);

    // Engines in alphabetical order: featherbench, mujoco, pinocchio.
    let (featherbench, mujoco, pinocchio) = (0, 1, 2);
    let expected = |state: &str, model: &str, method: &str, robots, lacking| {
        Some((state.to_owned(), model.to_owned(), method.to_owned(), robots, lacking))
    };
    assert_eq!(cell(matrix, pinocchio, "planar", false), expected("agrees", "joints-planar-fixed", "other", 3, 0));
    assert_eq!(cell(matrix, pinocchio, "planar", true), expected("unsupported", "joints-planar-free-armature", "rnea", 0, 1));
    assert_eq!(cell(matrix, pinocchio, "helical", false), expected("deviates", "joints-helical-free", "rnea", 1, 0));
    assert_eq!(cell(matrix, mujoco, "helical", false), expected("unsupported", "joints-helical-free", "inverse", 0, 1));
    assert_eq!(cell(matrix, mujoco, "free", false), expected("agrees", "joints-free-fixed-single", "inverse", 1, 1));
    assert_eq!(cell(matrix, mujoco, "planar", false), expected("fails", "joints-planar-free", "inverse", 1, 0));
    assert_eq!(cell(matrix, mujoco, "revolute", false), expected("error", "joints-revolute-free", "inverse", 1, 0));
    assert_eq!(cell(matrix, featherbench, "planar", false), None);
    assert_eq!(matrix["cells"].as_array().unwrap().len(), 8);

    // A click opens the rows of the robot that decided: each has a chunk.
    let (overview, chunks) = (written.data("overview"), written.chunk_names());
    for cell in matrix["cells"].as_array().unwrap() {
        let model = overview["robots"].as_array().unwrap().iter().position(|model| model["name"] == cell["worst"][0]);
        assert!(model.is_some_and(|model| chunks.contains(&format!("robot-{model}"))), "{cell}");
    }

    let section = written.section("joints");
    assert_eq!(section.matches("<button").count(), 8);
    let sentence = |engine| sentence(&section, engine);
    assert!(sentence("pinocchio").contains("at least +0.6 decades"), "{}", sentence("pinocchio"));
    assert!(sentence("pinocchio").contains("; deviates by known cause in inverse dynamics (3e-12); does not offer planar with armature."));
    assert!(sentence("mujoco").contains("; does not offer helical; offers in part free."), "{}", sentence("mujoco"));
    assert!(sentence("mujoco").contains("; is outside its gate in inverse dynamics (1e-11); gives no answer in inverse dynamics;"));
}

#[test]
fn a_row_with_an_answer_and_a_refusal_is_offered_in_part() {
    let turning = |quantity: &str| row("rapier", "joints-revolute-free-armature", "revolute", quantity, "forces");
    let ball = |quantity: &str| row("rapier", "joints-spherical-free-armature", "spherical", quantity, "forces");
    let refused = |row: Row| row.without_value(Verdict::Skip, "known (no armature)");
    let rows = [
        turning("id").gated(1e-16, Relation::Le, 1e-14),
        refused(turning("kinetic_energy")),
        refused(ball("id")),
        refused(ball("kinetic_energy")),
    ];
    let section = report(&RunInfo::default(), &rows).section("joints").to_owned();
    let said = sentence(&section, "rapier");
    assert!(said.contains("; does not offer spherical with armature; offers in part revolute with armature."), "{said}");
    assert_eq!(section.matches("button class=\"skip\"").count(), 3, "each refused quantity is still shown as such");
}

#[test]
fn it_appears_with_its_rows_alone() {
    let with = report(&RunInfo::default(), &rows());
    assert!(with.index.contains("href=\"#joints\""));
    let without: Vec<Row> = rows().into_iter().filter(|row| !row.robot.starts_with("joints-") || row.robot.contains("common")).collect();
    let written = report(&RunInfo::default(), &without);
    assert!(!written.index.contains("<section id=\"joints\"") && !written.index.contains("href=\"#joints\""));
}

#[test]
fn a_row_with_damaged_parameters_is_left_out() {
    for params in ["", "{", "[]", r#"{"joints":"planar"}"#] {
        let damaged: Vec<Row> = rows().into_iter().map(|row| Row { params: params.into(), ..row }).collect();
        assert!(!report(&RunInfo::default(), &damaged).index.contains("<section id=\"joints\""), "{params}");
    }
}
