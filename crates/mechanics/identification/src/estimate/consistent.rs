//! Parameters of bodies that can exist: least squares over log-Cholesky numbers, by Levenberg and Marquardt.
//!
//! ```text
//! minimise over φ:  ‖Y θ(φ) − τ‖² + (pull · s)² ‖φ − φ₀‖²
//! ```
//!
//! φ has ten numbers per body ([`LogCholesky`]). It has the logarithms of each armature, viscous and Coulomb friction, which are not
//! negative. The offsets are in it as they are. The start φ₀ is the description. The scale s is the longest column of ∂(Yθ)/∂φ at φ₀. The
//! pull decides only what the torques do not tell. Y enters by its triangular factor: so a step costs O(p³), whatever the length of the
//! log.
//!
//! With noise the best θ is on the edge of what can exist, and a residual stays there. Gauss and Newton's matrix leaves it out: their steps along
//! the edge are too long, and thousands of short ones are left. So a step has the second order of P = U Uᵀ, and of the logarithms, too.

use super::sizes;
use crate::{IdentificationError, Information, Kind, LinearModel, LogCholesky, PseudoInertia, Samples, Stacking};
use featherbench_dynamics::PARAMETERS;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector, Matrix4};

/// Bodies of the description whose smallest eigenvalue is below this share of the largest are thickened before they are a start.
const THIN: f64 = 1e-8;
/// A friction or armature that the description has as zero starts at this share of its size.
const SMALL: f64 = 1e-3;
/// The pull falls to its own size in these stages, each from where the one before ended: under a strong pull no long valleys
/// are followed.
const PULLS: [f64; 4] = [1e4, 1e3, 1e1, 1.0];
/// Steps of too little gain after which it ends.
const FLAT: usize = 5;
/// A residual below this share of the torques is less than any sensor tells: it ends there.
const EXACT: f64 = 1e-7;
/// Numbers of φ change by no more than this in a step: e³ is a factor of twenty.
const REACH: f64 = 3.0;

/// The settings of [`log_cholesky`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The weight of the description against the torques.
    pub pull: f64,
    /// The most steps.
    pub steps: usize,
    /// The relative change of φ at which it ends.
    pub end: f64,
    /// The relative gain of a step that is too little: after five such steps it ends. What is left then is the valley of parameters that
    /// the torques do not tell, in which the pull alone leads on.
    pub gain: f64,
}

impl Default for Settings {
    /// A pull of 1e-8 moves a parameter that the torques tell by 1e-16 of its distance, times its condition squared. With 1e-6, ten of 200 drawn
    /// estimates fitted worse than the truth, where noise was small.
    fn default() -> Self {
        Self { pull: 1e-8, steps: 4000, end: 1e-10, gain: 1e-6 }
    }
}

/// A physically consistent estimate.
#[derive(Clone, Debug)]
pub struct Consistent {
    /// θ̂.
    pub theta: Vec<f64>,
    /// Steps that were taken.
    pub steps: usize,
}

/// Physically consistent least squares by log-Cholesky numbers.
///
/// # Errors
/// [`IdentificationError::NotConverged`], or that the samples do not fit the robot.
pub fn log_cholesky(
    linear: &LinearModel,
    samples: &Samples,
    stacking: &Stacking,
    settings: Settings,
) -> Result<Consistent, IdentificationError> {
    let information = Information::of(linear, samples, stacking)?;
    let mut phi = start(linear)?;
    let home = phi.clone();
    let mut steps = 0;
    for pull in PULLS.map(|factor| factor * settings.pull) {
        steps += descend(linear, &information, &mut phi, &home, Settings { pull, ..settings })?;
    }
    let (theta, _) = parameters(linear, &phi);
    Ok(Consistent { theta: theta.as_slice().to_vec(), steps })
}

/// φ of the description. Bodies that could not exist, or are thin, are thickened for it.
fn start(linear: &LinearModel) -> Result<DVector<f64>, IdentificationError> {
    let (nominal, sizes) = (linear.nominal(), sizes(linear));
    let mut phi = DVector::zeros(nominal.len());
    for (body, described) in linear.description().bodies.iter().enumerate() {
        let at = PARAMETERS * body;
        let mut pi: [f64; PARAMETERS] = std::array::from_fn(|k| nominal[at + k]);
        let consistency = PseudoInertia::of(&pi).consistency();
        if consistency.smallest.is_nan() || consistency.smallest <= THIN * consistency.largest {
            // A ball of a thousandth of the largest mass, with the radius of gyration of a tenth of a metre, and what is missing besides.
            let missing = (-consistency.smallest).max(0.0) + THIN * consistency.largest;
            let ball = Matrix4::from_diagonal(&nalgebra::Vector4::new(0.01, 0.01, 0.01, 1.0)) * (SMALL * sizes[at]);
            pi = (PseudoInertia::of(&pi) + PseudoInertia(ball + Matrix4::identity() * missing)).parameters();
        }
        let of_body = LogCholesky::of(&pi).ok_or_else(|| IdentificationError::Unphysical {
            body: described.name.clone(),
            defect: format!("its pseudo-inertia has the eigenvalue {:.2e}", consistency.smallest),
        })?;
        phi.rows_mut(at, PARAMETERS).copy_from_slice(&of_body.0);
    }
    for (k, unknown) in linear.unknowns().iter().enumerate() {
        match unknown.kind {
            Kind::Inertial(_) => {}
            Kind::Offset => phi[k] = nominal[k],
            Kind::Armature | Kind::Viscous | Kind::Coulomb => phi[k] = nominal[k].max(SMALL * sizes[k]).ln(),
        }
    }
    Ok(phi)
}

