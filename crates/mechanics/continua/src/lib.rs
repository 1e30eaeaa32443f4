//! Rods, beams and strings in one tree with rigid bodies, and their known answers.
//!
//! - [`Material`], [`Section`] and [`Rod`] are what a rod is made of; a number that no rod has is refused by its name.
//! - [`Element`] is a discretisation: rigid links with springs, Ritz shape functions, sections of constant strain, strings.
//! - [`Assembly`] attaches rods to a robot or to the world, and [`Continuum`] is what comes out.
//! - [`Solver`] has the dynamics, [`Motion`] is the right-hand side of integrators, [`equilibrium`] the statics, [`modes`] the vibrations.
//! - [`passivity`] judges matrices; [`rigid_limit`] compares a stiff rod with the rigid tree.
//! - [`known`] has the answers, [`fit`](fit()) orders and prefactors, [`systems`] ready cases.
//!
//! # One concept
//!
//! Every element is an *embedding*: its coordinates s move a fine tree of rigid bodies by q = φ(s), q̇ = B ṡ, q̈ = B s̈ + Ḃ ṡ, B
//! block-diagonal. So M_s = Bᵀ M B and τ_s = Bᵀ ID(q, q̇, q̈), with the inverse dynamics of `featherbench_dynamics` as they are. Virtual
//! work goes through B both ways: M_s is symmetric and positive definite, energy and momentum are those of the bodies, whatever φ is.
//!
//! Conventions: SI units; a rod lies along x of its placement; strains are ξ = [κ; ε] in the axes of the section.
//!
//! ```
//! use featherbench_continua::{Element, Hinges, Rod, Strain, known, modes, systems};
//! // First frequency of a cantilever of 20 links: β₁² (1 − 0.229/n²).
//! let rod = Rod::textbook(1.0, 1.0, 1.0)?;
//! let element = Element::Links { count: 20, hinges: Hinges::Middle, strains: vec![Strain::BendZ] };
//! let (beam, _) = systems::cantilever(&rod, &element)?;
//! let first = modes(&beam, &beam.rest(), &[])?.frequencies()[0];
//! assert!((first / known::cantilever_root(0).powi(2) - 1.0).abs() < 0.25 / 400.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod basis;
mod block;
mod continuum;
mod described;
mod element;
pub mod examples;
mod fit;
pub mod known;
mod material;
mod modes;
mod passivity;
pub mod quadrature;
mod rigid;
mod shape;
mod solver;
mod statics;
pub mod systems;
mod tangent;

pub use assembly::{Assembly, Tip};
pub use basis::{Basis, Shape};
pub use continuum::Continuum;
pub use element::{Element, Hinges, Masses};
pub use fit::{Fit, fit};
pub use material::{Defect, Material, Refused, Rod, Section, Strain};
pub use modes::{Modes, generalized, modes};
pub use passivity::{Passivity, collocation, passivity};
pub use rigid::{RigidLimit, rigid_limit};
#[doc(hidden)]
pub use solver::instances;
pub use solver::{Load, Motion, SolveError, Solver, energies, momentum};
pub use statics::{Equilibrium, Settings, Status, equilibrium, judge, newton};
pub use tangent::{mass_matrix, residual, tangent_stiffness};
