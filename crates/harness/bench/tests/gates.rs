//! Gates and known deviations on rows made by hand: each condition in both directions.

use featherbench_bench::{Counts, DeviationFile, Engines, Gates, Range, RangeKey, SLACK, Suite};
use featherbench_results::{Expectation, GateKind, Kind, Relation, Row, RunInfo, Verdict};
use std::path::Path;

mod ranges;

const GATES: &str = r#"
[sharp]
study = "agreement"
quantity = "fd"
metric = "forward"
bound = 1e-12
reason = "sharp"
[[gate]]
study = "agreement"
quantities = ["id", "bias"]
metric = "scaled"
engines = ["crane"]
methods = ["rnea"]
robots = ["gantry", "hoist-*"]
max_depth = 20
bound = 1e-14
reason = "the first that matches"
[[gate]]
study = "agreement"
quantities = ["id"]
metric = "scaled"
bound = 1e-10
reason = "all others"
[[gate]]
study = "agreement"
quantities = ["fd"]
metric = "backward"
bound = 1e-14
times = "depth"
reason = "per level"
[[gate]]
study = "agreement"
quantities = ["fd"]
metric = "forward"
bound = 1e-14
times = "depth_and_amplification"
reason = "per level and growth"
"#;

/// A failure of one engine, version, method, quantity and case, and an error.
const DEVIATIONS: &str = r#"
version = "2"
[[deviation]]
id = "cables"
method = "rnea"
quantities = ["id"]
robots = ["gantry", "hoist-*"]
states = ["fast"]
verdict = "fail"
reason = "cables stretch"
reproduction = "not reproduced"
[[deviation]]
id = "foot"
robots = ["derrick"]
verdict = "error"
reason = "it has no foot"
reproduction = "not reproduced"
"#;

/// Something that the engine does not offer.
const ENGINES: &str = r#"
[crane]
title = "T"
package = { name = "crane", version = "2", released = "2026-01-31", licence = "MIT", home = "https://example.org" }
start = { kind = "python", module = "m" }
[[crane.lacks]]
quantities = ["com"]
robots = ["hoist-*"]
states = ["zero"]
reason = "no mass is known"
"#;

fn plain() -> Gates {
    let engines = Engines::parse(ENGINES, Path::new("engines.toml")).unwrap();
    gates().with_deviations(crane(DEVIATIONS)).with_lacks(engines.lacks())
}

/// The thresholds alone.
fn gates() -> Gates {
    Gates::parse(GATES, Path::new("gates.toml")).unwrap()
}

/// The known deviations of the engine in question.
fn crane(text: &str) -> DeviationFile {
    DeviationFile::parse(text, Path::new("deviations/crane.toml")).unwrap()
}

/// A row of the engine in question.
fn row() -> Row {
    Row {
        study: "agreement".into(),
        engine: "crane".into(),
        engine_version: "2".into(),
        method: "rnea".into(),
        quantity: "id".into(),
        robot: "gantry".into(),
        metric: "scaled".into(),
        states: "fast".into(),
        depth: Some(20),
        ..Row::default()
    }
}

fn on(model: &str) -> Row {
    Row { robot: model.into(), ..row() }
}

fn range(low: f64, high: f64, outside: u64, seeds: u64) -> Range {
    Range { deviation: "cables".into(), low, high, outside, seeds }
}

/// The gates with one range of a row's key.
fn with(row: &Row, range: Range) -> Gates {
    plain().with_ranges([(RangeKey::of(row), range)].into_iter().collect(), Path::new("here")).unwrap()
}

/// The suite that asks the crane.
fn suite() -> Suite {
    let text = "about = \"a\"\nseed = 1\nthorough = true\nengines = [\"crane\"]\n[agreement]\n";
    Suite::parse(text, Path::new("suite.toml")).unwrap()
}

/// The same suite, which need not show every deviation.
fn lenient() -> Suite {
    let mut suite = suite();
    suite.thorough = false;
    suite
}

fn unmet(conditions: &[Expectation]) -> Vec<&str> {
    conditions.iter().filter(|condition| condition.verdict != Verdict::Pass).map(|condition| condition.what.as_str()).collect()
}

fn red(gates: &Gates, records: &[Row]) -> Vec<String> {
    unmet(&gates.conditions(&suite(), records, true)).into_iter().map(str::to_owned).collect()
}

