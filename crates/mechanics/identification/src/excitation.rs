//! Exciting trajectories: finite Fourier series within the limits of joints, speed and torque, with cond(Y₁) as small as a search finds.
//!
//! Source: J. Swevers et al., *Optimal robot excitation and identification* (1997). With ω the base frequency:
//!
//! ```text
//! q_j(t) = c_j + Σ_l (a_jl sin(lωt) − b_jl cos(lωt))/(lω)      v_j = Σ_l a_jl cos(lωt) + b_jl sin(lωt)
//! ```
//!
//! The search draws trajectories, keeps the best, and changes it at random by ever smaller amounts. Numbers come from a counter: the same seed
//! gives the same trajectory.

use crate::linear::Rows;
use crate::{Base, IdentificationError, LinearModel, Samples};
use featherbench_robots::Random;
use featherbench_spatial::smaller;
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

/// The part of each limit that is used: between points of the grid a peak is missed by (π/[`GRID`])²/2, 0.5 %.
const SHARE: f64 = 0.98;
/// Points per period of the fastest harmonic.
const GRID: usize = 32;
/// A trajectory that breaks a limit of torque is made smaller by this factor, so often.
const SHRINK: (f64, usize) = (0.75, 8);

/// A finite Fourier series for each dof.
#[derive(Clone, Debug, PartialEq)]
pub struct Fourier {
    /// Base frequency, Hz.
    pub frequency: f64,
    /// The mean of each position.
    pub centre: Vec<f64>,
    /// Of each dof the pairs (a, b) of its harmonics, rad/s or m/s.
    pub harmonics: Vec<Vec<[f64; 2]>>,
}

impl Fourier {
    /// Position, velocity and acceleration at time `t`, s.
    pub fn at(&self, t: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let omega = TAU * self.frequency;
        let (mut q, mut v, mut a) = (self.centre.clone(), vec![0.0; self.centre.len()], vec![0.0; self.centre.len()]);
        for (dof, harmonics) in self.harmonics.iter().enumerate() {
            for (l, [x, y]) in harmonics.iter().enumerate() {
                let rate = omega * (l + 1) as f64;
                let (s, c) = (rate * t).sin_cos();
                q[dof] += (x * s - y * c) / rate;
                v[dof] += x * c + y * s;
                a[dof] += rate * (y * c - x * s);
            }
        }
        (q, v, a)
    }

    /// Samples over whole periods at equal steps, with the torques of parameters θ.
    ///
    /// # Errors
    /// [`IdentificationError`] when the trajectory or θ does not fit the robot.
    pub fn samples(&self, linear: &LinearModel, theta: &[f64], count: usize, periods: f64) -> Result<Samples, IdentificationError> {
        let mut samples = Samples::default();
        for k in 0..count {
            let t = periods / self.frequency * k as f64 / count as f64;
            let (q, v, a) = self.at(t);
            samples.time.push(t);
            samples.q.extend(q);
            samples.v.extend(v);
            samples.a.extend(a);
        }
        samples.tau = vec![0.0; samples.v.len()];
        samples.used = vec![true; samples.v.len()];
        samples.tau = linear.torques(&samples, theta)?;
        Ok(samples)
    }
}

/// How a trajectory is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Base frequency, Hz.
    pub frequency: f64,
    /// Harmonics per joint.
    pub harmonics: usize,
    /// Trajectories that are drawn.
    pub draws: usize,
    /// Changes of the best that are tried.
    pub changes: usize,
    /// The seed.
    pub seed: u64,
    /// The speed of joints without a limit, rad/s or m/s.
    pub speed: f64,
    /// Half the range of joints without a limit, rad or m.
    pub reach: f64,
}

impl Default for Search {
    fn default() -> Self {
        Self { frequency: 0.1, harmonics: 5, draws: 30, changes: 120, seed: 1, speed: 2.0, reach: 1.5 }
    }
}

