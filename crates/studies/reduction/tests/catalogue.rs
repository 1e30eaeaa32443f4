//! The catalogue of failures: a line for every known deviation, and cases that stay in their class.

use crate::reduce::{Faulty, balls, robot};
use featherbench_bench::{DeviationFile, Engine, Engines, Gates, Quantity, Range, RangeKey, Ranges, Robot};
use featherbench_engines::Featherbench;
use featherbench_reduction::{Catalogue, Failure, Fault, Kind, Line, Status, Subject, entries, reduce, section};
use featherbench_results::{Row, Verdict};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..")
}

fn gates_of_project() -> Gates {
    let engines = Engines::read(&project().join("oracles/engines.toml")).unwrap();
    Gates::read(&project().join("ci"), &engines).unwrap()
}

#[test]
fn every_known_deviation_and_every_reproduction_has_a_line() {
    let gates = gates_of_project();
    let far = Row {
        cell: "3f2a".into(),
        study: "agreement".into(),
        engine: "pinocchio".into(),
        quantity: "fd".into(),
        method: "aba_world".into(),
        metric: "backward".into(),
        states: "random".into(),
        robot: "chain".into(),
        bodies: Some(20),
        params: r#"{"deviation":"far-base"}"#.into(),
        ..Row::default()
    };
    let far = Row { verdict: Verdict::Deviation, ..far.informed(1e-9) };
    let elsewhere = Row { study: "operations".into(), params: r#"{"deviation":"zyx-aba"}"#.into(), ..far.clone() };
    let failing = Row { engine: "drake".into(), verdict: Verdict::Fail, params: String::new(), ..far.clone() };
    let against = Row {
        engine: "drake".into(),
        metric: "pairwise".into(),
        reference: "mujoco".into(),
        params: r#"{"deviation":"singular-mass"}"#.into(),
        ..far.clone()
    };
    let rows = [far, elsewhere, failing, against];
    let all = entries(&gates, &rows, &[]);

    let names: BTreeSet<&str> = all.iter().map(|entry| entry.line.name.as_str()).collect();
    assert_eq!(names.len(), all.len(), "names are those of folders");
    for known in gates.deviations() {
        let its = |line: &Line| line.engine == known.engine && line.class == known.id;
        assert_eq!(all.iter().filter(|entry| its(&entry.line)).count(), 1, "{} {}", known.engine, known.id);
    }
    for shown in gates.reproductions() {
        assert!(all.iter().any(|entry| entry.line.reproduction.as_ref() == Some(&shown.name)), "{}", shown.name);
    }
    assert!(gates.deviations().len() >= 45 && all.len() > gates.deviations().len() + 10, "{} lines", all.len());

    let of = |name: &str| all.iter().find(|entry| entry.line.name == name).unwrap();
    let why = |name: &str| match &of(name).line.status {
        Status::None { why } => why.clone(),
        Status::Reduced(_) => panic!("{name} is not reduced yet"),
    };
    let (found, finding) = &of("pinocchio-far-base").found[0];
    assert!(found.cell == "3f2a" && finding.fault == Fault::Known("far-base".into()));
    assert_eq!(of("drake-fd-aba_world-fails").found[0].1.fault, Fault::Unknown);
    assert!(of("pinocchio-zyx-aba").found.is_empty() && why("pinocchio-zyx-aba").contains("fd of operations"));
    assert!(why("drake-singular-mass").contains("difference from mujoco"));
    assert!(why("pinocchio-height-field").contains("reading a file"));
    assert!(why("pinocchio-world-aba").contains("no row shows it"));
    assert!(why("dart-zyx-aba").contains("no row of dart"));
    // Those of named cells alone.
    let named: Vec<String> = entries(&gates, &rows[..1], &["3f".into()]).into_iter().map(|entry| entry.line.name).collect();
    assert_eq!(named, ["pinocchio-far-base"]);
    assert!(entries(&gates, &rows, &["0".into()]).is_empty());

    let lines: Vec<Line> = all.into_iter().map(|entry| entry.line).collect();
    let catalogue = Catalogue { runs: vec!["a".into()], lines: lines.clone() };
    let page = section(&catalogue).body.0;
    assert!(lines.iter().all(|line| page.contains(&line.class)), "the page has every line");
    // Named cells renew their lines.
    let renewed = catalogue.clone().renewed(vec![Line { reason: "another".into(), ..lines[3].clone() }]);
    assert!(renewed.lines.len() == lines.len() && renewed.lines[3].reason == "another");
}

#[test]
fn a_catalogue_is_read_as_it_was_written_or_names_its_file() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(Catalogue::read(folder.path()).unwrap(), None);
    let path = folder.path().join("catalogue.json");
    std::fs::write(&path, "{").unwrap();
    assert!(Catalogue::read(folder.path()).unwrap_err().to_string().contains("catalogue.json"));
    let lines = entries(&gates_of_project(), &[], &[]).into_iter().map(|entry| entry.line).collect();
    let catalogue = Catalogue { runs: vec!["a".into()], lines };
    std::fs::write(&path, serde_json::to_string(&catalogue).unwrap()).unwrap();
    assert_eq!(Catalogue::read(folder.path()).unwrap(), Some(catalogue));
}

