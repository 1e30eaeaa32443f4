//! What uncertain parameters do to the dynamics: moments, quantiles, sensitivities, densities.
//!
//! A robot's masses, centres of mass, inertias and armatures are random variables (`featherbench_model::Uncertain`, the section `uncertain` of a
//! description). At a state (q, v, τ) its accelerations are then random too. Five methods say how:
//!
//! | method | file | answer | error |
//! |---|---|---|---|
//! | first order | `first_order.rs` | mean y(μ), covariance J Σ Jᵀ | of the second order in the deviations |
//! | unscented | `unscented.rs` | mean and covariance from 2n + 1 points | of the fourth order in the mean, for symmetric variables |
//! | polynomial chaos | `chaos.rs` | mean, variance, Sobol' indices from Gauss quadrature | falls exponentially with the order |
//! | Monte Carlo | `sampling.rs` | all of it | N^(−1/2), with standard errors |
//! | scrambled Sobol' points | `sampling.rs` | all of it | about N^(−1) and better for smooth answers, with standard errors |
//!
//! The parts:
//!
//! | file | what it is |
//! |---|---|
//! | `variable.rs` | a distribution: quantile, moments, orthogonal polynomials |
//! | `space.rs` | all variables, correlated by a Gaussian copula |
//! | `quadrature.rs` | Gauss rules |
//! | `sobol.rs` | points |
//! | `response.rs` | a function of the variables in SIMD lanes |
//! | `robot/` | the dynamics of a robot as such a function |
//! | `sensitivity.rs` | Sobol' indices by sampling |
//! | `mixture.rs` | answers that differ by contact mode |
//! | `moments.rs`, `histogram.rs`, `quantile.rs` | what samples are reduced to |
//! | `estimate.rs` | a number with its standard error and its interval |
//!
//! **Same digits for any number of threads.** A sample is a function of seed and index. Samples are reduced in blocks of fixed size, and blocks
//! are merged in their order.
//!
//! ```
//! use featherbench_model::Distribution;
//! use featherbench_uncertainty::{Closure, Points, Sampling, Space, sample};
//!
//! // v̇ = u/m with u = 1 N and a mass of 1 kg ± 20 %, uniform: E v̇ = ln(1.2/0.8)/0.4.
//! let space = Space::independent(&[Distribution::Uniform { low: 0.8, high: 1.2 }])?;
//! let acceleration = Closure::new(1, 1, |x: &[f64], y: &mut [f64]| y[0] = 1.0 / x[0]);
//! let settings = Sampling { points: Points::Sobol, samples: 1 << 14, ..Sampling::default() };
//! let found = sample(&space, &acceleration, None, &settings, &|_| ())?;
//! assert!((found.outputs[0].mean.value - (1.2_f64 / 0.8).ln() / 0.4).abs() < 4.0 * found.outputs[0].mean.error);
//! # Ok::<(), featherbench_uncertainty::Error>(())
//! ```

mod chaos;
mod error;
mod estimate;
mod first_order;
mod histogram;
mod mixture;
mod moments;
mod quadrature;
mod quantile;
mod response;
mod robot;
mod sampling;
mod sensitivity;
mod sobol;
mod space;
mod spread;
mod unscented;
mod variable;

pub use chaos::{Chaos, chaos, largest_order};
pub use error::Error;
pub use estimate::{Estimate, student};
pub use first_order::{Linear, first_order};
pub use histogram::{BINS, Histogram};
pub use mixture::{Mixture, Mode, mixture};
pub use moments::Moments;
pub use quadrature::{Recurrence, Rule};
pub use quantile::{QUANTILES, Quantile};
pub use response::{Closure, LANES, Lanes, Response, at};
pub use robot::{Quantity, RobotResponse, Route, State};
pub use sampling::{Output, Points, Sampled, Sampling, draw, sample};
pub use sensitivity::{Indices, sensitivity};
pub use sobol::Sobol;
pub use space::Space;
pub use spread::spread;
pub use unscented::{Propagated, unscented};
pub use variable::{Variable, normal_cdf, normal_quantile};
