//! The sections of the studies with the truth: they appear only with their rows, show these, and do not change the other sections.

use featherbench_results::{Relation, Row, RunInfo, Verdict};
use serde_json::Value;

use super::written::Written;
use super::{made_up, report};

fn of_studies(studies: &[&str]) -> (Vec<Row>, Written) {
    let run = made_up::run_info();
    let records: Vec<Row> = made_up::rows(&run).into_iter().filter(|row| studies.contains(&row.study.as_str())).collect();
    let written = report(&run, &records);
    (records, written)
}

fn has(written: &Written, section: &str) -> bool {
    let section_is_there = written.index.contains(&format!("<section id=\"{section}\""));
    assert_eq!(section_is_there, written.index.contains(&format!("<a href=\"#{section}\">")), "{section}: the navigation differs");
    section_is_there
}

/// The curve of an answer along an axis of a family.
fn curve<'a>(figures: &'a Value, overview: &Value, axis: &str, family: &str, answer: [&str; 3]) -> &'a Value {
    let digits = &figures["accuracy"];
    let is_answer = |about: &Value| {
        [&overview["engines"][about["engine"].as_u64().unwrap() as usize], &about["method"], &about["quantity"]]
            .iter()
            .zip(answer)
            .all(|(found, wanted)| *found == wanted)
    };
    let index = digits["answers"].as_array().unwrap().iter().position(is_answer).unwrap_or_else(|| panic!("no {answer:?}"));
    let curves = digits["curves"].as_array().unwrap();
    let found = curves.iter().find(|curve| curve["axis"] == axis && curve["family"] == family && curve["answer"] == index);
    found.unwrap_or_else(|| panic!("no curve of {answer:?} against {axis} in {family}"))
}

#[test]
fn each_section_appears_with_its_rows_alone() {
    let (_, written) = of_studies(&["agreement", "timing", "operations"]);
    assert_eq!(["accuracy", "tradeoff", "conditioning"].map(|section| has(&written, section)), [false; 3]);
    assert!(!written.section("verdict").contains("Against the truth"));
    let (_, written) = of_studies(&["accuracy"]);
    assert_eq!(["accuracy", "tradeoff", "conditioning"].map(|section| has(&written, section)), [true, false, false]);
    let (_, written) = of_studies(&["conditioning"]);
    assert_eq!(["accuracy", "tradeoff", "conditioning"].map(|section| has(&written, section)), [false, false, true]);
    let (_, written) = of_studies(&["accuracy", "timing"]);
    assert_eq!(["accuracy", "tradeoff", "conditioning"].map(|section| has(&written, section)), [true, true, false]);
}

#[test]
fn the_other_sections_stay_as_they_were() {
    let (_, without) = of_studies(&["agreement", "timing", "operations"]);
    let (_, with) = of_studies(&["agreement", "timing", "operations", "accuracy", "conditioning"]);
    for id in ["agreement", "depth", "time", "pairs"] {
        assert_eq!(without.section(id), with.section(id), "{id}");
    }
    let (without, with_data) = (without.data("figures"), with.data("figures"));
    assert_eq!((&without["depth"], &without["time"]), (&with_data["depth"], &with_data["time"]));
    let engines = with.data("overview")["engines"].clone();
    assert!(engines.as_array().unwrap().iter().all(|name| name != "all"), "nobody is called all: {engines}");
    assert!(!with.section("verdict").contains("<th scope=\"row\">all</th>"));
}

#[test]
fn growth_is_what_the_methods_were_made_with() {
    let (_, written) = of_studies(&["accuracy"]);
    let (figures, overview) = (written.data("figures"), written.data("overview"));
    let slope = |axis, family, answer| curve(&figures, &overview, axis, family, answer)["fit"]["slope"].as_f64().unwrap();
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 0.05, "{found}, not {expected}");
    close(slope("offset", "rand3d-20", ["pinocchio", "aba_world", "fd"]), 2.0);
    close(slope("offset", "rand3d-20", ["featherbench", "aba", "fd"]), 0.0);
    close(slope("offset", "rand3d-20", ["mujoco", "forward", "fd"]), 1.0);
    close(slope("depth", "chain_2d", ["featherbench", "ltdl", "fd"]), 4.0);
    // Lighter tips cost no digits. They are in the plot and not in the fit; the robot itself is at one.
    let tips = curve(&figures, &overview, "tip", "rand3d-20", ["featherbench", "aba", "fd"]);
    close(tips["fit"]["slope"].as_f64().unwrap(), 1.0);
    assert_eq!(tips["span"], serde_json::json!([1.0, 1e6]));
    let places: Vec<f64> = tips["points"].as_array().unwrap().iter().map(|point| point[0].as_f64().unwrap()).collect();
    assert_eq!(places, [1e-3, 1.0, 1e3, 1e6]);
    // A line connects entries of M, or products, but not both.
    let matrix = curve(&figures, &overview, "depth", "chain_2d", ["featherbench", "crba", "mass_matrix"]);
    assert_eq!((matrix["points"].as_array().unwrap().len(), &matrix["fit"]["points"]), (6, &5.into()));
    assert!(written.section("accuracy").contains("<td class=\"number\">1.9") || written.section("accuracy").contains("2.00 ±"));
}

