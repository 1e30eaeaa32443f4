//! What keeps loops closed while time passes: Baumgarte's feedback, or projection; and the drift of each.
//!
//! | | acts on | parameters | what it costs |
//! |---|---|---|---|
//! | [`Stabilisation::None`] | nothing | | φ drifts, in general with t² |
//! | [`Stabilisation::Baumgarte`] | a* = −2α φ̇ − β² φ | α, β in 1/s | φ stays near zero, and is not zero |
//! | [`Stabilisation::Projection`] | q and v, after each step and before each v̇ | tolerance | iterations; φ and φ̇ are zero to rounding |

mod projection;
mod run;

pub use projection::{HALVINGS, Projected, Projection};
pub use run::{Drift, Forces, Run, Simulation, Stabilisation};
