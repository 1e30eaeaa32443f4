//! The frame of the page: it takes sections from others, and tells by itself whether a run passed.

use std::fs;
use std::path::Path;

use featherbench_report::{Finding, Findings, Section, Status, forms};
use featherbench_results::{Convention, Culprit, EngineInfo, EngineSource, Expectation, GateKind, Relation, Row, RunInfo, Verdict};
use maud::html;

use crate::written::Written;

/// A section with an anchor and a text.
fn section(anchor: &'static str) -> Section {
    Section::new(anchor, anchor, html! { section #(anchor) { h2 { "What is " (anchor) "?" } } })
}

/// A row of a study whose error is twice its bound.
fn failing(study: &str) -> Row {
    Row { study: study.into(), engine: "drake".into(), robot: "arm".into(), quantity: "id".into(), ..Row::default() }.gated(
        2.0,
        Relation::Le,
        1.0,
    )
}

#[test]
fn sections_stand_in_the_order_in_which_they_are_given() {
    let late = Section { appendix: true, ..section("late") };
    let written = Written::of(&RunInfo::default(), &[], &[section("zebra"), late, section("aardvark")]);
    let order = ["verdict", "zebra", "aardvark", "conventions", "late", "provenance", "method", "unpassed"];
    for form in ["<section id=\"NAME\"", "href=\"#NAME\">"] {
        let places: Vec<usize> = order.iter().map(|name| written.index.rfind(&form.replace("NAME", name)).unwrap()).collect();
        assert!(places.is_sorted(), "{form}: {places:?}");
    }
    assert_eq!(written.index.matches("<section").count(), order.len());
}

#[test]
fn a_section_brings_its_data_script_and_style() {
    let one =
        Section { script: "// script one\n", style: ".one { color: red; }\n", ..section("one").with_data(&[Some("</script>"), None]) };
    let written = Written::of(&RunInfo::default(), &[], &[one, section("two")]);
    assert_eq!(written.data("figures"), serde_json::json!({"one": ["</script>", null]}));
    assert!(!written.text("data/figures.js").contains("</script>"));
    assert!(
        written.text("app.js").ends_with("featherbench.section(\"one\", () => {\n// script one\n});\n")
            && written.text("app.js").contains("featherbench.open = ")
    );
    assert!(written.text("style.css").ends_with(".one { color: red; }\n") && written.text("style.css").contains(".tiles"));
}

#[test]
fn data_that_are_no_json_are_an_error_with_the_name_of_the_section() {
    let damaged = section("mine").with_data(&std::collections::BTreeMap::from([((1, 2), 3)]));
    let error = featherbench_report::write(&RunInfo::default(), &[], &[damaged], tempfile::tempdir().unwrap().path()).unwrap_err();
    assert!(error.to_string().contains("mine: "), "{error}");
}

#[test]
fn the_method_explains_the_terms_and_measures_of_sections() {
    let one = Section { terms: &[("Widget", "a thing")], quantities: vec!["com".into()], ..section("one") };
    let page = |sections: &[Section]| Written::of(&RunInfo::default(), &[], sections).section("method");
    let (with, without) = (page(&[one]), page(&[]));
    for words in ["<dt>Widget</dt><dd>a thing</dd>", "<dt>centre of mass</dt>"] {
        assert!(with.contains(words) && !without.contains(words), "{words}: {with}");
    }
}

/// A row with a unit-free error where 1e-14 is allowed.
fn erring(engine: &str, quantity: &str, value: f64) -> Row {
    let (engine, quantity) = (engine.to_owned(), quantity.to_owned());
    Row { engine, quantity, metric: "scaled".into(), unit: "1".into(), ..failing("one") }.gated(value, Relation::Le, 1e-14)
}

#[test]
fn the_page_opens_with_the_verdict_and_the_gravest_finding() {
    let finding = |rank, words: &'static str| Some(Finding { rank, body: html! { p { (words) } } });
    let rows = [
        erring("drake", "id", 3e-14),
        erring("mujoco", "id", 1e-16),
        erring("dart", "kinetic_energy", 0.78).deviating("it forgets the armature"),
        erring("dart", "kinetic_energy", 0.5).deviating("it forgets the armature"),
        erring("drake", "com", 1e-10),
        Row { quantity: "fd".into(), ..erring("mujoco", "fd", 0.0) }.without_value(Verdict::Skip, "it has no such joint"),
    ];
    let sections =
        [Section { finding: finding(2, "the last"), ..section("a") }, Section { finding: finding(1, "the first"), ..section("b") }];
    let written = Written::of(&RunInfo::default(), &rows, &sections);
    let verdict = written.section("verdict");
    let places: Vec<usize> = [
        "<h1>drake, centre of mass: 4.0 digits lost beyond rounding",
        "in 1 row on 1 robot; and 1 more new finding</h1>",
        "method loses digits, new</span> <b><a href=\"engines/drake.html\">drake</a>, centre of mass</b>",
        "rounding, new</span> <b><a href=\"engines/drake.html\">drake</a>, inverse dynamics</b>: 3 times its gate",
        "<b><a href=\"engines/dart.html\">dart</a>, kinetic energy</b>: off by 78 %",
        "Known: it forgets the armature",
        "not offered</span> <b><a href=\"engines/mujoco.html\">mujoco</a>, forward dynamics</b>",
        "Among 6 rows: ",
        "the first",
        "the last",
    ]
    .iter()
    .map(|words| verdict.find(words).unwrap_or_else(|| panic!("{words}: {verdict}")))
    .collect();
    assert!(places.is_sorted(), "{places:?}");
    assert!(verdict.contains(">2 rows on 1 robot</button>") && verdict.contains("--filter"), "{verdict}");
    // Each level has its number of findings.
    let tiles =
        |class: &str, number: usize| verdict.contains(&format!("class=\"tile {class}")) && verdict.contains(&format!("<b>{number}</b>"));
    assert!(["physics", "digits", "absent", "rounding"].iter().all(|class| tiles(class, 1)), "{verdict}");
}

#[test]
fn a_condition_that_is_not_met_is_a_finding_too() {
    let missing = Expectation::new(GateKind::Engine, "engine drake answers".into(), 1, 0).because("not installed".into());
    let stale = Expectation::new(GateKind::Seen, "known deviation of dart still seen".into(), 1, 0);
    let expected = vec![stale.about(Culprit::engine("dart")), missing.about(Culprit::engine("drake"))];
    let run = RunInfo { expected, ..RunInfo::default() };
    let rows = [erring("drake", "id", 1e-16)];
    let findings = Findings::of(&run, &rows);
    assert_eq!(findings.status, Status::Failed);
    assert_eq!(findings.headline(), "drake: engine drake answers");
    assert!(findings.found[0].sentence().ends_with("; not installed"), "{}", findings.found[0].sentence());
    assert_eq!(findings.found[1].sentence(), "dart: known deviation of dart still seen; expected 1, found 0");
    let met = RunInfo { expected: vec![Expectation::new(GateKind::Rows, "rows at all".into(), 1, 1)], ..RunInfo::default() };
    let findings = Findings::of(&met, &rows);
    assert_eq!((findings.status, findings.headline().as_str()), (Status::Passed, "No engine misses a gate"));
}

#[test]
fn forms_for_programs_hold_every_new_finding_and_escape_names() {
    let mut row = erring("drake", "id", 0.5);
    row.robot = "arm <1> | \"a\"".into();
    let run = RunInfo { suite: "yard".into(), ..RunInfo::default() };
    let rows = [row, erring("dart", "com", 0.5).deviating("known")];
    let findings = Findings::of(&run, &rows);
    let junit = forms::junit(&run, &findings);
    assert!(junit.contains("tests=\"1\" failures=\"1\"") && junit.contains("arm &lt;1&gt; | &quot;a&quot;"), "{junit}");
    assert!(!junit.contains("dart"), "what is known is no failure: {junit}");
    let markdown = forms::markdown(&run, &findings);
    assert!(markdown.contains("arm <1> \\| \"a\"") && markdown.contains("#### Known") && markdown.contains("off by 50 %"), "{markdown}");
    let annotations = forms::annotations(&findings);
    assert_eq!(annotations.lines().count(), 1);
    assert!(
        annotations.starts_with("::error title=physics differs%3A drake%2C inverse dynamics::") && annotations.contains("50 %25"),
        "{annotations}"
    );
    let json = forms::json(&run, &findings);
    assert_eq!(json["findings"].as_array().unwrap().len(), 2);
    assert_eq!((&json["status"], &json["findings"][0]["culprit"]["engine"]), (&"failed".into(), &"drake".into()));
}

#[test]
fn a_robot_has_the_family_of_most_of_its_rows() {
    let row = |robot: &str, family: &str| Row { robot: robot.into(), family: family.into(), nv: Some(3), ..Row::default() };
    let rows = [row("a", "few"), row("b", "one"), row("a", "many"), row("b", "other"), row("a", "many")];
    let run = RunInfo::default();
    let overview = featherbench_report::Overview::of(&run, &rows);
    let found: Vec<_> = overview.robots.iter().map(|robot| (robot.name, robot.family, robot.nv)).collect();
    assert_eq!(found, [("a", "many", Some(3)), ("b", "one", Some(3))]);
    assert_eq!((overview.robot("b"), overview.robot("c")), (Some(1), None));
}

#[test]
fn a_row_lies_in_the_chunk_of_its_robot_or_of_its_study() {
    let rows = [failing("one"), Row { robot: String::new(), ..failing("two") }];
    let written = Written::of(&RunInfo::default(), &rows, &[]);
    let mut names = written.chunk_names();
    names.sort();
    assert_eq!(names, ["figure-data", "figures", "overview", "robot-0", "study-1", "times", "unpassed"]);
    let count = |name: &str| written.data(name)["rows"].as_array().unwrap().len();
    assert_eq!(["robot-0", "study-1", "unpassed"].map(count), [1, 1, 2]);
}

#[test]
fn an_empty_run_says_so() {
    let written = Written::of(&RunInfo::default(), &[], &[]);
    assert!(written.section("verdict").contains("Nothing judged"));
    assert!(written.section("unpassed").contains("Every judged row passed"));
    assert_eq!(written.data("figures"), serde_json::json!({}));
}

#[test]
fn pages_of_an_older_report_are_removed_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let of = |robot: &str| Row { robot: robot.into(), ..failing("one") };
    let large = || Section::new("large", "Large", html! { section #large { @for _ in 0..99 { p { "row" } } } });
    featherbench_report::write(&RunInfo::default(), &[of("arm"), of("leg")], &[large()], &out).unwrap();
    let stale = ["robots/leg.html", "data/robot-1.js", "sections/large.html", "sections/large.js"];
    let there = |name: &&str| out.join(name).is_file();
    assert!(stale.iter().all(there) && there(&"robots/arm.html"));
    // Files of others, one of them in a folder of the report; and a list that names what is not the report's.
    let foreign = ["rows.csv", "robots/notes.html", "figures/mine.svg", "../victim.txt"];
    for name in foreign {
        fs::create_dir_all(out.join(name).parent().unwrap()).unwrap();
        fs::write(out.join(name), "mine").unwrap();
    }
    let list = out.join("report-files.txt");
    let listed = fs::read_to_string(&list).unwrap();
    assert!(stale.iter().all(|name| listed.lines().any(|line| line == *name)), "{listed}");
    fs::write(&list, format!("{listed}rows.csv\n../victim.txt\nrobots/../../victim.txt\nrobots/gone.html\n")).unwrap();
    let paths = featherbench_report::write(&RunInfo::default(), &[of("arm")], &[], &out).unwrap();
    assert!(!stale.iter().any(there), "{:?}", stale.iter().filter(|name| there(name)).collect::<Vec<_>>());
    assert!(foreign.iter().all(there) && paths.files.iter().all(|path| path.is_file()));
    assert!(!fs::read_to_string(&list).unwrap().contains("leg"));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("blocked");
    fs::write(&blocked, "").unwrap();
    let error = featherbench_report::write(&RunInfo::default(), &[], &[], &blocked).unwrap_err().to_string();
    assert!(error.contains(Path::new("blocked").to_str().unwrap()), "{error}");
}

#[test]
fn conventions_are_listed_by_engine_with_their_tests() {
    let convention = |engine: &str, topic: &str| Convention {
        engine: engine.into(),
        topic: topic.into(),
        theirs: format!("{topic} as {engine} has it"),
        ours: "as we have it".into(),
        conversion: "`file.py: function`, twice".into(),
        test: format!("test_{engine}"),
    };
    let conventions = [("mujoco", "free v"), ("drake", "screw <pitch>")].map(|(engine, topic)| convention(engine, topic)).into();
    let engine = |name: &str, source| EngineInfo {
        name: name.into(),
        version: String::new(),
        released: String::new(),
        source,
        build: [].into(),
        status: "ok".into(),
        reason: String::new(),
    };
    let engines =
        vec![engine("featherbench", EngineSource::Own), engine("drake", EngineSource::Live), engine("rapier", EngineSource::Live)];
    let run = RunInfo { conventions, engines, ..RunInfo::default() };
    let written = Written::of(&run, &[], &[]);
    let section = written.section("conventions");
    for row in &run.conventions {
        for text in [&row.engine, &row.ours, &row.test] {
            assert!(section.contains(text.as_str()), "{text} is not in the section");
        }
    }
    assert!(section.contains("<code>file.py: function</code>, twice"), "backticks mark code");
    assert!(section.contains("screw &lt;pitch&gt;") && !section.contains("screw <pitch>"), "text cannot become markup");
    assert_eq!(section.matches("<h3>").count(), 2, "one table for each engine");
    assert!(section.contains("<b>rapier</b>: no row here."), "an engine without rows is named, our own is not");
    let nothing = Written::of(&RunInfo::default(), &[], &[]);
    assert!(nothing.section("conventions").contains("names no conventions"));
}