/// Gates under which a fault of balls is a known deviation of robots with a slide.
fn gates(robot: &Robot, high: f64) -> Gates {
    let engine = Featherbench::new();
    let (name, version) = (engine.identity().name.clone(), engine.identity().version.clone());
    let gate = "[[gate]]\nstudy = \"agreement\"\nquantities = [\"id\"]\nmetric = \"scaled\"\nbound = 1e-12\nreason = \"a test\"\n";
    let class = |id: &str, verdict: &str| {
        format!(
            "[[deviation]]\nid = \"{id}\"\nquantities = [\"id\"]\njoint = [\"prismatic\"]\nverdict = \"{verdict}\"\nreason = \"a test\"\n\
             reproduction = \"not reproduced\"\n"
        )
    };
    let text = format!("version = \"{version}\"\n{}{}", class("heavy", "fail"), class("lost", "error"));
    let key = RangeKey {
        engine: name,
        version,
        method: "rnea_packed".into(),
        quantity: "id".into(),
        robot: robot.name.clone(),
        metric: "scaled".into(),
    };
    let range = Range { deviation: "heavy".into(), low: 1e-9, high, outside: 20, seeds: 20 };
    let gates = Gates::parse(gate, Path::new("gates.toml")).unwrap();
    let file = DeviationFile::parse(&text, Path::new("featherbench.toml")).unwrap();
    gates.with_deviations(file).with_ranges(Ranges::from_iter([(key, range)]), Path::new("ci")).unwrap()
}

/// The first trees with a ball and a slide.
fn trees() -> impl Iterator<Item = Robot> {
    let all = (1..100).map(|seed| robot(&format!("tree:n=12,joints=common,seed={seed},base=fixed")));
    let has = |robot: &Robot, kind: &str| robot.joint_kinds().contains(&kind);
    all.filter(move |robot| has(robot, "spherical") && has(robot, "prismatic")).take(3)
}

fn finding(id: &str, robot: &Robot) -> Failure {
    let row = Row {
        study: "agreement".into(),
        quantity: "id".into(),
        method: "rnea_packed".into(),
        metric: "scaled".into(),
        states: robot.states.cases[0].name().into(),
        verdict: Verdict::Deviation,
        params: format!("{{\"deviation\":\"{id}\"}}"),
        ..Row::default()
    };
    Failure::of(&row).unwrap()
}

#[test]
fn a_case_stays_in_the_class_of_its_deviation() {
    let mut cases = 0;
    for robot in trees() {
        for (id, lost, kind) in [("heavy", false, Kind::Number), ("lost", true, Kind::NotFinite)] {
            let engine = Faulty { inner: Featherbench::new(), alter: balls, lost };
            let (gates, finding) = (gates(&robot, 1e-3), finding(id, &robot));
            let shown = |robot: &Robot| finding.shown(&engine, &gates, robot);
            let given = shown(&Subject::of(&robot, 0).robot().unwrap()).unwrap();
            assert_eq!(given.kind, kind, "{} {id}", robot.name);
            let severity = |robot: &Robot| shown(robot).filter(|shown| shown.kind == kind).map(|shown| shown.severity);
            let reduced = reduce(Subject::of(&robot, 0), 0.0, &severity).unwrap();
            // The fault takes a ball. The class takes a slide, which the fault would not.
            let mut joints: Vec<&str> = reduced.case.description.bodies.iter().map(|body| body.joint.kind.name()).collect();
            joints.sort_unstable();
            assert_eq!(joints, ["prismatic", "spherical"], "{} {id}", robot.name);
            assert_eq!(reduced.case.robot().unwrap().name, robot.name, "a size is that of a name");
            // A sound engine does not show it.
            assert_eq!(finding.shown(&Featherbench::new(), &gates, &reduced.case.robot().unwrap()), None, "{} {id}", robot.name);
            cases += 1;
        }
    }
    assert_eq!(cases, 6);
}

#[test]
fn another_fault_is_not_taken_for_a_known_one() {
    let robot = trees().next().unwrap();
    let engine = Faulty { inner: Featherbench::new(), alter: balls, lost: false };
    let one = Subject::of(&robot, 0).robot().unwrap();
    assert!(finding("heavy", &robot).shown(&engine, &gates(&robot, 1e-3), &one).is_some());
    // Larger than known, or of another robot.
    assert_eq!(finding("heavy", &robot).shown(&engine, &gates(&robot, 1e-11), &one), None);
    let other = Robot { name: "other".into(), ..one };
    assert_eq!(finding("heavy", &robot).shown(&engine, &gates(&robot, 1e-3), &other), None);
    let unknown = Failure { fault: Fault::Unknown, ..finding("heavy", &robot) };
    assert!(unknown.shown(&engine, &gates(&robot, 1e-3), &other).is_some(), "that is a failure for no known cause");
}

#[test]
fn what_asks_for_more_than_a_state_is_no_finding() {
    let row = Row { study: "agreement".into(), quantity: "id".into(), verdict: Verdict::Fail, ..Row::default() };
    assert_eq!(Failure::of(&row).unwrap().quantity, Quantity::InverseDynamics);
    for (study, quantity, metric) in [("import", "import", ""), ("agreement", "id_wrench", ""), ("agreement", "id", "pairwise")] {
        let row = Row { study: study.into(), quantity: quantity.into(), metric: metric.into(), ..row.clone() };
        assert_eq!(Failure::of(&row), None, "{study} {quantity} {metric}");
    }
}
