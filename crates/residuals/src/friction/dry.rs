//! Dry (Coulomb) friction as a set: r ∈ F Sgn(v) per dof, where Sgn(0) = [−1, 1].
//!
//! - Inverse dynamics. A dof that moves has r = F sign v. One at rest that accelerates sets off, and has r = F sign a. One that stays at rest
//!   has any r of [−F, F]: the answer is an interval.
//! - Forward dynamics. A dof that moves is known. Those at rest obey a complementarity problem: a_k = 0 and |r_k| ≤ F_k, or r_k = F_k sign a_k.
//!   These are the optimality conditions of a strictly convex problem, min ½ aᵀMa − (τ − h)ᵀa + Σ F_k |a_k|. So a is unique, for any M ≻ 0.
//!   Principal pivoting finds it in finitely many steps: which dofs stick is guessed, the linear equations are solved, and the dofs that
//!   contradict the guess change sides. All of them change while their number falls, after that the first alone.
//!   Source: K. G. Murty, *Linear complementarity* (1988), section 4; J. Júdice and F. Pires (1994) for bounds on both sides.

use crate::corrected::add_unless_zero;
use crate::error::{demand, expect, finite};
use crate::{Nominal, Residual, ResidualError, State};
use nalgebra::{DMatrix, DVector};

/// Dry friction of F per dof, N·m or N.
#[derive(Clone, Debug, PartialEq)]
pub struct DryFriction {
    friction: Vec<f64>,
}

/// The forward dynamics with dry friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Forces {
    /// The acceleration; exactly zero where a dof sticks.
    pub a: Vec<f64>,
    /// The friction r.
    pub friction: Vec<f64>,
    /// The dofs that stick.
    pub stuck: Vec<usize>,
}

/// What a dof at rest is thought to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guess {
    Sticks,
    /// It sets off in this direction, ±1.
    SetsOff(f64),
}

/// Contradictions below this share of the largest term are rounding errors: a dof at the brink may count to either side.
const ROUNDING: f64 = 1e-12;

impl DryFriction {
    /// Of this friction per dof.
    ///
    /// # Errors
    /// [`ResidualError::Parameter`] if one is negative or not finite.
    pub fn new(friction: Vec<f64>) -> Result<Self, ResidualError> {
        demand("dry friction", &friction, "it must be finite and not negative", |x| x >= 0.0)?;
        Ok(Self { friction })
    }

    /// The least and the greatest friction of each dof at a velocity and an acceleration.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit or is not finite.
    pub fn interval(&self, v: &[f64], a: &[f64]) -> Result<Vec<[f64; 2]>, ResidualError> {
        expect("velocity v", self.friction.len(), v.len())?;
        expect("acceleration a", self.friction.len(), a.len())?;
        finite("velocity v", v)?;
        finite("acceleration a", a)?;
        let of = |(k, &f): (usize, &f64)| match direction(v[k], a[k]) {
            Some(sign) => [sign * f; 2],
            None => [-f, f],
        };
        Ok(self.friction.iter().enumerate().map(of).collect())
    }

