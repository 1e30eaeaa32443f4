//! The timing study as a whole: its cells, the checks before a time counts, and why some do not count. Nothing here depends on a time.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::statistics::EPOCHS;
use featherbench_bench::{Cell, Context, Engine, Finished, Outcome, OutcomeStore, Quantity, Robot, Study};
use featherbench_doubles::{Double, gates, robot, whole};
use featherbench_engines::Featherbench;
use featherbench_results::{Kind, Row, Verdict};
use featherbench_speed::{Timing, TimingSettings};
use std::collections::BTreeSet;
use std::sync::LazyLock;

fn settings(engines: &[&str]) -> TimingSettings {
    TimingSettings {
        states: 20,
        seconds: 0.0,
        engines: engines.iter().map(|&name| name.into()).collect(),
        quantities: Vec::new(),
        best_of: Vec::new(),
        derivatives: false,
    }
}

fn study() -> Timing {
    let kernels = |_: &Robot| {
        vec![(Quantity::InverseDynamics, "rnea_packed"), (Quantity::ForwardDynamics, "aba"), (Quantity::ForwardDynamics, "ltdl")]
    };
    Timing { settings: settings(&["double", "absent"]), kernels }
}

/// The rows of a robot timed with a double.
fn rows(double: Double) -> Vec<Row> {
    rows_of(&study(), double)
}

/// The rows of an honest double: several tests look at them.
static HONEST: LazyLock<Vec<Row>> = LazyLock::new(|| rows(Double::of(&robot4())));

fn rows_of(study: &Timing, double: Double) -> Vec<Row> {
    let engines: [Box<dyn Engine>; 2] = [Box::new(Featherbench::new()), Box::new(double)];
    whole(study, &robot4(), &gates(""), &engines)
}

fn robot4() -> Robot {
    robot("chain:n=4,layout=spatial")
}

fn of<'a>(rows: &'a [Row], engine: &str, quantity: &str, metric: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row.engine == engine && row.quantity == quantity && row.metric == metric).collect()
}

#[test]
fn everyone_has_times_ratios_and_intervals_beside_a_control() {
    let rows = &*HONEST;
    for (quantity, methods) in [("id", 2), ("fd", 6)] {
        for (engine, timed) in [("featherbench", if quantity == "fd" { 2 } else { 1 }), ("double", methods)] {
            let found = of(rows, engine, quantity, "ns_per_call");
            assert_eq!(found.len(), 2 * timed, "{engine} {quantity}: stream and hot");
            assert!(found.iter().all(|row| row.value.is_some_and(|ns| ns > 0.0) && row.verdict == Verdict::Info && row.unit == "ns"));
            for row in found {
                assert!(row.ci_low <= row.value && row.value <= row.ci_high && row.ci_low.is_some(), "{row:?}");
                let params: serde_json::Value = serde_json::from_str(&row.params).unwrap();
                assert!(params["p10"].as_f64() <= params["p90"].as_f64() && params["p10"].is_f64(), "{params}");
            }
        }
        assert_eq!(of(rows, "featherbench", quantity, "control").len(), 2);
        for row in of(rows, "double", quantity, "ratio") {
            assert!(row.ci_low <= row.value && row.value <= row.ci_high && row.ci_low.is_some());
            assert_eq!(row.reference, if quantity == "id" { "featherbench rnea_packed" } else { "featherbench aba" });
        }
        assert!(of(rows, "double", quantity, "worst_error").iter().all(|row| row.verdict == Verdict::Pass));
    }
    let machine: Vec<_> = rows.iter().filter(|row| row.quantity == "machine").collect();
    assert_eq!(
        machine.iter().map(|row| row.metric.as_str()).collect::<Vec<_>>(),
        ["fma_per_ns", "fma_per_ns_per_lane", "fma_per_ns_scalar", "clock_ns", "empty_call_ns"]
    );
    assert!(machine.iter().all(|row| row.robot.is_empty() && row.value.is_some_and(|value| value > 0.0)));
    assert!(rows.iter().all(|row| row.engine != "absent"));
}

