//! The report's structure: the page has what it must have, nothing in it can become markup or use the network, and its data can be parsed.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use featherbench_results::{Relation, Row, RunInfo, Verdict};
use written::Written;

use crate::support;
use crate::written;

fn demo() -> (RunInfo, Vec<Row>, Written) {
    let run = support::run_info();
    let records = support::records(&run);
    let written = Written::of(&run, &records);
    (run, records, written)
}

#[test]
fn the_page_has_its_sections_and_stays_small() {
    let (_, records, written) = demo();
    assert!(records.len() > 10_000);
    let order = [
        "verdict",
        "agreement",
        "accuracy",
        "depth",
        "time",
        "speed",
        "tradeoff",
        "conditioning",
        "pairs",
        "conventions",
        "provenance",
        "method",
        "unpassed",
    ];
    let places: Vec<usize> = order.iter().map(|id| written.index.find(&format!("<section id=\"{id}\"")).unwrap()).collect();
    assert!(places.is_sorted(), "{places:?}");
    for id in order {
        assert!(written.index.contains(&format!("href=\"#{id}\"")), "the navigation lacks {id}");
    }
    assert!(written.index.len() < 1_000_000, "{} bytes", written.index.len());
    assert!(written.index.starts_with("<!DOCTYPE html><html lang=\"en\">"));
    for link in ["rows.csv", "run.json", "schema.json"] {
        assert!(written.index.contains(&format!("href=\"{link}\"")), "{link} is not linked");
    }
}

#[test]
fn counts_on_the_page_are_those_of_the_records() {
    let (run, records, written) = demo();
    let count = |verdict| records.iter().filter(|row| row.verdict == verdict).count();
    let grouped = |number: usize| match number {
        0..1000 => number.to_string(),
        _ => format!("{}\u{202f}{:03}", number / 1000, number % 1000),
    };
    let verdict = written.section("verdict");
    for &word in Verdict::ALL {
        let tile = verdict.split(&format!("class=\"tile {word}")).nth(1).unwrap_or_else(|| panic!("no tile for {word}"));
        assert!(tile[..200].contains(&format!("<b>{}</b>", grouped(count(word)))), "{word}: {}", &tile[..200]);
    }
    assert!(verdict.contains("class=\"verdict bad\""));
    for condition in &run.expected {
        assert!(verdict.contains(&condition.what));
    }
    let cells = records.iter().filter(|row| row.study == "agreement" && row.metric != "pairwise");
    let cells: std::collections::BTreeSet<_> = cells.map(|row| (&row.robot, &row.engine, &row.quantity)).collect();
    assert_eq!(written.data("overview")["cells"].as_array().unwrap().len(), cells.len());
    assert_eq!(
        written.section("agreement").matches("<td").count()
            - written.section("agreement").matches("<td></td>").count()
            - written.section("agreement").matches("<td class=\"first\"></td>").count(),
        cells.len()
    );
}

#[test]
fn every_row_lies_in_one_chunk_and_chunks_parse() {
    let (_, records, written) = demo();
    let mut by_chunk = BTreeMap::new();
    for name in written.chunk_names().into_iter().filter(|name| name != "overview" && name != "figures") {
        let data = written.data(&name);
        let columns: Vec<&str> = data["columns"].as_array().unwrap().iter().map(|column| column.as_str().unwrap()).collect();
        assert_eq!(columns, featherbench_results::COLUMNS.map(|column| column.name));
        let rows: Vec<Row> = data["rows"]
            .as_array()
            .unwrap()
            .iter()
            .map(|row| {
                let fields: serde_json::Map<_, _> =
                    columns.iter().map(|&name| name.to_owned()).zip(row.as_array().unwrap().clone()).collect();
                serde_json::from_value(fields.into()).unwrap()
            })
            .collect();
        by_chunk.insert(name, rows);
    }
    let unpassed = by_chunk.remove("unpassed").unwrap();
    let expected: Vec<&Row> = records.iter().filter(|row| !matches!(row.verdict, Verdict::Pass | Verdict::Info)).collect();
    assert_eq!(unpassed.iter().collect::<Vec<_>>(), expected);
    assert_eq!(by_chunk.values().map(Vec::len).sum::<usize>(), records.len());
    for (name, rows) in by_chunk.iter().filter(|(name, _)| name.starts_with("model-")) {
        assert!(rows.iter().all(|row| row.robot == rows[0].robot), "{name} mixes models");
    }
    let figures = written.data("figures");
    assert!(figures["errors"].as_array().unwrap().iter().any(|plot| plot["quantity"] == "fd" && plot["metric"] == "backward"));
    assert!(figures["times"].as_array().unwrap().iter().all(|line| line["points"][0]["p90"].is_f64()));
}

