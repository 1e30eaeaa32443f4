//! Robots, engines, studies, cells, the run, the comparison and the gates.
//!
//! A [`Study`] asks [`Engine`]s about [`Robot`]s. It plans [`Cell`]s. Each is evaluated once, and its [`Outcome`] is kept in an
//! [`OutcomeStore`]. A pure comparison turns outcomes into rows, judged by [`Gates`]. The error measures are in [`measure`].

mod cell;
pub mod conventions;
mod deviation;
mod engine;
mod error;
mod gates;
pub mod hash;
mod import;
pub mod layout;
mod means;
pub mod measure;
pub mod provenance;
mod quantity;
mod ranges;
mod relocation;
mod robot;
pub mod run;
mod stepper;
mod store;
mod study;
mod suite;
pub mod truth;

pub use cell::{Cell, Outcome};
pub use deviation::{Deviation, NotOffered, Reproduction, SEEDS, SLACK};
pub use engine::{Engine, Evaluation, Identity, NoAnswer};
pub use error::HarnessError;
pub use featherbench_formats::frame;
pub use gates::{Factor, Gate, Gates, Sharpness, accounted};
pub use import::{FileBase, FileFormat, FileInertial, FileLink, Import, ImportNote, RobotFile, WATER};
pub use means::{Known, Mean};
pub use quantity::{DENSE_LIMIT, Quantity};
pub use ranges::{Range, RangeKey, Ranges, RangesMeter};
pub use relocation::Relocation;
pub use robot::{Robot, Route};
pub use stepper::Stepper;
pub use store::{Lost, OUTCOMES_NAME, OutcomeStore};
pub use study::{Context, Finished, Study};
pub use suite::{AgreementEntry, RobotEntry, Suite, TimingEntry};
