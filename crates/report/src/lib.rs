//! A run's rows as a folder that opens in a browser: [`write()`] is a pure function of its arguments and reads no clock.
//!
//! The folder needs no network and no server. `index.html` has every table that is worth printing. `data/*.js` has the rows: the page adds
//! a script element to read them when a cell is clicked, as a page under `file://` may not fetch. `app.js` draws the plots as SVG.
//! Every number on the page is made from rows, and every cell and point leads back to its rows.
//!
//! Stages: rows are grouped ([`overview`], [`figures`], [`accuracy`]), turned into HTML (one module per section) and into chunks
//! ([`chunks`]). Then everything is written, with `index.html` last.

mod accuracy;
mod accuracy_section;
mod axes;
mod chunks;
mod conditioning;
mod conventions;
mod figures;
mod findings;
mod fit;
mod heatmap;
mod imports;
mod joint_matrix;
mod known;
mod labels;
mod method;
mod numbers;
mod overview;
mod page;
mod pairwise;
mod plots;
mod provenance;
mod speed;
mod speed_section;
mod steps;
mod summary;
mod tally;
mod tradeoff;
mod truth;
mod unpassed;
mod verdict;

use std::path::{Path, PathBuf};

use featherbench_results::{ResultsError, Row, RunInfo};

pub use crate::summary::summary;

use crate::figures::Figures;
use crate::overview::Overview;

/// Our style sheet.
const STYLE: &str = include_str!("../assets/style.css");

/// Our script: one file in the report, several here.
const SCRIPT: &str = concat!(
    include_str!("../assets/core.js"),
    include_str!("../assets/rows.js"),
    include_str!("../assets/grid.js"),
    include_str!("../assets/heatmap.js"),
    include_str!("../assets/joints.js"),
    include_str!("../assets/chart_axes.js"),
    include_str!("../assets/chart_marks.js"),
    include_str!("../assets/chart_draw.js"),
    include_str!("../assets/chart.js"),
    include_str!("../assets/plots.js"),
    include_str!("../assets/figures.js"),
    include_str!("../assets/accuracy.js"),
    include_str!("../assets/tradeoff.js"),
    include_str!("../assets/steps.js"),
    include_str!("../assets/imports.js"),
    include_str!("../assets/speed.js"),
);

/// Where a report was written.
#[derive(Clone, Debug)]
pub struct ReportPaths {
    /// The page to open.
    pub index: PathBuf,
    /// Every file of the report, the page included.
    pub files: Vec<PathBuf>,
}

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be written; the text names it.
    #[error(transparent)]
    Write(#[from] ResultsError),
    /// The data of the page could not be turned into JSON.
    #[error("the report's data: {0}")]
    Json(#[from] serde_json::Error),
}

/// Writes the report of a run into the folder `out`, which may already hold the run's own files; the page links to `rows.csv`,
/// `run.json` and `schema.json` beside it.
pub fn write(run: &RunInfo, records: &[Row], out: &Path) -> Result<ReportPaths, ReportError> {
    let overview = Overview::of(run, records);
    let figures = Figures::of(&overview, records);

    let mut files = vec![
        ("style.css".to_owned(), STYLE.as_bytes().to_vec()),
        ("app.js".to_owned(), SCRIPT.as_bytes().to_vec()),
        ("data/overview.js".to_owned(), chunks::script("overview", &overview.data())?),
        ("data/figures.js".to_owned(), chunks::script("figures", &figures)?),
    ];
    files.extend(chunks::rows(&overview, records)?);
    // Last, so that a page is never older than what it links to.
    files.push(("index.html".to_owned(), page::render(run, records, &overview, &figures).into_bytes()));

    let mut written = Vec::with_capacity(files.len());
    for (name, bytes) in files {
        let path = out.join(name);
        featherbench_results::atomic_write(&path, &bytes)?;
        written.push(path);
    }
    Ok(ReportPaths { index: out.join("index.html"), files: written })
}
