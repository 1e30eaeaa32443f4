//! Estimators of the base parameters, and the parameters that follow from them.
//!
//! | estimator | minimises | supposes |
//! |---|---|---|
//! | [`ordinary`] | `‖Y₁β − τ‖²` | the same noise on every torque, states without noise |
//! | [`weighted`] | `Σ_j ‖(Y₁β − τ)_j‖²/σ_j²`, with σ_j from the residuals of the ordinary one | noise of each dof alone |
//! | [`total`] | the smallest change of columns and torques that makes them agree | the same noise on every scaled column |
//!
//! The covariance of the first two is `σ²(Y₁ᵀY₁)⁻¹` with `σ² = ‖Y₁β̂ − τ‖²/(rows − r)` (weighted rows in the second).

mod consistent;
mod residuals;

pub use consistent::{Consistent, Settings as ConsistentSettings, log_cholesky};
pub use residuals::{Fit, LAGS, Whiteness, fit, whiteness};

use crate::{Base, IdentificationError, Information, LinearModel, Samples, Stacking};
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};

/// The 97.5 % point of the normal distribution: half the width of a 95 % interval in standard deviations.
const NORMAL: f64 = 1.959_963_984_540_054;

/// Estimated parameters.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// What the samples tell: the base parameters.
    pub base: Base,
    /// Their values β̂.
    pub beta: Vec<f64>,
    /// The covariance of β̂, where the estimator has one.
    pub covariance: Option<DMatrix<f64>>,
    /// Parameters θ̂ with `B θ̂ = β̂`: of all that have it, those nearest to the nominal ones.
    pub theta: Vec<f64>,
    /// Residuals of the samples that were fitted, dof by dof.
    pub fit: Fit,
    /// Equations less base parameters.
    pub degrees: usize,
    /// What weighed the equations of each dof.
    pub weights: Option<Vec<f64>>,
}

impl Estimate {
    /// The standard deviation of base parameter `i`, if the estimator has a covariance.
    pub fn deviation(&self, i: usize) -> Option<f64> {
        self.covariance.as_ref().map(|covariance| covariance[(i, i)].max(0.0).sqrt())
    }

    /// Half the width of the 95 % interval of base parameter `i`, by Student's distribution.
    pub fn half_width(&self, i: usize) -> Option<f64> {
        self.deviation(i).map(|deviation| deviation * student(self.degrees))
    }
}

