//! The embedded pair of Dormand and Prince, of orders 5 and 4, on the configuration space: fixed steps, and steps chosen by a tolerance.
//!
//! Source: J. R. Dormand and P. J. Prince, *A family of embedded Runge–Kutta formulae* (1980); its form on manifolds: see `explicit.rs`. The
//! step size by the controller of Hairer and Wanner, *Solving Ordinary Differential Equations II*, §IV.2 (PI, exponents 0.7/5 and 0.4/5).
//! Order 5. It keeps no structure but the length of quaternions.
//!
//! The error estimate of a step is `e = h Σ (bᵢ − b̂ᵢ) kᵢ`, in ξ and in v. Its measure is the root of the mean of
//!
//! ```text
//! (e_ξ / (absolute + relative·|ξ|))²    and    (e_v / (absolute + relative·max(|v|, |v'|)))²
//! ```
//!
//! A step is accepted if that is at most 1. It contains no position, so that the choice of an origin does not matter.
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of an accepted step: 6 accelerations; the first of the next step is the last of this one.
//! A call does not allocate.

use super::dynamics::Acceleration;
use super::error::{expect_finite, largest, magnitude};
use super::explicit::{Explicit, Tableau};
use super::{IntegrationError, Integrator, Linearise};
use featherbench_model::Topology;
use featherbench_spatial::Angle;

const TABLEAU: Tableau = Tableau {
    nodes: &[(0.0, 1.0), (1.0, 5.0), (3.0, 10.0), (4.0, 5.0), (8.0, 9.0), (1.0, 1.0), (1.0, 1.0)],
    rows: &[
        &[],
        &[(1.0, 5.0)],
        &[(3.0, 40.0), (9.0, 40.0)],
        &[(44.0, 45.0), (-56.0, 15.0), (32.0, 9.0)],
        &[(19372.0, 6561.0), (-25360.0, 2187.0), (64448.0, 6561.0), (-212.0, 729.0)],
        &[(9017.0, 3168.0), (-355.0, 33.0), (46732.0, 5247.0), (49.0, 176.0), (-5103.0, 18656.0)],
        WEIGHTS,
    ],
    weights: WEIGHTS,
};

const WEIGHTS: &[(f64, f64)] = &[(35.0, 384.0), (0.0, 1.0), (500.0, 1113.0), (125.0, 192.0), (-2187.0, 6784.0), (11.0, 84.0)];

/// The weights b̂ of order 4.
const EMBEDDED: [(f64, f64); 7] =
    [(5179.0, 57600.0), (0.0, 1.0), (7571.0, 16695.0), (393.0, 640.0), (-92097.0, 339_200.0), (187.0, 2100.0), (1.0, 40.0)];

/// What an adaptive integration may err by, and how far it may go for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The absolute error per step, in radians and metres, and in their rates.
    pub absolute: f64,
    /// The error per step relative to the displacement of the step and to the velocity.
    pub relative: f64,
    /// The first step to try; without it a thousandth of the time.
    pub first_step: Option<f64>,
    /// The longest step.
    pub longest_step: f64,
    /// The largest number of steps, rejected ones included.
    pub steps: usize,
}

impl Default for Tolerance {
    /// 10⁻⁹ absolute and relative, no longest step, a million steps.
    fn default() -> Self {
        Self { absolute: 1e-9, relative: 1e-9, first_step: None, longest_step: f64::INFINITY, steps: 1_000_000 }
    }
}

/// What an adaptive integration did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Steps accepted.
    pub accepted: usize,
    /// Steps tried with too large an error.
    pub rejected: usize,
    /// Accelerations evaluated.
    pub evaluations: usize,
    /// The shortest accepted step; the last one, which ends at the given time, is not counted unless it is the only one.
    pub shortest: f64,
    /// The longest accepted step.
    pub longest: f64,
}

/// The workspace of the pair of Dormand and Prince.
#[derive(Clone, Debug)]
pub struct DormandPrince<T> {
    method: Explicit<T>,
    /// bᵢ − b̂ᵢ.
    errors: Vec<T>,
}

