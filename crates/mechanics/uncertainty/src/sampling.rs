//! Sampling: moments, quantiles and densities from random or scrambled Sobol' points.
//!
//! The samples are those of R *replicates*: independent streams of random points, or independent scramblings of one sequence. Sample k of replicate r
//! is a function of (seed, r, k). Blocks of fixed size are reduced by themselves and merged in their order: the digits do not depend on the
//! number of threads.
//!
//! Standard errors: of random points, from the moments of all samples. Of Sobol' points, from the spread of the R replicates. Sobol' points of one
//! replicate are not independent, so nothing may be divided by N − 1: with the mean of all replicates ȳ and those of each, ȳ_r,
//! `V = Σ (y − ȳ)²/N + Σ_r (ȳ_r − ȳ)²/(R (R − 1))` has no bias. Its last term is the squared error of ȳ.
//!
//! Student's interval of R replicates whose estimates have the skewness γ holds the truth with a probability that is 0.25 γ²/R below its own (P. Hall,
//! 1983, the second order of Edgeworth's expansion at 95 %). γ of a variance is up to 2 here: 6 % with 16 replicates, 1.5 % with 64.
//!
//! **Control variate.** ℓ = y(μ) + J (x − μ) has a known mean, y(μ). With β = cov(y, ℓ)/var(ℓ), the mean of y − β (ℓ − y(μ)) is that of y, and
//! its variance is (1 − ρ²) var(y). β is fitted to the same samples, which biases the mean by O(1/N).

use crate::estimate::of_replicates;
use crate::moments::product_sum;
use crate::quantile::{QUANTILES, Quantile};
use crate::{Error, Estimate, Histogram, LANES, Lanes, Linear, Moments, Response, Sobol, Space};
use featherbench_robots::Random;
use featherbench_spatial::Real;
use featherbench_spatial::{larger, smaller};
use nalgebra::DMatrix;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Samples of a block.
pub(crate) const BLOCK: u64 = 4096;
/// Blocks that are computed before they are merged.
const WAVE: usize = 256;

/// Where samples are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// Independent random points: Monte Carlo.
    Random,
    /// Scrambled Sobol' points.
    Sobol,
}

/// How to sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Where.
    pub points: Points,
    /// How many, in all replicates together; rounded up to a multiple of the replicates.
    pub samples: u64,
    /// The seed.
    pub seed: u64,
    /// Independent replicates; two at least. Few make the interval of a skewed estimate too short, many the points of each less even.
    pub replicates: u64,
    /// Threads; `None` takes all that rayon has.
    pub threads: Option<usize>,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { points: Points::Random, samples: 1 << 16, seed: 1, replicates: 64, threads: None }
    }
}

/// What is known of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The mean.
    pub mean: Estimate,
    /// The variance.
    pub variance: Estimate,
    /// The standard deviation: the root of the variance, less its bias.
    pub deviation: Estimate,
    /// The mean by the control variate, if there is one.
    pub controlled: Option<Estimate>,
    /// 1/(1 − ρ²): how many times as many samples the plain mean would need.
    pub reduction: Option<f64>,
    /// The [`QUANTILES`].
    pub quantiles: [Quantile; QUANTILES.len()],
    /// All moments.
    pub moments: Moments,
    /// The density.
    pub histogram: Histogram,
}

/// What sampling found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// How many samples there were.
    pub samples: u64,
    /// The outputs.
    pub outputs: Vec<Output>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// The points of one replicate.
pub(crate) enum Stream {
    Random { seed: u64, replicate: u64 },
    Sobol(Sobol),
}

impl Stream {
    /// The streams of all replicates.
    pub(crate) fn all(points: Points, dimensions: usize, seed: u64, replicates: u64) -> Result<Vec<Self>, Error> {
        match points {
            Points::Random => Ok((0..replicates).map(|replicate| Self::Random { seed, replicate }).collect()),
            Points::Sobol => {
                let first = Sobol::new(dimensions, seed)?;
                let other = |r: u64| first.with_seed(Random::new(seed, r).bits64());
                Ok((0..replicates).map(|r| Self::Sobol(other(r))).collect())
            }
        }
    }