/// A trajectory that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// The trajectory.
    pub trajectory: Fourier,
    /// cond(Y₁) over a period, of the base columns as they are.
    pub condition: f64,
    /// The same with columns of length one.
    pub scaled: f64,
    /// cond(Y₁) of the first trajectory that was drawn: what the search gained.
    pub first: f64,
    /// Trajectories whose condition was computed.
    pub tried: usize,
}

/// Searches an exciting trajectory for a robot's base parameters.
///
/// # Errors
/// [`IdentificationError::NotExcitable`] for joints whose positions are no plain numbers, [`IdentificationError::NoTrajectory`], and
/// [`IdentificationError::Setting`].
pub fn excite(linear: &LinearModel, base: &Base, search: &Search) -> Result<Excitation, IdentificationError> {
    let setting = |setting, value: f64, good: bool, expected| match good {
        true => Ok(()),
        false => Err(IdentificationError::Setting { setting, value: value.to_string(), expected }),
    };
    setting("frequency", search.frequency, search.frequency > 0.0 && search.frequency.is_finite(), "give a positive number of Hz")?;
    setting("harmonics", search.harmonics as f64, search.harmonics > 0, "give at least one harmonic")?;
    setting("draws", search.draws as f64, search.draws > 0, "draw at least one trajectory")?;
    if let Some(dof) = linear.dofs().iter().find(|dof| dof.position.is_none()) {
        let kind = linear.description().bodies[dof.body].joint.kind.name();
        return Err(IdentificationError::NotExcitable { joint: dof.name.clone(), kind });
    }
    let limits = Limits::of(linear, search);
    let mut random = Random::named(search.seed, "excitation");
    let mut seeker = Seeker { linear, base, limits, rows: Rows::new(linear), tried: 0, broke: None };
    let mut best: Option<(Fourier, f64, f64)> = None;
    let mut first = None;
    for _ in 0..search.draws {
        let drawn = draw(linear.dofs().len(), search, &mut random);
        let Some((trajectory, condition, scaled)) = seeker.judge(drawn)? else { continue };
        first.get_or_insert(condition);
        if best.as_ref().is_none_or(|(_, least, _)| condition < *least) {
            best = Some((trajectory, condition, scaled));
        }
    }
    let Some(mut best) = best else {
        let joint = seeker.broke.map_or_else(String::new, |dof: usize| linear.dofs()[dof].name.clone());
        return Err(IdentificationError::NoTrajectory { tries: search.draws, joint });
    };
    for k in 0..search.changes {
        // From a half of the speed down to a fiftieth.
        let size = 0.5 * 0.04_f64.powf(k as f64 / search.changes as f64) * search.speed;
        let mut changed = best.0.clone();
        for harmonics in &mut changed.harmonics {
            harmonics.iter_mut().flatten().for_each(|x| *x += random.uniform(-size, size));
        }
        if let Some(found) = seeker.judge(changed)?.filter(|(_, condition, _)| *condition < best.1) {
            best = found;
        }
    }
    let (trajectory, condition, scaled) = best;
    Ok(Excitation { trajectory, condition, scaled, first: first.unwrap_or(f64::NAN), tried: seeker.tried })
}

fn draw(dofs: usize, search: &Search, random: &mut Random) -> Fourier {
    let mut pair = || [random.uniform(-1.0, 1.0) * search.speed, random.uniform(-1.0, 1.0) * search.speed];
    let harmonics = (0..dofs).map(|_| (0..search.harmonics).map(|_| pair()).collect()).collect();
    Fourier { frequency: search.frequency, centre: vec![0.0; dofs], harmonics }
}

/// What each dof may do.
struct Limits {
    position: Vec<(f64, f64)>,
    speed: Vec<f64>,
    effort: Vec<f64>,
}

impl Limits {
    fn of(linear: &LinearModel, search: &Search) -> Self {
        let model = linear.model();
        let range = |&(low, high): &(f64, f64)| match (low.is_finite(), high.is_finite()) {
            (true, true) => (low, high),
            (true, false) => (low, low + 2.0 * search.reach),
            (false, true) => (high - 2.0 * search.reach, high),
            (false, false) => (-search.reach, search.reach),
        };
        let position = linear.dofs().iter().filter_map(|dof| dof.position).map(|at| range(&model.limits[at])).collect();
        let speed = linear.dofs().iter().map(|dof| if dof.speed.is_finite() { dof.speed } else { search.speed }).collect();
        Self { position, speed, effort: linear.dofs().iter().map(|dof| dof.effort).collect() }
    }
}

