//! The ranking: what each number is of, and that the page and the terminal have the same.

use featherbench_registry::{ranking, sections};
use featherbench_report::summary;
use featherbench_results::{Ranked, Ranking, RecordedTimes, Relation, Row, RunInfo, Verdict};

const UNIT: f64 = f64::EPSILON;

fn error(engine: &str, method: &str, robot: &str, units: f64) -> Row {
    let [engine, method, robot] = [engine, method, robot].map(str::to_owned);
    Row {
        study: "accuracy".into(),
        precision: "f64".into(),
        quantity: "fd".into(),
        params: r#"{"states":20}"#.into(),
        engine,
        method,
        robot,
        metric: "error_median".into(),
        ..Row::default()
    }
    .informed(units * UNIT)
}

fn ratio(engine: &str, robot: &str, ratio: f64) -> Row {
    let [engine, robot] = [engine, robot].map(str::to_owned);
    let words = ["timing", "f64", "fd", "ratio", "stream"].map(str::to_owned);
    let [study, precision, quantity, metric, cache] = words;
    Row { study, precision, quantity, metric, cache, engine, robot, ..Row::default() }.informed(ratio)
}

fn rows() -> Vec<Row> {
    let judged = |engine: &str, verdict| Row {
        engine: engine.into(),
        study: "agreement".into(),
        quantity: "id".into(),
        value: Some(1e-16),
        bound: Some(1e-14),
        relation: Some(Relation::Le),
        verdict,
        ..Row::default()
    };
    [
        ["panda", "hand", "hyq"].into_iter().zip([2.0, 8.0, 3.0]).map(|(robot, units)| error("drake", "aba", robot, units)).collect(),
        // Not usual: fewer robots, a batch.
        vec![error("mujoco", "rare", "panda", 900.0), error("mujoco", "batch", "panda", 800.0)],
        vec![error("mujoco", "forward", "panda", 7.0), error("mujoco", "forward", "hand", 70.0)],
        vec![judged("drake", Verdict::Pass), judged("drake", Verdict::Pass), judged("mujoco", Verdict::Pass)],
        vec![judged("mujoco", Verdict::Deviation), judged("mujoco", Verdict::Skip)],
        // Of each robot the fastest build; what does not count is not used.
        vec![ratio("mujoco-native", "panda", 4.0), ratio("mujoco-gcc", "panda", 2.0), ratio("mujoco-native", "hand", 5.0)],
        vec![ratio("mujoco-native", "hyq", 3.0), ratio("mujoco-native", "hyq", 0.1).invalid("the machine was not quiet")],
    ]
    .concat()
}

fn of<'a>(ranking: &'a Ranking, engine: &str) -> &'a Ranked {
    ranking.engines.iter().find(|of| of.name == engine).unwrap()
}

#[test]
fn the_numbers_are_those_of_the_rows() {
    let ranking = ranking(&RunInfo::default(), &rows());
    let names: Vec<&str> = ranking.engines.iter().map(|of| of.name.as_str()).collect();
    assert_eq!(names, ["drake", "mujoco"], "the smallest worst error comes first, and a build is its engine");
    let (drake, mujoco) = (of(&ranking, "drake"), of(&ranking, "mujoco"));
    assert_eq!([drake.asked, drake.right, drake.known, mujoco.asked, mujoco.right, mujoco.known], [2, 2, 0, 2, 1, 1]);
    let errors = &drake.errors["fd"];
    assert_eq!((errors.robots, errors.states, errors.worst_robot.as_str()), (3, 60, "hand"));
    assert_eq!([errors.median / UNIT, errors.worst / UNIT], [3.0, 8.0]);
    assert_eq!([mujoco.errors["fd"].median / UNIT, mujoco.errors["fd"].worst / UNIT], [38.5, 70.0]);
    assert_eq!(mujoco.errors["fd"].method, "forward");
    let times = &mujoco.times["fd"];
    assert_eq!((times.robots, times.median, times.least, times.most, times.machines), (3, 3.0, 2.0, 5.0, 0));
    assert!(drake.times.is_empty());
}

/// Recorded times stand where the run has none; over machines the median, and the least and the most of all.
#[test]
fn recorded_times_fill_what_was_not_measured() {
    let recorded = |machine: &str, median: f64| {
        let [least, most] = [median / 2.0, 2.0 * median];
        ["drake", "mujoco", "dynibo"].map(|engine| RecordedTimes {
            machine: machine.into(),
            engine: engine.into(),
            quantity: "fd".into(),
            robots: 30,
            median,
            least,
            most,
            ..RecordedTimes::default()
        })
    };
    let recorded_times = [recorded("a", 2.0), recorded("b", 4.0)].concat();
    let run = RunInfo { recorded_times, ..RunInfo::default() };
    let ranking = ranking(&run, &rows());
    let drake = &of(&ranking, "drake").times["fd"];
    assert_eq!((drake.robots, drake.median, drake.least, drake.most, drake.machines), (30, 3.0, 1.0, 8.0, 2));
    assert_eq!(of(&ranking, "mujoco").times["fd"].machines, 0, "what this run measured stays");
    assert_eq!((of(&ranking, "dynibo").asked, of(&ranking, "dynibo").times["fd"].median), (0, 3.0), "one that has times alone");
    // A machine can be chosen: the first is open, the others are brought.
    let sections = sections(&run, &rows());
    let section = sections.iter().find(|section| section.lead.is_some()).unwrap();
    let parts: String = section.parts.iter().map(|part| part.body.0.as_str()).collect();
    for (machine, median) in [("a", "<b>2</b> <small>1 to 4, 30 robots"), ("b", "<b>4</b> <small>2 to 8, 30 robots")] {
        assert!(section.body.0.contains(&format!("<option value=\"{machine}, \"")), "{}", section.body.0);
        assert_eq!([section.body.0.contains(median), parts.contains(median)], [machine == "a", machine == "b"], "{machine}");
    }
}

#[test]
fn the_page_and_the_terminal_have_the_same_table() {
    let (run, rows) = (RunInfo::default(), rows());
    let sections = sections(&run, &rows);
    let lead = sections.iter().find_map(|section| section.lead.as_ref()).unwrap();
    let lines = summary(&run, &rows, &sections);
    let drake = lines.iter().find(|line| line.trim_start().starts_with("drake")).unwrap();
    let cells: Vec<&str> = drake.split_whitespace().collect();
    assert_eq!(&cells[..9], ["drake", "100", "%", "of", "2", "3", "8", "hand", "–"]);
    for words in ["<b>3</b>", "worst 8 on ", ">hand<", "<b>100 %</b>", "50.0 %", "2 to 5"] {
        assert!(lead.body.0.contains(words), "{words}: {}", lead.body.0);
    }
    assert_eq!(lead.body.0.matches("<svg").count(), 0, "one mark alone compares nothing");
    // A run about one thing alone has no ranking.
    let judged: Vec<Row> = rows.into_iter().filter(|row| row.study == "agreement").collect();
    assert!(featherbench_registry::sections(&run, &judged).iter().all(|section| section.lead.is_none()));
}
