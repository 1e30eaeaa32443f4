//! The section on the engines' imports of robots' files: it shows the rows, and runs without such rows do not have it.

use featherbench_results::{Relation, Row, RunInfo, Verdict};

use super::{made_up, report};

/// Rows of two robots. Imports of the first are equal, different and refused; that of the second is unexplained.
fn rows(run: &RunInfo) -> Vec<Row> {
    let row = |model: &str, engine: &str, quantity: &str, metric: &str, params: &str| Row {
        run: run.run.clone(),
        cell: format!("{model}{engine}{quantity}{metric}"),
        study: "import".into(),
        family: "robot".into(),
        robot: model.into(),
        engine: engine.into(),
        quantity: quantity.into(),
        metric: metric.into(),
        params: params.into(),
        reference: "featherbench".into(),
        ..Row::default()
    };
    let edited = r#"{"cause":"balanced","id":0.1,"mass_matrix":0.2,"note":null,"ours":"1 kg","theirs":"2 kg","weight":"dynamics"}"#;
    let tree = r#"{"unexplained":[{"bodies":["arm"],"error":0.5,"quantity":"mass_matrix"}]}"#;
    vec![
        row("one", "pinocchio", "import", "differences", "{}").informed(0.0),
        row("one", "pinocchio", "id", "as_read", "{}").informed(1e-15),
        row("one", "pinocchio", "import", "unexplained", "{}").gated(0.0, Relation::Le, 0.0),
        row("one", "mujoco", "import", "differences", r#"{"remedy":"set the inertia of 'arm' to 1 after loading"}"#).informed(1.0),
        Row { body: "arm".into(), ..row("one", "mujoco", "inertia", "difference", edited).informed(0.5) },
        row("one", "mujoco", "id", "as_read", "{}").informed(0.25),
        row("one", "drake", "import", "differences", "{}").without_value(Verdict::Error, "no <such> joint"),
        // A long chain; the study's bound for rounding depends on its depth.
        row("two", "pinocchio", "import", "differences", "{}").informed(0.0),
        row("two", "pinocchio", "id", "as_read", "{}").informed(7.8e-12),
        row("two", "pinocchio", "import", "unexplained", r#"{"gate":1e-11}"#).gated(0.0, Relation::Le, 0.0),
        row("two", "drake", "import", "differences", "{}").informed(0.0),
        row("two", "drake", "id", "as_read", "{}").informed(0.5),
        row("two", "drake", "import", "unexplained", tree).gated(1.0, Relation::Le, 0.0),
    ]
}

#[test]
fn each_import_has_its_cell_and_each_cause_its_count() {
    let run = made_up::run_info();
    let written = report(&run, &rows(&run));
    let section = written.section("import");
    assert_eq!(section.matches("data-import=").count(), 5, "five imports");
    let cell = |model: &str, engine: &str| {
        let line = section
            .split("<tr>")
            .find(|line| line.contains(&format!("<th scope=\"row\"><a href=\"robots/{model}.html\">{model}</a></th>")))
            .unwrap();
        let cells = line.split("<td").find(|cell| cell.contains(&format!("data-engine=\"{engine}\"")));
        cells.unwrap_or_else(|| panic!("{engine} has no cell of {model}: {line}")).to_owned()
    };
    assert!(cell("one", "pinocchio").contains("number d0") && cell("one", "pinocchio").contains('✓'));
    assert!(cell("two", "pinocchio").contains("number d0"), "{}", cell("two", "pinocchio"));
    assert!(cell("one", "mujoco").contains("number d5") && cell("one", "mujoco").contains(">1<"));
    assert!(cell("one", "drake").contains('–') && cell("one", "drake").contains("no &lt;such&gt; joint"));
    assert!(cell("two", "drake").contains("class=\"unexplained\">?"), "{}", cell("two", "drake"));
    assert!(section.contains("impossible principal moments were made equal"));
    assert!(written.index.contains("href=\"#import\""));
}

#[test]
fn the_first_page_says_what_each_engine_loads_and_what_to_do() {
    let run = made_up::run_info();
    let written = report(&run, &rows(&run));
    let opening = written.index.split("id=\"import-opening\"").nth(1).expect("the answers are on the first page");
    assert!(opening.contains("<b>2 of 5 readings</b>"), "pinocchio takes both robots as they are");
    let lines: Vec<Vec<String>> =
        opening.split("<tbody>").nth(1).unwrap().split("</tbody>").next().unwrap().split("<tr>").skip(1).map(cells).collect();
    let due = [
        ["one", "drake", "no", "–", "–", "correct what its parser names: no &lt;such&gt; joint"],
        ["one", "mujoco", "yes", "no", "arm: inertia by 0.20", "set the inertia of 'arm' to 1 after loading"],
    ];
    assert_eq!(lines.len(), 5);
    assert!(opening.contains("<a href=\"engines/drake.html\">drake</a>") && opening.contains("<a href=\"robots/one.html\">one</a>"));
    for (line, due) in lines.iter().zip(due) {
        assert_eq!(line[..], due, "{lines:?}");
    }
    assert!(lines[2][3] == "no" && lines[2][5].starts_with("do not trust its answers on this file"), "{:?}", lines[2]);
    assert!(lines[3..].iter().all(|line| line[2..] == ["yes", "yes", "–", "nothing"]), "{lines:?}");
}

/// The texts of a line's cells, which may be those of links.
fn cells(line: &str) -> Vec<String> {
    let inner = |cell: &str| cell.split('>').skip(1).map(|text| text.split('<').next().unwrap_or_default()).collect();
    line.split("<t").skip(1).map(inner).collect()
}

#[test]
fn many_readings_are_a_part_of_their_own() {
    let run = made_up::run_info();
    let one = rows(&run);
    let many: Vec<Row> =
        (0..5).flat_map(|k| one.iter().map(move |row| Row { robot: format!("{}{k}", row.robot), ..row.clone() })).collect();
    let written = report(&run, &many);
    let opening = written.index.split("id=\"import-opening\"").nth(1).unwrap();
    assert!(
        opening.contains("10 of 25 readings") && opening.contains("13 more readings") && opening.contains("sections/import-answers.html")
    );
}

#[test]
fn a_run_that_did_not_ask_has_no_section() {
    let run = made_up::run_info();
    let written = report(&run, &made_up::rows(&run));
    assert!(!written.index.contains("<section id=\"import\"") && !written.index.contains("href=\"#import\""));
}