/// θ(φ) and ∂θ/∂φ.
fn parameters(linear: &LinearModel, phi: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let count = phi.len();
    let (mut theta, mut jacobian) = (DVector::zeros(count), DMatrix::zeros(count, count));
    for body in 0..linear.description().bodies.len() {
        let at = PARAMETERS * body;
        let own = LogCholesky(std::array::from_fn(|k| phi[at + k]));
        theta.rows_mut(at, PARAMETERS).copy_from_slice(&own.parameters());
        jacobian.view_mut((at, at), (PARAMETERS, PARAMETERS)).copy_from(&own.jacobian());
    }
    for (k, unknown) in linear.unknowns().iter().enumerate() {
        match unknown.kind {
            Kind::Inertial(_) => {}
            Kind::Offset => (theta[k], jacobian[(k, k)]) = (phi[k], 1.0),
            Kind::Armature | Kind::Viscous | Kind::Coulomb => {
                theta[k] = phi[k].exp();
                jacobian[(k, k)] = theta[k];
            }
        }
    }
    (theta, jacobian)
}

/// Rows whose square is the second order of θ(φ) in a cost of this slope `∂cost/∂θ`, as far as it adds to the cost.
fn curvature(linear: &LinearModel, phi: &DVector<f64>, slope: &DVector<f64>) -> DMatrix<f64> {
    let (bodies, count) = (linear.description().bodies.len(), phi.len());
    let (inertial, each) = (PARAMETERS * bodies, 16);
    let mut rows = DMatrix::zeros(each * bodies + count - inertial, count);
    for body in 0..bodies {
        let at = PARAMETERS * body;
        let own = LogCholesky(std::array::from_fn(|k| phi[at + k]));
        rows.view_mut((each * body, at), (each, PARAMETERS)).copy_from(&own.curvature(&std::array::from_fn(|k| slope[at + k])));
    }
    for (k, unknown) in linear.unknowns().iter().enumerate().skip(inertial) {
        if !matches!(unknown.kind, Kind::Offset) {
            rows[(each * bodies + k - inertial, k)] = (0.5 * slope[k].max(0.0) * phi[k].exp()).sqrt();
        }
    }
    rows
}

/// Levenberg and Marquardt from φ, in place. Returns the steps.
fn descend(
    linear: &LinearModel,
    information: &Information,
    phi: &mut DVector<f64>,
    home: &DVector<f64>,
    settings: Settings,
) -> Result<usize, IdentificationError> {
    let (factor, right) = (information.factor(), information.right());
    let count = phi.len();
    let columns = |phi: &DVector<f64>| {
        let (theta, jacobian) = parameters(linear, phi);
        (&factor * theta - &right, &factor * jacobian)
    };
    let (mut rest, mut jacobian) = columns(phi);
    let longest = jacobian.column_iter().map(|column| column.norm()).fold(0.0, larger);
    let pull = settings.pull * longest;
    let cost = |rest: &DVector<f64>, phi: &DVector<f64>| rest.norm_squared() + pull * pull * (phi - home).norm_squared();
    let (mut now, mut damping, mut growth, mut step, mut flat) = (cost(&rest, phi), 1e-3, 2.0, f64::INFINITY, 0);
    for taken in 0..settings.steps {
        // Least squares of the stacked rows, which keep their condition number: [J; pull; √λ pull'] δ = −[r; pull (φ − φ₀); 0].
        let curvature = curvature(linear, phi, &(factor.tr_mul(&rest) * 2.0));
        let mut rows = jacobian.clone().insert_rows(factor.nrows(), 2 * count + curvature.nrows(), 0.0);
        let mut sides = (-&rest).insert_rows(factor.nrows(), 2 * count + curvature.nrows(), 0.0);
        rows.rows_mut(factor.nrows() + 2 * count, curvature.nrows()).copy_from(&curvature);
        for k in 0..count {
            let size = jacobian.column(k).norm() + pull;
            rows[(factor.nrows() + k, k)] = pull;
            sides[factor.nrows() + k] = -pull * (phi[k] - home[k]);
            rows[(factor.nrows() + count + k, k)] = damping * size;
        }
        let decomposed = rows.qr();
        decomposed.q_tr_mul(&mut sides);
        let change = decomposed
            .r()
            .solve_upper_triangular(&sides.rows(0, count).into_owned())
            .ok_or(IdentificationError::Singular("the step of log-Cholesky"))?;
        let change = &change * (REACH / change.amax().max(REACH));
        step = change.norm() / (1.0 + phi.norm());
        let trial = &*phi + &change;
        let promised = now - cost(&(&rest + &jacobian * &change), &trial) - (&curvature * &change).norm_squared();
        let (trial_rest, trial_jacobian) = columns(&trial);
        let next = cost(&trial_rest, &trial);
        if next.is_finite() && next <= now {
            let gained = (now - next) / now.max(f64::MIN_POSITIVE);
            // Nielsen's rule: the damping falls where the model promised what came, and rises where it promised too much.
            let kept = (1.0 - (2.0 * (now - next) / promised.max(f64::MIN_POSITIVE) - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
            (*phi, rest, jacobian, now) = (trial, trial_rest, trial_jacobian, next);
            damping = (damping * kept).max(1e-12);
            growth = 2.0;
            flat = if gained < settings.gain { flat + 1 } else { 0 };
            if step < settings.end || flat >= FLAT || rest.norm() <= EXACT * right.norm() {
                return Ok(taken + 1);
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            // No direction leads down any more.
            if step < settings.end || damping > 1e8 {
                return Ok(taken + 1);
            }
        }
    }
    Err(IdentificationError::NotConverged { method: "log-Cholesky", iterations: settings.steps, step })
}