#[test]
fn the_table_holds_every_median_once() {
    let (records, written) = of_studies(&["accuracy"]);
    let section = written.section("accuracy");
    let table = &section[section.find("id=\"accuracy-table\"").unwrap()..];
    let answers = |row: &&Row| row.engine != "all";
    let cells: std::collections::BTreeSet<_> =
        records.iter().filter(answers).map(|row| (&row.robot, &row.engine, &row.method, &row.quantity)).collect();
    assert_eq!(written.data("figures")["accuracy"]["cells"].as_array().unwrap().len(), cells.len());
    // Every cell leads to an existing chunk.
    let chunks = written.chunk_names();
    let data = written.data("figures");
    let models = data["accuracy"]["cells"].as_array().unwrap().iter().map(|cell| &cell["robot"]);
    assert!(models.map(|model| format!("robot-{model}")).all(|name| chunks.contains(&name)));
    assert_eq!(table.matches("<button").count(), cells.len());
    // A robot and an engine lead to their pages.
    assert_eq!(table.matches("<a href=\"robots/").count(), table.matches("<tr data-m").count());
    assert!(table.contains("<a href=\"engines/pinocchio.html\">pinocchio</a><small>aba_world</small>"), "{table}");
    // Pinocchio's world frame at 10⁶ m has lost all digits that it can; an exact answer is zero; a missed gate has its sign.
    assert!(table.contains("<button class=\"d5\" type=\"button\" tabindex=\"-1\"><i>✕</i>1.00e-2</button>"), "{table}");
    assert!(table.contains("tabindex=\"-1\">0</button>"));
    assert!(table.contains("class=\"error\" type=\"button\" tabindex=\"-1\">!</button>"));
    assert!(table.contains("class=\"skip\" type=\"button\" tabindex=\"-1\">–</button>"));
    assert!(table.contains("<span class=\"floor\">4.00e-15</span>"));
}

#[test]
fn the_verdict_says_who_is_right_by_truth() {
    let (_, written) = of_studies(&["accuracy"]);
    let verdict = written.section("verdict");
    for words in [
        "Against the truth",
        "<b><a href=\"engines/featherbench.html\">featherbench</a> aba and <a href=\"engines/pinocchio.html\">pinocchio</a> aba_local</b>",
        "keep every gate on forward dynamics",
        "pinocchio</a> aba_world</b> fails on 2 of 22 robots in forward dynamics: <a href=\"robots/rand3d-20-offset1e4.html\">rand3d-20-offset1e4</a> and ",
        "rand3d-20-offset1e6, 0.010 where 1e-7 is allowed",
        "M is singular",
        "pinocchio</a> aba_world <b>0.010</b>",
        "The reference is the suspect",
        "rand3d-20-tip1e6</button> 3 engines stop at the same error",
    ] {
        assert!(verdict.contains(words), "{words}: {verdict}");
    }
    assert!(written.section("accuracy").contains("The reference is the suspect"));
}

#[test]
fn a_deviation_is_neither_kept_nor_failed() {
    let row = |method: &str, model: &str| Row {
        study: "accuracy".into(),
        engine: "mujoco".into(),
        method: method.into(),
        robot: model.into(),
        quantity: "fd".into(),
        metric: "true_forward".into(),
        reference: "truth".into(),
        ..Row::default()
    };
    let rows = [
        row("forward", "a").gated(1e-15, Relation::Le, 1e-14),
        row("forward", "b").gated(1e-12, Relation::Le, 1e-14).deviating("far base"),
        // A question that is not supported is no answer, right or wrong.
        row("other", "a").gated(1e-15, Relation::Le, 1e-14),
        row("other", "b").without_value(featherbench_results::Verdict::Skip, "no such joint"),
    ];
    let written = report(&RunInfo::default(), &rows);
    let verdict = written.section("verdict");
    assert!(verdict.contains("mujoco</a> other</b> keeps every gate on forward dynamics"), "{verdict}");
    assert!(
        verdict
            .contains("mujoco</a> forward</b> misses by known cause on 1 of 2 robots in forward dynamics: <a href=\"robots/b.html\">b</a>"),
        "{verdict}"
    );
    assert!(!verdict.contains("<li class=\"fail\">"));
}

#[test]
fn work_against_precision_has_its_front() {
    let (_, written) = of_studies(&["accuracy", "timing"]);
    let (figures, overview) = (written.data("figures"), written.data("overview"));
    let points = figures["tradeoff"].as_array().unwrap();
    let of_model = |name: &str| -> Vec<(&str, bool)> {
        let of = |point: &&Value| overview["robots"][point["robot"].as_u64().unwrap() as usize]["name"] == name;
        points.iter().filter(of).map(|point| (point["method"].as_str().unwrap(), point["front"].as_bool().unwrap())).collect()
    };
    // On two joints the factorization is faster and less accurate: both are on the front. On a hundred it is slower and less accurate.
    assert_eq!(of_model("chain_2d_2"), [("ltdl", true), ("aba", true)]);
    assert_eq!(of_model("chain_2d_100"), [("aba", true), ("ltdl", false)]);
    assert!(points.iter().all(|point| overview["engines"][point["engine"].as_u64().unwrap() as usize] == "featherbench"));
    let section = written.section("tradeoff");
    assert_eq!(section.matches("● unbeaten").count(), points.iter().filter(|point| point["front"] == true).count());
}

