//! Robots, engines, studies, cells, the run, the comparison and the gates.
//!
//! A [`Study`] asks [`Engine`]s about [`Robot`]s. It plans [`Cell`]s. Each is evaluated once, and its [`Outcome`] is kept in an
//! [`OutcomeStore`]. A pure comparison turns outcomes into rows, judged by [`Gates`]. The error measures are in [`measure`].
//!
//! # The walk of a state
//! ```text
//! seed, name of the robot      StateBatch::agreement          robots     counter-based: the same bits everywhere
//!   → q, v, a, τ, wrenches     Robot::states                  bench      neutral coordinates
//!   → numbers of the engine    Engine::prepare                engines    one named conversion per engine, tested against it
//!   → values                   Evaluation::run, read          engines    one size of Quantity per state
//!   → Outcome                  OutcomeStore::insert           bench      kept at once: a killed run resumes
//!   → error, unit-free         measure::scaled_error          bench      over the magnitudes of the terms
//!   → Row                      Study::compare, Gates::judge   studies    the worst state of each kind
//!   → rows.csv, a page         Run::write, Section            results, studies, report
//! ```
//!
//! # The walk of a robot file
//! ```text
//! robot.urdf, .xml             FileContent                    bench      read once, its format recognised, its hash
//!   → RobotSource              urdf::Parsed, MuJoCo           formats    parsed once; errors name line and column
//!   → Description              plain numbers as written       model
//!   → canonical Description    Description::canonical         depth-first, fixed joints merged, axes normalised once
//!   → content hash             canonical JSON                 bench      every cell of the robot carries it
//!   → Model                    Model::build                   model      topology apart from parameters
//!   → Robot                    with its states                bench
//!   ↘ RobotFile                Engine::read                   engines    the engine's own parser; what it then holds is an Import
//!     → differences            studies::import                studies    by body and field, with a cause that predicts the numbers
//! ```
//!
//! # The walk of a timing sample
//! ```text
//! one block of calls           Evaluation::clock              engines    clock readings around the loop, in the process that runs it
//!   → ns per call              Samples                        studies    candidate × round, how crowded the core was; also in timing.jsonl
//!   → lower decile and ratio   Estimate                       studies    of each process; their spread makes the interval
//!   → one Row                  value, ci_low, ci_high, valid  results    valid = false where the A/A replicate is far from 1
//!   → a mark with its interval Section                        studies    the section of the timing study; report draws the frame
//! ```

mod core;
mod engine;
mod error;
mod gates;
pub mod hash;
pub mod layout;
pub mod measure;
mod robot;
pub mod run;
pub mod statistics;
mod suggestion;
mod suite;
pub mod truth;

pub use crate::core::Core;
pub use engine::answer::{Evaluation, NoAnswer};
pub use engine::contact_solver::{ContactProblems, ContactSolver, ContactSteps, StepMethod};
pub use engine::described::{ClockKind, DescribedEngine, Engines, Library, Package, Start};
pub use engine::lack::Lack;
pub use engine::loops::{LoopAccelerations, LoopDrive, LoopMotion, LoopSolver, LoopSpring, LoopStates, LoopSteps};
pub use engine::rod_solver::{RodAnswer, RodQuestion, RodSolver};
pub use engine::scene_engine::SceneEngine;
pub use engine::semidefinite::{SemidefiniteProblem, SemidefiniteSolution, SemidefiniteSolver};
pub use engine::stepper::Stepper;
pub use engine::with_residual::WithResidual;
pub use engine::{Engine, Identity};
pub use error::HarnessError;
pub use featherbench_formats::urdf::{FileInertial, FileLink};
pub use featherbench_protocol::{Limits, Memory};
pub use featherbench_results::Quantity;
pub use gates::counts::{COUNTS_NAME, Count, Counts};
pub use gates::deviation::{Deviation, DeviationFile, Reproduction, SEEDS};
pub use gates::known::cause;
pub use gates::means::{Known, Mean};
pub use gates::meter::RangesMeter;
pub use gates::ranges::{Range, RangeKey, Ranges, SLACK};
pub use gates::{Factor, Gate, Gates, Planted, Sharpness};
pub use layout::DENSE_LIMIT;
pub use robot::class::RobotClass;
pub use robot::file::{FileBase, FileContent, FileFormat, RobotFile, WATER};
pub use robot::import::{Import, ImportNote, ImportVariant, Rewritten};
pub use robot::relocation::{Relocation, STACK_PLACES, on_stack_at};
pub use robot::source::RobotSource;
pub use robot::{Robot, Route};
pub use run::cell::{Cell, Outcome};
pub use run::entries::{Entries, Lost};
pub use run::store::{OUTCOMES_NAME, OutcomeStore};
pub use run::study::{Asked, Context, Finished, Study};
pub use suggestion::did_you_mean;
pub use suite::draw::Draw;
pub use suite::entry::RobotEntry;
pub use suite::{NoSettings, Suite};
pub use truth::derivative_floor::derivative_floor;

pub use engine::alone;
pub use robot::conventions;
pub use robot::drawing;
pub use run::params;
pub use run::provenance;
pub use run::shard;
pub use truth::by_duals;

/// Our engine's name.
pub const OWN: &str = "featherbench";

/// Our method of many states at once: a state per lane of a register.
pub const BATCH: &str = "batch";
