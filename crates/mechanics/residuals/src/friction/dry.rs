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

/// What a dof is thought to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guess {
    /// It moves, or has no friction: its friction is known.
    Known(f64),
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
    /// assert!((friction.forward(&mut Rigid::new(&model), &[0.0], &[0.0], &[5.0])?.a[0] - 1.0).abs() < 1e-15);
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
        let guess = |k: usize| match direction(v[k], 0.0) {
            Some(sign) => Guess::Known(sign * self.friction[k]),
            None if self.friction[k] == 0.0 => Guess::Known(0.0),
            None => Guess::Sticks,
        };
        let guesses: Vec<Guess> = (0..n).map(guess).collect();
        if guesses.iter().all(|guess| matches!(guess, Guess::Known(_))) {
            let friction: Vec<f64> = guesses.iter().zip(&self.friction).map(|(guess, &limit)| guess.force(limit)).collect();
            let (mut rest, mut a) = (tau.to_vec(), vec![0.0; n]);
            add_unless_zero(&mut rest, &friction, -1.0);
            nominal.forward(q, v, &rest, &mut a)?;
            finite("acceleration a", &a)?;
            return Ok(Forces { a, friction, stuck: Vec::new() });
        }
        let mut bias = vec![0.0; n];
        nominal.inverse(q, v, &vec![0.0; n], &mut bias)?;
        finite("bias force h", &bias)?;
        let driving = DVector::from_fn(n, |k, _| tau[k] - bias[k]);
        pivot(&nominal.mass_matrix(q)?, &driving, &self.friction, guesses)
    }
}

impl Guess {
    /// The friction of a dof that does not stick.
    fn force(self, limit: f64) -> f64 {
        match self {
            Self::Known(force) => force,
            Self::SetsOff(sign) => sign * limit,
            Self::Sticks => 0.0,
        }
    }
}

/// M a + r = driving, with a_k = 0 and |r_k| ≤ limit_k, or r_k = limit_k sign a_k, or r_k known.
///
/// The block of M of the dofs that do not stick is solved. So no inverse of M amplifies rounding errors, and r of those that stick is a sum.
fn pivot(mass: &DMatrix<f64>, driving: &DVector<f64>, limits: &[f64], mut guesses: Vec<Guess>) -> Result<Forces, ResidualError> {
    let n = limits.len();
    // How many contradict, at best, and how often all may still change sides without fewer of them.
    let (mut best, mut patience) = (n + 1, 3);
    // Each guess comes at most once when the first alone changes; a cap for numbers that rounding spoils.
    let cap = 100 * (n + 1);
    for _ in 0..cap {
        let free: Vec<usize> = (0..n).filter(|&k| guesses[k] != Guess::Sticks).collect();
        let block = DMatrix::from_fn(free.len(), free.len(), |i, j| mass[(free[i], free[j])]);
        let right = DVector::from_fn(free.len(), |i, _| driving[free[i]] - guesses[free[i]].force(limits[free[i]]));
        let found = block.cholesky().ok_or(ResidualError::Indefinite { what: "the mass matrix M", smallest: f64::NAN })?.solve(&right);
        let mut a = DVector::zeros(n);
        free.iter().zip(&found).for_each(|(&k, &x)| a[k] = x);
        finite("acceleration a", a.as_slice())?;
        let held = driving - mass * &a;
        let friction = |k: usize| if guesses[k] == Guess::Sticks { held[k] } else { guesses[k].force(limits[k]) };
        let next = |k: usize| match guesses[k] {
            Guess::Sticks if held[k].abs() > limits[k] * (1.0 + ROUNDING) => Some(Guess::SetsOff(held[k].signum())),
            Guess::SetsOff(sign) if a[k] * sign < -ROUNDING * a.amax() => Some(Guess::Sticks),
            _ => None,
        };
        let changes: Vec<(usize, Guess)> = (0..n).filter_map(|k| Some((k, next(k)?))).collect();
        if changes.is_empty() {
            let stuck: Vec<usize> = (0..n).filter(|&k| guesses[k] == Guess::Sticks).collect();
            let within = |k: usize| if guesses[k] == Guess::Sticks { friction(k).clamp(-limits[k], limits[k]) } else { friction(k) };
            return Ok(Forces { friction: (0..n).map(within).collect(), a: a.as_slice().to_vec(), stuck });
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
