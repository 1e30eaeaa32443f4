//! The sections of the studies with the truth: they appear only with their rows, show these, and do not change the other sections.

use featherbench_results::{Relation, Row, RunInfo, Verdict};
use std::fs;

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

/// The section on accuracy with all its drawings.
fn accuracy(written: &Written) -> String {
    let parts =
        (1..).map_while(|part| fs::read_to_string(written.folder.path().join(format!("sections/accuracy-choices-{part}.html"))).ok());
    [written.section("accuracy")].into_iter().chain(parts).collect()
}

/// What is shown for a choice: its drawing, and the table of fitted exponents.
fn chosen<'a>(text: &'a str, values: [&str; 3]) -> &'a str {
    let opening = format!("data-choice=\"{}\"", values.join("\t"));
    let shown = text.split(&opening).nth(1).unwrap_or_else(|| panic!("no {values:?}"));
    shown.split("data-choice=").next().unwrap()
}

/// The numbers in the line of a method in the table of fitted exponents: robots, p, p at the end, error at the end.
fn growth<'a>(shown: &'a str, method: &str) -> Vec<&'a str> {
    let words = |head: &str| head.split('<').map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text)).collect::<String>();
    let line = shown.split("<th scope=\"row\">").filter_map(|line| line.split_once("</th>")).find(|(head, _)| words(head) == method);
    let (_, line) = line.unwrap_or_else(|| panic!("no {method}: {shown}"));
    line.split("</tr>").next().unwrap().split("<td class=\"number\">").skip(1).map(|cell| cell.split('<').next().unwrap()).collect()
}

/// The marks of a series: their places across and upwards.
fn places(shown: &str, series: usize) -> Vec<(f64, f64)> {
    let group = shown.split("<g class=\"series\"").nth(series + 1).unwrap();
    let values = group.split("data-value=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    values.map(|pair| pair.split_once(' ').unwrap()).map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).collect()
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
    let engines = with.data("overview")["engines"].clone();
    assert!(engines.as_array().unwrap().iter().all(|name| name != "all"), "nobody is called all: {engines}");
    assert!(!with.section("verdict").contains("<th scope=\"row\">all</th>"));
}

#[test]
fn growth_is_what_the_methods_were_made_with() {
    let (_, written) = of_studies(&["accuracy"]);
    let text = accuracy(&written);
    let slope = |values, method: &str| -> f64 { growth(chosen(&text, values), method)[1].split(' ').next().unwrap().parse().unwrap() };
    // A fit of rounding errors: within a twentieth of the exponent that the numbers were made with.
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 0.05, "{found}, not {expected}");
    close(slope(["fd", "offset", "rand3d-20"], "pinocchio aba_world"), 2.0);
    close(slope(["fd", "offset", "rand3d-20"], "featherbench aba"), 0.0);
    close(slope(["fd", "offset", "rand3d-20"], "mujoco forward"), 1.0);
    close(slope(["fd", "depth", "chain_2d"], "featherbench ltdl"), 4.0);
    // Lighter tips cost no digits. They are in the plot and not in the fit; the robot itself is at one.
    let tips = ["fd", "tip", "rand3d-20"];
    close(slope(tips, "featherbench aba"), 1.0);
    let found: Vec<f64> = places(chosen(&text, tips), 0).into_iter().map(|(x, _)| x).collect();
    assert_eq!(found, [1e-3, 1.0, 1e3, 1e6]);
    // Entries of M, and products with it, are marks of one series; the last of each engine is hollow.
    let matrix = chosen(&text, ["mass_matrix", "depth", "chain_2d"]);
    assert_eq!((growth(matrix, "featherbench crba")[0], matrix.matches("seen through products").count()), ("6", 2), "{matrix}");
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
    let section = written.section("tradeoff");
    let table: Vec<&str> = section.split("<tr><th scope=\"row\">").collect();
    let of_model = |name: &str| -> Vec<(&str, bool)> {
        let rows = table.iter().filter(|row| row.starts_with(&format!("{name}</th><td>featherbench</td>")));
        rows.map(|row| (row.split("<td>").nth(2).unwrap().split('<').next().unwrap(), row.contains("unbeaten"))).collect()
    };
    // On two joints the factorization is faster and less accurate: both are on the front. On a hundred it is slower and less accurate.
    assert_eq!(of_model("chain_2d_2"), [("ltdl", true), ("aba", true)]);
    assert_eq!(of_model("chain_2d_100"), [("aba", true), ("ltdl", false)]);
    // The marks of all robots say the same: some are on the page, the others in a part.
    let others = fs::read_to_string(written.folder.path().join("sections/tradeoff-choices-1.html")).unwrap();
    let marks = |words: &str| [&section, &others].map(|text| text.matches(words).count()).iter().sum::<usize>();
    assert_eq!(marks("\nunbeaten"), section.matches("● unbeaten").count());
    assert_eq!(marks("data-rows="), table.iter().filter(|row| row.contains("</th><td>featherbench</td>")).count());
}

#[test]
fn conditioning_shows_local_exponents_and_the_floor() {
    let (_, written) = of_studies(&["conditioning"]);
    let section = written.section("conditioning");
    // The exponents of the fits stand in the legend.
    for words in
        ["κ(M), p = 4.00", "κ scaled, p = 4.25", "conditioning bound", "straight-64", "5.033e7", "6.400e-15", "</span> 4.000", "4.250"]
    {
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
    let section = written.section("conditioning");
    // A complement without κ after scaling has no place.
    assert_eq!([0, 1, 2].map(|series| places(&section, series)), [vec![(4e6, 500.0)], vec![(30.0, 20.0)], vec![]]);
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
    let section = written.section("steps");
    // Two lines of accelerations, then one of the energy.
    assert_eq!(places(&section, 0), [(0.01, 2e-2), (0.001, 2e-3), (1e-10, 2e-10)]);
    assert_eq!([1, 2].map(|series| places(&section, series)), [vec![(0.001, 0.5)], vec![(0.01, 0.125)]]);
    assert!(section.contains("step · random, p = 1.250") && section.matches("p = ").count() == 1, "{section}");
    assert!(section.contains("1.2500") && section.contains("badge fail"), "{section}");
    assert!(written.index.contains("<a href=\"#steps\">"));

    let without = report(&run, &made_up::rows(&run));
    assert!(!without.index.contains("<section id=\"steps\"") && !without.index.contains("<a href=\"#steps\">"));
}
