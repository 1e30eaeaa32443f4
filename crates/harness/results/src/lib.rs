//! The result row of featherbench, and how it is written and read back.
//!
//! A [`Row`] is the unit of result: one row of `rows.csv`, with the columns of [`COLUMNS`]. A failure is a row too, with its [`Verdict`]
//! and its reason. [`RunInfo`] is common to all rows of one run: where, when, with what. Together they are everything that a report needs.
//! This crate computes no results.
//!
//! ```
//! use featherbench_results::{Row, Relation, Verdict};
//!
//! let row = Row { engine: "mujoco".into(), quantity: "id".into(), metric: "scaled".into(), ..Row::default() }
//!     .gated(3.1e-16, Relation::Le, 1e-14);
//! assert_eq!(row.verdict, Verdict::Pass);
//! let lost = Row::default().gated(f64::NAN, Relation::Le, 1e-14);
//! assert_eq!((lost.value, lost.verdict), (None, Verdict::Error));
//! ```

mod apart;
mod checksum;
mod columns;
mod dictionary;
mod diff;
mod disk;
mod drawing;
mod error;
mod file;
mod names;
mod params;
mod properties;
mod quantity;
mod ranking;
mod row;
mod run_info;
mod severity;
mod shell;
mod trend;

pub use apart::Apart;
pub use checksum::{CHECKSUMS_NAME, Checksums, checksum, checksum_of, seal, unsealed};
pub use columns::{COLUMNS, CSV_NAME, Column, ColumnType, Row, schema_json};
pub use dictionary::{Dictionary, Named, Term};
pub use diff::{COMMON, Change, Changed, Diff, ERROR_FACTOR, ERROR_FLOOR, FALSE_SHARE, NORMAL, STUDENT, TIME_NOISE, diff};
pub use disk::{atomic_write, atomic_write_with, quick_write};
pub use drawing::{DRAWINGS_NAME, Drawing, DrawnBody, drawings_to_text, parse_drawings};
pub use error::ResultsError;
pub use file::{RUN_NAME, SCHEMA_NAME, parse_csv, read_csv, read_run, to_csv, write_csv, write_run, write_run_with};
pub use names::{Kind, Relation, Verdict};
pub use params::canonical_json;
pub use properties::{Base, Feature, Properties};
pub use quantity::{Asked, Extent, Extents, Measure, Quantity};
pub use ranking::{Errors, Ranked, Ranking, RecordedTimes, Times};
pub use row::{MARGIN_LIMIT, RATIO};
pub use run_info::{
    Convention, Culprit, EngineInfo, EngineSource, Expectation, GateKind, GitInfo, Host, ModelOrigin, RUN_FORMAT, RobotInfo, RunInfo,
    ShardInfo,
};
pub use severity::Severity;
pub use shell::{quoted, words};
pub use trend::{BESIDE, ChangePoint, Point, Trend, Trended, trends};