    /// Point `sample`, in (0, 1).
    pub(crate) fn point(&self, sample: u64, unit: &mut [f64]) {
        match self {
            Self::Random { seed, replicate } => {
                // A stream for each sample: up to 2⁴⁰ of a replicate.
                let mut random = Random::new(*seed, replicate << 40 | sample);
                unit.iter_mut().for_each(|u| *u = ((random.bits64() >> 11) as f64 + 0.5) * (0.5 * f64::EPSILON));
            }
            Self::Sobol(sobol) => sobol.point(sample, unit),
        }
    }
}

/// A pool of so many threads, or none: rayon's own.
pub(crate) fn pool(threads: Option<usize>) -> Result<Option<ThreadPool>, Error> {
    let start = |count| ThreadPoolBuilder::new().num_threads(count).build().map_err(|error| Error::Threads(error.to_string()));
    match threads {
        Some(0) => Err(Error::Setting { setting: "threads", found: 0, demand: "one at least" }),
        threads => threads.map(start).transpose(),
    }
}

/// Blocks in waves: computed in any order by any thread, merged in their order.
pub(crate) fn in_order<S: Send, B: Send>(
    pool: Option<&ThreadPool>,
    tasks: &[(u64, u64)],
    scratch: impl Fn() -> S + Sync,
    block: impl Fn(&mut S, u64, u64) -> B + Sync,
    mut merge: impl FnMut(u64, u64, B) -> Result<(), Error>,
) -> Result<(), Error> {
    for wave in tasks.chunks(WAVE) {
        let compute = || wave.par_iter().map_init(&scratch, |scratch, &(r, b)| block(scratch, r, b)).collect::<Vec<B>>();
        let done = match pool {
            Some(pool) => pool.install(compute),
            None => compute(),
        };
        for (&(r, b), found) in wave.iter().zip(done) {
            merge(r, b, found)?;
        }
    }
    Ok(())
}

/// What a thread works in.
pub(crate) struct Bench<S> {
    pub(crate) scratch: S,
    unit: Vec<f64>,
    normal: Vec<f64>,
    one: Vec<f64>,
    x: Vec<Lanes>,
    y: Vec<Lanes>,
    /// The answers of a block, output after output, and their linear parts.
    values: Vec<f64>,
    linear: Vec<f64>,
}

impl<S> Bench<S> {
    fn new<R: Response<Scratch = S>>(response: &R) -> Self {
        let (inputs, outputs) = (response.inputs(), response.outputs());
        Self {
            scratch: response.scratch(),
            unit: vec![0.0; inputs],
            normal: vec![0.0; inputs],
            one: vec![0.0; inputs],
            x: vec![Lanes::zero(); inputs],
            y: vec![Lanes::zero(); outputs],
            values: vec![0.0; outputs * BLOCK as usize],
            linear: vec![0.0; outputs * BLOCK as usize],
        }
    }

    /// Evaluates samples first … first + count − 1 of a replicate into `values`, and the linear part into `linear`.
    fn fill<R: Response<Scratch = S>>(&mut self, problem: &Problem<R>, replicate: u64, first: u64, count: usize) {
        let Self { scratch, unit, normal, one, x, y, values, linear } = self;
        for group in (0..count).step_by(LANES) {
            for lane in 0..LANES {
                let sample = first + (group + lane).min(count - 1) as u64;
                problem.streams[replicate as usize].point(sample, unit);
                problem.space.map(unit, normal, one);
                x.iter_mut().zip(&*one).for_each(|(x, one)| x.as_mut_array()[lane] = *one);
            }
            problem.response.evaluate(scratch, x, y);
            let lanes = LANES.min(count - group);
            for (k, y) in y.iter().enumerate() {
                let begin = k * BLOCK as usize + group;
                values[begin..begin + lanes].copy_from_slice(&y.to_array()[..lanes]);
            }
            if let Some(known) = problem.linear {
                for k in 0..y.len() {
                    let terms = x.iter().enumerate();
                    let sum = terms.fold(Lanes::from_f64(known.value[k]), |sum, (i, x)| {
                        (*x - Lanes::from_f64(known.at[i])).mul_add(Lanes::from_f64(known.jacobian[(k, i)]), sum)
                    });
                    let begin = k * BLOCK as usize + group;
                    linear[begin..begin + lanes].copy_from_slice(&sum.to_array()[..lanes]);
                }
            }
        }
    }
}