/// Each of our methods stands beside the fastest of the named engines' methods whose answers are right.
#[test]
fn the_best_other_is_the_fastest_whose_answers_are_right() {
    let named = TimingSettings { best_of: vec!["double".into()], ..settings(&["double"]) };
    let found = |double: Double| {
        let rows = rows_of(&Timing { settings: named.clone(), ..study() }, double);
        let ours = |quantity: &str| of(&rows, "featherbench", quantity, "best_other").into_iter().cloned().collect::<Vec<_>>();
        (ours("id"), ours("fd"))
    };
    let (id, fd) = found(Double::of(&robot4()));
    // One of our methods for id and two for fd, over the stream and hot.
    assert_eq!((id.len(), fd.len()), (2, 4));
    for row in id.iter().chain(&fd) {
        let params: serde_json::Value = serde_json::from_str(&row.params).unwrap();
        let others = params["others"].as_array().unwrap();
        assert_eq!(others.len(), if row.quantity == "id" { 2 } else { 6 }, "all methods of the double");
        assert!(others.contains(&row.reference.as_str().into()), "{} among {others:?}", row.reference);
        assert!(row.ci_low <= row.value && row.value <= row.ci_high && row.value.is_some_and(|ratio| ratio > 0.0), "{row:?}");
    }
    assert_eq!(fd.iter().map(|row| row.method.as_str()).collect::<Vec<_>>(), ["aba", "ltdl", "aba", "ltdl"]);
    let (id, fd) = found(Double::twisting(&robot4(), |answer| {
        if answer.quantity == Quantity::InverseDynamics {
            answer.values[0] += 1.0;
        }
    }));
    assert_eq!((id.len(), fd.len()), (0, 4), "a wrong answer is beside nothing");
    assert!(of(&HONEST, "featherbench", "fd", "best_other").is_empty(), "no engine was named");
}

/// Inverses are multiplied with M.
#[test]
fn an_inverse_is_checked_backwards() {
    let wrong = |twist: featherbench_doubles::Twist| {
        let study = Timing { kernels: |_| vec![(Quantity::MassMatrixInverse, "ltdl"), (Quantity::MassMatrixInverse, "batch")], ..study() };
        let rows = rows_of(&study, Double::twisting(&robot4(), twist));
        assert!(rows.iter().filter(|row| row.engine == "featherbench").all(|row| row.verdict == Verdict::Info), "ours are right");
        let errors = of(&rows, "double", "mass_matrix_inverse", "worst_error");
        (errors.len(), errors.iter().filter(|row| row.verdict == Verdict::Fail).count())
    };
    assert_eq!(wrong(|_| ()), (2, 0));
    assert_eq!(
        wrong(|answer| {
            if answer.quantity == Quantity::MassMatrixInverse {
                answer.values[0] *= 1.0 + 1e-8;
            }
        }),
        (2, 2),
        "an entry of the diagonal"
    );
    assert_eq!(
        wrong(|answer| {
            if answer.quantity == Quantity::MassMatrixInverse {
                answer.values[1] += 1e-8 * answer.values[0];
            }
        }),
        (2, 2),
        "one beside it"
    );
}

/// The condition number of M divides the error of a derivative of forward dynamics, and does not hide a wrong one.
#[test]
fn a_wrong_derivative_of_forward_dynamics_has_no_time() {
    for quantity in [Quantity::ForwardDynamicsDq, Quantity::ForwardDynamicsDv] {
        let wrong = |twist: featherbench_doubles::Twist| {
            let kernels = move |_: &Robot| vec![(Quantity::ForwardDynamicsDq, "analytic"), (Quantity::ForwardDynamicsDv, "analytic")];
            let study = Timing { kernels, settings: TimingSettings { derivatives: true, ..study().settings } };
            let rows = rows_of(&study, Double::twisting(&robot4(), twist));
            let errors = of(&rows, "double", quantity.name(), "worst_error");
            (!errors.is_empty()).then(|| errors.iter().map(|row| row.verdict == Verdict::Fail).collect::<BTreeSet<_>>())
        };
        assert_eq!(wrong(|_| ()), Some(BTreeSet::from([false])), "{quantity:?}");
        let entry = wrong(|answer| {
            if answer.quantity.is_derivative() {
                answer.values[0] += 1e-7 * answer.values.iter().map(|x| x.abs()).sum::<f64>();
            }
        });
        assert_eq!(entry, Some(BTreeSet::from([true])), "{quantity:?}");
    }
}