impl<T: Angle> DormandPrince<T> {
    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        Self { method: Explicit::new(topology, &TABLEAU), errors: errors() }
    }

    /// A workspace for steps and their derivatives with this many inputs.
    pub fn with_derivatives(topology: &Topology, inputs: usize) -> Self {
        Self { method: Explicit::with_derivatives(topology, &TABLEAU, inputs), errors: errors() }
    }

    /// Replaces the state at time `from` by that at `to`, with steps chosen by the tolerance. `accepted` is called with the length of each
    /// accepted step and the state after it.
    ///
    /// With lanes as scalars the steps are the same for all, as the worst lane needs them.
    ///
    /// ```
    /// use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
    /// use featherbench_model::{Axis, JointKind, Topology};
    ///
    /// // q̈ = −q, from 1 at rest: the cosine.
    /// let slider = Topology::new(&[(None, JointKind::Prismatic(Axis::Z))]).unwrap();
    /// let mut spring = |_: f64, q: &[f64], _: &[f64], a: &mut [f64]| {
    ///     a[0] = -q[0];
    ///     Ok(())
    /// };
    /// let (mut q, mut v) = ([1.0], [0.0]);
    /// let statistics = DormandPrince::new(&slider).run(&mut spring, [0.0, 1.0], &mut q, &mut v, &Tolerance::default(), |_, _, _| ())?;
    /// assert!((q[0] - 1.0_f64.cos()).abs() < 1e-8 && (v[0] + 1.0_f64.sin()).abs() < 1e-8);
    /// assert!(statistics.accepted < 60);
    /// # Ok::<(), featherbench_dynamics::integrate::IntegrationError>(())
    /// ```
    ///
    /// # Errors
    /// [`IntegrationError`]; the state is then that after the last accepted step.
    pub fn run<F: Acceleration<T>>(
        &mut self,
        f: &mut F,
        [from, to]: [T; 2],
        q: &mut [T],
        v: &mut [T],
        tolerance: &Tolerance,
        mut accepted: impl FnMut(T, &[T], &[T]),
    ) -> Result<Statistics, IntegrationError> {
        expect_finite(from, q, v)?;
        let span = (to - from).min_lane();
        let mut statistics = Statistics { accepted: 0, rejected: 0, evaluations: 0, shortest: f64::INFINITY, longest: 0.0 };
        let (mut t, mut known) = (from, 0);
        let mut size = tolerance.first_step.unwrap_or(1e-3 * span.abs()).abs();
        let mut previous_error = 1e-4_f64;
        loop {
            let rest = (to - t).min_lane();
            if rest == 0.0 {
                return Ok(statistics);
            }
            // NaN ends here too.
            let resolved = size > 16.0 * f64::EPSILON * (t.min_lane().abs() + rest.abs());
            if !resolved {
                return Err(IntegrationError::StepTooSmall { time: t.min_lane(), step: size });
            }
            if statistics.accepted + statistics.rejected >= tolerance.steps {
                return Err(IntegrationError::TooManySteps { time: t.min_lane(), steps: tolerance.steps });
            }
            size = if size > tolerance.longest_step { tolerance.longest_step } else { size };
            // A rest that is hardly longer than a step is taken whole: no tiny step follows.
            let last = size * (1.0 + 1e-3) >= rest.abs();
            let h = if last { to - t } else { T::from_f64(size.copysign(span)) };
            let evaluations = &mut statistics.evaluations;
            let tried = self.method.evaluate(known, t, h, q, v, |_, t, q, v, a| {
                *evaluations += 1;
                f.acceleration(t, q, v, a)
            });
            known = 1;
            let error = match tried {
                Ok(()) => self.error(h, v, tolerance),
                // A shorter step may avoid it.
                Err(IntegrationError::NotFinite { .. }) if largest(self.method.stages[0].a.iter().copied()).is_finite() => f64::INFINITY,
                Err(error) => return Err(error),
            };
            if error <= 1.0 {
                t = if last { to } else { t + h };
                q.copy_from_slice(&self.method.q);
                v.copy_from_slice(&self.method.v);
                // The last stage is the first of the next step: α is the same, and κ is computed anew.
                let end = self.method.stages.len() - 1;
                let (first, others) = self.method.stages.split_at_mut(1);
                first[0].a.copy_from_slice(&others[end - 1].a);
                accepted(h, q, v);
                let length = magnitude(h);
                if statistics.accepted == 0 || (!last && length < statistics.shortest) {
                    statistics.shortest = length;
                }
                statistics.longest = if length > statistics.longest { length } else { statistics.longest };
                statistics.accepted += 1;
                let error = if error > 1e-10 { error } else { 1e-10 };
                size = length * (0.9 * error.powf(-0.14) * previous_error.powf(0.08)).clamp(0.2, 10.0);
                previous_error = if error > 1e-4 { error } else { 1e-4 };
            } else {
                statistics.rejected += 1;
                // Also for an error that is infinite or NaN.
                let factor = 0.9 * error.powf(-0.2);
                size = magnitude(h) * if factor > 0.1 { factor } else { 0.1 };
            }
        }
    }

    /// The measure of the error of the step just tried from a state with velocity `v`; NaN if a number is.
    fn error(&self, h: T, v: &[T], tolerance: &Tolerance) -> f64 {
        let estimate = |k: usize, of: fn(&super::explicit::Stage<T>, usize) -> T| {
            let sum = self.errors.iter().zip(&self.method.stages).fold(T::zero(), |sum, (e, stage)| e.mul_add(of(stage, k), sum));
            magnitude(sum * h)
        };
        let mut squares = 0.0;
        for (k, v) in v.iter().enumerate() {
            let step = estimate(k, |stage, k| stage.rate[k]) / (tolerance.absolute + tolerance.relative * magnitude(self.method.step[k]));
            let (before, after) = (magnitude(*v), magnitude(self.method.v[k]));
            let speed = if before > after { before } else { after };
            let velocity = estimate(k, |stage, k| stage.a[k]) / (tolerance.absolute + tolerance.relative * speed);
            squares += step * step + velocity * velocity;
        }
        (squares / (2 * v.len()) as f64).sqrt()
    }
}

/// bᵢ − b̂ᵢ.
fn errors<T: Angle>() -> Vec<T> {
    let ratio = |(numerator, denominator): (f64, f64)| T::from_f64(numerator) / T::from_f64(denominator);
    EMBEDDED.iter().enumerate().map(|(i, embedded)| WEIGHTS.get(i).map_or(T::zero(), |weight| ratio(*weight)) - ratio(*embedded)).collect()
}

impl<T: Angle> Integrator<T> for DormandPrince<T> {
    const ORDER: u32 = 5;

    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.method.step(f, t, h, q, v)
    }

    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.method.linearise(f, t, h, q, v)
    }

    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        self.method.push(dq, dv, du);
    }

    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        self.method.pull(lq, lv, lu);
    }
}