struct Problem<'a, R> {
    space: &'a Space,
    response: &'a R,
    linear: Option<&'a Linear>,
    streams: &'a [Stream],
}

/// What a block, or several, come to.
#[derive(Clone)]
struct Reduced {
    outputs: Vec<Moments>,
    /// Σ (y_i − ȳ_i)(y_j − ȳ_j) for j < i.
    products: Vec<f64>,
    /// Moments of ℓ, and Σ (y − ȳ)(ℓ − ℓ̄).
    linear: Vec<(Moments, f64)>,
    histograms: Vec<Histogram>,
    /// The first sample without a finite answer.
    bad: Option<u64>,
}

impl Reduced {
    fn of<S>(bench: &Bench<S>, outputs: usize, first: u64, count: usize, with_linear: bool, ranges: &[(f64, f64)]) -> Self {
        let part = |list: &'_ [f64], k: usize| -> Vec<f64> { list[k * BLOCK as usize..k * BLOCK as usize + count].to_vec() };
        let values: Vec<Vec<f64>> = (0..outputs).map(|k| part(&bench.values, k)).collect();
        let bad = values.iter().filter_map(|list| list.iter().position(|y| !y.is_finite())).min().map(|place| first + place as u64);
        let moments: Vec<Moments> = values.iter().map(|list| Moments::of(list)).collect();
        let pairs = (0..outputs).flat_map(|i| (0..i).map(move |j| (i, j)));
        let products = pairs.map(|(i, j)| product_sum(&values[i], moments[i].mean, &values[j], moments[j].mean)).collect();
        let of_linear = |k: usize| {
            let list = part(&bench.linear, k);
            let of = Moments::of(&list);
            (of, product_sum(&values[k], moments[k].mean, &list, of.mean))
        };
        let linear = if with_linear { (0..outputs).map(of_linear).collect() } else { Vec::new() };
        let counted = |((low, high), list): (&(f64, f64), &Vec<f64>)| {
            let mut histogram = Histogram::new(*low, *high);
            histogram.count(list);
            histogram
        };
        let histograms = ranges.iter().zip(&values).map(counted).collect();
        Self { outputs: moments, products, linear, histograms, bad }
    }

    fn merge(&mut self, other: &Self) {
        // Σ(y − ȳ)(z − z̄) of both: their own, and n_a n_b/n times the differences of the means.
        let share = |a: &Moments, b: &Moments| a.count * b.count / (a.count + b.count);
        let mut place = 0;
        for i in 0..self.outputs.len() {
            for j in 0..i {
                let apart = (other.outputs[i].mean - self.outputs[i].mean) * (other.outputs[j].mean - self.outputs[j].mean);
                self.products[place] += other.products[place] + apart * share(&self.outputs[i], &other.outputs[i]);
                place += 1;
            }
        }
        for (k, (own, more)) in self.linear.iter_mut().zip(&other.linear).enumerate() {
            let apart = (other.outputs[k].mean - self.outputs[k].mean) * (more.0.mean - own.0.mean);
            *own = (own.0.merged(more.0), own.1 + more.1 + apart * share(&own.0, &more.0));
        }
        self.outputs.iter_mut().zip(&other.outputs).for_each(|(own, more)| *own = own.merged(*more));
        self.histograms.iter_mut().zip(&other.histograms).for_each(|(own, more)| own.add(more));
    }

    /// The mean of y − β (ℓ − y(μ)), and β.
    fn controlled(&self, k: usize, known: f64) -> Option<(f64, f64)> {
        let (of, with) = self.linear.get(k)?;
        let slope = if of.sums[0] > 0.0 { with / of.sums[0] } else { 0.0 };
        Some((self.outputs[k].mean - slope * (of.mean - known), slope))
    }
}