#[test]
fn a_batch_in_single_precision_stands_beside_the_usual_method() {
    let kernels = |_: &Robot| {
        vec![(Quantity::ForwardDynamics, "aba"), (Quantity::ForwardDynamics, "batch"), (Quantity::ForwardDynamicsSingle, "batch")]
    };
    let study = Timing { settings: settings(&[]), kernels };
    let rows = whole(&study, &robot4(), &gates(""), &[Box::new(Featherbench::new()) as Box<dyn Engine>]);
    assert!(rows.iter().all(|row| row.verdict == Verdict::Info), "its answers are right to its own precision");
    for metric in ["ns_per_call", "ratio", "finding"] {
        let found: Vec<_> = of(&rows, "featherbench", "fd", metric).into_iter().filter(|row| row.method == "batch").collect();
        let precisions: Vec<&str> = found.iter().map(|row| row.precision.as_str()).collect();
        assert_eq!(precisions, ["f64", "f32", "f64", "f32"], "{metric} of the stream, then hot");
        assert!(metric == "ns_per_call" || found.iter().all(|row| row.reference == "featherbench aba"));
    }
    assert!(rows.iter().all(|row| row.quantity != "fd_f32"), "it has no experiment of its own");
}

#[test]
fn a_wrong_answer_at_one_state_costs_its_times_and_no_others() {
    let rows = rows(Double::twisting(&robot4(), |answer| {
        if answer.quantity == Quantity::InverseDynamics && answer.state == 17 {
            answer.values[2] *= 1.0 + 1e-9;
        }
    }));
    let failed: Vec<_> = rows.iter().filter(|row| row.verdict == Verdict::Fail).collect();
    assert_eq!(failed.iter().map(|row| row.method.as_str()).collect::<Vec<_>>(), ["rnea_packed", "batch"]);
    assert!(failed.iter().all(|row| (&*row.engine, &*row.quantity, &*row.metric) == ("double", "id", "worst_error")));
    for row in of(&rows, "double", "id", "ns_per_call").into_iter().chain(of(&rows, "double", "id", "ratio")) {
        assert!(!row.valid && row.reason.starts_with("a wrong answer has no time"), "{}", row.reason);
    }
    for engine in ["featherbench", "double"] {
        assert!(of(&rows, engine, "fd", "ns_per_call").iter().all(|row| !row.reason.contains("wrong answer")));
    }
}

#[test]
fn one_that_refuses_is_a_row_with_its_reason_and_no_time() {
    let rows = rows(Double::refusing(&robot4()));
    let refused: Vec<_> = rows.iter().filter(|row| row.engine == "double").collect();
    assert_eq!(refused.len(), 8, "one for each method");
    assert!(refused.iter().all(|row| row.verdict == Verdict::Skip && row.reason == "it supports nothing" && row.value.is_none()));
    assert_eq!(of(&rows, "featherbench", "fd", "ns_per_call").len(), 4);
}

#[test]
fn forward_dynamics_is_checked_backwards() {
    let errors =
        |rows: &[Row]| of(rows, "double", "fd", "worst_error").iter().map(|row| (row.value.unwrap(), row.verdict)).collect::<Vec<_>>();
    let honest = errors(&HONEST);
    assert!(honest.len() == 6 && honest.iter().all(|&(error, verdict)| error < 1e-14 && verdict == Verdict::Pass), "{honest:?}");
    let wrong = errors(&rows(Double::altered(&robot4(), |description| description.bodies[3].mass *= 1.0 + 1e-8)));
    assert!(wrong.iter().filter(|(_, verdict)| *verdict == Verdict::Fail).count() == 6, "{wrong:?}");
}

#[test]
fn factors_are_checked_by_the_matrix_that_they_make() {
    let wrong = |twist: featherbench_doubles::Twist| {
        let study = Timing { kernels: |_| vec![(Quantity::Factorization, "ltdl")], ..study() };
        let rows = rows_of(&study, Double::twisting(&robot4(), twist));
        let errors = of(&rows, "double", "factorization", "worst_error");
        (errors.len(), errors.iter().filter(|row| row.verdict == Verdict::Fail).count())
    };
    let (honest, none) = wrong(|_| ());
    assert!(honest > 0 && none == 0);
    let (twisted, failed) = wrong(|answer| {
        if answer.quantity == Quantity::Factorization {
            answer.values[0] *= 1.0 + 1e-10;
        }
    });
    assert_eq!((twisted, failed), (honest, honest), "1e-10 of one entry");
}