#[test]
fn estimates_are_marked() {
    let row = |engine: &str, metric: &str, value: f64, estimated: bool, valid: bool| {
        let row = Row {
            study: "timing".into(),
            engine: engine.into(),
            robot: "arm".into(),
            method: "rnea".into(),
            quantity: "id".into(),
            cache: "stream".into(),
            metric: metric.into(),
            nv: Some(7),
            estimated,
            ..Row::default()
        }
        .informed(value);
        if valid { row } else { row.invalid("noise") }
    };
    let rows = [
        row("drake", "ratio", 3.25, true, true),
        row("drake", "ns_per_call", 6500.0, true, true),
        row("dart", "ratio", 4.25, true, false),
        row("pinocchio", "ratio", 1.25, false, true),
        row("pinocchio", "ns_per_call", 2500.0, false, false),
    ];
    let written = Written::of(&RunInfo::default(), &rows);
    let section = written.section("speed");
    // In the table of robots and in that of means; an invalid one is not in the mean.
    for (ratio, times) in [("≈\u{202f}3.250", 6), ("≈\u{202f}4.250", 3), ("≈\u{202f}1.250", 0), ("1.250", 6)] {
        assert_eq!(section.matches(ratio).count(), times, "{ratio}: {section}");
    }
    let note = section.split("id=\"speed-estimates\"").nth(1).unwrap();
    assert!(note[..200].contains("dart and drake are called through Python") && !note[..200].contains("pinocchio"), "{note}");
    let flags = |values: &serde_json::Value| -> Vec<bool> {
        values.as_array().unwrap().iter().map(|value| value["estimated"].as_bool().unwrap()).collect()
    };
    let figures = written.data("figures");
    assert_eq!(flags(&figures["speed"]["ratios"]), [true, true, false]);
    let points: Vec<bool> = figures["times"].as_array().unwrap().iter().flat_map(|line| flags(&line["points"])).collect();
    assert_eq!(points.iter().filter(|&&estimate| estimate).count(), 1, "{points:?}");
}

#[test]
fn ratios_have_intervals_a_mean_and_a_least() {
    let timing = |engine: &str, model: &str, metric: &str, value: f64, spread: f64| {
        let row = Row {
            study: "timing".into(),
            engine: engine.into(),
            robot: model.into(),
            method: "rnea".into(),
            quantity: "id".into(),
            cache: "stream".into(),
            metric: metric.into(),
            reference: "featherbench rnea".into(),
            bodies: Some(7),
            nv: Some(7),
            ..Row::default()
        };
        row.measured(value, (1.0 - spread) * value, (1.0 + spread) * value)
    };
    let machine = |metric: &str, value: f64| Row {
        quantity: "machine".into(),
        robot: String::new(),
        ..timing("featherbench", "", metric, value, 0.0)
    };
    let mut rows =
        vec![machine("fma_per_ns", 56.8), machine("fma_per_ns_per_lane", 7.1), timing("featherbench", "a", "ns_per_call", 280.0, 0.0)];
    for (model, ratio) in [("a", 2.0), ("b", 8.0)] {
        rows.push(timing("pinocchio", model, "ratio", ratio, 0.1));
    }
    rows.push(timing("pinocchio", "c", "ratio", 0.5, 0.1).invalid("noise"));
    rows.push(timing("featherbench", "a", "control", 1.001, 0.003));
    let written = Written::of(&RunInfo::default(), &rows);
    let section = written.section("speed");
    // √(2·8) over the two valid ones, the smallest on a; the invalid one is listed and not in the mean.
    assert!(section.contains("4.000") && section.contains("<td class=\"number\">2.000</td><td>a</td>"), "{section}");
    assert!(section.contains("1.800") && section.contains("2.200") && section.contains("0.500"));
    assert!(section.contains("1 of 1 such A/A control</b>") && section.contains("noise") && section.contains("(1 row)"));
    // 142 operations at 7.1 per nanosecond are 20 ns; 280 ns for seven joints are twice as much.
    assert!(section.contains("<td class=\"number\">40</td><td class=\"number\">20</td><td class=\"number\">2.000</td>"), "{section}");
    assert!(section.contains("timing.jsonl"));
    let speed = &written.data("figures")["speed"];
    assert_eq!(speed["ratios"].as_array().unwrap().len(), 3);
    assert_eq!((&speed["ratios"][2]["valid"], &speed["ratios"][0]["low"]), (&false.into(), &1.8.into()));

    assert!(!section.contains('≈') && !section.contains("id=\"speed-estimates\""), "nothing is estimated");
    let none = Written::of(&RunInfo::default(), &rows[2..3]);
    assert!(!none.index.contains("<section id=\"speed\"") && !none.index.contains("href=\"#speed\""));
}

