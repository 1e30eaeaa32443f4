//! Sobol' indices by sampling: the part of the variance that each variable explains alone (S), and with all others (T).
//!
//! With two independent points A and B, and A_i = A with coordinate i of B:
//! `S_i = E[f(B) (f(A_i) − f(A))] / V` (Saltelli et al., 2010) and `T_i = E[(f(A) − f(A_i))²] / 2V` (Jansen, 1999). f has its mean taken off, which
//! changes neither and makes S less noisy. Cost: N (d + 2) evaluations. V has no bias (`sampling.rs`), and the jackknife over the replicates takes
//! off that of the ratio and gives its standard error.

use crate::estimate::jackknife;
use crate::sampling::{BLOCK, Stream, in_order, pool, tasks};
use crate::{Error, Estimate, LANES, Lanes, Response, Sampling, Space, at};
use featherbench_spatial::Real;

/// The indices of one output.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// S of each variable.
    pub first: Vec<Estimate>,
    /// T of each variable.
    pub total: Vec<Estimate>,
}

/// Sums of a replicate: of one output, Σ f, Σ f² over A and B, and for each variable Σ f(B)(f(A_i) − f(A)) and Σ (f(A) − f(A_i))².
#[derive(Clone)]
struct Sums {
    count: f64,
    plain: Vec<[f64; 2]>,
    pairs: Vec<[f64; 2]>,
}

/// The indices of each output. `settings.samples` counts pairs of points.
///
/// # Errors
/// [`Error`] when variables are correlated, a setting makes no sense, or a sample has no finite answer.
pub fn sensitivity<R: Response>(space: &Space, response: &R, settings: &Sampling) -> Result<Vec<Indices>, Error> {
    featherbench_model::DimensionError::expect("variables of the answer", space.len(), response.inputs())?;
    if space.is_correlated() {
        return Err(Error::Correlated);
    }
    let (n, outputs, replicates) = (space.len(), response.outputs(), settings.replicates);
    let each = settings.samples.div_ceil(replicates.max(1));
    if replicates < 3 || each < 2 {
        return Err(Error::Setting {
            setting: "samples",
            found: settings.samples,
            demand: "two at least in each of three replicates at least",
        });
    }
    let streams = Stream::all(settings.points, 2 * n, settings.seed, replicates)?;
    let middle = at(response, &space.means());
    let mut found: Vec<Option<Sums>> = vec![None; replicates as usize];
    in_order(
        pool(settings.threads)?.as_ref(),
        &tasks(each, replicates),
        || response.scratch(),
        |scratch, r, b| block(space, response, scratch, &streams[r as usize], b * BLOCK, (each - b * BLOCK).min(BLOCK), &middle),
        |r, b, sums| {
            if sums.plain.iter().chain(&sums.pairs).flatten().any(|sum| !sum.is_finite()) {
                return Err(Error::NotFinite { replicate: r, sample: b * BLOCK });
            }
            match &mut found[r as usize] {
                Some(own) => {
                    own.count += sums.count;
                    let all = own.plain.iter_mut().chain(&mut own.pairs).zip(sums.plain.iter().chain(&sums.pairs));
                    all.for_each(|(own, more)| own.iter_mut().zip(more).for_each(|(own, more)| *own += more));
                }
                empty => *empty = Some(sums),
            }
            Ok(())
        },
    )?;
    let found: Vec<Sums> = found.into_iter().flatten().collect();
    let index = |output: usize, i: usize, which: usize| {
        // Of all replicates, or of all but one.
        let of = |without: Option<usize>| -> f64 {
            let kept = || found.iter().enumerate().filter(move |(r, _)| Some(*r) != without).map(|(_, sums)| sums);
            let count = kept().count() as f64;
            let mean = |value: &dyn Fn(&Sums) -> f64| kept().map(value).sum::<f64>() / count;
            let middle = |sums: &Sums| sums.plain[output][0] / (2.0 * sums.count);
            let [all, square] = [mean(&middle), mean(&|sums| sums.plain[output][1] / (2.0 * sums.count))];
            let of_mean = mean(&|sums| (middle(sums) - all).powi(2)) / (count - 1.0);
            let variance = square - all * all + of_mean;
            let part = mean(&|sums| sums.pairs[output * n + i][which] / sums.count) * if which == 0 { 1.0 } else { 0.5 };
            // No variable explains a part of nothing.
            if variance > 0.0 { part / variance } else { 0.0 }
        };
        jackknife(of(None), &(0..found.len()).map(|r| of(Some(r))).collect::<Vec<f64>>())
    };
    let of = |output: usize| Indices {
        first: (0..n).map(|i| index(output, i, 0)).collect(),
        total: (0..n).map(|i| index(output, i, 1)).collect(),
    };
    Ok((0..outputs).map(of).collect())
}

fn block<R: Response>(
    space: &Space,
    response: &R,
    scratch: &mut R::Scratch,
    stream: &Stream,
    first: u64,
    count: u64,
    middle: &[f64],
) -> Sums {
    let (n, outputs) = (space.len(), middle.len());
    let mut sums = Sums { count: count as f64, plain: vec![[0.0; 2]; outputs], pairs: vec![[0.0; 2]; outputs * n] };
    let (mut unit, mut normal, mut one) = (vec![0.0; 2 * n], vec![0.0; n], vec![0.0; n]);
    let mut points = [vec![Lanes::zero(); n], vec![Lanes::zero(); n]];
    let mut answers = [vec![Lanes::zero(); outputs], vec![Lanes::zero(); outputs], vec![Lanes::zero(); outputs]];
    for group in (0..count).step_by(LANES) {
        let lanes = (count - group).min(LANES as u64) as usize;
        for lane in 0..LANES {
            stream.point(first + group + lane.min(lanes - 1) as u64, &mut unit);
            for (half, x) in unit.chunks(n).zip(&mut points) {
                space.map(half, &mut normal, &mut one);
                x.iter_mut().zip(&one).for_each(|(x, one)| x.as_mut_array()[lane] = *one);
            }
        }
        for k in 0..2 {
            response.evaluate(scratch, &points[k], &mut answers[k]);
            answers[k].iter_mut().zip(middle).for_each(|(y, middle)| *y -= Lanes::from_f64(*middle));
            for (sum, y) in sums.plain.iter_mut().zip(&answers[k]) {
                y.to_array()[..lanes].iter().for_each(|y| *sum = [sum[0] + y, sum[1] + y * y]);
            }
        }
        for i in 0..n {
            let kept = points[0][i];
            points[0][i] = points[1][i];
            response.evaluate(scratch, &points[0], &mut answers[2]);
            points[0][i] = kept;
            for output in 0..outputs {
                let [a, b, mixed] = [0, 1, 2].map(|k: usize| answers[k][output].to_array());
                let sum = &mut sums.pairs[output * n + i];
                for lane in 0..lanes {
                    let moved = mixed[lane] - middle[output] - a[lane];
                    *sum = [sum[0] + b[lane] * moved, sum[1] + moved * moved];
                }
            }
        }
    }
    sums
}