#[test]
fn a_reference_that_refuses_from_the_start_is_one_row_with_its_reason() {
    let mut description = robot4().description.clone();
    let last = description.bodies.last_mut().unwrap();
    (last.mass, last.inertia) = (0.0, [0.0; 6]);
    let robot = Robot::new(&description, "test", featherbench_results::ModelOrigin::Generated, 20, 1).unwrap();
    let study = Timing { kernels: |_| vec![(Quantity::Factorization, "ltdl")], settings: settings(&[]) };
    let rows = whole(&study, &robot, &gates(""), &[Box::new(Featherbench::new()) as Box<dyn Engine>]);
    let rows: Vec<_> = rows.iter().filter(|row| row.quantity == "factorization").collect();
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert!(rows[0].verdict == Verdict::Error && rows[0].reason.contains("not positive definite"), "{rows:?}");
}

#[test]
fn estimates_are_flagged_valid_or_not_and_tell_what_was_subtracted() {
    let estimate = |row: &&Row| row.estimated;
    assert!(!HONEST.iter().any(|row| row.estimated || row.metric == "overhead_ns"));
    let rows = rows(Double::estimating(Double::twisting(&robot4(), |answer| {
        if answer.quantity == Quantity::InverseDynamics {
            answer.values[0] += 1.0;
        }
    })));
    assert!(rows.iter().filter(estimate).all(|row| row.engine == "double"));
    let metrics = ["ns_per_call", "ratio", "finding"];
    for (metric, count) in metrics.map(|metric| (metric, 2)).into_iter().chain([("overhead_ns", 1)]) {
        for (quantity, wrong_answer) in [("id", metric != "overhead_ns"), ("fd", false)] {
            let found = of(&rows, "double", quantity, metric);
            assert_eq!(found.len(), count, "{quantity} {metric}: one method is timed, over the stream and hot");
            assert!(found.iter().all(|row| row.estimated && row.value.is_some()), "{quantity} {metric}");
            let wrong = |row: &&&Row| !row.valid && row.reason.starts_with("a wrong answer has no time");
            assert_eq!(
                found.iter().filter(wrong).count(),
                if wrong_answer { count } else { 0 },
                "{quantity} {metric}: {}",
                found[0].reason
            );
        }
    }
    assert!(of(&rows, "double", "fd", "overhead_ns").iter().all(|row| row.value == Some(700.0) && row.unit == "ns"));
    assert!(of(&rows, "double", "fd", "worst_error").iter().all(|row| row.verdict == Verdict::Pass && row.reason.is_empty()));
}

/// A finished study whose samples are rewritten before they are compared.
fn rewritten(rewrite: impl Fn(&mut Vec<f64>)) -> Vec<Row> {
    altered(|cell, values| {
        if cell.params["what"] == "experiment" {
            rewrite(values);
        }
    })
}

/// The study of our own kernels, finished once: its outcomes are altered.
static FINISHED: LazyLock<Vec<Finished>> = LazyLock::new(|| {
    let (robot, gates, engines) = (robot4(), gates(""), [Box::new(Featherbench::new()) as Box<dyn Engine>]);
    let context = Context { robots: std::slice::from_ref(&robot), engines: &engines, gates: &gates, seed: 1 };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let cells = plan(&study(), &context, &|_| true);
    evaluate(&study(), &context, cells, &store, &Silent).unwrap()
});