/// No kernel is faster than the machine. If a time is below its limit, or the peak is not valid, no limit is shown.
#[test]
fn a_limit_that_is_none_is_not_shown() {
    let row = |quantity: &str, metric: &str, value: f64| {
        let row = Row {
            study: "timing".into(),
            engine: "featherbench".into(),
            quantity: quantity.into(),
            metric: metric.into(),
            ..Row::default()
        };
        row.informed(value)
    };
    let time = |model: &str, ns: f64| {
        let row = row("id", "ns_per_call", ns);
        Row { robot: model.into(), method: "rnea".into(), cache: "stream".into(), bodies: Some(7), nv: Some(7), ..row }
    };
    let section = |peak: &str, lane: f64, ns: [f64; 2]| {
        let machine = |metric, value| Row { valid: peak.is_empty(), reason: peak.into(), ..row("machine", metric, value) };
        let rows = [machine("fma_per_ns", 8.0 * lane), machine("fma_per_ns_per_lane", lane), time("a", ns[0]), time("b", ns[1])];
        Written::of(&RunInfo::default(), &rows).section("speed").to_owned()
    };
    let (table, none) = ("times the limit", "id=\"speed-no-limits\"");
    // 142 operations for each of seven joints at 7.1 per nanosecond: 140 ns.
    let good = section("", 7.1, [280.0, 140.0]);
    assert!(good.contains(table) && !good.contains(none), "{good}");
    let fast = section("", 7.1, [280.0, 126.0]);
    assert!(
        !fast.contains(table) && fast.contains("1 of 2 times are below their limits (featherbench rnea on b takes 0.90 times its limit)"),
        "{fast}"
    );
    // Measured when the compiler did not use vectors.
    let slow = section("", 0.325, [280.0, 140.0]);
    assert!(
        !slow.contains(table) && slow.contains("2 of 2 times are below their limits (featherbench rnea on b takes 0.05 times its limit)"),
        "{slow}"
    );
    let told = section("vectors make too little", 7.1, [280.0, 140.0]);
    assert!(!told.contains(table) && told.contains("The peak does not count: vectors make too little."), "{told}");
}

#[test]
fn names_stay_text() {
    let (_, _, written) = demo();
    assert!(written.index.contains("robot &quot;&lt;/script&gt;&lt;script&gt;"));
    assert!(!written.index.contains("<script>alert"));
    // The page's own scripts are the only ones, and none is inline.
    assert_eq!(written.index.matches("<script").count(), 3);
    assert_eq!(written.index.matches("</script>").count(), 3);
    for name in written.chunk_names() {
        let text = written.text(&format!("data/{name}.js"));
        assert!(!text.contains(['<', '>', '\u{2028}', '\u{2029}']), "{name}");
        assert_eq!(text.matches('\n').count(), 1, "{name}");
    }
    let models = written.data("overview")["models"].clone();
    assert!(models.as_array().unwrap().iter().any(|model| model["name"] == support::HOSTILE));
}

#[test]
fn every_text_of_a_run_is_escaped() {
    let evil = "</script><img src=x onerror=alert(1)>\u{2028}\"'&";
    let mut run = support::run_info();
    run.suite = evil.into();
    run.command = evil.into();
    run.host.cpu = evil.into();
    run.expected[0].what = evil.into();
    run.engines[1].reason = evil.into();
    run.engines[1].build.insert(evil.into(), evil.into());
    run.models[0].licence = evil.into();
    let row = || Row {
        robot: "m".into(),
        study: evil.into(),
        engine: evil.into(),
        quantity: evil.into(),
        metric: evil.into(),
        family: evil.into(),
        ..Row::default()
    };
    let rows = [
        row().without_value(Verdict::Error, evil),
        Row { study: "agreement".into(), reference: evil.into(), ..row() }.gated(2.0, Relation::Le, 1.0),
        Row { study: "timing".into(), metric: "ns_per_call".into(), states: evil.into(), nv: Some(3), ..row() }.informed(3.0),
    ];
    let written = Written::of(&run, &rows);
    assert!(!written.index.contains("<img"));
    assert!(written.index.contains("&lt;img"));
    for name in written.chunk_names() {
        assert!(!written.text(&format!("data/{name}.js")).contains('<'));
        written.data(&name);
    }
}

