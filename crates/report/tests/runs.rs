//! The page over several runs: what appeared and vanished from one run of a suite to the next.

use featherbench_report::runs::{Past, render};
use featherbench_results::{EngineInfo, EngineSource, Relation, Row, RunInfo};

/// A run of a suite that started on a day, with an engine's version and one finding.
fn past(day: u8, suite: &str, version: &str, row: Row) -> Past {
    let engine = EngineInfo {
        name: "drake".into(),
        version: version.into(),
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
