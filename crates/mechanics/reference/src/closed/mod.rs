//! Closed forms: problems with a formula for the motion, at any precision.
//!
//! - [`Elliptic`]: the complete integral K and the functions sn, cn, dn of one modulus, by the arithmetic-geometric mean;
//! - [`Pendulum`]: swinging and full turns;
//! - [`DoublePendulum`]: its accelerations;
//! - [`FreeTop`]: a free rigid body with three different moments of inertia;
//! - [`HeavyTop`]: steady precession and conserved quantities of a symmetric top.

mod double_pendulum;
mod elliptic;
mod free_top;
mod heavy_top;
mod pendulum;

pub use double_pendulum::DoublePendulum;
pub use elliptic::Elliptic;
pub use free_top::FreeTop;
pub use heavy_top::{HeavyTop, SteadyPrecession, TopMomenta};
pub use pendulum::Pendulum;
