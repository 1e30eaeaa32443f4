//! The report's structure: the page has what it must have, nothing in it can become markup or use the network, and its data can be parsed.

use std::collections::BTreeMap;
use std::fs;

use featherbench_results::{Expectation, GateKind, Relation, Row, RunInfo, Verdict};

use super::written::Written;
use super::{made_up, report};

fn demo() -> (RunInfo, Vec<Row>, Written) {
    let run = made_up::run_info();
    let records = made_up::rows(&run);
    let written = report(&run, &records);
    (run, records, written)
}

#[test]
fn the_page_has_its_sections_and_stays_small() {
    let (_, records, written) = demo();
    assert!(records.len() > 10_000);
    let order = [
        "verdict",
        "pairs",
        "agreement",
        "depth",
        "accuracy",
        "conditioning",
        "time",
        "speed",
        "tradeoff",
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
fn a_run_of_fifty_thousand_rows_has_a_small_first_page() {
    let (run, rows) = made_up::large(50_000);
    assert!(rows.len() >= 50_000);
    let folder = tempfile::tempdir().unwrap();
    let paths = featherbench_report::write(&run, &rows, &featherbench_registry::sections(&run, &rows), folder.path()).unwrap();
    let page = fs::read_to_string(&paths.index).unwrap();
    // A browser lays out so many in a fraction of a second.
    assert!(made_up::nodes(&page) <= 3000, "{} nodes", made_up::nodes(&page));
    let of_summary = paths.files.iter().filter(|path| !made_up::holds_rows(path.file_name().unwrap().to_str().unwrap()));
    let bytes: u64 = of_summary.map(|path| fs::metadata(path).unwrap().len()).sum();
    assert!(bytes <= 15 << 20, "{bytes} bytes without the rows");
    // Nothing is lost: each row is in a chunk, and what is left out has a script and a page of its own.
    let left_out: Vec<&str> = page.split("data-part=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(left_out.contains(&"agreement") && left_out.contains(&"findings"), "{left_out:?}");
    for name in left_out {
        let own = fs::read_to_string(folder.path().join(format!("sections/{name}.html"))).unwrap();
        assert!(page.contains(&format!("href=\"sections/{name}.html\"")) && own.contains("<base href=\"../index.html\">"), "{name}");
        let script = fs::read_to_string(folder.path().join(format!("sections/{name}.js"))).unwrap();
        assert!(script.starts_with(&format!("featherbench.chunk(\"part-{name}\",\"")), "{name}");
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
    let start = verdict.find(&format!("Among {} rows: ", grouped(records.len()))).unwrap();
    let told = &verdict[start..start + verdict[start..].find("</p>").unwrap()];
    for &word in Verdict::ALL {
        let words = format!("{} {}", grouped(count(word)), featherbench_report::labels::verdict(word));
        assert_eq!(told.contains(&words), count(word) > 0, "{words}: {told}");
    }
    assert!(verdict.contains("class=\"verdict bad\""));
    for condition in &run.expected {
        assert!(written.section("conditions").contains(&condition.what));
    }
    let cells = records.iter().filter(|row| row.study == "agreement" && row.metric != "pairwise");
    let cells: std::collections::BTreeSet<_> = cells.map(|row| (&row.robot, &row.engine, &row.quantity)).collect();
    // Each engine has its quantities on a page of its own; the section has the worst of each robot and engine.
    let filled = |page: &str| page.matches("<td").count() - page.matches("<td></td>").count();
    let engines: std::collections::BTreeSet<_> = cells.iter().map(|&(_, engine, _)| engine).collect();
    let of_engines: usize = engines.iter().map(|engine| filled(&written.section(&format!("agreement-{engine}")))).sum();
    assert_eq!(of_engines, cells.len());
    let pairs: std::collections::BTreeSet<_> = cells.iter().map(|&(robot, engine, _)| (robot, engine)).collect();
    assert_eq!(filled(&written.section("agreement")), pairs.len());
}

#[test]
fn engines_robots_and_studies_have_pages() {
    let (run, records, written) = demo();
    let engine = written.text("engines/pinocchio.html");
    assert!(engine.contains("<h1>pinocchio: ") && engine.contains("href=\"robots/panda.html\""), "{engine}");
    // Its findings stand as on the first page, from the gravest.
    let own = featherbench_report::Findings::of(&run, &records);
    let own: Vec<_> = own.found.iter().filter(|found| found.culprit.engine == "pinocchio").collect();
    assert!(!own.is_empty() && engine.matches("class=\"level ").count() == own.len().min(30));
    let cells: std::collections::BTreeSet<_> =
        records.iter().filter(|row| row.engine == "pinocchio" && !row.robot.is_empty()).map(|row| (&row.robot, &row.quantity)).collect();
    assert_eq!(engine.matches("<td").count() - engine.matches("<td></td>").count(), cells.len());

    let robot = written.text("robots/panda.html");
    assert!(
        robot.contains("<h1>panda: ") && robot.contains("href=\"engines/drake.html\"") && robot.contains("9 degrees of freedom"),
        "{robot}"
    );
    let study = written.text("studies/timing.html");
    assert!(study.contains("<h1>timing: ") && study.contains("href=\"robots/panda.html\""));
    // A study's page leads to its sections, and says what they add to the verdict.
    assert!(study.contains("href=\"#time\"") && study.contains("href=\"#speed\"") && study.contains("id=\"speed-verdict\""));
    assert!(written.text("studies/agreement.html").contains("href=\"#agreement\""));
    // Every link of the first page and of the pages leads to a file.
    for page in ["index.html", "engines/pinocchio.html", "robots/panda.html", "studies/timing.html"] {
        let text = written.text(page);
        let links = text.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
        let files: Vec<&str> =
            links.filter(|link| ["engines/", "robots/", "studies/", "sections/"].iter().any(|at| link.starts_with(at))).collect();
        assert!(files.len() > 3, "{page}: {files:?}");
        for link in files {
            let file = link.split('#').next().unwrap();
            assert!(written.folder.path().join(file).is_file(), "{page} links to {link}");
        }
    }
}

#[test]
fn every_row_lies_in_the_chunks_that_it_belongs_to() {
    let (_, records, written) = demo();
    let mut by_chunk = BTreeMap::new();
    for name in written.chunk_names().into_iter().filter(|name| !["overview", "figures", "figure-data"].contains(&&**name)) {
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
    let times = by_chunk.remove("times").unwrap();
    assert_eq!(times.iter().collect::<Vec<_>>(), records.iter().filter(|row| !row.cache.is_empty()).collect::<Vec<_>>());
    assert!(!times.is_empty());
    assert_eq!(by_chunk.values().map(Vec::len).sum::<usize>(), records.len());
    for (name, rows) in by_chunk.iter().filter(|(name, _)| name.starts_with("robot-")) {
        assert!(rows.iter().all(|row| row.robot == rows[0].robot), "{name} mixes models");
    }
    // Every mark leads to rows, and marks of times have their intervals.
    for (section, name) in [("depth", "depth-plot"), ("time", "time-plot")] {
        let text = written.section(section);
        assert!(text.contains(&format!("data-name=\"{name}\"")), "{section}");
        let marks = text.matches("<title>").count() - text.matches("role=\"img\"").count();
        // The gates of the drawing of depth are no rows of their own.
        assert_eq!(text.matches("data-rows=").count() + text.matches("<title>gate").count(), marks, "{section}");
    }
    assert!(written.section("depth").contains("\nquantity=fd") && written.section("time").contains("class=\"interval\""));
}

#[test]
fn names_stay_text() {
    let (_, _, written) = demo();
    assert!(written.index.contains("robot &quot;&lt;/script&gt;&lt;script&gt;"));
    assert!(!written.index.contains("<script>alert"));
    // The page's own scripts are the only ones, and none is inline.
    assert_eq!(written.index.matches("<script").count(), 2);
    assert_eq!(written.index.matches("</script>").count(), 2);
    for name in written.chunk_names() {
        let text = written.text(&format!("data/{name}.js"));
        assert!(!text.contains(['<', '>', '\u{2028}', '\u{2029}']), "{name}");
        assert_eq!(text.matches('\n').count(), 1, "{name}");
    }
    let models = written.data("overview")["robots"].clone();
    assert!(models.as_array().unwrap().iter().any(|model| model["name"] == made_up::HOSTILE));
}

#[test]
fn every_text_of_a_run_is_escaped() {
    let evil = "</script><img src=x onerror=alert(1)>\u{2028}\"'&";
    let mut run = made_up::run_info();
    run.suite = evil.into();
    run.command = evil.into();
    run.host.cpu = evil.into();
    run.expected[0].what = evil.into();
    run.engines[1].reason = evil.into();
    run.engines[1].build.insert(evil.into(), evil.into());
    run.robots[0].licence = evil.into();
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
    let written = report(&run, &rows);
    assert!(!written.index.contains("<img"));
    assert!(written.index.contains("&lt;img"));
    let folders = ["engines", "robots", "studies", "sections"].map(|folder| fs::read_dir(written.folder.path().join(folder)).unwrap());
    for file in folders.into_iter().flatten().map(|entry| entry.unwrap().path()) {
        let text = fs::read_to_string(&file).unwrap();
        assert!(!text.contains("<img") && !text.contains("<script>"), "{}", file.display());
    }
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
    // One script makes the page answer. No other script is beside the data, and it is short.
    let entries = fs::read_dir(written.folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(entries.filter(|name| name.ends_with(".js")).collect::<Vec<_>>(), ["app.js"]);
    let script = written.text("app.js");
    assert!(script.contains("featherbench.open = ") && script.len() < 100_000, "{} bytes", script.len());
}

#[test]
fn a_report_is_a_pure_function() {
    let run = made_up::run_info();
    let records: Vec<Row> = made_up::rows(&run).into_iter().step_by(7).collect();
    let (one, other) = (report(&run, &records), report(&run, &records));
    let names = one.chunk_names().into_iter().map(|name| format!("data/{name}.js")).chain(["index.html".into()]);
    for name in names {
        assert_eq!(one.text(&name), other.text(&name), "{name}");
    }
}

#[test]
fn an_empty_run_says_so() {
    let written = report(&RunInfo::default(), &[]);
    assert!(written.section("verdict").contains("Nothing judged"));
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
            unit: "1".into(),
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
    let engines = RunInfo { engines: made_up::run_info().engines, ..RunInfo::default() };
    let written = report(&engines, &rows);
    let verdict = written.section("verdict");
    assert!(verdict.contains("<h1>mujoco, inverse dynamics: 3.0 digits lost beyond rounding against featherbench (1e-11 where 1e-14 is allowed), in 1 row on 1 robot</h1>"), "{verdict}");
    assert!(
        verdict.contains("mujoco and drake agree with featherbench on") && verdict.contains("(2e-15)") && verdict.contains("over 2 robots")
    );
    assert!(verdict.contains("drake agrees with featherbench on") && verdict.contains("over 1 robot."));
    assert!(
        verdict.contains("<b><a href=\"engines/mujoco.html\">mujoco</a>, inverse dynamics</b>: ")
            && verdict.contains("where 1e-14 is allowed")
    );
    assert!(written.section("pairs").contains("1e-11"));
    assert!(written.section("unpassed").contains("1e-11 is not at most 1e-14"));

    let good = report(&RunInfo::default(), &rows[..5]);
    assert!(good.section("verdict").contains("<h1>No deviations, "));
    let expected = Expectation::new(GateKind::Counts, "id".into(), 2, 1).because("one is missing".into());
    let short = report(&RunInfo { expected: vec![expected], ..RunInfo::default() }, &rows[..5]);
    assert!(short.section("verdict").contains("verdict bad") && short.section("verdict").contains("one is missing"));
}
