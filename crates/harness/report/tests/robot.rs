//! The picture of a robot: it stands without a script, and marks the bodies that differ.

use featherbench_report::robot::drawn;
use featherbench_report::{Mark, Section, Shown};
use featherbench_results::{Culprit, Drawing, DrawnBody, Expectation, GateKind, ModelOrigin, Relation, RobotInfo, Row, RunInfo, Verdict};
use std::collections::{BTreeMap, BTreeSet};

use crate::written::Written;

fn body(name: &str, parent: Option<usize>, z: f64) -> DrawnBody {
    let axes = [[0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]];
    DrawnBody { name: name.into(), parent, mass: 1.5, origin: [0.0, 0.0, z], centre: [0.0, 0.1, z], axes }
}

#[test]
fn the_body_that_differs_is_marked_in_picture_and_tree() {
    let robot = Drawing(vec![body("base", None, 0.0), body("arm <1>", Some(0), 1.0), body("hand", Some(1), 2.0)]);
    let marked = BTreeSet::from(["arm <1>".to_owned()]);
    let page = drawn("crane", &robot, &marked, "the physics differs").into_string();
    assert_eq!((page.matches("<ellipse").count(), page.matches("<line").count()), (3, 3), "{page}");
    for words in [
        "crane: the physics differs in arm &lt;1&gt;",
        "<ellipse class=\"marked\" data-body=\"1\"",
        "<li class=\"marked\" style=\"padding-left: 1rem\"",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert_eq!(page.matches("class=\"marked\"").count(), 2, "{page}");
    assert_eq!(page.matches("<text").count(), 1, "only bodies that differ are named in the picture");
    assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
    // The script reads the same numbers.
    let data = page.split("data-robot=\"").nth(1).unwrap().split('"').next().unwrap().replace("&quot;", "\"");
    let data: serde_json::Value = serde_json::from_str(&data).unwrap();
    assert_eq!(data["bodies"][2][0], serde_json::json!([0.0, 0.0, 1.0]), "a line begins at the parent's origin");
    let page = drawn("crane", &robot, &BTreeSet::new(), "the physics differs").into_string();
    assert!(page.contains("crane: 3 bodies") && !page.contains("class=\"marked\""), "{page}");
}

#[test]
fn odd_drawings_are_drawn() {
    // A body without extent at the origin, and a parent that is not before its child.
    let flat = DrawnBody { axes: [[0.0; 3]; 3], origin: [0.0; 3], centre: [0.0; 3], ..body("point", Some(7), 0.0) };
    let page = drawn("dot", &Drawing(vec![flat]), &BTreeSet::new(), "").into_string();
    assert!(page.contains("dot: 1 body") && !page.contains("NaN") && !page.contains("inf"), "{page}");
    assert!(drawn("none", &Drawing(Vec::new()), &BTreeSet::new(), "").into_string().contains("none: 0 bodies"));
}

/// A run of three robots: one that an engine reads otherwise, one without a finding, and one of too many bodies.
fn yard() -> (RunInfo, Vec<Row>, Section) {
    let robot = |name: &str| RobotInfo {
        name: name.into(),
        hash: String::new(),
        origin: ModelOrigin::Robot,
        licence: String::new(),
        source: String::new(),
        nq: 3,
        nv: 3,
        bodies: 3,
        depth: 3,
        notes: Vec::new(),
        properties: None,
    };
    let drawing = Drawing(vec![body("base", None, 0.0), body("arm", Some(0), 1.0), body("hand", Some(1), 2.0)]);
    let drawings = BTreeMap::from([("crane".to_owned(), drawing.clone()), ("quiet".to_owned(), drawing)]);
    let run = RunInfo { robots: ["crane", "quiet", "long"].map(robot).into(), drawings, ..RunInfo::default() };
    let row = |robot: &str, engine: &str| Row { study: "s".into(), robot: robot.into(), engine: engine.into(), ..Row::default() };
    let far = Row { quantity: "id".into(), unit: "1".into(), ..row("crane", "drake") }.gated(0.5, Relation::Le, 1e-14);
    let of_hand = Row { body: "hand".into(), quantity: "readback".into(), ..row("crane", "mujoco") }.gated(0.5, Relation::Le, 1e-14);
    let of_base = Row { body: "base".into(), ..row("crane", "dart") }.gated(0.0, Relation::Le, 1e-14);
    let rows = vec![
        far,
        of_hand,
        of_base,
        row("quiet", "drake").gated(0.0, Relation::Le, 1.0),
        row("long", "drake").gated(2.0, Relation::Le, 1.0),
    ];
    let mark = Mark { robot: "crane".into(), engine: "drake".into(), body: "arm".into() };
    (run, rows, Section { marks: vec![mark], ..Section::new("mine", "Mine", maud::html! { section #mine { h2 { "Mine" } } }) })
}

#[test]
fn a_robots_page_draws_it_and_marks_what_findings_name() {
    let (run, rows, section) = yard();
    let written = Written::of(&run, &rows, &[section]);
    let page = written.text("robots/crane.html");
    // A row that does not pass names the hand, a section the arm; the base is named by a row that passes.
    assert!(page.contains("crane: engines differ in arm and hand"), "{page}");
    assert_eq!(page.matches("<ellipse class=\"marked\"").count(), 2, "{page}");
    assert!(page.contains("<summary>Kinematic tree</summary>"), "{page}");
    let quiet = written.text("robots/quiet.html");
    assert!(quiet.contains("quiet: 3 bodies") && !quiet.contains("class=\"marked\""), "{quiet}");
    let long = written.text("robots/long.html");
    assert!(!long.contains("<figure class=\"robot\"") && long.contains("It is not drawn."), "{long}");
    // A run of an older version has no drawings, and says nothing of them.
    let old = Written::of(&RunInfo { drawings: BTreeMap::new(), ..run }, &rows, &[]);
    assert!(!old.text("robots/long.html").contains("It is not drawn."));
    assert_eq!(rows[4].verdict, Verdict::Fail);
}

#[test]
fn a_card_brings_the_drawing_of_its_robot_with_the_bodies_of_its_engine() {
    let (run, rows, section) = yard();
    let written = Written::of(&run, &rows, &[section]);
    let of = |engine: &str| {
        let page = written.text(&format!("engines/{engine}.html"));
        let place = page.split("<details class=\"look\"><summary>Show crane</summary><div data-part=\"").nth(1).unwrap();
        assert!(place.contains("<a href=\"robots/crane.html\">crane on a page of its own</a>"), "{place}");
        let name = place.split('"').next().unwrap();
        let piece = written.text(&format!("sections/{name}.js"));
        assert!(piece.starts_with(&format!("featherbench.chunk(\"part-{name}\",\"<figure class=")), "{piece}");
        piece
    };
    for (engine, body) in [("drake", "arm"), ("mujoco", "hand")] {
        let piece = of(engine);
        assert!(piece.contains(&format!("crane: {engine} differs in {body}")), "{piece}");
        assert_eq!(piece.matches("<ellipse class=\\\"marked").count(), 1, "{piece}");
    }
    // The first page has the places alone, and the robot's own page needs none.
    assert!(written.index.contains("<details class=\"look\">") && !written.index.contains("<ellipse"), "{}", written.index);
    assert!(!written.text("robots/crane.html").contains("<details class=\"look\">"));
    // What is not drawn cannot be shown, and what no finding names is not brought.
    assert!(!written.index.contains("Show long") && !written.index.contains("Show quiet"));
    let brought = std::fs::read_dir(written.folder.path().join("sections")).unwrap();
    let names = brought.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.starts_with("drawing-")).count(), 3, "crane without a mark, and for two engines");
}

#[test]
fn a_card_leads_to_the_drawing_that_shows_its_rows_or_to_the_section_of_its_study() {
    let (run, rows, section) = yard();
    let page = |shows: Vec<Shown>, study: &'static str| {
        let body = maud::html! { section #mine { h2 { "Mine" } } };
        Written::of(&run, &rows, &[Section { shows, study, ..Section::new("mine", "Mine", body) }]).index
    };
    assert_eq!(section.study, "");
    let shown = |quantity: &str, metric: Option<&str>| Shown {
        quantity: quantity.into(),
        metric: metric.map(str::to_owned),
        choice: ("my-list", "7".into()),
    };
    let figure = "<a class=\"figure\" href=\"#mine\" data-list=\"my-list\" data-value=\"7\">Its figure</a>";
    assert_eq!(page(vec![shown("id", None)], "s").matches(figure).count(), 1, "the finding on inverse dynamics alone");
    let other = page(vec![shown("id", Some("another"))], "s");
    assert!(!other.contains("Its figure") && other.contains("<a class=\"figure\" href=\"#mine\">Its section</a>"), "{other}");
    assert!(!page(vec![shown("id", None)], "other").contains("class=\"figure\" href"), "a section of another study shows none of it");
}

#[test]
fn a_condition_about_a_robot_shows_it_too() {
    let (run, _, section) = yard();
    let culprit = Culprit { robot: "crane".into(), method: "parser".into(), ..Culprit::engine("drake") };
    let expected = vec![Expectation::new(GateKind::Import, "differences that change the physics".into(), 0, 1).about(culprit)];
    let row = Row { engine: "drake".into(), robot: "crane".into(), ..Row::default() }.informed(1.0);
    let written = Written::of(&RunInfo { expected, ..run }, &[row], &[section]);
    assert!(written.index.contains("(<a href=\"robots/crane.html\">crane</a>, parser)"), "{}", written.index);
    assert!(written.index.contains("<summary>Show crane</summary><div data-part=\"drawing-0-0\">"), "{}", written.index);
    assert!(written.text("sections/drawing-0-0.js").contains("crane: drake differs in arm"));
}