#[test]
fn the_first_gate_that_matches_judges() {
    let gates = plain();
    let bound = |row: Row| gates.judge(row, 1e-16, 8.0).bound;
    assert_eq!(bound(row()), Some(1e-14));
    assert_eq!(bound(on("hoist-3")), Some(1e-14));
    let others = [
        Row { engine: "winch".into(), ..row() },
        Row { method: "aba".into(), ..row() },
        on("gantry-2"),
        on("hoist"),
        Row { depth: Some(21), ..row() },
    ];
    for other in others {
        assert_eq!(bound(other.clone()), Some(1e-10), "{other:?}");
    }
    assert_eq!(bound(Row { depth: None, ..row() }), Some(1e-14), "a row without a depth is not deep");
    for none in
        [Row { quantity: "com".into(), ..row() }, Row { metric: "pairwise".into(), ..row() }, Row { study: "accuracy".into(), ..row() }]
    {
        let row = gates.judge(none, 1.0, 8.0);
        assert_eq!((row.bound, row.verdict), (None, Verdict::Info));
    }
    let forward = |metric: &str| bound(Row { quantity: "fd".into(), metric: metric.into(), depth: Some(4), ..row() });
    assert_eq!((forward("backward"), forward("forward")), (Some(1e-14 * 4.0), Some(1e-14 * 32.0)));
    let judged = |value: f64| gates.judge(Row { states: "zero".into(), ..row() }, value, 1.0).verdict;
    assert_eq!((judged(1e-14), judged(1.1e-14)), (Verdict::Pass, Verdict::Fail));
}

#[test]
fn a_deviation_excuses_its_own_rows_up_to_its_range() {
    let gates = with(&row(), range(2e-14, 3e-14, 20, 20));
    let judged = |row: Row, value: f64| gates.judge(row, value, 1.0);
    let known = judged(row(), 2e-14);
    assert_eq!((known.verdict, known.value), (Verdict::Deviation, Some(2e-14)));
    assert_eq!(known.reason, "cables stretch (2e-14 is not at most 1e-14)");
    assert_eq!(known.params, "{\"deviation\":\"cables\"}", "no program reads the reason");
    let with_more = judged(Row { params: "{\"base\":\"free\"}".into(), ..row() }, 2e-14);
    assert_eq!(with_more.params, "{\"base\":\"free\",\"deviation\":\"cables\"}");
    assert_eq!(judged(row(), SLACK * 3e-14).verdict, Verdict::Deviation, "as far as a twenty-first draw may go");
    let beyond = judged(row(), SLACK * 3.001e-14);
    assert_eq!(beyond.verdict, Verdict::Fail);
    for words in ["is not at most 1e-14", "at most 3e-14 in 20 seeds", "cables stretch"] {
        assert!(beyond.reason.contains(words), "{}", beyond.reason);
    }
    // Any other row fails as without the deviation.
    let others = [
        Row { engine: "winch".into(), quantity: "id".into(), ..row() },
        Row { engine_version: "3".into(), ..row() },
        Row { method: "aba".into(), ..row() },
        Row { quantity: "bias".into(), ..row() },
        Row { states: "zero".into(), ..row() },
        on("gantry-2"),
    ];
    for other in others {
        let judged = judged(other, 1e-9);
        assert!(!judged.reason.contains("cables"), "{judged:?}");
        assert_eq!(judged.verdict, Verdict::Fail);
    }
    // A robot of the same class that was never measured is not excused, and the row says what to do.
    let unmeasured = judged(on("hoist-1"), 2e-14);
    assert_eq!(unmeasured.verdict, Verdict::Fail);
    assert!(unmeasured.reason.contains("no range was measured on this robot") && unmeasured.reason.contains("gate --ranges"));
    // Nor is another measure of the same answer.
    let other = gates.explain(Row { metric: "other".into(), ..row() }.gated(2e-14, Relation::Le, 1e-14));
    assert_eq!(other.verdict, Verdict::Fail);
    // A row within its gate needs no excuse.
    assert_eq!(judged(row(), 1e-15).verdict, Verdict::Pass);
}

