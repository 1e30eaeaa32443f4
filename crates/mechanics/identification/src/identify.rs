//! The whole way from samples to a robot: estimate, statistics, held-out error, flags, description.

use crate::log::{Flag, FlagKind};
use crate::{
    Base, Consistency, ConsistentSettings, Estimate, Fit, IdentificationError, Information, LinearModel, Samples, Semidefinite, Stacking,
    consistency, fit, log_cholesky, ordinary, total, weighted,
};
use nalgebra::DMatrix;
use std::ops::Range;

/// Scaled columns with a condition above this tell some combination a thousand times worse than another.
pub const WEAK: f64 = 1e3;
/// The weight of the description in the semidefinite programme, relative to the longest column.
const PULL: f64 = 1e-6;

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Ordinary least squares.
    Ordinary,
    /// Weighted least squares.
    Weighted,
    /// Total least squares.
    Total,
    /// Physically consistent, by log-Cholesky numbers.
    LogCholesky,
    /// Physically consistent, by a semidefinite programme that a solver outside answers.
    Semidefinite,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Ordinary, Self::Weighted, Self::Total, Self::LogCholesky, Self::Semidefinite];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ordinary => "ordinary",
            Self::Weighted => "weighted",
            Self::Total => "total",
            Self::LogCholesky => "log_cholesky",
            Self::Semidefinite => "semidefinite",
        }
    }
}

/// Answers a semidefinite programme: x, or why there is none.
pub type Solve<'a> = &'a dyn Fn(&Semidefinite) -> Result<Vec<f64>, String>;

/// What is asked.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The estimator.
    pub method: Method,
    /// The share of samples, at the end, that is not fitted: 0 to 0.9.
    pub held_out: f64,
    /// The solver of semidefinite programmes, if there is one.
    pub solver: Option<Solve<'a>>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The estimator.
    pub method: Method,
    /// Base parameters with their deviations: of the estimator itself, or, of a consistent one, those of weighted least squares.
    pub estimate: Estimate,
    /// The values of these base parameters by the estimator that was asked.
    pub beta: Vec<f64>,
    /// All parameters.
    pub theta: Vec<f64>,
    /// Base parameters that any motion would tell.
    pub rank_of_robot: usize,
    /// Samples that were fitted.
    pub fitted: usize,
    /// Residuals of these.
    pub fit: Fit,
    /// Samples that were held out, and their residuals, under the description and under the estimate.
    pub held_out: Option<(usize, Fit, Fit)>,
    /// Residuals of the description on the samples that were fitted.
    pub before: Fit,
    /// Whether each body can exist.
    pub bodies: Vec<Consistency>,
    /// Steps of an iteration.
    pub steps: usize,
    /// What is odd.
    pub flags: Vec<Flag>,
}

/// Identifies a robot from samples.
///
/// # Errors
/// [`IdentificationError`] when the samples do not determine what they tell, or the estimator has no answer.
pub fn identify(linear: &LinearModel, samples: &Samples, request: &Request) -> Result<Identified, IdentificationError> {
    if !(0.0..=0.9).contains(&request.held_out) {
        let (value, expected) = (request.held_out.to_string(), "give a share from 0 to 0.9");
        return Err(IdentificationError::Setting { setting: "held-out", value, expected });
    }
    let count = samples.count();
    let cut = count - (request.held_out * count as f64).round() as usize;
    let part = |range: Range<usize>| samples.range(linear, range);
    let (own, others) = (part(0..cut), part(cut..count));
    let estimate = match request.method {
        Method::Ordinary => ordinary(linear, &own)?,
        Method::Total => total(linear, &own)?,
        _ => weighted(linear, &own)?,
    };
    let found = match request.method {
        Method::LogCholesky => {
            let stacking = Stacking { weights: estimate.weights.as_deref(), ..Stacking::plain(linear) };
            let found = log_cholesky(linear, &own, &stacking, ConsistentSettings::default())?;
            Some((found.theta, found.steps))
        }
        Method::Semidefinite => Some((semidefinite(linear, &own, &estimate, request.solver)?, 0)),
        _ => None,
    };
    let (theta, steps) = found.unwrap_or_else(|| (estimate.theta.clone(), 0));
    let robot = Base::of_robot(linear, 1)?;
    let bodies = consistency(linear, &theta);
    let mut flags = excitation(linear, &estimate, &robot);
    flags.extend(unphysical(linear, &bodies, &theta));
    let nominal = linear.nominal();
    let held_out = match others.count() {
        0 => None,
        count => Some((count, fit(linear, &others, &nominal)?, fit(linear, &others, &theta)?)),
    };
    Ok(Identified {
        method: request.method,
        beta: estimate.base.values(&theta),
        rank_of_robot: robot.rank(),
        fitted: own.count(),
        fit: fit(linear, &own, &theta)?,
        before: fit(linear, &own, &nominal)?,
        held_out,
        theta,
        bodies,
        steps,
        flags,
        estimate,
    })
}

