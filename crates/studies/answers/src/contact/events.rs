//! Events of hybrid systems: their times, saltation matrices, derivatives of whole runs, and the penalty law.

use super::{Case, Number, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_hybrid::penalty::{Drop, PenaltyBall};
use featherbench_hybrid::systems::{BouncingBall, MovingTable, RimlessWheel, RockingBlock, SlantedBox, SlidingSphere, StickSlip};
use featherbench_hybrid::{Hybrid, Run, Saltation, Settings, Start, Status, adjoint, sensitivity, simulate};
use featherbench_robots::Random;
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Draws of each case.
const DRAWS: usize = 200;

pub(super) fn cases() -> Vec<Case> {
    [times(), saltations(), derivatives(), ends(), penalties(), lesson()].into_iter().flatten().collect()
}

fn go<S: Hybrid>(system: &S, theta: &[f64], mode: usize, state: &[f64], to: f64) -> Result<Run<f64>, NoAnswer> {
    let start = Start { mode, time: 0.0, state: state.to_vec() };
    simulate(system, theta, &start, to, &Settings::default()).map_err(failed)
}

fn case(
    name: &str,
    quantity: &'static str,
    params: Value,
    numbers: Vec<Number>,
    evaluate: impl Fn(u64) -> Result<Vec<f64>, NoAnswer> + Send + Sync + 'static,
) -> Case {
    Case { name: name.into(), quantity, method: "hybrid".into(), params, numbers, evaluate: Box::new(evaluate) }
}

/// A number of the largest of some draws, judged as an error.
fn drawn(name: &'static str, quantity: &'static str, one: impl Fn(&mut Random) -> Result<f64, NoAnswer> + Send + Sync + 'static) -> Case {
    case(name, quantity, json!({"draws": DRAWS}), vec![error("error", "closed form")], move |seed| {
        let mut random = Random::named(seed, name);
        let mut most = 0.0;
        for _ in 0..DRAWS {
            most = largest([most, one(&mut random)?]);
        }
        Ok(vec![most])
    })
}

fn event(run: &Run<f64>, index: usize) -> Result<&featherbench_hybrid::Event<f64>, NoAnswer> {
    run.events.get(index).ok_or_else(|| NoAnswer::Failed(format!("the run has {} events", run.events.len())))
}

fn relative(found: f64, known: f64) -> f64 {
    (found / known - 1.0).abs()
}

/// Event times, and what follows from them.
fn times() -> Vec<Case> {
    let quantity = "event_time";
    let ball = |height: f64, gravity: f64, restitution: f64| -> Result<f64, NoAnswer> {
        let run = go(&BouncingBall, &[gravity, restitution], 0, &[height, 0.0, 0.0], 1e3)?;
        let Status::Zeno(tail) = &run.status else { return Err(NoAnswer::Failed(format!("the ball's run is {}", run.status.name()))) };
        let path = tail.state[2].map_or(f64::NAN, |limit| limit.value);
        let impacts = run.events.iter().filter(|event| event.mode == 0).enumerate();
        let of_impacts = impacts.map(|(index, event)| relative(event.time, BouncingBall::impact_time(height, gravity, restitution, index)));
        let ends = [
            relative(tail.time.value, BouncingBall::zeno_time(height, gravity, restitution)),
            relative(path, BouncingBall::path(height, restitution)),
        ];
        Ok(largest(of_impacts.chain(ends)))
    };
    let mut cases = vec![
        case(
            "ball, until it rests",
            quantity,
            json!({"height": 1.0, "restitution": 0.8}),
            vec![error("error", "closed form")],
            move |_| Ok(vec![ball(1.0, 9.81, 0.8)?]),
        ),
        drawn("ball, drawn", quantity, move |random| {
            ball(random.uniform(0.05, 20.0), random.uniform(1.0, 25.0), random.uniform(0.2, 0.95))
        }),
        drawn("sphere begins to roll", quantity, |random| {
            let [speed, friction] = [random.uniform(0.5, 9.0), random.uniform(0.1, 1.0)];
            let [gravity, radius] = [random.uniform(1.0, 20.0), random.uniform(0.05, 2.0)];
            let known = SlidingSphere::rolling_time(speed, friction, gravity);
            let run = go(&SlidingSphere, &[friction, gravity, radius], 0, &[0.0, speed, 0.0], 1.5 * known)?;
            Ok(largest([relative(event(&run, 0)?.time, known), relative(run.state[1], 5.0 * speed / 7.0)]))
        }),
    ];
    for theta in [[1.0, 1.0, 0.3, 1.0, 0.6], [2.0, 50.0, 0.1, 4.0, 3.0], [0.7, 9.0, 1.1, 2.0, 0.1]] {
        let name = format!("stick and slip, k = {}", theta[1]);
        cases.push(case(&name, quantity, json!({"theta": theta}), vec![error("error", "closed form")], move |_| {
            let (slip, stick) = (StickSlip::slip_time(&theta), StickSlip::stick_time(&theta));
            let run = go(&StickSlip, &theta, 1, &[theta[3] / theta[1], theta[2]], 5.5 * (slip + stick))?;
            let known = |index: usize| (index / 2) as f64 * (slip + stick) + slip + if index.is_multiple_of(2) { 0.0 } else { stick };
            event(&run, 9)?;
            Ok(vec![largest(run.events.iter().enumerate().map(|(index, event)| relative(event.time, known(index))))])
        }));
    }
    for (width, amplitude) in [(0.25, 0.05), (0.25, 0.5), (0.25, 0.9), (0.2, 0.5)] {
        let name = format!("rocking block, b/h = {width}, θ₀ = {amplitude} α");
        let numbers = vec![error("error", "closed form"), told("quarter", "1"), told("linear_quarter", "1")];
        cases.push(case(&name, quantity, json!({"width": width, "amplitude": amplitude}), numbers, move |_| {
            let alpha = f64::atan(width);
            let rate = RockingBlock::frequency(9.81, width, 1.0);
            let known = RockingBlock::quarter(alpha, amplitude * alpha).map_err(failed)?;
            let run = go(&RockingBlock, &[9.81, width, 1.0], 0, &[amplitude * alpha, 0.0], 1.2 * known / rate)?;
            let impact = event(&run, 0)?;
            let ratio = RockingBlock::ratio(width, 1.0);
            let missed = largest([relative(impact.time * rate, known), relative(impact.after[1] / impact.before[1], ratio)]);
            Ok(vec![missed, known, RockingBlock::linear_quarter(alpha, amplitude * alpha).map_err(failed)?])
        }));
    }
    cases.push(case("rimless wheel", quantity, json!({"theta": [9.81, 0.2, 0.3]}), vec![error("error", "closed form")], |_| {
        let theta = [9.81, 0.2, 0.3];
        let rate = RimlessWheel::limit_cycle(&theta);
        let run = go(&RimlessWheel, &theta, 0, &[theta[1] - theta[2], rate], 3.0)?;
        event(&run, 1)?;
        Ok(vec![largest(run.events.iter().map(|event| relative(event.after[1], rate)))])
    }));
    cases
}

/// The largest difference of two matrices, relative to the largest entry.
fn difference(found: &DMatrix<f64>, known: &DMatrix<f64>) -> f64 {
    largest((found - known).iter().copied()) / largest(known.iter().copied())
}

/// Ξ against its closed forms.
fn saltations() -> Vec<Case> {
    let quantity = "saltation";
    vec![
        drawn("ball", quantity, |random| {
            let (g, e, v) = (random.uniform(1.0, 20.0), random.uniform(0.0, 1.0), -random.uniform(0.01, 10.0));
            let found = Saltation::new(&BouncingBall, &[g, e], 0, 0, 1, 0.0, &[0.0, v, 2.0]).map_err(failed)?.matrix();
            let known = DMatrix::from_row_slice(2, 2, &[-e, 0.0, -(1.0 + e) * g / v, -e]);
            Ok(difference(&found.view((0, 0), (2, 2)).into_owned(), &known))
        }),
        drawn("moving table", quantity, |random| {
            let theta = [random.uniform(1.0, 20.0), random.uniform(0.0, 1.0), random.uniform(0.01, 0.3), random.uniform(1.0, 20.0)];
            let t = random.uniform(0.0, 5.0);
            let (sine, cosine) = f64::sin_cos(theta[3] * t);
            // Faster downwards than the table.
            let v = theta[2] * theta[3] * cosine - random.uniform(0.1, 5.0);
            let found = Saltation::new(&MovingTable, &theta, 0, 0, 0, t, &[theta[2] * sine, v]).map_err(failed)?;
            Ok(difference(&found.matrix(), &DMatrix::from_row_slice(2, 2, &MovingTable::saltation(t, v, &theta))))
        }),
        drawn("slanted wall", quantity, |random| {
            let (g, e, angle) = (random.uniform(1.0, 20.0), random.uniform(0.0, 1.0), random.uniform(-3.0, 3.0));
            let (d, normal, along) = (random.uniform(-1.0, 1.0), -random.uniform(0.1, 5.0), random.uniform(-5.0, 5.0));
            let (sine, cosine) = f64::sin_cos(angle);
            let v = [normal * cosine - along * sine, normal * sine + along * cosine];
            let before = [d * cosine, d * sine, v[0], v[1]];
            let found = Saltation::new(&SlantedBox { walls: 1 }, &[g, e, angle, d], 0, 0, 0, 0.0, &before).map_err(failed)?;
            Ok(difference(&found.matrix(), &DMatrix::from_row_slice(4, 4, SlantedBox::saltation(g, e, angle, v).as_flattened())))
        }),
    ]
}

/// Derivatives of whole runs.
fn derivatives() -> Vec<Case> {
    let (g, e, to) = (9.81_f64, 0.8, 0.7);
    // The flow to t₁, Ξ, and the flow to T, by hand.
    let by_hand = move || {
        let first = (2.0 / g).sqrt();
        let (v, rest) = (-g * first, to - first);
        let flow = |t: f64| DMatrix::from_row_slice(2, 2, &[1.0, t, 0.0, 1.0]);
        let jump = DMatrix::from_row_slice(2, 2, &[-e, 0.0, -(1.0 + e) * g / v, -e]);
        (flow(rest) * jump * flow(first), [-v * rest, -v], (v, rest))
    };
    let numbers = vec![error("error", "closed form"), error("adjoint", "forward"), told("lesson_error", "1")];
    let ball = case("ball, one bounce", "run_derivative", json!({"g": g, "e": e, "to": to}), numbers, move |_| {
        let run = go(&BouncingBall, &[g, e], 0, &[1.0, 0.0, 0.0], to)?;
        let columns = sensitivity(&BouncingBall, &[g, e], &run).map_err(failed)?.columns;
        let (known, of_e, (v, rest)) = by_hand();
        let found = DMatrix::from_fn(2, 2, |row, column| columns[column][row]);
        let missed_e = largest([0, 1].map(|row| columns[4][row] - of_e[row])) / largest(of_e);
        let gradient = adjoint(&BouncingBall, &[g, e], &run, &[1.0, 0.0, 0.0], &vec![0.0; run.events.len()]).map_err(failed)?;
        let apart = largest([0, 1].map(|column| gradient.state[column] - columns[column][0])) / largest(gradient.state.iter().copied());
        // The lesson's law forgets that the time of the event moves: Δ = diag(1, −e) between the flows.
        let flow = |t: f64| DMatrix::from_row_slice(2, 2, &[1.0, t, 0.0, 1.0]);
        let lesson = flow(rest) * DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, -e]) * flow(-v / g);
        Ok(vec![largest([difference(&found, &known), missed_e]), apart, difference(&lesson, &known)])
    });
    let numbers = vec![error("adjoint", "forward"), told("impacts", "1")];
    let throws = case("throws into a box", "run_derivative", json!({"draws": DRAWS}), numbers, |seed| {
        let mut random = Random::named(seed, "throws");
        let (mut missed, mut impacts) = (0.0, 0.0);
        for _ in 0..DRAWS {
            let theta = [random.uniform(2.0, 12.0), random.uniform(0.5, 1.0), random.uniform(0.7, 1.3), 0.0, random.uniform(1.9, 2.5), 0.0];
            let state = [random.uniform(-0.2, 0.2), random.uniform(0.8, 1.2), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
            let run = go(&SlantedBox { walls: 2 }, &theta, 0, &state, 1.0)?;
            // A slow impact has a derivative of 1/ġ, which no bound holds.
            if run.status != Status::Finished || run.events.is_empty() || run.events.iter().any(|event| event.rate > -0.5) {
                continue;
            }
            impacts += run.events.len() as f64;
            let columns = sensitivity(&SlantedBox { walls: 2 }, &theta, &run).map_err(failed)?.columns;
            for row in 0..4 {
                let mut of_state = [0.0; 4];
                of_state[row] = 1.0;
                let zeros = vec![0.0; run.events.len()];
                let gradient = adjoint(&SlantedBox { walls: 2 }, &theta, &run, &of_state, &zeros).map_err(failed)?;
                let backward = gradient.state.iter().chain(&gradient.parameters);
                let size = largest(columns.iter().map(|column| column[row]));
                missed = largest([missed, largest(backward.zip(&columns).map(|(a, column)| a - column[row])) / size]);
            }
        }
        Ok(vec![missed, impacts])
    });
    vec![ball, throws]
}