#[test]
fn nothing_reaches_the_network() {
    let (_, _, written) = demo();
    for name in ["index.html", "style.css", "app.js"] {
        let text = written.text(name);
        for word in ["http://", "https://", "//cdn", "fetch(", "XMLHttpRequest", "@import", "WebSocket", "sendBeacon"] {
            assert!(!text.contains(word), "{name} contains {word}");
        }
    }
    // One script draws everything. No other script is beside the data, and it is short.
    let entries = fs::read_dir(written.folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(entries.filter(|name| name.ends_with(".js")).collect::<Vec<_>>(), ["app.js"]);
    let script = written.text("app.js");
    assert!(script.contains("featherbench.chart = ") && script.len() < 150_000, "{} bytes", script.len());
}

#[test]
fn a_report_is_a_pure_function() {
    let run = support::run_info();
    let records: Vec<Row> = support::records(&run).into_iter().step_by(7).collect();
    let (one, other) = (Written::of(&run, &records), Written::of(&run, &records));
    let names = one.chunk_names().into_iter().map(|name| format!("data/{name}.js")).chain(["index.html".into()]);
    for name in names {
        assert_eq!(one.text(&name), other.text(&name), "{name}");
    }
}

#[test]
fn an_empty_run_says_so() {
    let written = Written::of(&RunInfo::default(), &[]);
    assert!(written.section("verdict").contains("Nothing was judged"));
    for (id, words) in [
        ("agreement", "no rows of agreement"),
        ("depth", "no errors"),
        ("time", "no times"),
        ("pairs", "no rows that compare"),
        ("unpassed", "Every judged row passed"),
    ] {
        assert!(written.section(id).contains(words), "{id}");
    }
}

#[test]
fn sentences_tell_who_agrees_and_who_does_not() {
    let row = |engine: &str, model: &str, quantity: &str, value| {
        Row {
            study: "agreement".into(),
            engine: engine.into(),
            robot: model.into(),
            quantity: quantity.into(),
            metric: "scaled".into(),
            reference: "featherbench".into(),
            ..Row::default()
        }
        .gated(value, Relation::Le, 1e-14)
    };
    let rows = [
        row("drake", "a", "mass_matrix", 1e-15),
        row("mujoco", "a", "mass_matrix", 2e-15),
        row("drake", "b", "mass_matrix", 0.0),
        row("mujoco", "b", "mass_matrix", 0.0),
        row("drake", "a", "id", 1e-16),
        row("mujoco", "a", "id", 1e-11),
    ];
    let engines = RunInfo { engines: support::run_info().engines, ..RunInfo::default() };
    let written = Written::of(&engines, &rows);
    let verdict = written.section("verdict");
    assert!(verdict.contains("1 row of 6 outside their gates"), "{verdict}");
    assert!(
        verdict.contains("mujoco and drake agree with featherbench on") && verdict.contains("(2e-15)") && verdict.contains("over 2 models")
    );
    assert!(verdict.contains("drake agrees with featherbench on") && verdict.contains("over 1 model."));
    assert!(verdict.contains("inverse dynamics: fails 1 of 1 row against featherbench") && verdict.contains("(−3.0 decades)"));
    assert!(written.section("pairs").contains("1e-11"));
    assert!(written.section("unpassed").contains("1e-11 is not at most 1e-14"));

    let good = Written::of(&RunInfo::default(), &rows[..5]);
    assert!(good.section("verdict").contains("All 5 judged rows are inside their gates"));
    let expected = featherbench_results::Expectation {
        what: "id".into(),
        expected: 2,
        found: 1,
        verdict: Verdict::Fail,
        reason: "one is missing".into(),
    };
    let short = Written::of(&RunInfo { expected: vec![expected], ..RunInfo::default() }, &rows[..5]);
    assert!(short.section("verdict").contains("verdict bad") && short.section("verdict").contains("1 expectation not met"));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("blocked");
    fs::write(&blocked, "").unwrap();
    let error = featherbench_report::write(&RunInfo::default(), &[], &blocked).unwrap_err().to_string();
    assert!(error.contains(Path::new("blocked").to_str().unwrap()), "{error}");
}

#[test]
fn conventions_are_listed_by_engine_with_their_tests() {
    let (run, _, written) = demo();
    let section = written.section("conventions");
    for row in &run.conventions {
        for text in [&row.engine, &row.ours, &row.test] {
            assert!(section.contains(text.as_str()), "{text} is not in the section");
        }
    }
    assert!(section.contains("<code>file.py: function</code>, twice"), "backticks mark code");
    assert!(section.contains("screw &lt;pitch&gt;") && !section.contains("screw <pitch>"), "text cannot become markup");
    assert_eq!(section.matches("<h3>").count(), 2, "one table for each engine");
    let nothing = Written::of(&RunInfo::default(), &[]);
    assert!(nothing.section("conventions").contains("names no conventions"));
}
