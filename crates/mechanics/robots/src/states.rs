//! States: configurations, velocities, accelerations, forces and wrenches, many at a time.

use crate::Random;
use featherbench_model::{JointKind, Model};
use thiserror::Error;

/// The kind of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Case {
    /// Everything drawn at random.
    Random,
    /// q at its neutral value; v, a, τ and wrenches zero.
    Zero,
    /// q at its neutral value; v, a, τ and wrenches random.
    Straight,
    /// Random, with velocities a thousand times larger.
    Fast,
    /// Random, with each limited joint at its lower or upper limit.
    Limit,
    /// q of a keyframe of the robot's file; v, a, τ and wrenches random.
    Keyframe,
}

impl Case {
    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Zero => "zero",
            Self::Straight => "straight",
            Self::Fast => "fast",
            Self::Limit => "limit",
            Self::Keyframe => "keyframe",
        }
    }

    /// The case named by a word.
    pub fn parse(word: &str) -> Option<Self> {
        [Self::Random, Self::Zero, Self::Straight, Self::Fast, Self::Limit, Self::Keyframe].into_iter().find(|case| case.name() == word)
    }
}

/// A batch of states of one model, each array state after state.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct StateBatch {
    /// Length of one configuration.
    pub nq: usize,
    /// Degrees of freedom.
    pub nv: usize,
    /// Number of described bodies (wrenches act on these).
    pub bodies: usize,
    /// The case of each state.
    pub cases: Vec<Case>,
    /// Configurations, `count × nq`.
    pub q: Vec<f64>,
    /// Velocities, `count × nv`.
    pub v: Vec<f64>,
    /// Accelerations, `count × nv`.
    pub a: Vec<f64>,
    /// Joint forces, `count × nv`.
    pub tau: Vec<f64>,
    /// Wrenches [moment; force] at each described body's origin in body axes, `count × bodies × 6`.
    pub wrench: Vec<f64>,
}

/// The cases at the beginning of an agreement batch: one of each first, so that a short prefix covers all.
const OPENING: [Case; 10] =
    [Case::Random, Case::Zero, Case::Straight, Case::Fast, Case::Random, Case::Limit, Case::Straight, Case::Fast, Case::Limit, Case::Fast];

/// Why a batch of states does not belong to a model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BadState {
    /// An array has the wrong length.
    #[error("{array} has {found} numbers; {count} states of this model take {expected}")]
    Length {
        /// The array.
        array: &'static str,
        /// Numbers found.
        found: usize,
        /// States in the batch.
        count: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("state {state}: {array}[{index}] is {value}; give a finite number")]
    NotFinite {
        /// The state, counted from 0.
        state: usize,
        /// The array.
        array: &'static str,
        /// The index within the state.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A quaternion has not length one.
    #[error("state {state}: the quaternion at q[{index}] has length {length}; divide it by that")]
    NonUnitQuaternion {
        /// The state, counted from 0.
        state: usize,
        /// Where the quaternion begins in q.
        index: usize,
        /// Its length.
        length: f64,
    },
}

/// Normalising in double precision leaves an error of a few 1e-16, printing with 12 digits one of 1e-12.
const QUATERNION_TOLERANCE: f64 = 1e-9;

