//! USD with its physics schemas, written. Reading it needs OpenUSD: `featherbench compare` and `gen` ask its own parser.
//!
//! - A body is a prim with `PhysicsRigidBodyAPI` and `PhysicsMassAPI`, beside the others: none is within another. Its place is that at the
//!   neutral configuration.
//! - A joint has its frame in both bodies. An axis along a coordinate axis stays that one; of another one the joint's frame is turned.
//! - A free joint is no joint: a body that nothing holds floats.
//! - The numbers of the schemas are single: they are read back within 2⁻²⁴ of each number, and rotations within 2e-7. The inertia stands in
//!   double beside them, as `newton:inertia`.
//! - Lengths are in m, masses in kg, angles in degrees, and z is up.

mod stage;
mod write;

pub use write::{to_string, write};
