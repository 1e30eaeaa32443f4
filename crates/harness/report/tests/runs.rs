//! The page over several runs: what appeared and vanished from one run of a suite to the next.

use featherbench_report::changes::between;
use featherbench_report::runs::{Past, render};
use featherbench_results::{EngineInfo, EngineSource, Relation, Row, RunInfo};

/// A run of a suite that started on a day, with an engine's version and one finding.
fn past(day: u8, suite: &str, version: &str, row: Row) -> Past {
    let engine = EngineInfo {
        name: "drake".into(),
        version: version.into(),
        released: String::new(),
        source: EngineSource::Live,
        build: [].into(),
        status: "ok".into(),
        reason: String::new(),
    };
    let info = RunInfo { suite: suite.into(), started: format!("2026-03-0{day}"), engines: vec![engine], ..RunInfo::default() };
    Past { folder: format!("run-{day}"), info, rows: vec![row] }
}

fn off(engine: &str, quantity: &str, value: f64) -> Row {
    let (engine, quantity) = (engine.to_owned(), quantity.to_owned());
    Row { engine, quantity, study: "s".into(), robot: "arm".into(), metric: "scaled".into(), unit: "1".into(), ..Row::default() }.gated(
        value,
        Relation::Le,
        1e-14,
    )
}

#[test]
fn runs_of_a_suite_are_compared_in_the_order_of_their_start() {
    let known = || off("drake", "id", 0.5).deviating("a sign");
    let runs = vec![
        past(3, "yard", "1.1", off("dart", "com", 1e-10)),
        past(1, "yard", "1.0", known()),
        past(2, "dock", "1.0", off("dart", "fd", 0.1)),
    ];
    let page = render(runs);
    let part = |from: &str| {
        let start = page.find(from).unwrap_or_else(|| panic!("{from}: {page}"));
        &page[start..start + page[start..].find("</section>").unwrap()]
    };
    let last = part("<h2>2026-03-03, suite yard");
    for words in [
        "Against the run of 2026-03-01: 1 finding appeared, 1 vanished, 1 gone, 1 new, of 0 rows compared",
        "drake: version 1.0 became 1.1.",
        "dart, centre of mass",
        "drake, inverse dynamics: off by 50 %",
    ] {
        assert!(last.contains(words), "{words}: {last}");
    }
    assert!(last.find("Findings that appeared").unwrap() < last.find("Findings that vanished").unwrap());
    assert!(part("<h2>2026-03-02, suite dock").contains("nothing to compare with"), "another suite is not compared");
    assert!(page.contains("<h1>3 runs, the last: dart, centre of mass: 4.0 digits lost"), "{page}");
    // The same finding of another size is the same finding.
    let page = render(vec![past(1, "yard", "1", known()), past(2, "yard", "1", off("drake", "id", 0.1).deviating("a sign"))]);
    assert!(page.contains("0 findings appeared, 0 vanished, 1 error, of 1 row compared"), "{page}");
}

/// Eight runs; from the fifth on, drake has another version and its error is `factor` times as large.
fn eight(factor: f64) -> Vec<Past> {
    let of = |day: u8| {
        let late = day > 4;
        past(day, "yard", if late { "1.1" } else { "1.0" }, off("drake", "id", 1e-13 * if late { factor } else { 1.0 }))
    };
    (1..=8).map(of).collect()
}

#[test]
fn a_planted_jump_is_a_change_point_with_its_upgrade() {
    let page = render(eight(30.0));
    for words in [
        "Trends of suite yard over 8 runs",
        "Change points: 1 confirmed, 0 not yet",
        "2026-03-05 (run 5)",
        "drake: version 1.0 became 1.1.",
        "The history of each of 1 robot",
        "geometric mean of the errors",
        "Rows that do not pass",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    // The line of the upgrade is in each of three figures: errors, failing rows, and errors of the one robot.
    assert_eq!(page.matches("class=\"event\"").count(), 3, "{page}");
    assert_eq!(page.matches("text-anchor=\"end\">drake 1.1<").count(), 3, "{page}");
    assert_eq!(page.matches("http").count(), page.matches("http://www.w3.org/2000/svg").count(), "the page fetches nothing");
}

#[test]
fn runs_without_a_jump_have_no_change_point() {
    let page = render(eight(1.5));
    assert!(page.contains("Change points: 0 confirmed, 0 not yet") && page.contains("class=\"event\""), "{page}");
    assert!(!render(vec![past(1, "yard", "1", off("drake", "id", 0.1))]).contains("Trends"), "one run has no trend");
}

#[test]
fn two_runs_have_a_page_and_two_suites_are_one_sentence() {
    let (a, b) = (past(1, "yard", "1.0", off("drake", "id", 0.5)), past(2, "yard", "1.1", off("drake", "id", 0.1)));
    let page = between((&a.info, &a.rows), (&b.info, &b.rows));
    for words in ["<h1>1 row changed beyond noise", "drake: version 1.0 became 1.1.", "2026-03-02", "0.2"] {
        assert!(page.contains(words), "{words}: {page}");
    }
    let rows: Vec<Row> = (0..500).map(|k| off("dart", &format!("q{k}"), 0.1)).collect();
    let other = Past { info: RunInfo { suite: "dock".into(), ..b.info.clone() }, rows, ..b.clone() };
    let page = between((&a.info, &a.rows), (&other.info, &other.rows));
    assert!(page.contains("Two suites; nothing changed beyond noise in the 0 rows that both have"), "{page}");
    assert!(page.contains("1 rows are in the first run only and 500 in the second only"), "{page}");
    assert!(!page.contains(">q77<") && !page.contains("<summary>500"), "rows of one suite alone are not listed");
    let same = between((&a.info, &a.rows), (&a.info, &a.rows));
    assert!(same.contains("<h1>Nothing changed beyond noise, of 1 row"), "{same}");
    // Such a page has no script: it follows the system's choice of light or dark.
    let rule = "@media screen and (prefers-color-scheme: dark) {\n:root:not([data-theme]) {";
    assert!([&same, &render(vec![a.clone()])].iter().all(|page| page.contains(rule) && !page.contains("<script")));
    // A suite whose file changed is told so on the page over runs as well, and not row by row.
    let changed = Past { info: RunInfo { suite_hash: "other".into(), ..b.info.clone() }, rows: other.rows.clone(), ..b };
    let page = render(vec![a, changed]);
    assert!(page.contains("The suite 'yard' changed between the two runs: 1 rows are in the first run only and 500"), "{page}");
    assert!(!page.contains(">q77<"));
}