#[test]
fn errors_and_what_is_not_offered_are_told_apart() {
    let gates = plain();
    let without = |row: Row, verdict| gates.explain(row.without_value(verdict, "it says so"));
    let error = without(on("derrick"), Verdict::Error);
    assert_eq!((error.verdict, error.reason.as_str()), (Verdict::Deviation, "it has no foot (it says so)"));
    for other in [on("gantry"), Row { engine_version: "3".into(), ..on("derrick") }] {
        assert_eq!(without(other, Verdict::Error).verdict, Verdict::Error);
    }
    assert_eq!(without(on("derrick"), Verdict::Skip).reason, "it says so", "an error's cause is none of a skip");
    assert_eq!(gates.explain(on("derrick").gated(1.0, Relation::Le, 0.5)).verdict, Verdict::Fail);

    // That an engine offers nothing of a study needs no entry.
    let nothing = Row { quantity: String::new(), robot: String::new(), ..row() }.without_value(Verdict::Skip, "not offered");
    assert_eq!(red(&gates, &[gates.explain(nothing)]), [""; 0]);

    let lacking = || Row { quantity: "com".into(), states: "zero".into(), ..on("hoist-9") };
    let skip = without(lacking(), Verdict::Skip);
    assert_eq!((skip.verdict, skip.reason.as_str()), (Verdict::Skip, "no mass is known (it says so)"), "it is no deviation");
    assert_eq!(without(lacking(), Verdict::Error).verdict, Verdict::Error);
    let known = |row: Row| !red(&gates, &[without(row, Verdict::Skip)]).iter().any(|what| what.starts_with("rows that an engine"));
    assert!(known(lacking()));
    let others = [
        Row { quantity: "id".into(), ..lacking() },
        Row { states: "fast".into(), ..lacking() },
        Row { robot: "gantry".into(), ..lacking() },
        Row { engine: "winch".into(), ..lacking() },
        Row { engine_version: "3".into(), ..lacking() },
    ];
    for other in others {
        assert!(!known(other.clone()), "{other:?}");
    }
}

#[test]
fn a_row_that_is_no_pass_is_red_in_any_run() {
    let gates = plain();
    let pass = row().gated(1e-15, Relation::Le, 1e-14);
    for complete in [true, false] {
        let unmet = |rows: &[Row]| unmet(&gates.conditions(&lenient(), rows, complete)).into_iter().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(unmet(std::slice::from_ref(&pass)), [""; 0]);
        let of = |verdict| Row { verdict, ..pass.clone() };
        assert_eq!(unmet(&[pass.clone(), of(Verdict::Fail)]), ["rows outside their bound"]);
        assert_eq!(unmet(&[pass.clone(), of(Verdict::Error)]), ["rows without a value that was due"]);
        assert_eq!(
            unmet(&[pass.clone(), of(Verdict::Skip)]),
            ["rows that an engine does not offer and oracles/engines.toml does not name"]
        );
        assert_eq!(unmet(&[pass.clone(), of(Verdict::Info), of(Verdict::Deviation)]), [""; 0]);
        assert_eq!(unmet(&[]).len(), usize::from(complete), "rows at all");
    }
    let two = [Row { verdict: Verdict::Fail, ..pass.clone() }, Row { verdict: Verdict::Fail, ..pass }];
    assert_eq!(gates.conditions(&suite(), &two, false)[0].found, 2);
}

