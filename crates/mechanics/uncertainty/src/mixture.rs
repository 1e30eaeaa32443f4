//! Mixtures: answers that differ by contact mode.
//!
//! A sample has a mode (a number, such as the number of impacts) and an answer. Each mode has a weight w = n/N with the standard error
//! √(w (1 − w)/N), and moments of its own. The moments of all are those of the mixture:
//! `E y = Σ w_k E_k`, `Var y = Σ w_k (V_k + (E_k − E y)²)`. A linearisation at the mean sees one mode alone.

use crate::sampling::{BLOCK, Stream, in_order, pool, tasks};
use crate::{Error, Estimate, Moments, Sampling, Space};
use std::collections::BTreeMap;

/// One mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Its number.
    pub mode: u64,
    /// The part of the samples that has it.
    pub weight: Estimate,
    /// The moments of the answer in it.
    pub moments: Moments,
}

/// The modes, and all of them together.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// By rising number.
    pub modes: Vec<Mode>,
    /// The moments of all samples.
    pub all: Moments,
}

/// Samples a function that gives a mode and an answer. The points are random ones: weights of modes are not smooth.
///
/// # Errors
/// [`Error`] when a setting makes no sense, or a sample has no finite answer.
pub fn mixture(space: &Space, settings: &Sampling, answer: impl Fn(&[f64]) -> Option<(u64, f64)> + Sync) -> Result<Mixture, Error> {
    let n = space.len();
    if settings.samples < 2 {
        return Err(Error::Setting { setting: "samples", found: settings.samples, demand: "two at least" });
    }
    let streams = Stream::all(crate::Points::Random, n, settings.seed, 1)?;
    let mut found: BTreeMap<u64, Moments> = BTreeMap::new();
    in_order(
        pool(settings.threads)?.as_ref(),
        &tasks(settings.samples, 1),
        || (vec![0.0; n], vec![0.0; n], vec![0.0; n]),
        |(unit, normal, x), _, b| {
            let mut values: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
            for sample in b * BLOCK..((b + 1) * BLOCK).min(settings.samples) {
                streams[0].point(sample, unit);
                space.map(unit, normal, x);
                match answer(x).filter(|(_, y)| y.is_finite()) {
                    Some((mode, y)) => values.entry(mode).or_default().push(y),
                    None => return Err(Error::NotFinite { replicate: 0, sample }),
                }
            }
            Ok(values.into_iter().map(|(mode, list)| (mode, Moments::of(&list))).collect::<Vec<_>>())
        },
        |_, _, block: Result<Vec<(u64, Moments)>, Error>| {
            for (mode, moments) in block? {
                let own = found.entry(mode).or_default();
                *own = own.merged(moments);
            }
            Ok(())
        },
    )?;
    let total = settings.samples as f64;
    let all = found.values().fold(Moments::default(), |all, own| all.merged(*own));
    let of = |(mode, moments): (u64, Moments)| {
        let value = moments.count / total;
        Mode { mode, weight: Estimate { value, error: (value * (1.0 - value) / total).sqrt(), freedom: total - 1.0 }, moments }
    };
    Ok(Mixture { modes: found.into_iter().map(of).collect(), all })
}
