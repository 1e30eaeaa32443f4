//! How good a learned model is: torques of motions that it has not seen, and the energy over a long motion.

use crate::learned::expect;
use crate::motion::rms;
use crate::{Dynamics, ResidualError, Sample};
use featherbench_dynamics::integrate::{DormandPrince, Integrator};
use featherbench_model::Topology;

/// The error of a model's torques: root mean square over all samples and joints, each joint over the root mean square of its torque.
///
/// # Errors
/// [`ResidualError`] if there are no samples, or the model does not answer.
pub fn held_out<D: Dynamics + ?Sized>(model: &D, samples: &[Sample]) -> Result<f64, ResidualError> {
    let n = model.nv();
    if samples.is_empty() {
        return Err(ResidualError::Learning("there is no sample to score with".into()));
    }
    let mut errors = Vec::with_capacity(samples.len() * n);
    for sample in samples {
        expect("joint forces of a sample", n, sample.tau.len())?;
        errors.push(model.inverse(&sample.q, &sample.v, &sample.a)?);
    }
    let of = |joint: usize| {
        let wrong = rms(errors.iter().zip(samples).map(|(found, sample)| found[joint] - sample.tau[joint]));
        wrong / rms(samples.iter().map(|sample| sample.tau[joint]))
    };
    Ok(rms((0..n).map(of)))
}

/// A motion without forces, and how it is integrated: Dormand and Prince's fifth-order rule with fixed steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollout {
    /// The configuration where it begins at rest.
    pub start: Vec<f64>,
    /// The step, s.
    pub step: f64,
    /// The times at which energies are read, s, rising; each is rounded to whole steps.
    pub times: Vec<f64>,
    /// The largest |q_j| that counts as a motion of this robot; beyond it the model has escaped.
    pub bound: f64,
}

/// A model left the range in which its robot moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape {
    /// When, s.
    pub time: f64,
}

/// Of each time: the change of the judge's energy, and of the model's own if it has one.
pub(crate) type Changes = Vec<(f64, f64, Option<f64>)>;

impl Rollout {
    /// Integrates a model, and reads two energies at each time: that of `judge` (the truth), and that of the model itself.
    ///
    /// Each time gives (time, judge's, own). Both energies are changes since the start, over the judge's energy at the start above rest,
    /// that is above q = 0.
    ///
    /// The motion ends where the model escapes: then the second value says when, and later times are missing.
    ///
    /// # Errors
    /// [`ResidualError`] if an argument does not fit, the judge has no energy, or the start is at rest.
    pub fn run<D: Dynamics + ?Sized, J: Dynamics + ?Sized>(
        &self,
        topology: &Topology,
        model: &D,
        judge: &J,
    ) -> Result<(Changes, Option<Escape>), ResidualError> {
        let n = model.nv();
        expect("start of the motion", n, self.start.len())?;
        expect("dofs of the tree", n, topology.nv())?;
        let refuse = |reason: &str| ResidualError::Learning(reason.into());
        let still = vec![0.0; n];
        let energy = |q: &[f64], v: &[f64]| judge.energy(q, v)?.ok_or_else(|| refuse("the judge has no energy"));
        let first = energy(&self.start, &still)?;
        let scale = first - energy(&still, &still)?;
        let own = model.energy(&self.start, &still)?;
        if !(scale.is_finite() && scale > 0.0 && self.step.is_finite() && self.step > 0.0) {
            return Err(refuse("the motion must begin above rest, with a positive step"));
        }
        // A model without an answer gives NaN, which ends the motion.
        let mut acceleration = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
            match model.forward(q, v, &still) {
                Ok(found) => a.copy_from_slice(&found),
                Err(_) => a.fill(f64::NAN),
            }
            Ok(())
        };
        let mut rule = DormandPrince::new(topology);
        let (mut q, mut v, mut steps) = (self.start.clone(), vec![0.0; n], 0_u64);
        let mut changes = Vec::with_capacity(self.times.len());
        for &time in &self.times {
            while (steps as f64 + 0.5) * self.step < time {
                let now = steps as f64 * self.step;
                let stepped = rule.step(&mut acceleration, now, self.step, &mut q, &mut v);
                if stepped.is_err() || q.iter().any(|x| x.abs() > self.bound) {
                    return Ok((changes, Some(Escape { time: now })));
                }
                steps += 1;
            }
            let own = match (own, model.energy(&q, &v)?) {
                (Some(before), Some(now)) => Some((now - before) / scale),
                _ => None,
            };
            changes.push((time, (energy(&q, &v)? - first) / scale, own));
        }
        Ok((changes, None))
    }
}
