//! Hybrid systems with closed forms. Every number is a parameter: the same case runs with others.
//!
//! | system | what is known |
//! |---|---|
//! | [`BouncingBall`] | event times, t∞ = t₁(1 + e)/(1 − e), path h(1 + e²)/(1 − e²), saltation |
//! | [`MovingTable`] | saltation with guard and reset that depend on time |
//! | [`SlantedBox`] | saltation at a wall of any direction; corners where two walls are met |
//! | [`RimlessWheel`] | limit cycle ω² = 4(g/l) sin α sin γ/sin² 2α, and its multiplier cos² 2α |
//! | [`RockingBlock`] | Housner's r, quarter periods linear and nonlinear |
//! | [`StickSlip`] | slip and stick times, sliding mode, saltation 1 ⊕ 0 at its entry and 1 at an exit with equal fields |
//! | [`SlidingSphere`] | sliding ends at 2v₀/(7μg) with 5v₀/7 |

mod ball;
mod block;
mod elliptic;
mod slanted;
mod sphere;
mod stick_slip;
mod table;
mod wheel;

pub use ball::BouncingBall;
pub use block::RockingBlock;
pub use elliptic::{carlson, incomplete};
pub use slanted::SlantedBox;
pub use sphere::SlidingSphere;
pub use stick_slip::StickSlip;
pub use table::MovingTable;
pub use wheel::RimlessWheel;
