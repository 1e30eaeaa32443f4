//! The section on speed: intervals, means, estimates, and the machine's limit.

use featherbench_results::{Row, RunInfo};

use super::report;

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
    let written = report(&RunInfo::default(), &rows);
    let section = written.section("speed");
    // In the table of robots and in that of means; an invalid one is not in the mean.
    let tables = section.split("</svg>").last().unwrap();
    for (ratio, times) in [("≈\u{202f}3.250", 6), ("≈\u{202f}4.250", 3), ("≈\u{202f}1.250", 0), ("1.250", 6)] {
        assert_eq!(tables.matches(ratio).count(), times, "{ratio}: {section}");
    }
    let note = section.split("id=\"speed-estimates\"").nth(1).unwrap();
    assert!(note[..200].contains("dart and drake are called through Python") && !note[..200].contains("pinocchio"), "{note}");
    // Marks say it too: two of three ratios, and one of two times.
    assert_eq!((section.matches("class=\"mark\"").count(), section.matches("\nestimate").count()), (6, 2), "{section}");
    let times = written.section("time");
    assert_eq!(times.matches("\nestimate").count(), 1, "{times}");
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
    let written = report(&RunInfo::default(), &rows);
    let section = written.section("speed");
    // √(2·8) over the two valid ones, the smallest on a; the invalid one is listed and not in the mean.
    assert!(section.contains("4.000") && section.contains("<td class=\"number\">2.000</td><td>a</td>"), "{section}");
    assert!(section.contains("1.800") && section.contains("2.200") && section.contains("0.500"));
    assert!(section.contains("1 of 1 such A/A control</b>") && section.contains("noise") && section.contains("(1 row)"));
    // 142 operations at 57 per nanosecond are 2.5 ns; 280 ns for seven joints are sixteen times as much.
    assert!(section.contains("<td class=\"number\">40</td><td class=\"number\">2.5</td><td class=\"number\">16.0</td>"), "{section}");
    assert!(section.contains("timing.jsonl"));
    assert_eq!((section.matches("data-rows=").count(), section.matches("\ndoes not count").count()), (3, 1), "{section}");
    assert!(section.contains("\n[1.800, 2.200]"), "{section}");

    assert!(!section.contains('≈') && !section.contains("id=\"speed-estimates\""), "nothing is estimated");
    let none = report(&RunInfo::default(), &rows[2..3]);
    assert!(!none.index.contains("<section id=\"speed\"") && !none.index.contains("href=\"#speed\""));
}

/// The quantity that most stand side by side in is drawn first, whatever the order of the list.
#[test]
fn the_section_opens_where_most_are_compared() {
    let row = |engine: &str, quantity: &str| {
        let row = Row { study: "timing".into(), engine: engine.into(), robot: "arm".into(), cache: "stream".into(), ..Row::default() };
        Row { method: "usual".into(), quantity: quantity.into(), metric: "ratio".into(), nv: Some(7), ..row }.informed(2.0)
    };
    let opens = |rows: &[Row]| {
        let written = report(&RunInfo::default(), rows);
        let list = written.section("speed").split("id=\"speed-quantity\"").nth(1).unwrap().split("</select>").next().unwrap().to_owned();
        let chosen = list.split("<option ").find(|option| option.contains("selected")).unwrap();
        chosen.split('"').nth(1).unwrap().to_owned()
    };
    let rows = [row("drake", "bias"), row("drake", "fd"), row("dart", "fd"), row("drake", "id"), row("dart", "id")];
    assert_eq!(opens(&rows), "id", "the first of two");
    assert_eq!(opens(&rows[..3]), "fd");
    assert_eq!(opens(&rows[..2]), "bias");
}

