//! Robots with loops whose motion is known. Each is data: its numbers are fields.
//!
//! | | loops | Grübler, d = 3 or 6 | true mobility | known |
//! |---|---|---|---|---|
//! | [`Ladder`] with one window | 1 | 1 | 1; 2 when flat | θ̈ in closed form |
//! | [`Ladder`] with N windows (IFToMM A02) | N | 1 | 1; N + 1 when flat | θ̈ in closed form, energy |
//! | [`Bricard`] (IFToMM A04) | 1 | 0 | 1 | energy |
//! | [`Squeezer`] (Andrews) | 3 | 1 | 1 | the equations in closed form |
//! | [`Biped`] | 6 | 6 | 12 | J v̇ = 0 and energy |
//! | [`Pair`]: pendulums with a gear, a cam, a rod or a weld | 1 | – | 1 | θ̈ in closed form |

mod biped;
mod bricard;
mod ladder;
mod pair;
mod parts;
mod squeezer;

pub use biped::Biped;
pub use bricard::Bricard;
pub use ladder::Ladder;
pub use pair::{Pair, Tie};
pub use squeezer::Squeezer;