/// Runs that do not simply finish say why: one word is due.
fn ends() -> Vec<Case> {
    let of = |name: &str, due: &'static str, make: fn() -> Result<Run<f64>, NoAnswer>| {
        case(name, "end_of_run", json!({"due": due}), vec![count("as_known", 1.0, "theory")], move |_| {
            Ok(vec![f64::from(u8::from(make()?.status.name() == due))])
        })
    };
    /// A throw to a ceiling this far above the apex.
    fn ceiling(above: f64) -> Result<Run<f64>, NoAnswer> {
        let speed = 3.0;
        let height = speed * speed / (2.0 * 9.81) + above;
        go(&SlantedBox { walls: 1 }, &[9.81, 0.8, -FRAC_PI_2, -height], 0, &[0.0, 0.0, 0.7, speed], 0.6)
    }
    vec![
        of("ball, until it rests", "zeno", || go(&BouncingBall, &[9.81, 0.8], 0, &[1.0, 0.0, 0.0], 1e3)),
        of("throw to the ceiling", "grazing", || ceiling(0.0)),
        of("throw below the ceiling", "finished", || ceiling(1e-6)),
        of("throw into the ceiling", "finished", || ceiling(-1e-6)),
    ]
}

/// The slope of log |error| in log k by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(k, error)| (k.ln(), error.abs().ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    logs.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / logs.iter().map(|point| (point.0 - x).powi(2)).sum::<f64>()
}