/// The geometric mean and the least of each of our methods beside the best other, with the robots that do not count.
#[test]
fn ours_stand_beside_the_best_other() {
    let row = |quantity: &str, method: &str, robot: &str, reference: &str, ratio: f64| {
        Row {
            study: "timing".into(),
            engine: "featherbench".into(),
            robot: robot.into(),
            method: method.into(),
            precision: "f64".into(),
            quantity: quantity.into(),
            cache: "stream".into(),
            metric: "best_other".into(),
            reference: reference.into(),
            nv: Some(7),
            ..Row::default()
        }
        .measured(ratio, 0.9 * ratio, 1.1 * ratio)
    };
    let rows = [
        row("id", "rnea", "a", "pinocchio-clang rnea", 2.0),
        row("id", "rnea", "b", "mujoco-native rne", 8.0),
        row("id", "rnea", "c", "mujoco-native rne", 100.0).invalid("noise"),
        row("id", "batch", "a", "pinocchio-clang rnea", 13.5),
        row("fd", "aba", "a", "pinocchio-clang aba_local", 3.0).invalid("noise"),
    ];
    let written = report(&RunInfo::default(), &rows);
    let section = written.section("speed");
    let table = section.split("id=\"speed-best\"").nth(1).expect("the table").split("</table>").next().unwrap();
    let line =
        |method: &str| table.split("<tr>").find(|line| line.contains(method)).unwrap_or_else(|| panic!("{method}: {table}")).to_owned();
    let rnea = line("<td>rnea</td>");
    assert!(
        rnea.contains("<td class=\"number\">2</td><td class=\"number\">1</td><td class=\"number\">4.000</td>"),
        "two count, one is void: {rnea}"
    );
    assert!(rnea.contains("<td class=\"number\">2.000</td><td>a</td><td class=\"number\">8.000</td><td>b</td>"), "{rnea}");
    assert!(rnea.contains("mujoco-native 1, pinocchio-clang 1"), "{rnea}");
    assert!(line("<td>batch</td>").contains("13.5"));
    assert!(line("<td>aba</td>").contains("none of 1 robot counts"));
    assert!(!report(&RunInfo::default(), &rows[..0]).index.contains("speed-best"));
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
        report(&RunInfo::default(), &rows).section("speed").to_owned()
    };
    let (table, none) = ("times the limit", "id=\"speed-no-limits\"");
    // 142 operations for each of seven joints at 56.8 per nanosecond: 17.5 ns.
    let good = section("", 7.1, [35.0, 17.51]);
    assert!(good.contains(table) && !good.contains(none), "{good}");
    let fast = section("", 7.1, [35.0, 15.75]);
    assert!(
        !fast.contains(table) && fast.contains("1 of 2 times are below their limits (featherbench rnea on b takes 0.90 times its limit)"),
        "{fast}"
    );
    // Measured when the compiler did not use vectors.
    let slow = section("", 0.325, [35.0, 17.5]);
    assert!(
        !slow.contains(table) && slow.contains("2 of 2 times are below their limits (featherbench rnea on b takes 0.05 times its limit)"),
        "{slow}"
    );
    let told = section("vectors make too little", 7.1, [35.0, 17.51]);
    assert!(!told.contains(table) && told.contains("The peak does not count: vectors make too little."), "{told}");
}