/// The 97.5 % point of Student's distribution, by the expansion in 1/ν (M. Abramowitz & I. Stegun, 26.7.5): to four digits from ν = 5 on.
pub fn student(degrees: usize) -> f64 {
    let (n, x) = (degrees.max(1) as f64, NORMAL);
    let terms = [
        (x.powi(3) + x) / 4.0,
        (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / 96.0,
        (3.0 * x.powi(7) + 19.0 * x.powi(5) + 17.0 * x.powi(3) - 15.0 * x) / 384.0,
        (79.0 * x.powi(9) + 776.0 * x.powi(7) + 1482.0 * x.powi(5) - 1920.0 * x.powi(3) - 945.0 * x) / 92160.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n) + x
}

/// Ordinary least squares.
///
/// ```
/// use featherbench_identification::{LinearModel, Samples, Terms, ordinary};
/// use featherbench_robots::Family;
///
/// let linear = LinearModel::new(&Family::parse("chain:n=2")?.generate()?, Terms::ALL)?;
/// let mut truth = linear.nominal();
/// truth[10] = 1.2; // the second link is heavier than its description says
/// let samples = Samples::random(&linear, 40, 1, &truth)?;
/// let found = ordinary(&linear, &samples)?;
/// for (found, due) in found.beta.iter().zip(found.base.values(&truth)) {
///     assert!((found - due).abs() < 1e-10);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentificationError`] when the samples do not determine what they tell.
pub fn ordinary(linear: &LinearModel, samples: &Samples) -> Result<Estimate, IdentificationError> {
    let information = Information::of(linear, samples, &Stacking::plain(linear))?;
    least_squares(linear, samples, &information, None)
}

/// Weighted least squares: the equations of each dof divided by the deviation of its residuals, found by [`ordinary`] and once more by itself.
///
/// # Errors
/// [`IdentificationError`] when the samples do not determine what they tell.
pub fn weighted(linear: &LinearModel, samples: &Samples) -> Result<Estimate, IdentificationError> {
    let mut estimate = ordinary(linear, samples)?;
    for _ in 0..2 {
        let loudest = estimate.fit.rms.iter().copied().fold(0.0, larger);
        // A dof without residuals would weigh infinitely: none weighs more than 1e6 times the loudest.
        let weights: Vec<f64> =
            estimate.fit.rms.iter().map(|rms| if loudest > 0.0 { 1.0 / rms.max(1e-6 * loudest) } else { 1.0 }).collect();
        let stacking = Stacking { weights: Some(&weights), ..Stacking::plain(linear) };
        let information = Information::of(linear, samples, &stacking)?;
        estimate = least_squares(linear, samples, &information, Some(weights.clone()))?;
    }
    Ok(estimate)
}

fn least_squares(
    linear: &LinearModel,
    samples: &Samples,
    information: &Information,
    weights: Option<Vec<f64>>,
) -> Result<Estimate, IdentificationError> {
    let base = Base::of(information)?;
    let own = restricted(information, &base)?;
    let rank = base.rank();
    let (square, right) = (own.factor(), own.right());
    let upper = square.rows(0, rank).into_owned();
    let beta =
        upper.solve_upper_triangular(&right.rows(0, rank).into_owned()).ok_or(IdentificationError::Singular("the base regressor"))?;
    let rest = right.rows(rank, right.len() - rank).norm_squared();
    let degrees = information.rows() - rank;
    let inverse =
        upper.solve_upper_triangular(&DMatrix::identity(rank, rank)).ok_or(IdentificationError::Singular("the base regressor"))?;
    let covariance = (degrees > 0).then(|| &inverse * inverse.transpose() * (rest / degrees as f64));
    let beta = beta.as_slice().to_vec();
    let theta = nearest(linear, &base, &beta)?;
    let fit = fit(linear, samples, &theta)?;
    Ok(Estimate { base, beta, covariance, theta, fit, degrees, weights })
}

/// The equations of the base parameters alone.
fn restricted(information: &Information, base: &Base) -> Result<Information, IdentificationError> {
    let (equations, unknowns) = (information.rows(), base.rank());
    if equations < unknowns {
        return Err(IdentificationError::TooFew { equations, unknowns });
    }
    Ok(information.only(&base.independent))
}

/// Total least squares: `[Y₁, τ] [β; −1] = 0` at the smallest change of the scaled matrix.
///
/// Source: S. Van Huffel & J. Vandewalle, *The Total Least Squares Problem* (1991). Each column and the torques are divided by their length.
/// The estimate has no covariance: the theory's needs the noise of each column.
///
/// # Errors
/// [`IdentificationError`] when the samples do not determine what they tell, or when there is no such change.
pub fn total(linear: &LinearModel, samples: &Samples) -> Result<Estimate, IdentificationError> {
    let information = Information::of(linear, samples, &Stacking::plain(linear))?;
    let base = Base::of(&information)?;
    let own = restricted(&information, &base)?;
    let rank = base.rank();
    let mut both = own.factor().insert_column(rank, 0.0);
    both.set_column(rank, &own.right());
    let lengths: Vec<f64> = both.column_iter().map(|column| column.norm()).collect();
    if lengths[rank] == 0.0 {
        return Err(IdentificationError::Singular("total least squares of torques that are all zero"));
    }
    for (mut column, length) in both.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let missing = IdentificationError::Singular("total least squares");
    let decomposed = both.try_svd(false, true, f64::EPSILON, 0).ok_or(missing.clone())?;
    let rows = decomposed.v_t.as_ref().ok_or(missing.clone())?;
    // As many rows as columns, unless the equations are as many as the base parameters: then they are solved exactly.
    let direction =
        if rows.nrows() > rank { rows.row(decomposed.singular_values.imin()).into_owned() } else { return ordinary(linear, samples) };
    if direction[rank].abs() < f64::EPSILON {
        return Err(missing);
    }
    let beta: Vec<f64> = (0..rank).map(|k| -direction[k] / direction[rank] * lengths[rank] / lengths[k]).collect();
    let theta = nearest(linear, &base, &beta)?;
    let fit = fit(linear, samples, &theta)?;
    let degrees = information.rows() - rank;
    Ok(Estimate { base, beta, covariance: None, theta, fit, degrees, weights: None })
}

/// Of all θ with `B θ = β` the one nearest to the nominal parameters, each measured by the size of its kind.
///
/// `θ = θ₀ + S Bᵀ (B S Bᵀ)⁻¹ (β − B θ₀)` with `S = diag(s²)`.
fn nearest(linear: &LinearModel, base: &Base, beta: &[f64]) -> Result<Vec<f64>, IdentificationError> {
    let nominal = DVector::from_vec(linear.nominal());
    let spread = DMatrix::from_diagonal(&DVector::from_vec(sizes(linear)).map(|size| size * size));
    let across = &spread * base.map.transpose();
    let missing = DVector::from_column_slice(beta) - &base.map * &nominal;
    let shares = (&base.map * &across).cholesky().ok_or(IdentificationError::Singular("the map of base parameters"))?.solve(&missing);
    Ok((nominal + across * shares).as_slice().to_vec())
}

/// The size of each unknown: the largest of its kind in the description (inertias, first moments, masses), and of friction 1.
pub(crate) fn sizes(linear: &LinearModel) -> Vec<f64> {
    use crate::Kind;
    let nominal = linear.nominal();
    let class = |kind: Kind| match kind {
        Kind::Inertial(0) => 0,
        Kind::Inertial(1..=3) => 1,
        Kind::Inertial(_) | Kind::Armature => 2,
        Kind::Viscous | Kind::Coulomb | Kind::Offset => 3,
    };
    let mut largest = [0.0_f64; 4];
    for (unknown, value) in linear.unknowns().iter().zip(&nominal) {
        let class = class(unknown.kind);
        largest[class] = larger(largest[class], value.abs());
    }
    largest[3] = 1.0;
    linear.unknowns().iter().map(|unknown| largest[class(unknown.kind)]).map(|size| if size > 0.0 { size } else { 1.0 }).collect()
}