fn check(settings: &Sampling) -> Result<u64, Error> {
    let Sampling { samples, replicates, .. } = *settings;
    if replicates < 2 {
        return Err(Error::Setting { setting: "replicates", found: replicates, demand: "two at least, or there is no standard error" });
    }
    let each = samples.div_ceil(replicates);
    if each < 2 {
        return Err(Error::Setting { setting: "samples", found: samples, demand: "two at least in each replicate" });
    }
    if each > 1 << 32 {
        return Err(Error::Setting { setting: "samples", found: samples, demand: "2³² at most in each replicate" });
    }
    Ok(each)
}

/// Blocks of `each` samples for all replicates: (replicate, block).
pub(crate) fn tasks(each: u64, replicates: u64) -> Vec<(u64, u64)> {
    (0..replicates).flat_map(|r| (0..each.div_ceil(BLOCK)).map(move |b| (r, b))).collect()
}

/// Samples answers. With `linear`, its linear part is a control variate. `progress` gets the number of samples that are done.
///
/// # Errors
/// [`Error`] when a setting makes no sense, the parts do not fit each other, or a sample has no finite answer.
pub fn sample<R: Response>(
    space: &Space,
    response: &R,
    linear: Option<&Linear>,
    settings: &Sampling,
    progress: &dyn Fn(u64),
) -> Result<Sampled, Error> {
    featherbench_model::DimensionError::expect("variables of the answer", space.len(), response.inputs())?;
    let each = check(settings)?;
    let (outputs, replicates) = (response.outputs(), settings.replicates);
    let streams = Stream::all(settings.points, space.len(), settings.seed, replicates)?;
    let problem = Problem { space, response, linear, streams: &streams };
    // A first block says where the bins are: twice as wide as its samples.
    let first = each.min(BLOCK) as usize;
    let mut bench = Bench::new(response);
    bench.fill(&problem, 0, 0, first);
    let range = |k: usize| {
        let values = &bench.values[k * BLOCK as usize..k * BLOCK as usize + first];
        let bounds = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (smaller(low, *y), larger(high, *y)));
        (bounds.0 - 0.5 * (bounds.1 - bounds.0), bounds.1 + 0.5 * (bounds.1 - bounds.0))
    };
    let ranges: Vec<(f64, f64)> = (0..outputs).map(range).collect();
    drop(bench);
    let mut found: Vec<Option<Reduced>> = vec![None; replicates as usize];
    let mut done = 0;
    let size = |b: u64| (each - b * BLOCK).min(BLOCK) as usize;
    in_order(
        pool(settings.threads)?.as_ref(),
        &tasks(each, replicates),
        || Bench::new(response),
        |bench, r, b| {
            bench.fill(&problem, r, b * BLOCK, size(b));
            Reduced::of(bench, outputs, b * BLOCK, size(b), linear.is_some(), &ranges)
        },
        |r, b, block| {
            if let Some(sample) = block.bad {
                return Err(Error::NotFinite { replicate: r, sample });
            }
            match &mut found[r as usize] {
                Some(own) => own.merge(&block),
                empty => *empty = Some(block),
            }
            done += size(b) as u64;
            progress(done);
            Ok(())
        },
    )?;
    let found: Vec<Reduced> = found.into_iter().flatten().collect();
    summary(settings, each * replicates, &found, linear)
}