/// Stiffnesses per unit of mass, N/m: from 10⁷ on the next term of the law, of relative size 1/ω, is below 1 %.
const STIFFNESSES: [f64; 5] = [1e7, 1e8, 1e9, 1e10, 1e11];

/// The penalty limit: the error falls as k^(−1/2), with a known prefactor.
fn penalties() -> Vec<Case> {
    let elastic = Drop { mass: 1.0, gravity: 9.81, height: 1.0, damping: 0.0, time: 0.7 };
    let drops = [
        elastic,
        Drop { damping: 0.1, ..elastic },
        Drop { damping: 0.3, time: 0.6, ..elastic },
        Drop { mass: 3.0, gravity: 1.6, height: 0.4, damping: 0.05, time: 1.0 },
    ];
    let of = |drop: Drop| {
        let numbers = vec![error("slope_off", "theory"), error("prefactor_off", "closed form"), told("slope", "1")];
        let params = json!({"mass": drop.mass, "gravity": drop.gravity, "height": drop.height, "damping": drop.damping, "time": drop.time});
        case(&format!("penalty, m = {}, ζ = {}", drop.mass, drop.damping), "penalty_law", params, numbers, move |_| {
            let law = drop.law().map_err(failed)?;
            let mut errors = Vec::new();
            for stiffness in STIFFNESSES {
                let stiffness = drop.mass * stiffness;
                let run = go(&PenaltyBall, &drop.parameters(stiffness), 0, &[drop.height, 0.0], drop.time)?;
                errors.push((stiffness, [run.state[0] - law.limit[0], run.state[1] - law.limit[1]]));
            }
            let slopes = [0, 1].map(|k| slope(&errors.iter().map(|(stiffness, error)| (*stiffness, error[k])).collect::<Vec<_>>()));
            let Some((stiffness, last)) = errors.last() else { return Err(NoAnswer::Failed("there is no stiffness".into())) };
            let prefactors = [0, 1].map(|k| relative(last[k] * stiffness.sqrt(), law.prefactor[k]));
            Ok(vec![largest(slopes.map(|slope| slope + 0.5)), largest(prefactors), slopes[0]])
        })
    };
    drops.into_iter().map(of).collect()
}