#[test]
fn a_suite_counts_its_rows() {
    let info = |studies: &[&str]| RunInfo {
        suite: "yard".into(),
        studies: studies.iter().map(|&study| study.into()).collect(),
        ..RunInfo::default()
    };
    let engines = ["crane".to_owned()];
    let pass = row().gated(1e-15, Relation::Le, 1e-14);
    let deviating = row().gated(1e-13, Relation::Le, 1e-14).deviating("known");
    let lost = row().without_value(Verdict::Error, "lost").deviating("known");
    let counts = |cells: u64, rows: u64| {
        let text = format!("suite,study,engine,quantity,cells,rows\nyard,agreement,crane,id,{cells},{rows}\n");
        Counts::parse(&text, Path::new("counts.csv")).unwrap()
    };
    let skipped = row().without_value(Verdict::Skip, "not offered");
    for (rows, due) in [(&pass, 1), (&deviating, 1), (&lost, 0), (&skipped, 0)] {
        assert_eq!(Counts::of("yard", &engines, std::slice::from_ref(rows)), counts(1, due));
    }
    let is_met = |rows: &[Row]| unmet(&counts(1, 2).conditions(&info(&["agreement"]), &engines, rows)).is_empty();
    assert!(is_met(&[pass.clone(), deviating.clone()]));
    assert!(!is_met(std::slice::from_ref(&pass)) && !is_met(&[pass.clone(), pass.clone(), pass.clone()]));
    assert!(!is_met(&[pass.clone(), lost]));
    assert!(!is_met(&[pass.clone(), Row { quantity: "bias".into(), ..pass.clone() }]));
    assert!(!is_met(&[pass.clone(), Row { engine: "winch".into(), ..pass.clone() }]));
    let cells = ["1", "2"].map(|cell| Row { cell: cell.into(), ..pass.clone() });
    assert!(!is_met(&cells), "as many rows, and one cell more");
    // Rows of engines that are not named, times, studies that were left out, and other suites have no condition.
    assert!(is_met(&[pass.clone(), pass.clone(), Row { engine: "winch".into(), ..pass.clone() }]));
    assert!(is_met(&[pass.clone(), pass.clone(), Row { kind: Kind::Measured, ..pass.clone() }]));
    assert!(counts(1, 2).conditions(&info(&["timing"]), &engines, &[]).is_empty());
    let other = RunInfo { suite: "dock".into(), ..info(&["agreement"]) };
    assert!(counts(1, 2).conditions(&other, &engines, std::slice::from_ref(&pass)).is_empty());
    // Of an engine that the file names, what it does not name is too much. An engine that it does not name may answer what it will.
    let more = [pass.clone(), pass.clone(), Row { quantity: "bias".into(), ..pass.clone() }];
    let conditions = counts(1, 2).conditions(&info(&["agreement"]), &engines, &more);
    assert_eq!(unmet(&conditions), ["cells and rows of crane in the study agreement as counts.csv has them"]);
    assert!(conditions.iter().any(|condition| condition.reason == "bias: 1 cells and 1 rows, not 0 and 0"), "{conditions:?}");
    assert!(is_met(&[pass.clone(), pass.clone(), Row { engine: "featherbench".into(), ..pass.clone() }]));
    // A suite's counts are written in the place of those it had.
    let written = counts(1, 2).with("yard", Counts::of("yard", &engines, std::slice::from_ref(&pass)));
    assert_eq!(written, counts(1, 1));
    assert_eq!(Counts::parse(&counts(1, 2).with("dock", Counts::default()).to_csv(), Path::new("counts.csv")).unwrap(), counts(1, 2));
}

#[test]
fn a_deviation_must_be_seen_where_its_robots_are() {
    let gates = with(&row(), range(2e-14, 3e-14, 20, 20));
    let seen = gates.judge(row(), 2.5e-14, 1.0);
    assert_eq!(red(&gates, std::slice::from_ref(&seen)), [""; 0]);
    let gone = "known deviation of crane, 'cables', still seen: cables stretch";
    let small = "robots on which a known deviation of crane, 'cables', is smaller than known: cables stretch";
    assert_eq!(red(&gates, &[gates.judge(row(), 1e-15, 1.0)]), [gone, small]);
    // Where no robot shows it at every seed, one seed need not.
    let rare = with(&row(), range(2e-15, 3e-14, 19, 20));
    assert_eq!(red(&rare, &[rare.judge(row(), 1e-15, 1.0)]), [""; 0]);
    // Where only one seed in ten million is without it, one that is shows that it is gone.
    let usual = with(&row(), range(2e-15, 3e-14, 9_999_999, 10_000_000));
    assert_eq!(red(&usual, &[usual.judge(row(), 1e-15, 1.0)]), [gone]);
    // Rows of another version or method are expected as well, and show nothing.
    for other in [Row { engine_version: "3".into(), ..row() }, Row { method: "aba".into(), ..row() }] {
        assert_eq!(red(&gates, &[gates.judge(other, 1e-15, 1.0)]), [gone]);
    }
    // A row with another cause does not count.
    let other = Row { params: "{\"deviation\":\"winds\"}".into(), ..seen.clone() };
    assert_eq!(red(&gates, &[other]), [gone]);
    assert_eq!(red(&gates, &[Row { verdict: Verdict::Info, ..seen.clone() }]), [gone]);
    // Nothing is expected if none of its robots, quantities or cases is asked, or if the engine is external.
    for elsewhere in [on("pulley"), Row { quantity: "bias".into(), ..row() }, Row { states: "zero".into(), ..row() }] {
        assert_eq!(red(&gates, &[gates.judge(elsewhere, 1e-15, 1.0)]), [""; 0]);
    }
    let records = [gates.judge(row(), 1e-15, 1.0)];
    let mut external = suite();
    external.engines = None;
    assert!(unmet(&gates.conditions(&external, &records, true)).is_empty());
    assert!(unmet(&gates.conditions(&lenient(), &records, true)).is_empty());
    assert!(unmet(&gates.conditions(&suite(), &records, false)).is_empty());

    let error = || on("derrick").without_value(Verdict::Error, "it says so");
    assert_eq!(red(&gates, &[gates.explain(error())]), [""; 0]);
    let answered = on("derrick").gated(1e-15, Relation::Le, 1e-14);
    assert_eq!(red(&gates, &[answered]), ["known deviation of crane, 'foot', still seen: it has no foot"]);

    let lacking = || Row { quantity: "com".into(), states: "zero".into(), ..on("hoist-9") };
    assert_eq!(red(&gates, &[gates.explain(lacking().without_value(Verdict::Skip, "it says so"))]), [""; 0]);
    assert_eq!(red(&gates, &[lacking().gated(1e-15, Relation::Le, 1e-14)]), ["crane still does not offer: no mass is known"]);
}