/// A finished study whose cells and their outcomes are altered before they are compared.
fn altered(alter: impl Fn(&mut Cell, &mut Vec<f64>)) -> Vec<Row> {
    let (robot, gates, engines) = (robot4(), gates(""), [Box::new(Featherbench::new()) as Box<dyn Engine>]);
    let context = Context { robots: std::slice::from_ref(&robot), engines: &engines, gates: &gates, seed: 1 };
    let mut finished = FINISHED.clone();
    for (cell, outcome) in &mut finished {
        if let Outcome::Values(values) = outcome {
            alter(cell, values);
        }
    }
    let text = study().side_file(&finished).unwrap().1;
    let lines = finished.iter().filter_map(|(cell, _)| cell.params["candidates"].as_array()).map(|all| all.len() + 1).sum::<usize>();
    assert_eq!(text.lines().count(), lines, "a line for each candidate of each experiment, and one of how crowded the core was");
    for line in text.lines() {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(finished.iter().any(|(cell, _)| cell.id() == line["cell"]), "{line}");
        let rounds = [&line["ns"], &line["contention"]].into_iter().find_map(|rounds| rounds.as_array()).unwrap();
        assert!(rounds.len() >= EPOCHS);
    }
    compare(&study(), &context, finished)
}

/// The rounds of an experiment. Its samples are after the number of candidates and their calls, candidate by candidate, and then come the
/// rounds' contentions.
fn rounds(values: &[f64]) -> usize {
    let candidates = values[0] as usize;
    (values.len() - 1 - candidates) / (candidates + 1)
}

/// Fills in the samples, on a core that was alone in all rounds.
fn fill(values: &mut [f64], ns: impl Fn(usize, usize) -> f64) {
    let (candidates, rounds) = (values[0] as usize, rounds(values));
    for (place, value) in values[1 + candidates..].iter_mut().enumerate() {
        *value = if place / rounds < candidates { ns(place / rounds, place % rounds) } else { 1.0 };
    }
}

/// A program on the core's other thread in these rounds, which slows all candidates by as much.
fn crowd(values: &mut [f64], crowded: impl Fn(usize) -> bool) {
    let (candidates, rounds) = (values[0] as usize, rounds(values));
    for (place, value) in values[1 + candidates..].iter_mut().enumerate() {
        if crowded(place % rounds) {
            *value *= 1.25;
        }
    }
}

#[test]
fn a_control_that_is_not_one_costs_the_times() {
    let quiet = rewritten(|values| fill(values, |_, round| 100.0 + (round % 3) as f64));
    assert!(quiet.iter().all(|row| row.reason.is_empty()));
    assert!(quiet.iter().filter(|row| row.metric == "control").all(|row| row.value == Some(1.0)));
    // The A/A replicate, which is after the first copy, is slower by ten percent.
    let noisy = rewritten(|values| fill(values, |candidate, round| if candidate == 1 { 110.0 } else { 100.0 } + (round % 3) as f64));
    let times: Vec<_> = noisy.iter().filter(|row| row.metric == "ns_per_call").collect();
    assert!(!times.is_empty() && times.iter().all(|row| !row.valid && row.value.is_some()));
    assert!(times[0].reason.contains("4 of 4 A/A controls"), "{}", times[0].reason);
}

/// A study on a machine without noise, except for the changes to the experiments of some quantity and cache regime.
fn quiet_but(spoil: impl Fn(&mut Cell, &mut Vec<f64>) -> bool) -> [Vec<Row>; 2] {
    let spoilt = std::cell::RefCell::new(Vec::new());
    let rows = altered(|cell, values| {
        if cell.params["what"] == "experiment" {
            fill(values, |_, round| 100.0 + (round % 3) as f64);
            if spoil(cell, values) {
                spoilt.borrow_mut().push((cell.quantity.clone(), cell.params["cache"].as_str().unwrap().to_owned()));
            }
        }
    });
    assert!(!spoilt.borrow().is_empty());
    let of_spoilt = |row: &Row| spoilt.borrow().contains(&(row.quantity.clone(), row.cache.clone()));
    let (spoilt, others) = rows.into_iter().filter(|row| row.kind == Kind::Measured && row.quantity != "machine").partition(of_spoilt);
    [spoilt, others]
}

/// All rows but that of the A/A ratio.
fn times(rows: &[Row]) -> Vec<&Row> {
    let times: Vec<_> = rows.iter().filter(|row| row.metric != "control").collect();
    assert!(!times.is_empty());
    times
}

/// Whether it is the experiment of inverse dynamics at one state.
fn hot_id(cell: &Cell) -> bool {
    cell.quantity == "id" && cell.params["cache"] == "hot"
}

