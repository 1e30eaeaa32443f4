//! Six-dimensional spatial algebra, generic over the scalar [`Real`].
//!
//! Motion and force vectors have named parts, `ang` and `lin`; nothing is indexed.
//! A [`Transform`] `X` is the placement of a child frame in its parent. It takes child coordinates to parent coordinates; its `inverse_*`
//! methods go the other way. Products are written with [`Real::mul_add`]: the compiler never fuses `a * b + c` by itself.
//!
//! Products of small matrices and the arithmetic of wide scalars are inlined in optimised builds. In debug builds they are calls, so
//! that tests compile faster (`docs/kernels/compilation.md`).
//!
//! Source: R. Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapter 2 and appendix A ("the book" in this workspace).

mod contention;
mod exponential;
mod inertia;
mod linear;
mod operators;
mod order;
pub mod peak;
mod principal;
mod scalar;
mod transform;
mod vector;

pub use contention::contention;
pub use exponential::TangentBlock;
pub use inertia::{ArticulatedInertia, CentralInertia, RigidBodyInertia};
pub use linear::{Ldl3, Mat3, Sym3, Vec3};
pub use order::{larger, largest, smaller};
pub use scalar::{Angle, Compensated, Counted, DoubleDouble, Dual, Lift, Logarithm, Operations, Part, Real};
pub use transform::{Quaternion, Transform};
pub use vector::{Force, Motion};
