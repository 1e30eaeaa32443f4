//! A run's rows as a folder that opens in a browser: the building blocks of the page, and its frame.
//!
//! This crate knows no study. A study makes [`Section`]s from rows; [`write()`] puts them on the page in the order in which they are given.
//! It is a pure function of its arguments and reads no clock.
//!
//! The folder needs no network and no server. `index.html` opens with the findings and names every section. A large piece is brought when the
//! window is near it or when it is opened. It has a page of its own under `sections/`. Each engine, robot and study has a page, too.
//! `data/*.js` has the rows and those pieces: the page adds a script element to read them, as a page under `file://` may not fetch.
//! [`mod@figure`] draws the plots of sections and the figures for papers, which are in `figures/`.
//! Every number on the page is made from rows, and every cell and point leads back to its rows.
//!
//! # The order of the files
//! A file uses only files of its own line and of the lines above it, and never in a circle (`tests/layers.rs`).
//!
//! | layer | files |
//! |---|---|
//! | data | [`numbers`], [`labels`], [`fit`], `error`, then [`figure`], then `tally`, `overview`, `section`, then [`choices`], `findings`, `parts`, then `chunks`, [`forms`] |
//! | sections | `blocks`, [`mod@robot`], then [`map`], `drawings`, then `cards`, then `verdict`, `conventions`, `provenance`, `method`, `unpassed`, `figures`, `subjects` |
//! | page | `page`, `sheet`, `summary`, [`changes`], `trends`, then [`runs`], then `files`, then `write` |

mod blocks;
mod cards;
pub mod changes;
pub mod choices;
mod chunks;
mod conventions;
mod drawings;
mod error;
pub mod figure;
mod figures;
mod files;
mod findings;
pub mod fit;
pub mod forms;
pub mod labels;
pub mod map;
mod method;
pub mod numbers;
mod overview;
mod page;
mod parts;
mod provenance;
pub mod robot;
pub mod runs;
mod section;
mod sheet;
mod subjects;
mod summary;
mod tally;
mod trends;
mod unpassed;
mod verdict;
mod write;

pub use blocks::{engine, opener, robot, sentence, study, swatch};
pub use chunks::{TIMES, UNPASSED};
pub use error::ReportError;
pub use findings::{Findings, Found, Status};
pub use overview::{EVERYONE, Overview, Pages, Robot, robot_chunk};
pub use section::{Finding, Lead, Mark, Part, Section, Shown};
pub use summary::{summary, unmet};
pub use tally::{Tally, worst_first};
pub use write::{ReportPaths, write};