fn slower_copy(values: &mut [f64]) {
    fill(values, |candidate, round| if candidate == 1 { 110.0 } else { 100.0 } + (round % 3) as f64);
}

#[test]
fn one_bad_control_of_four_costs_its_experiment_alone() {
    let [spoilt, others] = quiet_but(|cell, values| {
        if hot_id(cell) {
            slower_copy(values);
        }
        hot_id(cell)
    });
    for row in &spoilt {
        assert!(
            !row.valid && row.reason.starts_with("the second copy of featherbench over the first is 1."),
            "{}: {}",
            row.metric,
            row.reason
        );
        assert!(row.value.is_some());
    }
    assert!(spoilt.iter().any(|row| row.metric == "control") && !times(&spoilt).is_empty());
    assert!(times(&others).iter().all(|row| row.reason.is_empty()));
}

/// The experiments of a robot know of each other: where one is crowded all the while, the others tell.
#[test]
fn rounds_with_a_neighbour_do_not_count() {
    let usual = |round: usize| 100.0 + (round % 3) as f64;
    let value = |rows: &[Row]| -> Vec<Option<f64>> { rows.iter().filter(|row| row.metric == "ns_per_call").map(|row| row.value).collect() };
    // In half of the rounds: the times are those of the others.
    let [spoilt, others] = quiet_but(|cell, values| {
        if hot_id(cell) {
            crowd(values, |round| round % 2 == 1);
        }
        hot_id(cell)
    });
    assert!(times(&spoilt).iter().chain(&times(&others)).all(|row| row.reason.is_empty() && row.valid));
    assert!(value(&spoilt).iter().chain(&value(&others)).all(|value| value.is_some_and(|value| (value - 100.0).abs() < 0.5)));
    // In seven of ten processes; in eight; in all.
    for (from, counts) in [(3, true), (2, false), (0, false)] {
        let [spoilt, others] = quiet_but(|cell, values| {
            if hot_id(cell) && cell.params["process"].as_u64().unwrap() >= from {
                crowd(values, |_| true);
            }
            hot_id(cell)
        });
        let all = times(&spoilt);
        assert!(all.iter().all(|row| row.valid == counts && row.params.contains(&format!("\"fastest\":{from}"))), "{from}: {all:?}");
        let reason = format!("the core was at its fastest in {from} of 10 processes, and 3 are needed");
        assert!(all.iter().all(|row| counts || row.reason == reason), "{}", all[0].reason);
        assert!(value(&spoilt).iter().all(|value| value.is_some_and(|value| (value < 101.0) == counts)), "{from}");
        assert!(times(&others).iter().all(|row| row.valid));
    }
    // A robot that met no other state: nothing in it can tell.
    let all = rewritten(|values| {
        fill(values, |_, round| usual(round));
        crowd(values, |_| true);
    });
    assert!(value(&all).iter().all(|value| value.is_some_and(|value| value > 120.0)));
}

#[test]
fn two_bad_controls_of_four_cost_the_robot() {
    let [spoilt, others] = quiet_but(|cell, values| {
        if cell.quantity == "id" {
            slower_copy(values);
        }
        cell.quantity == "id"
    });
    let all = times(&spoilt).into_iter().chain(times(&others));
    for row in all {
        assert_eq!(row.reason, "2 of 4 A/A controls of this robot are far from 1: the machine was not quiet", "{}", row.metric);
    }
    let control = |rows: &[Row], valid: bool| {
        rows.iter().filter(|row| row.metric == "control" && row.valid == valid && row.reason.starts_with("the second") != valid).count()
    };
    assert_eq!([control(&spoilt, false), control(&spoilt, true), control(&others, false), control(&others, true)], [2, 0, 0, 2]);
}