#[test]
fn conditioning_shows_local_exponents_and_the_floor() {
    let (_, written) = of_studies(&["conditioning"]);
    let families = written.data("figures")["conditioning"]["families"].clone();
    assert_eq!(families.as_array().unwrap().len(), 1);
    assert!((families[0]["raw"]["slope"].as_f64().unwrap() - 4.0).abs() < 1e-9, "{families}");
    assert!((families[0]["scaled"]["slope"].as_f64().unwrap() - 4.25).abs() < 1e-9);
    let section = written.section("conditioning");
    for words in ["straight-64", "5.033e7", "6.400e-15", "</span> 4.000", "4.250"] {
        assert!(section.contains(words), "{words}: {section}");
    }
}

/// A robot with a floating base has a mark for each of three matrices, and no point among the chains.
#[test]
fn conditioning_shows_the_blocks_of_floating_bases() {
    let run = made_up::run_info();
    let blank = Row {
        study: "conditioning".into(),
        robot: run.robots[0].name.clone(),
        engine: "featherbench".into(),
        quantity: "mass_matrix".into(),
        method: "partition".into(),
        states: "random".into(),
        ..Row::default()
    };
    let of = |metric: &str, value: f64| Row { metric: metric.into(), ..blank.clone() }.informed(value);
    let judged = |metric: &str, value: f64, bound: f64| Row { metric: metric.into(), ..blank.clone() }.gated(value, Relation::Le, bound);
    let records = [
        of("kappa", 4e6),
        of("kappa_scaled", 500.0),
        of("kappa_base", 30.0),
        of("kappa_base_scaled", 20.0),
        of("kappa_joints", 2e6),
        judged("complement_over_whole", 0.5, 1.0),
        judged("complement_error", 3e-12, 1e-14),
        Row { robot: run.robots[1].name.clone(), ..blank.clone() }.without_value(Verdict::Error, "it floats away"),
    ];
    let written = report(&run, &records);
    let figures = &written.data("figures")["conditioning"];
    assert_eq!(figures["families"], serde_json::json!([]));
    let bases = figures["bases"].as_array().unwrap();
    assert_eq!(bases.len(), 2);
    assert_eq!(bases[0]["kappa"], serde_json::json!([4e6, 500.0, 30.0, 20.0, 2e6, null]));
    let section = written.section("conditioning");
    for words in ["floating-base-plot", "4.00e6", "5.00e2", "</span> 5.00e-1", "</span> 3.00e-12", "it floats away"] {
        assert!(section.contains(words), "{words}: {section}");
    }
    assert!(!section.contains("conditioning-plot"), "there are no chains");
}

#[test]
fn steps_become_lines_and_orders() {
    let run = made_up::run_info();
    let blank = Row {
        study: "steps".into(),
        robot: run.robots[0].name.clone(),
        engine: run.engines[0].name.clone(),
        quantity: "fd".into(),
        method: "step".into(),
        states: "random".into(),
        metric: "step_error".into(),
        unit: "1".into(),
        ..Row::default()
    };
    let at = |dt: &str, error: f64| Row { params: format!("{{\"dt\":{dt}}}"), ..blank.clone() }.informed(error);
    let judged = Row { metric: "order_off_one".into(), verdict: Verdict::Fail, value: Some(0.25), ..blank.clone() };
    let other = Row { method: "step_default".into(), ..at("0.001", 0.5) };
    let drift = Row { quantity: "kinetic_energy".into(), metric: "energy_drift".into(), ..at("0.01", 0.125) };
    let order = Row { metric: "order".into(), ..blank.clone() }.informed(1.25);
    let records = [at("0.001", 2e-3), at("0.01", 2e-2), at("1e-10", 2e-10), order, judged, other, drift];

    let written = report(&run, &records);
    let lines = &written.data("figures")["steps"];
    let kinds: Vec<_> =
        lines.as_array().unwrap().iter().map(|line| (line["method"].as_str().unwrap(), line["energy"].as_bool().unwrap())).collect();
    assert_eq!(kinds, [("step", false), ("step_default", false), ("step", true)]);
    assert_eq!(lines[0]["points"], serde_json::json!([[0.01, 2e-2], [0.001, 2e-3], [1e-10, 2e-10]]));
    assert_eq!((&lines[0]["order"], &lines[1]["order"]), (&serde_json::json!(1.25), &serde_json::Value::Null));
    let section = written.section("steps");
    assert!(section.contains("1.2500") && section.contains("badge fail"), "{section}");
    assert!(written.index.contains("<a href=\"#steps\">"));

    let without = report(&run, &made_up::rows(&run));
    assert!(!without.index.contains("<section id=\"steps\"") && !without.index.contains("<a href=\"#steps\">"));
}