fn semidefinite(
    linear: &LinearModel,
    samples: &Samples,
    estimate: &Estimate,
    solver: Option<Solve>,
) -> Result<Vec<f64>, IdentificationError> {
    let solve = solver.ok_or(IdentificationError::NoSolver { reason: "none was given".into() })?;
    let stacking = Stacking { weights: estimate.weights.as_deref(), ..Stacking::plain(linear) };
    let problem = Semidefinite::of(linear, &Information::of(linear, samples, &stacking)?, PULL)?;
    let x = solve(&problem).map_err(|reason| IdentificationError::NoSolver { reason })?;
    problem.theta(linear, &x)
}

/// What the motion does not tell, or hardly.
fn excitation(linear: &LinearModel, estimate: &Estimate, robot: &Base) -> Vec<Flag> {
    let base = &estimate.base;
    let mut flags = Vec::new();
    let flag = |about: String, count, consequence: String| Flag { kind: FlagKind::Excitation, about, line: None, count, consequence };
    if base.rank() < robot.rank() {
        let missing = not_told(&robot.map, &base.map);
        let names = robot.names(linear);
        let listed: Vec<&str> = missing.iter().map(|&i| names[i].as_str()).collect();
        let consequence = "this motion does not tell them apart; what it does not tell is taken from the description. Move every joint, at several speeds";
        flags.push(flag(listed.join(", "), robot.rank() - base.rank(), consequence.into()));
    }
    let condition = base.condition();
    if condition > WEAK {
        let consequence = format!("noise of some combination grows by {condition:.1e}; excite more, or trust the intervals alone");
        flags.push(flag("the condition of the scaled base regressor".into(), 1, consequence));
    }
    let names = base.names(linear);
    let poor = |&i: &usize| estimate.half_width(i).is_some_and(|half| half > estimate.beta[i].abs());
    let poor: Vec<&str> = (0..base.rank()).filter(poor).map(|i| names[i].as_str()).collect();
    if !poor.is_empty() {
        flags.push(flag(poor.join(", "), poor.len(), "the 95 % interval holds zero: these torques do not show that it is there".into()));
    }
    flags
}

/// The rows of `wanted` that are no combination of the rows of `known`, to 1e-6 of their length.
fn not_told(wanted: &DMatrix<f64>, known: &DMatrix<f64>) -> Vec<usize> {
    let basis = known.transpose().qr().q();
    let remainder = |i: &usize| {
        let row = wanted.row(*i).transpose();
        let rest = &row - &basis * (basis.transpose() * &row);
        rest.norm() > 1e-6 * row.norm()
    };
    (0..wanted.nrows()).filter(remainder).collect()
}

fn unphysical(linear: &LinearModel, bodies: &[Consistency], theta: &[f64]) -> Vec<Flag> {
    use crate::Kind;
    let consequence = "no description can hold it; take log_cholesky or semidefinite, or add data".to_owned();
    let flag = |about, count| Flag { kind: FlagKind::Unphysical, about, line: None, count, consequence: consequence.clone() };
    let impossible: Vec<&str> = linear
        .description()
        .bodies
        .iter()
        .zip(bodies)
        .filter(|(_, body)| !body.is_consistent())
        .map(|(body, _)| body.name.as_str())
        .collect();
    let friction = linear
        .unknowns()
        .iter()
        .zip(theta)
        .filter(|(unknown, value)| !matches!(unknown.kind, Kind::Inertial(_) | Kind::Offset) && **value < 0.0);
    let negative: Vec<String> = friction.map(|(unknown, _)| unknown.name()).collect();
    let mut flags = Vec::new();
    if !impossible.is_empty() {
        flags.push(flag(format!("bodies {}", impossible.join(", ")), impossible.len()));
    }
    if !negative.is_empty() {
        flags.push(flag(format!("negative {}", negative.join(", ")), negative.len()));
    }
    flags
}