/// Without an A/A ratio nothing is known about the noise.
#[test]
fn without_a_control_no_time_counts() {
    let lost_copy = |cell: &mut Cell, values: &mut Vec<f64>| {
        if hot_id(cell) {
            // The last block of the second candidate.
            let last = values[0] as usize + 2 * rounds(values);
            values[last] = f64::NAN;
        }
        hot_id(cell)
    };
    let no_copy = |cell: &mut Cell, _: &mut Vec<f64>| {
        if hot_id(cell) {
            cell.params["candidates"][1]["control"] = false.into();
        }
        hot_id(cell)
    };
    for (spoil, words) in [
        (&lost_copy as &dyn Fn(&mut Cell, &mut Vec<f64>) -> bool, "the A/A control or the reference stopped answering while it was timed"),
        (&no_copy, "the experiment has no A/A control"),
    ] {
        let [spoilt, others] = quiet_but(spoil);
        let invalid: Vec<_> = spoilt.iter().filter(|row| row.metric != "control").collect();
        assert!(!invalid.is_empty() && invalid.iter().all(|row| !row.valid && row.reason == words && row.value.is_some()), "{invalid:?}");
        let controls: Vec<_> = spoilt.iter().filter(|row| row.metric == "control").collect();
        assert!(controls.iter().all(|row| row.verdict == Verdict::Error && row.value.is_none() && row.reason == words), "{controls:?}");
        assert_eq!(controls.len(), usize::from(words.contains("stopped")));
        assert!(times(&others).iter().all(|row| row.reason.is_empty()), "one of four: the others count");
    }
    let rows = rewritten(|values| {
        let half = rounds(values) / 2;
        fill(values, |candidate, round| if (candidate, round) == (1, half) { f64::NAN } else { 100.0 });
    });
    let times: Vec<_> = rows.iter().filter(|row| row.metric == "ns_per_call").collect();
    assert!(!times.is_empty() && times.iter().all(|row| !row.valid && row.reason.starts_with("4 of 4 A/A controls")));
}

/// A peak that is not valid does not count for a kernel's limit.
#[test]
fn a_peak_below_what_single_doubles_make_does_not_count() {
    let machine = |peak: f64| {
        let rows = altered(|cell, values| {
            if cell.params["what"] == "machine" {
                *values = vec![peak, 6.5, 20.0, 1.0];
            }
        });
        let found = |metric: &str| rows.iter().find(|row| row.metric == metric).unwrap().clone();
        ["fma_per_ns", "fma_per_ns_per_lane", "fma_per_ns_scalar", "clock_ns", "empty_call_ns"].map(found)
    };
    let [vector, lane, rest @ ..] = machine(2.6);
    for row in [vector, lane] {
        assert!(
            row.value.is_some() && !row.valid && row.reason.starts_with("vectors of ") && row.reason.contains("0.40 times"),
            "{}",
            row.reason
        );
    }
    assert!(rest.iter().all(|row| row.reason.is_empty()));
    let [vector, lane, scalar, ..] = machine(52.0);
    assert!([&vector, &lane, &scalar].iter().all(|row| row.reason.is_empty()));
    assert_eq!((vector.value, scalar.value), (Some(52.0), Some(6.5)));
}

#[test]
fn one_that_stops_answering_is_an_error() {
    let rows = rewritten(|values| {
        let last = values.len() - 1 - rounds(values);
        values[last] = f64::NAN;
    });
    let errors: Vec<_> = rows.iter().filter(|row| row.verdict == Verdict::Error).collect();
    // The last candidate of forward dynamics is ltdl, the last of inverse dynamics the A/A replicate: without it no time there counts.
    assert_eq!(errors.len(), 4);
    assert!(errors.iter().all(|row| row.reason.contains("stopped answering")));
    assert_eq!(errors.iter().filter(|row| row.method == "ltdl" && row.metric == "ns_per_call").count(), 2);
    assert_eq!(errors.iter().filter(|row| row.quantity == "id" && row.metric == "control").count(), 2);
    assert!(rows.iter().filter(|row| row.quantity == "id" && row.metric == "ns_per_call").all(|row| !row.valid));
}

#[test]
fn a_suite_chooses_quantities() {
    let timed = |rows: &[Row]| rows.iter().map(|row| row.quantity.clone()).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>();
    let one = Timing { settings: TimingSettings { quantities: vec![Quantity::ForwardDynamics], ..settings(&["double"]) }, ..study() };
    assert_eq!(timed(&rows_of(&one, Double::of(&robot4()))), ["fd", "machine"]);
    assert_eq!(timed(&HONEST), ["fd", "id", "machine"]);
}