/// Merges the replicates and finds the errors.
fn summary(settings: &Sampling, samples: u64, found: &[Reduced], linear: Option<&Linear>) -> Result<Sampled, Error> {
    let [first, others @ ..] = found else {
        return Err(Error::Setting { setting: "replicates", found: 0, demand: "two at least" });
    };
    let mut all = first.clone();
    others.iter().for_each(|other| all.merge(other));
    let spread = |of: &dyn Fn(&Reduced) -> f64| of_replicates(&found.iter().map(of).collect::<Vec<f64>>());
    // The covariance of the means of all replicates, from those of each. `Σ (y − ȳ)(z − z̄)/N` lacks it: a mean is nearer to its own samples.
    let of_means = |i: usize, j: usize| {
        let apart = |own: &Reduced, k: usize| own.outputs[k].mean - all.outputs[k].mean;
        spread(&|own| apart(own, i) * apart(own, j)).value / (found.len() as f64 - 1.0)
    };
    let random = settings.points == Points::Random;
    let output = |k: usize| {
        let moments = all.outputs[k];
        let known = linear.map_or(0.0, |linear| linear.value[k]);
        let mean = if random { moments.mean_estimate() } else { Estimate { value: moments.mean, ..spread(&|own| own.outputs[k].mean) } };
        let variance = if random {
            moments.variance_estimate()
        } else {
            // The mean square about the mean of all replicates has the error of the variance, to the first order.
            let about = |own: &Moments| own.sums[0] / own.count + (own.mean - moments.mean).powi(2);
            let about = spread(&|own| about(&own.outputs[k]));
            Estimate { value: about.value + of_means(k, k), ..about }
        };
        let part = all.linear.get(k).map(|(of, with)| (with * with / (of.sums[0] * moments.sums[0])).min(1.0));
        let controlled = all.controlled(k, known).map(|(value, slope)| match (random, part) {
            (true, Some(part)) => Estimate { value, error: mean.error * (1.0 - part).sqrt(), freedom: mean.freedom - 1.0 },
            _ => Estimate { value, ..spread(&|own| own.outputs[k].mean - slope * (own.linear[k].0.mean - known)) },
        });
        Output {
            mean,
            variance,
            deviation: root(variance),
            controlled,
            reduction: part.map(|part| 1.0 / (1.0 - part)),
            quantiles: QUANTILES.map(|p| Quantile::of(p, &all.histograms[k], found.iter().map(|own| &own.histograms[k]), random)),
            moments,
            histogram: all.histograms[k].clone(),
        }
    };
    let outputs: Vec<Output> = (0..all.outputs.len()).map(output).collect();
    let covariance = DMatrix::from_fn(outputs.len(), outputs.len(), |i, j| {
        let (high, low) = (i.max(j), i.min(j));
        match (high == low, random) {
            (true, _) => outputs[i].variance.value,
            (false, true) => all.products[high * (high - 1) / 2 + low] / (samples as f64 - 1.0),
            (false, false) => all.products[high * (high - 1) / 2 + low] / samples as f64 + of_means(i, j),
        }
    });
    Ok(Sampled { samples, outputs, covariance })
}

/// The root of a variance. E √V̂ = σ (1 − Var V̂/8σ⁴ …): that bias is taken off.
fn root(variance: Estimate) -> Estimate {
    let Estimate { value, error, freedom } = variance;
    if value <= 0.0 {
        return Estimate { value: 0.0, error: error.sqrt(), freedom };
    }
    Estimate { value: value.sqrt() * (1.0 + (error / value).powi(2) / 8.0), error: 0.5 * error / value.sqrt(), freedom }
}

/// The answers themselves: of each sample of one replicate, output after output. For few samples.
///
/// # Errors
/// [`Error`] when the parts do not fit each other, or there are too many dimensions.
pub fn draw<R: Response>(space: &Space, response: &R, points: Points, samples: u64, seed: u64) -> Result<Vec<Vec<f64>>, Error> {
    featherbench_model::DimensionError::expect("variables of the answer", space.len(), response.inputs())?;
    let streams = Stream::all(points, space.len(), seed, 1)?;
    let problem = Problem { space, response, linear: None, streams: &streams };
    let mut bench = Bench::new(response);
    let mut all = vec![Vec::with_capacity(samples as usize); response.outputs()];
    for first in (0..samples).step_by(BLOCK as usize) {
        let count = (samples - first).min(BLOCK) as usize;
        bench.fill(&problem, 0, first, count);
        for (k, list) in all.iter_mut().enumerate() {
            list.extend_from_slice(&bench.values[k * BLOCK as usize..k * BLOCK as usize + count]);
        }
    }
    Ok(all)
}