/// Brings trajectories into the limits and asks for their condition.
struct Seeker<'a> {
    linear: &'a LinearModel,
    base: &'a Base,
    limits: Limits,
    rows: Rows,
    tried: usize,
    /// The dof whose limit of torque the last trajectory broke.
    broke: Option<usize>,
}

impl Seeker<'_> {
    /// The trajectory within its limits, cond(Y₁), and that of scaled columns; `None` if torques stay too large.
    fn judge(&mut self, mut trajectory: Fourier) -> Result<Option<(Fourier, f64, f64)>, IdentificationError> {
        for _ in 0..SHRINK.1 {
            self.fit(&mut trajectory);
            let grid = GRID * trajectory.harmonics.first().map_or(1, Vec::len);
            let samples = trajectory.samples(self.linear, &self.linear.nominal(), grid, 1.0)?;
            let nv = self.limits.effort.len();
            let above = |(at, tau): (usize, &f64)| (tau.abs() > SHARE * self.limits.effort[at % nv]).then_some(at % nv);
            self.broke = samples.tau.iter().enumerate().find_map(above);
            if self.broke.is_none() {
                let (condition, scaled) = self.condition(&samples)?;
                self.tried += 1;
                return Ok(Some((trajectory, condition, scaled)));
            }
            trajectory.harmonics.iter_mut().flatten().flatten().for_each(|x| *x *= SHRINK.0);
        }
        Ok(None)
    }

    /// Shrinks each dof to its speed and range, and centres it in the range.
    fn fit(&self, trajectory: &mut Fourier) {
        let points = GRID * trajectory.harmonics.first().map_or(1, Vec::len);
        trajectory.centre.fill(0.0);
        let (mut low, mut high, mut fastest) = (
            vec![f64::INFINITY; self.limits.speed.len()],
            vec![f64::NEG_INFINITY; self.limits.speed.len()],
            vec![0.0_f64; self.limits.speed.len()],
        );
        for k in 0..points {
            let (q, v, _) = trajectory.at(k as f64 / points as f64 / trajectory.frequency);
            for dof in 0..q.len() {
                (low[dof], high[dof], fastest[dof]) = (low[dof].min(q[dof]), high[dof].max(q[dof]), fastest[dof].max(v[dof].abs()));
            }
        }
        for (dof, harmonics) in trajectory.harmonics.iter_mut().enumerate() {
            let (lower, upper) = self.limits.position[dof];
            // A joint that turns freely needs no more than a turn.
            let room = (upper - lower).min(2.0 * PI);
            let factor = [room * SHARE / (high[dof] - low[dof]), self.limits.speed[dof] * SHARE / fastest[dof], 1.0];
            let factor = factor.into_iter().fold(1.0, smaller);
            harmonics.iter_mut().flatten().for_each(|x| *x *= factor);
            trajectory.centre[dof] = 0.5 * (lower + upper) - 0.5 * factor * (low[dof] + high[dof]);
        }
    }

    fn condition(&mut self, samples: &Samples) -> Result<(f64, f64), IdentificationError> {
        let nv = self.limits.effort.len();
        let mut matrix = DMatrix::zeros(samples.count() * nv, self.base.rank());
        for k in 0..samples.count() {
            let (q, v, a) = samples.state(self.linear, k);
            let block = self.rows.at(self.linear, q, v, a)?;
            matrix.rows_mut(k * nv, nv).copy_from(&block.select_columns(&self.base.independent));
        }
        let mut factor = matrix.qr().unpack_r();
        let condition = |factor: &DMatrix<f64>| {
            let values = factor.singular_values();
            values.max() / values.min()
        };
        let plain = condition(&factor);
        for mut column in factor.column_iter_mut() {
            let length = column.norm();
            column /= length;
        }
        Ok((plain, condition(&factor)))
    }
}