/// The worst of a robot's rows has the known size, or the list must be corrected. If not every seed showed it, no value is too small.
#[test]
fn a_deviation_must_be_as_large_as_known() {
    let small = "robots on which a known deviation of crane, 'cables', is smaller than known: cables stretch";
    let judged = |gates: &Gates, values: &[f64]| -> Vec<String> {
        let rows: Vec<Row> = values.iter().map(|&value| gates.judge(row(), value, 1.0)).collect();
        red(gates, &rows)
    };
    let always = with(&row(), range(8e-14, 9e-14, 20, 20));
    assert_eq!(judged(&always, &[8e-14 / SLACK]), [""; 0]);
    assert_eq!(judged(&always, &[3.9e-14]), [small]);
    assert_eq!(judged(&always, &[1.5e-14, 7e-14, 2e-14]), [""; 0], "the worst row counts");
    let rows = [always.judge(row(), 3.9e-14, 1.0)];
    let conditions = always.conditions(&suite(), &rows, true);
    let told = &conditions.iter().find(|condition| condition.what == small).unwrap().reason;
    assert!(told.contains("gantry rnea id (3.9e-14, known from 8e-14)"), "{told}");
    let sometimes = with(&row(), range(8e-14, 9e-14, 19, 20));
    assert_eq!(judged(&sometimes, &[3.9e-14]), [""; 0]);
    // Rows without a verdict have no size.
    assert_eq!(red(&always, &[always.judge(row(), 8e-14, 1.0), Row { robot: "gantry".into(), ..row() }.informed(1e-20)]), [""; 0]);
}

#[test]
fn a_computed_bound_must_be_sharp_somewhere() {
    let gates = gates();
    let bounded = |engine: &str, method: &str, joints: &str, base: &str, bound: f64| Row {
        engine: engine.into(),
        method: method.into(),
        quantity: "fd".into(),
        metric: "forward".into(),
        params: format!("{{\"base\":\"{base}\",\"joints\":[{joints}]}}"),
        ..row().gated(0.0, Relation::Le, bound)
    };
    let blunt = |rows: &[Row]| -> Vec<(String, u64)> {
        let of_bounds = |condition: &Expectation| condition.what.starts_with("kinds of joint and base");
        gates.conditions(&suite(), rows, true).into_iter().filter(of_bounds).map(|condition| (condition.what, condition.found)).collect()
    };
    let found = |rows: &[Row]| blunt(rows).into_iter().map(|(_, found)| found).collect::<Vec<_>>();
    assert_eq!(found(&[bounded("crane", "aba", "\"revolute\"", "fixed", 1e-12)]), [0]);
    assert_eq!(found(&[bounded("crane", "aba", "\"revolute\"", "fixed", 1.1e-12)]), [1]);
    // For each joint, base and method, the sharpest of several robots counts. Our own kernels are included; an external engine is not.
    let rows = [
        bounded("crane", "aba", "\"revolute\",\"planar\"", "fixed", 1e-9),
        bounded("crane", "aba", "\"revolute\"", "fixed", 1e-13),
        bounded("crane", "aba", "\"revolute\"", "free", 1e-9),
        bounded("crane", "lu", "\"revolute\"", "fixed", 1e-13),
        bounded("featherbench", "aba", "\"revolute\"", "fixed", 1e-9),
        bounded("external", "aba", "\"revolute\"", "fixed", 1e-9),
    ];
    let told = blunt(&rows);
    assert_eq!(found(&rows), [2, 0, 1], "{told:?}");
    assert!(told[0].0.contains("crane aba") && told[2].0.contains("featherbench aba"), "{told:?}");
    // Other studies, quantities and measures have no such bounds.
    for other in [
        Row { study: "accuracy".into(), ..bounded("crane", "aba", "\"revolute\"", "fixed", 1e-9) },
        Row { quantity: "id".into(), ..bounded("crane", "aba", "\"revolute\"", "fixed", 1e-9) },
        Row { metric: "backward".into(), ..bounded("crane", "aba", "\"revolute\"", "fixed", 1e-9) },
    ] {
        assert_eq!(blunt(&[other]), []);
    }
}

