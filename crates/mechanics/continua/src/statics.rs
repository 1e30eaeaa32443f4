//! Equilibria under loads: r(s, λ) = elastic forces + λ (gravity and loads) = 0 at λ = 1.
//!
//! Method: continuation from the rest at λ = 0. A step predicts by the tangent, s' = −K_T⁻¹ ∂r/∂λ, and Newton's method corrects. A step is
//! taken back and halved if the correction is longer than half of the prediction: then it may have left the branch. Newton's method alone
//! finds whatever equilibrium is near, stable or not, or one on another branch; [`judge`] tells.
//!
//! K_T is judged by its symmetric part. That is stability where gravity and dead loads in a plane have a potential; follower loads can make
//! a rod flutter before.
//!
//! | status | meaning |
//! |---|---|
//! | converged | on the branch from rest, K_T ≻ 0 all the way |
//! | unstable | an equilibrium whose K_T has a negative eigenvalue; along the branch the first such one stops the continuation: the rod buckles |
//! | spurious | a stable equilibrium that is not on the branch from rest |
//! | cap reached | no equilibrium within the allowed steps |

use crate::tangent::{residual, tangent_stiffness};
use crate::{Continuum, Load, SolveError};
use featherbench_spatial::largest;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// How to look for an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The first step of the load factor λ.
    pub first_step: f64,
    /// The largest number of load steps, halved ones included.
    pub steps: usize,
    /// The largest number of Newton's iterations in a step.
    pub iterations: usize,
    /// Reduced dofs that motors hold where they are.
    pub held: Vec<usize>,
    /// The configuration without loads and gravity, for example a robot's pose with straight rods; [`Continuum::rest`] if there is none.
    pub start: Option<Vec<f64>>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { first_step: 0.1, steps: 400, iterations: 20, held: Vec::new(), start: None }
    }
}

/// What is known of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Status {
    /// It is on the stable branch from rest.
    Converged,
    /// K_T has a negative eigenvalue.
    Unstable {
        /// The load factor.
        load: f64,
        /// The smallest eigenvalue of the symmetric part of K_T.
        eigenvalue: f64,
    },
    /// It is an equilibrium, but not that of the branch from rest.
    Spurious {
        /// The largest difference of a coordinate.
        distance: f64,
        /// The smallest eigenvalue of the symmetric part of K_T.
        eigenvalue: f64,
    },
    /// Newton's method or the continuation came to its cap.
    CapReached {
        /// The load factor that was reached.
        load: f64,
        /// The largest number of the residual there, N or N·m.
        residual: f64,
    },
}

/// An equilibrium, or where the search for it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The reduced configuration.
    pub s: Vec<f64>,
    /// What is known of it.
    pub status: Status,
    /// Load steps taken.
    pub steps: usize,
    /// Newton's iterations in all.
    pub iterations: usize,
}

/// A step of Newton's method changes a coordinate by at most this, relative to the largest, when only roundings are left.
const NEAR: f64 = 1e-9;
/// Two equilibria are the same if no coordinate differs by more, relative to the largest: the square root of a rounding, because Newton's
/// method converges to roundings.
const SAME: f64 = 1e-7;

/// The equilibrium under loads and gravity on the branch from rest; it allocates.
///
/// # Errors
/// [`SolveError`]: a load acts on no body. A search without success is no error: see the status.
pub fn equilibrium(continuum: &Continuum, loads: &[Load], settings: &Settings) -> Result<Equilibrium, SolveError> {
    let mut search = Search::new(continuum, settings);
    let mut s = settings.start.clone().unwrap_or_else(|| continuum.rest());
    let (mut load, mut step, mut steps) = (0.0, settings.first_step.clamp(1e-6, 1.0), 0);
    loop {
        let tangent = search.tangent(&s, load, loads)?;
        if let Some(eigenvalue) = negative(&tangent) {
            return Ok(Equilibrium { s, status: Status::Unstable { load, eigenvalue }, steps, iterations: search.iterations });
        }
        if load >= 1.0 {
            return Ok(Equilibrium { s, status: Status::Converged, steps, iterations: search.iterations });
        }
        if steps >= settings.steps || step < 1e-9 {
            let residual = largest(search.residual(&s, 1.0, loads)?.iter().copied());
            return Ok(Equilibrium { s, status: Status::CapReached { load, residual }, steps, iterations: search.iterations });
        }
        steps += 1;
        let next = if load + step > 1.0 - 1e-9 { 1.0 } else { load + step };
        // r is linear in λ
        let by_load = search.residual(&s, 1.0, loads)? - search.residual(&s, 0.0, loads)?;
        let slope = if by_load.is_empty() { Some(by_load) } else { tangent.lu().solve(&by_load) };
        let Some(slope) = slope else {
            step *= 0.5;
            continue;
        };
        let predicted = slope * (load - next);
        let length = if predicted.is_empty() { 0.0 } else { predicted.amax() };
        let mut moved = s.clone();
        search.advance(&mut moved, &predicted)?;
        let before = moved.clone();
        let converged = search.newton(&mut moved, next, loads)?;
        let correction = search.distance(&before, &moved)?;
        if converged && correction <= 0.5 * length + SAME {
            (s, load) = (moved, next);
            step *= if correction <= 0.1 * length { 1.5 } else { 1.0 };
        } else {
            step *= 0.5;
        }
    }
}

