//! Every 95 % interval holds the truth in 95 % of the draws: of means, variances, deviations, quantiles, indices and weights, by every kind of
//! points. Robots, states, spreads, seeds and numbers of samples are drawn.

use crate::share::one_of;
use featherbench_model::{Distribution, Model};
use featherbench_robots::{Family, Random, StateBatch};
use featherbench_uncertainty::{
    Closure, Estimate, Linear, Points, Quantity, Response, RobotResponse, Sampling, Space, State, at, chaos, mixture, normal_quantile,
    sample, sensitivity, spread,
};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Draws at night: the coverage of an interval is then known to √(0.95·0.05/4000) = 0.34 %. By day an eighth of them: 1 %.
const DRAWS: usize = 4000;

/// How often an interval held the truth, by estimator.
#[derive(Default)]
struct Tally(BTreeMap<String, [usize; 2]>);

impl Tally {
    /// What rounds to nothing has no error that could be estimated, such as the index of a mass without effect.
    fn add(&mut self, name: String, found: Estimate, known: f64) {
        let [held, all] = self.0.entry(name).or_default();
        let rounding = 1e-13 * (1.0 + known.abs());
        *held += usize::from((found.value - known).abs() <= found.half_width() + rounding);
        *all += 1;
    }

    /// Each coverage is 95 %, to 2 % and to five of its own deviations, whichever is more. So a right interval fails with a probability below 6e-7,
    /// and one of the forty here with below 3e-5.
    fn judge(&self) {
        assert!(self.0.len() >= 12, "{}", self.0.len());
        let mut wrong = Vec::new();
        for (name, [held, all]) in &self.0 {
            let (share, deviation) = (*held as f64 / *all as f64, (0.95 * 0.05 / *all as f64).sqrt());
            println!("{name}: {held} of {all}, {share:.4} ± {deviation:.4}");
            if (share - 0.95).abs() > (5.0 * deviation).max(0.02) {
                wrong.push(format!("{name}: {held} of {all}"));
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}

/// What is known of an answer. The quantiles by their probability.
struct Known {
    mean: f64,
    variance: f64,
    indices: Vec<[f64; 2]>,
    quantile: Option<Box<dyn Fn(f64) -> f64>>,
}

fn drawn_points(random: &mut Random) -> (Sampling, [Points; 2]) {
    let samples = 1024 << random.below(4);
    (Sampling { samples, seed: random.bits64() >> 1, ..Sampling::default() }, [Points::Random, Points::Sobol])
}

fn ask<R: Response>(tally: &mut Tally, random: &mut Random, space: &Space, response: &R, linear: &Linear, known: &Known) {
    let (settings, kinds) = drawn_points(random);
    let variable = random.below(space.len());
    for points in kinds {
        let mut add = |name: &str, found: Estimate, known: f64| tally.add(format!("{points:?}, {name}"), found, known);
        let settings = Sampling { points, ..settings };
        let found = &sample(space, response, Some(linear), &settings, &|_| ()).unwrap().outputs[0];
        add("mean", found.mean, known.mean);
        add("mean with a control variate", found.controlled.unwrap(), known.mean);
        add("variance", found.variance, known.variance);
        add("deviation", found.deviation, known.variance.sqrt());
        for quantile in &found.quantiles {
            if let (Some(known), Some(found)) = (&known.quantile, quantile.found) {
                add(&format!("quantile {}", quantile.probability), found, known(quantile.probability));
            }
        }
        let found = &sensitivity(space, response, &settings).unwrap()[0];
        // Of a variable without effect both indices are what rounding left: no interval is due.
        if known.indices[variable][1] > 1e-12 {
            add("index, alone", found.first[variable], known.indices[variable][0]);
            add("index, in all", found.total[variable], known.indices[variable][1]);
        }
    }
}

/// A product of powers of lognormal variables is lognormal: all is known in closed form.
fn product(tally: &mut Tally, random: &mut Random, points: &mut Random) {
    let count = 1 + random.below(4);
    let powers: Vec<f64> = (0..count).map(|_| if random.unit() < 0.5 { -1.0 } else { 1.0 }).collect();
    let squares: Vec<f64> = (0..count).map(|_| random.uniform(0.05, 0.2).powi(2).ln_1p()).collect();
    let variable = |square: &f64| Distribution::Lognormal { mean: 1.0, deviation: square.exp_m1().sqrt() };
    let space = Space::independent(&squares.iter().map(variable).collect::<Vec<_>>()).unwrap();
    let location: f64 = powers.iter().zip(&squares).map(|(power, square)| -0.5 * power * square).sum();
    let total: f64 = squares.iter().sum();
    let mean = (location + 0.5 * total).exp();
    let variance = mean * mean * total.exp_m1();
    let indices = squares.iter().map(|own| [own.exp_m1() / total.exp_m1(), 1.0 - (total - own).exp_m1() / total.exp_m1()]).collect();
    let quantile = Box::new(move |p: f64| (location + total.sqrt() * normal_quantile(p)).exp());
    let linear =
        Linear { at: vec![1.0; count], value: DVector::from_element(1, 1.0), jacobian: DMatrix::from_row_slice(1, count, &powers) };
    let response = Closure::new(count, 1, move |x: &[f64], y: &mut [f64]| {
        y[0] = x.iter().zip(&powers).map(|(x, power)| if *power > 0.0 { *x } else { 1.0 / x }).product();
    });
    ask(tally, points, &space, &response, &linear, &Known { mean, variance, indices, quantile: Some(quantile) });
}

/// The first acceleration of an arm. Polynomial chaos of these orders is right to rounding; with one mass the acceleration is monotonic in it.
fn arm(tally: &mut Tally, random: &mut Random, points: &mut Random) {
    let count = 1 + random.below(3);
    let layout = if count == 1 { "planar" } else { "spatial" };
    let mut robot = Family::parse(&format!("chain:n={count},layout={layout}")).unwrap().generate().unwrap();
    robot.uncertain = spread(&robot, random.uniform(0.1, 0.35)).unwrap();
    let model: Model<f64> = Model::build(&robot).unwrap();
    let states = StateBatch::random(&model, 1, random.bits64() >> 1);
    let state = State { q: states.q(0).into(), v: states.v(0).into(), drive: states.tau(0).into() };
    let response = RobotResponse::new(&robot, &state, Quantity::Acceleration, None).unwrap();
    let space = Space::of(&robot.uncertain).unwrap();
    let series = chaos(&space, &response, [30, 15, 10][count - 1]).unwrap();
    let (mass, same) = (space.clone(), response.clone());
    let answer = move |p: f64| at(&same, &[mass.variables()[0].quantile(p)])[0];
    let rises = count > 1 || answer(0.9) > answer(0.1);
    let quantile: Box<dyn Fn(f64) -> f64> = Box::new(move |p| answer(if rises { p } else { 1.0 - p }));
    let known = Known {
        mean: series.mean(0),
        variance: series.variance(0),
        indices: series.sobol_indices(0).unwrap(),
        quantile: (count == 1).then_some(quantile),
    };
    ask(tally, points, &space, &response, &response.linear().unwrap(), &known);
}

/// A part of a uniform variable is one mode, the rest another.
fn modes(tally: &mut Tally, random: &mut Random) {
    let end = random.uniform(0.1, 0.9);
    let space = Space::independent(&[Distribution::Uniform { low: 0.0, high: 1.0 }]).unwrap();
    let (settings, _) = drawn_points(random);
    let found = mixture(&space, &settings, |x| Some((u64::from(x[0] < end), x[0]))).unwrap();
    let mode = &found.modes[1];
    tally.add("mixture, weight".into(), mode.weight, end);
    tally.add("mixture, mean of a mode".into(), mode.moments.mean_estimate(), 0.5 * end);
    tally.add("mixture, variance of a mode".into(), mode.moments.variance_estimate(), end * end / 12.0);
    tally.add("mixture, mean".into(), found.all.mean_estimate(), 0.5);
    tally.add("mixture, variance".into(), found.all.variance_estimate(), 1.0 / 12.0);
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let mut tally = Tally::default();
    let mut random = Random::named(1, "coverage");
    for draw in 0..DRAWS / one_of(8) {
        let mut points = Random::named(draw as u64, "points");
        let of = if draw % 2 == 0 { arm } else { product };
        of(&mut tally, &mut random, &mut points);
        modes(&mut tally, &mut random);
    }
    tally.judge();
}

/// The same, over the seeds of one problem: nothing but the points is drawn. The last problem is the most skewed of the eight: with 16 replicates
/// 90 % of its intervals of the variance hold it. By day it alone, and a quarter of the seeds.
#[test]
fn intervals_hold_the_truth_of_one_problem() {
    for problem in (0..8).rev().take(8 / one_of(8)) {
        let mut tally = Tally::default();
        for seed in 0..2000 / one_of(4) as u64 {
            let mut drawn = Random::named(problem, "problem");
            let mut points = Random::named(seed, "points");
            let of = if problem % 2 == 0 { arm } else { product };
            of(&mut tally, &mut drawn, &mut points);
        }
        tally.judge();
    }
}
