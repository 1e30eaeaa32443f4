//! Robots whose true parameters are known, with motions that tell them: what estimators are measured on.

use crate::{
    Arm, Base, Estimate, Gravity, IdentificationError, Information, LinearModel, Samples, Search, Stacking, Terms, excite, ordinary,
};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

/// A robot, its true parameters, a motion to fit and another one to judge by.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The robot as its description has it.
    pub linear: LinearModel,
    /// Its true parameters, which the description does not have.
    pub truth: Vec<f64>,
    /// The motion to fit, without noise.
    pub fitted: Samples,
    /// Another trajectory, without noise: what is held out is not the same motion.
    pub held_out: Samples,
}

impl Scenario {
    /// An arm whose links were drawn anew and whose joints have armature and friction, as far as the terms are identified.
    ///
    /// # Errors
    /// [`IdentificationError`] when no trajectory is found.
    pub fn of(arm: &Arm, terms: Terms, count: usize) -> Result<Self, IdentificationError> {
        let linear = LinearModel::new(&arm.describe(Gravity::Parallel, 1), terms)?;
        let mut other = arm.describe(Gravity::Parallel, 2);
        for (k, body) in other.bodies.iter_mut().enumerate() {
            let step = k as f64;
            (body.joint.armature, body.joint.damping, body.joint.friction) =
                (vec![0.1 + 0.02 * step], vec![0.3 + 0.1 * step], vec![0.5 + 0.05 * step]);
        }
        let truth = LinearModel::new(&other, terms)?.nominal();
        let base = Base::of_robot(&linear, 1)?;
        let search = |seed| Search { draws: 4, changes: 12, frequency: 0.2, seed, ..Search::default() };
        let motion = |seed| excite(&linear, &base, &search(seed))?.trajectory.samples(&linear, &truth, count, 1.0);
        let (fitted, held_out) = (motion(1)?, motion(2)?);
        Ok(Self { truth, fitted, held_out, linear })
    }

    /// The motion to fit with noise of this deviation on every torque.
    pub fn noisy(&self, deviation: f64, seed: u64) -> Samples {
        disturbed(&self.fitted, deviation, seed)
    }
}

/// Samples with noise on their torques: nearly normal, a sum of twelve uniform numbers.
pub fn disturbed(samples: &Samples, deviation: f64, seed: u64) -> Samples {
    let mut random = Random::named(seed, "torque noise");
    let mut samples = samples.clone();
    samples.tau.iter_mut().for_each(|tau| *tau += deviation * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0));
    samples
}

/// How far the mean square error of predicted torques of the held-out motion, over that of the noise, is above what theory expects of ordinary least
/// squares: in normal deviations.
///
/// The errors are `e + Y₂(β̂ − β)`: their covariance is `1 + Y₂(Y₁ᵀY₁)⁻¹Y₂ᵀ` in units of the noise, with eigenvalues 1 + λ_i and ones. A sum of their
/// squares is nearly χ² with the same first three moments (P. Hall, 1983), and the cube root of that is nearly normal (Wilson & Hilferty, 1931).
///
/// # Errors
/// [`IdentificationError`] when the motion to fit does not tell the base parameters.
pub fn held_out_deviation(scenario: &Scenario, mean_square: f64) -> Result<f64, IdentificationError> {
    let linear = &scenario.linear;
    let of = |samples: &Samples| Information::of(linear, samples, &Stacking::plain(linear));
    let fitted = of(&scenario.fitted)?;
    let base = Base::of(&fitted)?;
    let factor = |information: Information| information.only(&base.independent).factor().rows(0, base.rank()).transpose();
    let (fitted, other) = (factor(fitted), factor(of(&scenario.held_out)?));
    let ratio = fitted.solve_lower_triangular(&other).ok_or(IdentificationError::Singular("the regressor of the motion to fit"))?;
    let grown = (&ratio * ratio.transpose()).symmetric_eigenvalues().add_scalar(1.0);
    let count = scenario.held_out.tau.len() as f64;
    let [first, second, third] = [1, 2, 3].map(|power| count - grown.len() as f64 + grown.map(|x| x.powi(power)).sum());
    let freedom = second.powi(3) / third.powi(2);
    let chi = 1.0 + (count * mean_square - first) / (2.0 * second).sqrt() * (2.0 / freedom).sqrt();
    let ninth = 2.0 / (9.0 * freedom);
    Ok((chi.cbrt() - 1.0 + ninth) / ninth.sqrt())
}

/// How the estimates of many draws of noise spread, against the theory `σ²(Y₁ᵀY₁)⁻¹`.
///
/// Estimates are whitened, `e = R(β̂ − β)/σ` with `RᵀR = Y₁ᵀY₁`: then the theory's covariance is the identity, whatever the units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// The mean variance over all directions; its own deviation is `√(2/(r·repeats))`.
    pub variance: f64,
    /// The least and largest variance of any direction.
    pub extremes: [f64; 2],
    /// Where these are expected: `(1 ∓ √(r/repeats))²` (V. Marchenko & L. Pastur, 1967).
    pub edges: [f64; 2],
    /// The mean error over all directions, in units of its deviation over all repeats: the square has the mean 1.
    pub bias: f64,
    /// The share of 95 % intervals that hold the truth.
    pub coverage: f64,
}

/// Repeats ordinary least squares with fresh noise.
///
/// # Errors
/// [`IdentificationError`] of an estimate.
pub fn scatter(scenario: &Scenario, deviation: f64, repeats: usize, seed: u64) -> Result<Scatter, IdentificationError> {
    let linear = &scenario.linear;
    let clean = Information::of(linear, &scenario.fitted, &Stacking::plain(linear))?;
    let base = Base::of(&clean)?;
    let (rank, truth) = (base.rank(), base.values(&scenario.truth));
    let root = clean.only(&base.independent).factor().rows(0, rank).into_owned() / deviation;
    let mut errors = DMatrix::zeros(rank, repeats);
    let mut covered = 0;
    for k in 0..repeats {
        let estimate: Estimate = ordinary(linear, &scenario.noisy(deviation, seed.wrapping_mul(1_000_003).wrapping_add(k as u64)))?;
        let error = DVector::from_fn(rank, |i, _| estimate.beta.get(i).map_or(f64::NAN, |beta| beta - truth[i]));
        covered += (0..rank).filter(|&i| estimate.half_width(i).is_some_and(|half| error[i].abs() <= half)).count();
        errors.set_column(k, &(&root * error));
    }
    let mean = errors.column_mean();
    for mut column in errors.column_iter_mut() {
        column -= &mean;
    }
    let covariance = &errors * errors.transpose() / (repeats - 1) as f64;
    let values = covariance.symmetric_eigenvalues();
    let edge = (rank as f64 / repeats as f64).sqrt();
    Ok(Scatter {
        variance: values.mean(),
        extremes: [values.min(), values.max()],
        edges: [(1.0 - edge).powi(2), (1.0 + edge).powi(2)],
        bias: (mean.norm_squared() * repeats as f64 / rank as f64).sqrt(),
        coverage: covered as f64 / (rank * repeats) as f64,
    })
}