impl StateBatch {
    /// Checks that the batch belongs to a model: lengths, finite numbers, unit quaternions.
    ///
    /// # Errors
    /// The first [`BadState`].
    pub fn check(&self, model: &Model<f64>) -> Result<(), BadState> {
        let (count, nq, nv) = (self.count(), model.topology.nq(), model.topology.nv());
        let wrenches = 6 * model.described.len();
        let arrays =
            [("q", &self.q, nq), ("v", &self.v, nv), ("a", &self.a, nv), ("tau", &self.tau, nv), ("wrench", &self.wrench, wrenches)];
        for (array, numbers, each) in arrays {
            if numbers.len() != count * each {
                return Err(BadState::Length { array, found: numbers.len(), count, expected: count * each });
            }
            if let Some((at, &value)) = numbers.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(BadState::NotFinite { state: at / each, array, index: at % each, value });
            }
        }
        for state in 0..count {
            for index in model.topology.quaternions() {
                let quaternion = &self.q[state * nq + index..state * nq + index + 4];
                let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
                if (length - 1.0).abs() > QUATERNION_TOLERANCE {
                    return Err(BadState::NonUnitQuaternion { state, index, length });
                }
            }
        }
        Ok(())
    }

    /// Number of states.
    pub fn count(&self) -> usize {
        self.cases.len()
    }

    /// Configuration of state `k`.
    pub fn q(&self, k: usize) -> &[f64] {
        &self.q[k * self.nq..(k + 1) * self.nq]
    }

    /// Velocity of state `k`.
    pub fn v(&self, k: usize) -> &[f64] {
        &self.v[k * self.nv..(k + 1) * self.nv]
    }

    /// Acceleration of state `k`.
    pub fn a(&self, k: usize) -> &[f64] {
        &self.a[k * self.nv..(k + 1) * self.nv]
    }

    /// Joint forces of state `k`.
    pub fn tau(&self, k: usize) -> &[f64] {
        &self.tau[k * self.nv..(k + 1) * self.nv]
    }

    /// Wrenches of state `k`.
    pub fn wrench(&self, k: usize) -> &[f64] {
        &self.wrench[k * 6 * self.bodies..(k + 1) * 6 * self.bodies]
    }

    /// Length of a head of an agreement batch that covers every case at least once.
    pub const HEAD: usize = 6;

    /// `count` states that cover every case: one zero, two straight, three fast, two at limits (if there are any), the rest random.
    /// The first [`StateBatch::HEAD`] include each case.
    ///
    /// A state depends on the seed, its case and its own number only. v, a, τ and wrenches are uniform in (−1, 1), angles in (−π, π),
    /// quaternions uniform on the sphere, positions in (−1, 1).
    pub fn agreement(model: &Model<f64>, count: usize, seed: u64) -> Self {
        let limited = model.limits.iter().any(|(lower, upper)| lower.is_finite() && upper.is_finite());
        let opening = OPENING.iter().copied().filter(|case| limited || *case != Case::Limit);
        let mut cases: Vec<Case> = opening.take(count).collect();
        cases.resize(count, Case::Random);
        Self::draw(model, cases, seed)
    }

    /// `count` random states: the stream of the timing study.
    pub fn random(model: &Model<f64>, count: usize, seed: u64) -> Self {
        Self::draw(model, vec![Case::Random; count], seed)
    }

    /// `count` random states with the angles of revolute joints uniform in (−reach, reach) and velocities `speed` times larger.
    /// Every number but the quaternions is rounded to the nearest `f32`, so that single precision can be asked the same question.
    pub fn narrow(model: &Model<f64>, count: usize, seed: u64, reach: f64, speed: f64) -> Self {
        let mut batch = Self::random(model, count, seed);
        let single = |x: &mut f64, factor: f64| *x = f64::from((*x * factor) as f32);
        for joint in model.topology.joints() {
            // The coordinates before a quaternion, if there is one. A quaternion is not rounded: it would lose its unit length.
            let (numbers, factor) = match joint.kind {
                JointKind::Revolute(_) => (1, reach / std::f64::consts::PI),
                JointKind::Prismatic(_) | JointKind::Helical => (1, 1.0),
                JointKind::Spherical => (0, 1.0),
                JointKind::Free => (3, 1.0),
            };
            for q in batch.q.chunks_exact_mut(batch.nq) {
                q[joint.q..joint.q + numbers].iter_mut().for_each(|x| single(x, factor));
            }
        }
        batch.v.iter_mut().for_each(|x| single(x, speed));
        batch.a.iter_mut().chain(&mut batch.tau).for_each(|x| single(x, 1.0));
        batch
    }

    /// The batch with one more state for each of these configurations; velocities, accelerations, forces and wrenches are in (−1, 1).
    ///
    /// Quaternions are normalised. One of length zero, which stands for no rotation, becomes the identity, as in MuJoCo.
    ///
    /// # Errors
    /// [`BadState`] of a configuration that is not this model's.
    pub fn with_keyframes(mut self, model: &Model<f64>, configurations: &[Vec<f64>], seed: u64) -> Result<Self, BadState> {
        for configuration in configurations {
            let mut q = configuration.clone();
            // Of another length, it is not this model's: `check` says so.
            let _ = model.topology.normalise(&mut q);
            let mut random = Random::new(seed, self.count() as u64);
            self.q.extend(q);
            self.draw_motion(&mut random, 1.0, 1.0);
            self.cases.push(Case::Keyframe);
        }
        self.check(model)?;
        Ok(self)
    }

    /// Draws v, a, τ and wrenches of one state.
    fn draw_motion(&mut self, random: &mut Random, speed: f64, effort: f64) {
        self.v.extend((0..self.nv).map(|_| random.uniform(-1.0, 1.0) * speed * effort));
        self.a.extend((0..self.nv).map(|_| random.uniform(-1.0, 1.0) * effort));
        self.tau.extend((0..self.nv).map(|_| random.uniform(-1.0, 1.0) * effort));
        self.wrench.extend((0..6 * self.bodies).map(|_| random.uniform(-1.0, 1.0) * effort));
    }

    fn draw(model: &Model<f64>, cases: Vec<Case>, seed: u64) -> Self {
        let (nq, nv, bodies) = (model.topology.nq(), model.topology.nv(), model.described.len());
        let mut batch = Self { nq, nv, bodies, ..Self::default() };
        for (k, &case) in cases.iter().enumerate() {
            let mut random = Random::new(seed, k as u64);
            let speed = if case == Case::Fast { 1e3 } else { 1.0 };
            let effort = if case == Case::Zero { 0.0 } else { 1.0 };
            draw_configuration(model, case, &mut random, &mut batch.q);
            batch.draw_motion(&mut random, speed, effort);
        }
        batch.cases = cases;
        batch
    }
}