/// A fault for each kind of gate: it fires, and names the crane. Those of engines and of files are planted in the tests of the command.
#[test]
fn every_kind_of_gate_fires_and_names_its_culprit() {
    let mean = "[[mean]]\nstudy = \"agreement\"\nmetric = \"over_best\"\nquantities = [\"id\"]\nmean = 1.5\nbound = 3.0\nreason = \"r\"\n";
    let engines = Engines::parse(ENGINES, Path::new("engines.toml")).unwrap();
    let plain = Gates::parse(&format!("{GATES}{mean}"), Path::new("gates.toml")).unwrap();
    let plain = plain.with_deviations(crane(DEVIATIONS)).with_lacks(engines.lacks());
    let sized = plain.clone().with_ranges([(RangeKey::of(&row()), range(8e-14, 9e-14, 20, 20))].into_iter().collect(), Path::new("here"));
    let sized = sized.unwrap();
    let pass = || row().gated(1e-15, Relation::Le, 1e-14);
    let lacking = Row { quantity: "com".into(), states: "zero".into(), ..on("hoist-9") };
    let blunt =
        Row { quantity: "fd".into(), metric: "forward".into(), params: "{\"base\":\"free\",\"joints\":[\"planar\"]}".into(), ..row() };
    let far = Row { metric: "over_best".into(), engine: "featherbench".into(), ..row() };
    let counts = Counts::parse("suite,study,engine,quantity,cells,rows\nyard,agreement,crane,id,1,2\n", Path::new("counts.csv")).unwrap();
    let run = RunInfo { suite: "yard".into(), studies: vec!["agreement".into()], ..RunInfo::default() };
    let of = |gates: &Gates, rows: &[Row]| {
        let mut all = gates.conditions(&suite(), rows, true);
        all.extend(counts.conditions(&run, &["crane".to_owned()], rows));
        all
    };
    let planted = [
        (GateKind::Bound, of(&plain, &[row().gated(1.0, Relation::Le, 1e-14)])),
        (GateKind::Answer, of(&plain, &[row().without_value(Verdict::Error, "NaN")])),
        (GateKind::Unlisted, of(&plain, &[row().without_value(Verdict::Skip, "no")])),
        (GateKind::Rows, of(&plain, &[])),
        (GateKind::Seen, of(&sized, &[pass()])),
        (GateKind::Size, of(&sized, &[sized.judge(row(), 2e-14, 1.0)])),
        (GateKind::Lack, of(&plain, &[lacking.gated(1e-15, Relation::Le, 1e-14)])),
        (GateKind::Sharp, of(&plain, &[blunt.gated(0.0, Relation::Le, 1.0)])),
        (GateKind::Mean, of(&plain, &[far.informed(4.0)])),
        (GateKind::Counts, of(&plain, &[pass()])),
    ];
    for (kind, conditions) in &planted {
        let fired = conditions.iter().find(|condition| condition.kind == *kind && !condition.is_met());
        let culprit = &fired.unwrap_or_else(|| panic!("{kind} did not fire: {conditions:?}")).culprit;
        let due = match kind {
            GateKind::Rows => "",
            GateKind::Mean => "featherbench",
            _ => "crane",
        };
        assert_eq!(culprit.engine, due, "{kind}");
    }
    let never = GateKind::ALL.iter().filter(|kind| !planted.iter().any(|(planted, _)| planted == *kind)).collect::<Vec<_>>();
    assert_eq!(never, [&GateKind::Engine, &GateKind::Import, &GateKind::Other]);
}

/// A gate behind another one that matches all of its rows never fires, and is found.
#[test]
fn a_hidden_gate_is_found() {
    let silent = |text: &str| {
        let gates = Gates::parse(text, Path::new("gates.toml")).unwrap();
        gates.planted().iter().filter(|planted| !planted.fired).map(|planted| planted.gate.reason.clone()).collect::<Vec<_>>()
    };
    assert_eq!(silent(GATES), [""; 0]);
    let hidden = "[[gate]]\nstudy = \"agreement\"\nquantities = [\"id\"]\nmetric = \"scaled\"\nrobots = [\"hoist-*\"]\nbound = 1e-9\nreason = \"hidden\"\n";
    assert_eq!(silent(&format!("{GATES}{hidden}")), ["hidden"]);
}
