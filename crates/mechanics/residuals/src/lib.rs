//! What a nominal robot model lacks: residuals, and the dynamics that they correct.
//!
//! # The sign
//! One convention holds everywhere, `true = nominal + r`:
//!
//! ```text
//! τ = ID(q, v, a) + r(q, v, a)          M a + h + r = τ
//! ```
//!
//! So r is the joint force that the motion needs *beyond* what the nominal model says. Friction, which opposes the motion, has vᵀr ≥ 0.
//! A disturbance force d on the right-hand side, M a + h = τ + d, is d = −r.
//!
//! # What is here
//! - [`Residual`] is the trait: r, and its derivative ∂r/∂a. [`Sum`] adds residuals, [`Zero`] is none.
//! - [`Viscous`], [`SmoothCoulomb`], [`Stribeck`] are friction. [`DryFriction`] is set-valued: at rest the answer is an interval.
//! - [`SpringDamper`] is the compliance of a joint or link. [`SeriesElastic`], [`Lag`] and [`Delay`] have inner states, which are named.
//! - [`Payload`] is a mass that a body carries. [`Linear`] is linear in its parameters.
//! - [`Passive`] is a linear residual that provably makes no energy, by projection.
//! - [`Described`] are the residuals of a description file.
//! - [`Corrected`] has the inverse and forward dynamics of a nominal model with a residual. A [`Nominal`] is any rigid-body dynamics: [`Rigid`]
//!   is ours.
//!
//! ```
//! use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
//! use featherbench_residuals::{Corrected, Rigid, Viscous};
//!
//! let joint = JointDescription { kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] }, ..JointDescription::default() };
//! let cart = BodyDescription { name: "cart".into(), parent: None, mass: 2.0, com: [0.0; 3], inertia: [0.0; 6], joint };
//! let model = Model::build(&Description { bodies: vec![cart], ..Description::default() })?;
//! let mut cart = Corrected::new(Rigid::new(&model), Viscous::new(vec![0.5])?)?;
//! // 2 kg, 0.5 N·s/m: at 4 m/s an acceleration of 3 m/s² needs 2·3 + 0.5·4 = 8 N.
//! assert_eq!(cart.inverse(&[0.0], &[4.0], &[3.0])?, [8.0]);
//! assert_eq!(cart.forward(&[0.0], &[4.0], &[8.0])?, [3.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod compliance;
mod corrected;
mod delay;
mod described;
mod error;
mod friction;
mod linear;
mod nominal;
mod on_joints;
mod passive;
mod payload;
mod power;
mod residual;
mod series_elastic;

pub use compliance::SpringDamper;
pub use corrected::{Corrected, WELL_POSED, WellPosed, add_unless_zero, corrected_acceleration};
pub use delay::{Delay, Lag};
pub use described::{Described, DescribedError, NamedBounds};
pub use error::ResidualError;
pub use friction::{DryFriction, Forces, SmoothCoulomb, Stribeck, Viscous};
pub use linear::Linear;
pub use nominal::{Nominal, Rigid};
pub use passive::{Certificate, Passive, Projection};
pub use payload::{Payload, PayloadError};
pub use power::{PowerBalance, Quadrature};
pub use residual::{Residual, State, Sum, Zero};
pub use series_elastic::SeriesElastic;
