//! Our error over the best engine's: which answers count, and the ratio that results.

use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_doubles::{Answer, Double, Twist, agreement, gates, robot};
use featherbench_engines::Featherbench;
use featherbench_results::Row;

/// The quantity that the changed answers are wrong in.
const SPOILED: Quantity = Quantity::InverseDynamics;

/// A relative error of 1e-9.
fn off(answer: Answer) {
    if answer.quantity == SPOILED {
        answer.values.iter_mut().for_each(|value| *value *= 1.0 + 1e-9);
    }
}

/// Answers that are NaN.
fn missing(answer: Answer) {
    if answer.quantity == SPOILED {
        answer.values.fill(f64::NAN);
    }
}

/// The rows with doubles of these names and answers, by our usual methods and by all of forward dynamics, and with our own kernels unless a double has their name.
fn rows(robot: &Robot, doubles: &[(&str, Twist)]) -> Vec<Row> {
    let mut engines: Vec<Box<dyn Engine>> = doubles
        .iter()
        .map(|(name, twist)| Box::new(Double::twisting(robot, *twist).named(name).by_usual_methods()) as Box<dyn Engine>)
        .collect();
    if doubles.iter().all(|(name, _)| *name != "featherbench") {
        engines.insert(0, Box::new(Featherbench::new()));
    }
    let mut rows = agreement(robot, &gates(""), &engines);
    rows.retain(|row| row.metric == "over_best");
    rows
}

/// A torque that is wrong by 1e-9 is also rounded: its error is larger or smaller by 2⁻⁵³ of the torque, 1.1e-7 of the error.
const ROUNDED: f64 = 1.2e-7;

/// The ratio for the wrong quantity, and the engine that is the best.
fn ratio(rows: &[Row]) -> (f64, &str) {
    let row = rows.iter().find(|row| row.quantity == SPOILED.name()).unwrap();
    (row.value.unwrap(), &row.reference)
}

#[test]
fn the_same_answers_have_the_same_error() {
    let robot = robot("chain:n=4,layout=spatial");
    let rows = rows(&robot, &[("a", |_| ())]);
    // The doubles also answer forward dynamics by our refined method, which is better than our usual one.
    let (fd, others): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.quantity == Quantity::ForwardDynamics.name());
    assert!(others.iter().all(|row| row.engine == "featherbench" && row.value == Some(1.0) && row.reference == "a"), "{others:?}");
    assert!(fd.iter().all(|row| row.params.contains("\"by\":\"refined_1\"") && row.value > Some(1.0)), "{fd:?}");
    // All quantities except: the whole mass matrix on robots too large for it, its products on all others, and the read-back, which no
    // kernel computes.
    assert_eq!(rows.len(), 14);
}

#[test]
fn our_error_shows_at_its_size_against_the_best_of_all() {
    let robot = robot("chain:n=4,layout=spatial");
    let worse = rows(&robot, &[("featherbench", off), ("honest", |_| ()), ("spoiled", off)]);
    let (value, reference) = ratio(&worse);
    // The error is 1e-9 of the torques, and at the worst state at least a hundredth of that of the scale of their terms. The best error is
    // between half an ulp and 20 ulps.
    let largest = 1e-9 * (1.0 + ROUNDED) / (0.5 * f64::EPSILON);
    assert!((1e-11 / 20.0 / f64::EPSILON..=largest).contains(&value), "{value:e}");
    assert_eq!(reference, "honest");
    let unspoiled = |row: &&Row| ![SPOILED, Quantity::ForwardDynamics].iter().any(|quantity| row.quantity == quantity.name());
    assert!(worse.iter().filter(unspoiled).all(|row| row.value == Some(1.0)), "{worse:?}");
}

#[test]
fn engines_that_err_or_answer_no_numbers_are_not_the_best() {
    let robot = robot("chain:n=4,layout=spatial");
    let spoiled = rows(&robot, &[("spoiled", off)]);
    let (value, reference) = ratio(&spoiled);
    assert!((0.5 * f64::EPSILON / (1e-9 * (1.0 + ROUNDED))..=20.0 * f64::EPSILON / 1e-11).contains(&value), "{value:e}");
    assert_eq!(reference, "spoiled");

    let with_nan = rows(&robot, &[("nan", missing), ("spoiled", off)]);
    assert_eq!(ratio(&with_nan), (value, "spoiled"));
    let nan_alone = rows(&robot, &[("nan", missing)]);
    assert!(nan_alone.iter().all(|row| row.quantity != SPOILED.name()), "{nan_alone:?}");
    let ours_is_nan = rows(&robot, &[("featherbench", missing), ("honest", |_| ())]);
    assert!(ours_is_nan.iter().all(|row| row.quantity != SPOILED.name() || row.value.is_none()), "a NaN of ours is no good ratio");
}