/// A random configuration: limited joints uniform within their limits, other angles in (−π, π), distances and positions in (−1, 1),
/// quaternions uniform on the sphere.
///
/// ```
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, Random, random_configuration};
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let q = random_configuration(&model, &mut Random::new(1, 0));
/// assert_eq!(q.len(), model.topology.nq());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn random_configuration(model: &Model<f64>, random: &mut Random) -> Vec<f64> {
    let mut q = Vec::with_capacity(model.topology.nq());
    draw_configuration(model, Case::Random, random, &mut q);
    for (q, &(lower, upper)) in q.iter_mut().zip(&model.limits) {
        if lower.is_finite() && upper.is_finite() {
            *q = random.uniform(lower, upper);
        }
    }
    q
}

fn draw_configuration(model: &Model<f64>, case: Case, random: &mut Random, q: &mut Vec<f64>) {
    let neutral = matches!(case, Case::Zero | Case::Straight);
    for joint in model.topology.joints() {
        let quaternion = random.direction::<4>();
        match joint.kind {
            JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
                let reach = if matches!(joint.kind, JointKind::Revolute(_)) { std::f64::consts::PI } else { 1.0 };
                let drawn = random.uniform(-reach, reach);
                let upper_end = random.bits32() & 1 == 1;
                let (lower, upper) = model.limits[joint.q];
                q.push(match case {
                    _ if neutral => 0.0,
                    Case::Limit if lower.is_finite() && upper.is_finite() => {
                        if upper_end {
                            upper
                        } else {
                            lower
                        }
                    }
                    _ => drawn,
                });
            }
            JointKind::Spherical | JointKind::Free => {
                if joint.kind == JointKind::Free {
                    let position: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
                    q.extend(position.map(|x| if neutral { 0.0 } else { x }));
                }
                q.extend(if neutral { [0.0, 0.0, 0.0, 1.0] } else { quaternion });
            }
        }
    }
}