/// Newton's method alone from the configuration `from` at full load, and its end judged by [`judge`]; it allocates.
///
/// # Errors
/// As [`equilibrium`].
pub fn newton(continuum: &Continuum, from: &[f64], loads: &[Load], settings: &Settings) -> Result<Equilibrium, SolveError> {
    let mut search = Search::new(continuum, settings);
    let mut s = from.to_vec();
    let converged = search.newton(&mut s, 1.0, loads)?;
    let status = if converged {
        judge(continuum, &s, loads, settings)?
    } else {
        Status::CapReached { load: 1.0, residual: largest(search.residual(&s, 1.0, loads)?.iter().copied()) }
    };
    Ok(Equilibrium { s, status, steps: 1, iterations: search.iterations })
}

/// Whether an equilibrium `s` is stable, and the one on the branch from rest; it allocates.
///
/// # Errors
/// As [`equilibrium`].
pub fn judge(continuum: &Continuum, s: &[f64], loads: &[Load], settings: &Settings) -> Result<Status, SolveError> {
    let search = Search::new(continuum, settings);
    let tangent = search.tangent(s, 1.0, loads)?;
    if let Some(eigenvalue) = negative(&tangent) {
        return Ok(Status::Unstable { load: 1.0, eigenvalue });
    }
    let branch = equilibrium(continuum, loads, settings)?;
    let distance = search.distance(&branch.s, s)?;
    let size = 1.0 + largest(branch.s.iter().copied());
    let same = branch.status == Status::Converged && distance <= SAME * size;
    Ok(if same { Status::Converged } else { Status::Spurious { distance, eigenvalue: smallest(&tangent) } })
}

/// The smallest eigenvalue of the symmetric part; infinite where nothing is free.
fn smallest(matrix: &DMatrix<f64>) -> f64 {
    if matrix.is_empty() {
        return f64::INFINITY;
    }
    let symmetric = (matrix + matrix.transpose()) * 0.5;
    if symmetric.iter().any(|x| !x.is_finite()) { f64::NAN } else { SymmetricEigen::new(symmetric).eigenvalues.min() }
}

/// The smallest eigenvalue if it is negative beyond rounding, n ε ‖K‖, or NaN.
fn negative(matrix: &DMatrix<f64>) -> Option<f64> {
    let eigenvalue = smallest(matrix);
    let rounding = matrix.nrows() as f64 * f64::EPSILON * matrix.norm();
    (eigenvalue.is_nan() || eigenvalue < -rounding).then_some(eigenvalue)
}

/// The free dofs, and the continuum at a load factor.
struct Search<'a> {
    continuum: &'a Continuum,
    free: Vec<usize>,
    most: usize,
    iterations: usize,
}

impl<'a> Search<'a> {
    fn new(continuum: &'a Continuum, settings: &Settings) -> Self {
        let free = (0..continuum.topology().nv()).filter(|dof| !settings.held.contains(dof)).collect();
        Self { continuum, free, most: settings.iterations, iterations: 0 }
    }

    fn loaded(&self, load: f64, loads: &[Load]) -> (Continuum, Vec<Load>) {
        (self.continuum.with_gravity_times(load), loads.iter().map(|x| x.times(load)).collect())
    }

    fn residual(&self, s: &[f64], load: f64, loads: &[Load]) -> Result<DVector<f64>, SolveError> {
        let (continuum, loads) = self.loaded(load, loads);
        let all = residual(&continuum, s, &loads)?;
        Ok(DVector::from_iterator(self.free.len(), self.free.iter().map(|dof| all[*dof])))
    }

    fn tangent(&self, s: &[f64], load: f64, loads: &[Load]) -> Result<DMatrix<f64>, SolveError> {
        let (continuum, loads) = self.loaded(load, loads);
        let all = tangent_stiffness(&continuum, s, &loads)?;
        Ok(DMatrix::from_fn(self.free.len(), self.free.len(), |i, j| all[(self.free[i], self.free[j])]))
    }

    /// s ⊕ step
    fn advance(&self, s: &mut Vec<f64>, step: &DVector<f64>) -> Result<(), SolveError> {
        let topology = self.continuum.topology();
        let (mut all, mut moved) = (vec![0.0; topology.nv()], s.clone());
        self.free.iter().zip(step.iter()).for_each(|(dof, step)| all[*dof] = *step);
        topology.integrate(s, &all, &mut moved)?;
        *s = moved;
        Ok(())
    }

    fn distance(&self, from: &[f64], to: &[f64]) -> Result<f64, SolveError> {
        let topology = self.continuum.topology();
        let mut way = vec![0.0; topology.nv()];
        topology.difference(from, to, &mut way)?;
        Ok(largest(way.iter().copied()))
    }

    /// Newton's method until its steps no longer shrink; whether it converged.
    fn newton(&mut self, s: &mut Vec<f64>, load: f64, loads: &[Load]) -> Result<bool, SolveError> {
        if self.free.is_empty() {
            return Ok(true);
        }
        let mut previous = f64::INFINITY;
        for _ in 0..self.most {
            self.iterations += 1;
            let residual = self.residual(s, load, loads)?;
            let Some(step) = self.tangent(s, load, loads)?.lu().solve(&residual) else { return Ok(false) };
            let change = step.amax();
            if !change.is_finite() {
                return Ok(false);
            }
            self.advance(s, &-step)?;
            let size = 1.0 + largest(s.iter().copied());
            if change == 0.0 || change <= 1e-15 * size || (change <= NEAR * size && change >= 0.25 * previous) {
                return Ok(true);
            }
            previous = change;
        }
        Ok(previous <= NEAR)
    }
}