    /// The least and the greatest joint force of each dof that go with an acceleration: inverse dynamics as an interval.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit or is not finite, or the nominal model does not answer.
    pub fn inverse<N: Nominal>(&self, nominal: &mut N, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<[f64; 2]>, ResidualError> {
        let intervals = self.interval(v, a)?;
        let mut tau = vec![0.0; self.friction.len()];
        nominal.inverse(q, v, a, &mut tau)?;
        finite("joint forces τ", &tau)?;
        Ok(tau.iter().zip(intervals).map(|(tau, bounds)| bounds.map(|r| if r == 0.0 { *tau } else { tau + r })).collect())
    }

    /// The acceleration under joint forces, the friction, and which dofs stick.
    ///
    /// ```
    /// use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
    /// use featherbench_residuals::{DryFriction, Rigid};
    /// let joint = JointDescription { kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] }, ..JointDescription::default() };
    /// let box_ = BodyDescription { name: "box".into(), parent: None, mass: 2.0, com: [0.0; 3], inertia: [0.0; 6], joint };
    /// let model = Model::build(&Description { bodies: vec![box_], ..Description::default() })?;
    /// let friction = DryFriction::new(vec![3.0])?;
    /// // Pushed with 2 N it sticks; with 5 N it sets off with (5 − 3) / 2 m/s².
    /// assert_eq!(friction.forward(&mut Rigid::new(&model), &[0.0], &[0.0], &[2.0])?.a, [0.0]);
    /// assert_eq!(friction.forward(&mut Rigid::new(&model), &[0.0], &[0.0], &[5.0])?.a, [1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit or is not finite, or the nominal model does not answer.
    pub fn forward<N: Nominal>(&self, nominal: &mut N, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Forces, ResidualError> {
        let n = self.friction.len();
        expect("dofs of the friction", nominal.nv(), n)?;
        expect("velocity v", n, v.len())?;
        expect("joint forces τ", n, tau.len())?;
        finite("velocity v", v)?;
        finite("joint forces τ", tau)?;
        let moving = |k: usize| if v[k] == 0.0 { 0.0 } else { self.friction[k].copysign(v[k]) };
        let mut friction: Vec<f64> = (0..n).map(moving).collect();
        let (mut rest, mut a) = (tau.to_vec(), vec![0.0; n]);
        add_unless_zero(&mut rest, &friction, -1.0);
        nominal.forward(q, v, &rest, &mut a)?;
        finite("acceleration a", &a)?;
        let resting: Vec<usize> = (0..n).filter(|&k| v[k] == 0.0 && self.friction[k] > 0.0).collect();
        if resting.is_empty() {
            return Ok(Forces { a, friction, stuck: Vec::new() });
        }
        let factors = nominal.mass_matrix(q)?.lu();
        let unit = |k: usize| DVector::from_fn(n, |row, _| f64::from(row == k));
        let columns: Option<Vec<DVector<f64>>> = resting.iter().map(|&k| factors.solve(&unit(k))).collect();
        let columns = columns.ok_or(ResidualError::Indefinite { what: "the mass matrix M", smallest: 0.0 })?;
        let inverse = DMatrix::from_fn(resting.len(), resting.len(), |i, j| columns[j][resting[i]]);
        let free = DVector::from_iterator(resting.len(), resting.iter().map(|&k| a[k]));
        let limits: Vec<f64> = resting.iter().map(|&k| self.friction[k]).collect();
        let (guesses, at_rest) = pivot(&inverse, &free, &limits)?;
        for (&k, &r) in resting.iter().zip(&at_rest) {
            friction[k] = r;
            rest[k] -= r;
        }
        nominal.forward(q, v, &rest, &mut a)?;
        finite("acceleration a", &a)?;
        let stuck: Vec<usize> = resting.iter().zip(&guesses).filter(|(_, guess)| **guess == Guess::Sticks).map(|(&k, _)| k).collect();
        stuck.iter().for_each(|&k| a[k] = 0.0);
        Ok(Forces { a, friction, stuck })
    }
}

/// The friction of the dofs at rest: a = free − G r with a_k = 0 and |r_k| ≤ limit_k, or r_k = limit_k sign a_k.
fn pivot(g: &DMatrix<f64>, free: &DVector<f64>, limits: &[f64]) -> Result<(Vec<Guess>, Vec<f64>), ResidualError> {
    let n = limits.len();
    let mut guesses = vec![Guess::Sticks; n];
    // How many contradict, at best, and how often all may still change sides without fewer of them.
    let (mut best, mut patience) = (n + 1, 3);
    // Each guess comes at most once when the first alone changes; a cap for numbers that rounding spoils.
    let cap = 100 * (n + 1);
    for _ in 0..cap {
        let sticking: Vec<usize> = (0..n).filter(|&k| guesses[k] == Guess::Sticks).collect();
        let known = |k: usize| if let Guess::SetsOff(sign) = guesses[k] { sign * limits[k] } else { 0.0 };
        let mut r = DVector::from_fn(n, |k, _| known(k));
        let driven = free - g * &r;
        let block = DMatrix::from_fn(sticking.len(), sticking.len(), |i, j| g[(sticking[i], sticking[j])]);
        let right = DVector::from_fn(sticking.len(), |i, _| driven[sticking[i]]);
        let held = block.cholesky().ok_or(ResidualError::Indefinite { what: "M⁻¹ of the dofs at rest", smallest: f64::NAN })?.solve(&right);
        sticking.iter().zip(&held).for_each(|(&k, &force)| r[k] = force);
        let a = free - g * &r;
        let scale = free.amax().max((g * &r).amax());
        let next = |k: usize| match guesses[k] {
            Guess::Sticks if r[k].abs() > limits[k] * (1.0 + ROUNDING) => Some(Guess::SetsOff(r[k].signum())),
            Guess::SetsOff(sign) if a[k] * sign < -ROUNDING * scale => Some(Guess::Sticks),
            _ => None,
        };
        let changes: Vec<(usize, Guess)> = (0..n).filter_map(|k| Some((k, next(k)?))).collect();
        if changes.is_empty() {
            let within = |k: usize| r[k].clamp(-limits[k], limits[k]);
            return Ok((guesses.clone(), (0..n).map(within).collect()));
        }
        if changes.len() < best {
            (best, patience) = (changes.len(), 3);
        } else if patience > 0 {
            patience -= 1;
        }
        let all = patience > 0;
        for (k, guess) in changes.into_iter().take(if all { n } else { 1 }) {
            guesses[k] = guess;
        }
    }
    Err(ResidualError::NotConverged { iterations: cap, residual: f64::NAN })
}

/// The direction in which a dof moves or sets off, ±1; `None` if it stays at rest.
fn direction(v: f64, a: f64) -> Option<f64> {
    [v, a].into_iter().find(|x| *x != 0.0).map(f64::signum)
}

/// As a residual it answers where it has one value. [`crate::Corrected::forward`] refuses it at rest: use [`DryFriction::forward`].
impl Residual for DryFriction {
    fn nv(&self) -> usize {
        self.friction.len()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        for (dof, &limit) in self.friction.iter().enumerate().filter(|(_, limit)| **limit > 0.0) {
            let sign = direction(state.v[dof], state.a[dof]).ok_or(ResidualError::Interval { dof, limit })?;
            r[dof] += sign * limit;
        }
        Ok(())
    }
}
