//! Derivatives of whole runs: forward and adjoint, against re-simulation in double-double, against duals of the whole simulation, and each
//! other.

use featherbench_hybrid::penalty::PenaltyBall;
use featherbench_hybrid::systems::{BouncingBall, MovingTable, RimlessWheel, RockingBlock, SlantedBox, SlidingSphere, StickSlip};
use featherbench_hybrid::{Hybrid, Run, Settings, Start, Status, adjoint, sensitivity, simulate};
use featherbench_spatial::{DoubleDouble, Dual, Real, largest};

/// A run to take derivatives of.
struct Case<'a> {
    name: &'a str,
    theta: &'a [f64],
    mode: usize,
    state: &'a [f64],
    to: f64,
    events: usize,
}

fn go<S: Hybrid, T: Real>(system: &S, case: &Case, theta: &[T], state: Vec<T>, settings: &Settings) -> Run<T> {
    let start = Start { mode: case.mode, time: T::zero(), state };
    let run = simulate(system, theta, &start, T::from_f64(case.to), settings).unwrap();
    assert_eq!((run.status.name(), run.events.len()), ("finished", case.events), "{}", case.name);
    run
}

/// All outputs of a run: the state at its end and the event times.
fn outputs<T: Real>(run: &Run<T>) -> Vec<T> {
    run.state.iter().copied().chain(run.events.iter().map(|event| event.time)).collect()
}

fn check<S: Hybrid>(system: &S, case: &Case) {
    let run = go(system, case, case.theta, case.state.to_vec(), &Settings::default());
    let derivative = sensitivity(system, case.theta, &run).unwrap();
    let inputs = case.state.len() + case.theta.len();
    let mut forward: Vec<Vec<f64>> = derivative.columns.clone();
    for time in &derivative.times {
        forward.iter_mut().zip(time).for_each(|(column, entry)| column.push(*entry));
    }
    let scale = |row: usize| largest(forward.iter().map(|column| column[row]).chain([1.0]));
    let (mut worst, mut worst_dual, mut worst_adjoint) = (0.0_f64, 0.0_f64, 0.0_f64);

    // Re-simulation: central differences of a step of 10⁻⁹ err by 10⁻¹⁸ times a third derivative, and by 10⁻²⁵/10⁻⁹ of rounding.
    let step = 1e-9;
    let moved = |input: usize, by: f64| {
        let at = |offset: usize, numbers: &[f64]| -> Vec<DoubleDouble> {
            let of = |(index, number): (usize, &f64)| {
                if offset + index == input { DoubleDouble::from_sum(*number, by) } else { DoubleDouble::from_f64(*number) }
            };
            numbers.iter().enumerate().map(of).collect()
        };
        outputs(&go(system, case, &at(case.state.len(), case.theta), at(0, case.state), &Settings::extended()))
    };
    let twice = DoubleDouble::from_f64(2.0 * step);
    for (input, column) in forward.iter().enumerate() {
        let (after, before) = (moved(input, step), moved(input, -step));
        for (row, entry) in column.iter().enumerate() {
            let truth = ((after[row] - before[row]) / twice).to_f64();
            worst = largest([worst, (entry - truth) / scale(row)]);
        }
    }

    // Duals through the whole simulation: Newton's last correction of an event time carries its derivative.
    for (input, column) in forward.iter().enumerate() {
        let seed = |offset: usize, numbers: &[f64]| -> Vec<Dual<f64>> {
            let of = |(index, number): (usize, &f64)| Dual::new(*number, if offset + index == input { 1.0 } else { 0.0 });
            numbers.iter().enumerate().map(of).collect()
        };
        let run = go(system, case, &seed(case.state.len(), case.theta), seed(0, case.state), &Settings::default());
        for (row, (entry, output)) in column.iter().zip(outputs(&run)).enumerate() {
            worst_dual = largest([worst_dual, (entry - output.derivative) / scale(row)]);
        }
    }

    // The adjoint of each output.
    let outputs = case.state.len() + run.events.len();
    for row in 0..outputs {
        let unit: Vec<f64> = (0..outputs).map(|index| if index == row { 1.0 } else { 0.0 }).collect();
        let (of_state, of_times) = unit.split_at(case.state.len());
        let gradient = adjoint(system, case.theta, &run, of_state, of_times).unwrap();
        for (column, entry) in forward.iter().zip(gradient.state.iter().chain(&gradient.parameters)) {
            worst_adjoint = largest([worst_adjoint, (entry - column[row]) / scale(row)]);
        }
    }
    assert!(inputs == forward.len() && outputs > 0);
    println!("{}: re-simulation {worst:e}, duals {worst_dual:e}, adjoint {worst_adjoint:e}", case.name);
    // The tolerance of f64 runs, 10⁻¹⁴ per step, grows by the condition of the events: 10⁻¹² is a hundred of it. The derivative of a Newton
    // step errs by its correction, at most 10⁻¹² s, times a second derivative of g and the like.
    assert!(worst <= 1e-12 && worst_dual <= 1e-11, "{}: {worst:e} {worst_dual:e}", case.name);
    // The adjoint is the transpose of the same numbers: rounding alone.
    assert!(worst_adjoint <= 1e-12, "{}: {worst_adjoint:e}", case.name);
}