/// The first page says who is fastest by what counts and is no estimate. It shows a median over robots for each engine and quantity. It
/// tells in one sentence what does not count.
#[test]
fn the_first_page_says_who_is_fastest() {
    let row = |engine: &str, robot: &str, method: &str, metric: &str, value: f64| {
        let row = Row {
            study: "timing".into(),
            engine: engine.into(),
            robot: robot.into(),
            method: method.into(),
            precision: "f64".into(),
            quantity: "id".into(),
            cache: "stream".into(),
            metric: metric.into(),
            reference: "featherbench rnea".into(),
            nv: Some(7),
            bodies: Some(7),
            ..Row::default()
        };
        row.measured(value, 0.9 * value, 1.1 * value)
    };
    let mut rows = vec![
        row("featherbench", "a", "refined", "ns_per_call", 90.0),
        row("featherbench", "a", "rnea", "ns_per_call", 100.0),
        row("featherbench", "b", "rnea", "ns_per_call", 200.0),
        row("featherbench", "c", "rnea", "ns_per_call", 300.0),
        row("featherbench", "d", "rnea", "ns_per_call", 400.0),
        // Two methods of one engine: the faster one speaks for it.
        row("pinocchio", "a", "slow", "ratio", 9.0),
        row("pinocchio", "a", "rnea", "ratio", 2.0),
        row("pinocchio", "b", "rnea", "ratio", 0.5),
        row("pinocchio", "c", "rnea", "ratio", 4.0),
        row("pinocchio", "d", "rnea", "ratio", 8.0).invalid("noise"),
        row("featherbench", "d", "rnea", "control", 1.5).invalid("noise"),
        Row { estimated: true, ..row("drake", "a", "inverse_dynamics", "ratio", 0.25) },
    ];
    let written = report(&RunInfo::default(), &rows);
    let verdict = written.section("verdict");
    assert!(
        verdict.contains(
            "Of 4 robots and quantities with times of others, 3 count: ours is the fastest for 2, within 2 % of the fastest other for 0, slower for 1"
        ),
        "{verdict}"
    );
    assert!(
        verdict.contains("2 of 12 rows on speed do not count, because the A/A control of their experiment is far from 1."),
        "{verdict}"
    );
    let unsteady: Vec<Row> =
        rows.iter().map(|row| if row.valid { row.clone() } else { Row { params: r#"{"fastest":2}"#.into(), ..row.clone() } }).collect();
    let told = report(&RunInfo::default(), &unsteady).section("verdict").to_owned();
    assert!(told.contains("2 of 12 rows on speed do not count, because the core was at its fastest in too few processes."), "{told}");
    let map = verdict.split("speed-map").nth(1).expect("the map").split("</table>").next().unwrap();
    // The median of 2, 0.5 and 4; the estimate is marked; a click opens the rows of all robots.
    assert!(map.contains(">2.00</button>") && map.contains("≈\u{202f}0.25</button>") && map.contains("data-chunk=\"times\""), "{map}");
    assert_eq!(written.data("times")["rows"].as_array().unwrap().len(), rows.len());
    let table = written.section("speed-by-robot");
    assert!(table.contains("100 ns [90, 110]") && !table.contains("90 ns ["), "our usual method, as the ratios are over it: {table}");
    assert!(table.contains("class=\"number void\">8.000 <small>[7.200, 8.800]</small>"), "what does not count is struck out: {table}");
    assert!(table.contains("class=\"number ahead3\">4.000"), "a map of times, coloured by the ratio: {table}");
    assert!(written.section("time").contains("id=\"time-first\"") && written.section("time").contains("ns ["));

    let estimate = rows.pop().unwrap();
    rows.truncate(5);
    let alone = report(&RunInfo::default(), &rows);
    assert!(alone.section("verdict").contains("This run timed featherbench, and no other engine; the table of engines has"));
    rows.push(estimate);
    let estimated = report(&RunInfo::default(), &rows);
    assert!(estimated.section("verdict").contains("This run timed featherbench, and others by estimates alone; the table of engines has"));
    assert!(!report(&RunInfo::default(), &[]).index.contains("speed-verdict"));
}

/// At the end of a run: a line for each quantity with our fastest method, and the batch beside it.
#[test]
fn the_best_other_is_a_table_in_the_terminal() {
    let row = |method: &str, robot: &str, ratio: f64| {
        let row = Row {
            study: "timing".into(),
            engine: "featherbench".into(),
            robot: robot.into(),
            method: method.into(),
            precision: "f64".into(),
            quantity: "fd".into(),
            cache: "stream".into(),
            metric: "best_other".into(),
            reference: "pinocchio aba".into(),
            ..Row::default()
        };
        row.measured(ratio, ratio, ratio)
    };
    let rows = [row("aba", "a", 2.0), row("aba", "b", 8.0), row("refined", "a", 1.5), row("batch", "a", 20.0)];
    let lines: Vec<String> =
        featherbench_registry::sections(&RunInfo::default(), &rows).into_iter().flat_map(|section| section.lines).collect();
    let at = lines.iter().position(|line| line.starts_with("the best other over ours")).expect("the table");
    let words: Vec<&str> = lines[at + 1].split_whitespace().collect();
    assert_eq!(words, ["forward", "dynamics", "aba", "4.000", "2.000", "20.0"], "{lines:?}");
    assert_eq!(lines.len(), at + 2, "one line for one quantity: {lines:?}");
}