/// ẋ = θ until x reaches a threshold, and αθ after it: the lesson's problem 3 in numbers.
struct Threshold;

impl Hybrid for Threshold {
    fn states(&self) -> usize {
        1
    }

    fn parameters(&self) -> usize {
        3
    }

    fn modes(&self) -> usize {
        2
    }

    fn guards(&self, mode: usize) -> usize {
        1 - mode
    }

    fn direction(&self, _: usize, _: usize) -> featherbench_hybrid::Direction {
        featherbench_hybrid::Direction::Rising
    }

    fn flow<T: featherbench_spatial::Real>(&self, _: usize, _: T, _: &[T], theta: &[T], rate: &mut [T]) {
        rate[0] = theta[0];
    }

    fn guard<T: featherbench_spatial::Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T]) -> T {
        x[0] - theta[1]
    }

    fn reset<T: featherbench_spatial::Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        after[0] = theta[2] * x[0];
    }

    fn target(&self, _: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1
    }
}

/// f = θ = 2 from x = 0; at x_i = 1 the state becomes α x_i = ½. Then x(1) = ½ + θ (1 − 1/θ) = θ − ½, and dx(1)/dθ = 1. The lesson scales by α: ¾.
fn lesson() -> Vec<Case> {
    let numbers = vec![error("error", "closed form"), told("derivative", "1"), told("lesson_error", "1")];
    let one = case("lesson, problem 3", "run_derivative", json!({"theta": 2.0, "threshold": 1.0, "alpha": 0.5}), numbers, |_| {
        let theta = [2.0, 1.0, 0.5];
        let run = go(&Threshold, &theta, 0, &[0.0], 1.0)?;
        let columns = sensitivity(&Threshold, &theta, &run).map_err(failed)?.columns;
        let found = columns[1][0];
        // Before the event dx/dθ = t₁ = ½, which the lesson scales by α; after it ½ is added.
        let lesson = 0.5 * 0.5 + 0.5;
        Ok(vec![(found - 1.0).abs(), found, f64::abs(lesson - 1.0)])
    });
    vec![one]
}