#[test]
fn systems() {
    fn case<'a>(name: &'a str, theta: &'a [f64], mode: usize, state: &'a [f64], to: f64, events: usize) -> Case<'a> {
        Case { name, theta, mode, state, to, events }
    }
    check(&BouncingBall, &case("ball", &[9.81, 0.8], 0, &[1.0, 0.0, 0.0], 1.7, 4));
    check(&MovingTable, &case("table", &[9.81, 0.7, 0.05, 12.0], 0, &[0.5, 0.3], 0.9, 3));
    // Two walls that open upwards.
    check(&SlantedBox { walls: 2 }, &case("box", &[9.81, 0.9, 1.1, 0.0, 2.3, 0.0], 0, &[0.1, 1.0, 0.3, 0.0], 1.2, 3));
    let theta = [9.81, 0.2, 0.3];
    check(&RimlessWheel, &case("wheel", &theta, 0, &[-0.1, RimlessWheel::limit_cycle(&theta) + 0.1], 1.0, 3));
    check(&RockingBlock, &case("block", &[9.81, 0.25, 1.0], 0, &[0.1, 0.0], 2.0, 3));
    check(&StickSlip, &case("stick-slip", &[1.0, 1.0, 0.3, 1.0, 0.6], 1, &[1.0, 0.2], 14.0, 4));
    check(&SlidingSphere, &case("sphere", &[0.3, 9.81, 0.1], 0, &[0.0, 5.0, 0.0], 1.0, 1));
    check(&PenaltyBall, &case("penalty", &[1.0, 9.81, 1e4, 20.0], 0, &[1.0, 0.0], 0.8, 2));
}

/// Drawn throws into a box of two walls: most have several impacts, each with its own saltation.
#[test]
fn drawn_throws() {
    let mut random = featherbench_robots::Random::named(7, "throws");
    let (mut cases, mut impacts) = (0, 0);
    while cases < 40 {
        let theta = [random.uniform(2.0, 12.0), random.uniform(0.5, 1.0), random.uniform(0.7, 1.3), 0.0, random.uniform(1.9, 2.5), 0.0];
        let state = [random.uniform(-0.2, 0.2), random.uniform(0.8, 1.2), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
        let start = Start { mode: 0, time: 0.0, state: state.to_vec() };
        let run = simulate(&SlantedBox { walls: 2 }, &theta, &start, 1.0, &Settings::default()).unwrap();
        // A slow impact has a derivative of 1/ġ, which is too large for the bound of the other cases.
        if run.status != Status::Finished || run.events.is_empty() || run.events.iter().any(|event| event.rate > -0.5) {
            continue;
        }
        let case = Case { name: "throw", theta: &theta, mode: 0, state: &state, to: 1.0, events: run.events.len() };
        check(&SlantedBox { walls: 2 }, &case);
        (cases, impacts) = (cases + 1, impacts + run.events.len());
    }
    assert!(impacts > 60, "{impacts}");
}
