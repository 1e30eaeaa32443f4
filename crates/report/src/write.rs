//! Writing the report's folder.

use std::path::{Path, PathBuf};

use featherbench_results::{Row, RunInfo};

use crate::chunks;
use crate::error::ReportError;
use crate::figures;
use crate::overview::Overview;
use crate::page;
use crate::section::Section;

/// The report's style sheet; sections add to it.
const STYLE: &str = include_str!("../assets/style.css");

/// The report's scripts; sections add to them.
const SCRIPT: &str = concat!(
    include_str!("../assets/core.js"),
    include_str!("../assets/rows.js"),
    include_str!("../assets/grid.js"),
    include_str!("../assets/chart_axes.js"),
    include_str!("../assets/chart_marks.js"),
    include_str!("../assets/chart_draw.js"),
    include_str!("../assets/chart.js"),
    include_str!("../assets/plots.js"),
    include_str!("../assets/figures.js"),
);

/// Where a report was written.
#[derive(Clone, Debug)]
pub struct ReportPaths {
    /// The page to open.
    pub index: PathBuf,
    /// Every file of the report, the page included.
    pub files: Vec<PathBuf>,
}

/// Writes the report of a run into the folder `out`, which may already hold the run's own files; the page links to `rows.csv`,
/// `run.json` and `schema.json` beside it. The sections stand in the order given here.
///
/// # Errors
/// [`ReportError`] if a file cannot be written, or if a section's data are no JSON.
pub fn write(run: &RunInfo, rows: &[Row], sections: &[Section], out: &Path) -> Result<ReportPaths, ReportError> {
    let overview = Overview::of(run, rows);
    let with_sections = |own: &str, of: fn(&Section) -> &'static str| {
        let parts = std::iter::once(own).chain(sections.iter().map(of));
        parts.collect::<String>().into_bytes()
    };
    let mut files = vec![
        ("style.css".to_owned(), with_sections(STYLE, |section| section.style)),
        ("app.js".to_owned(), with_sections(SCRIPT, |section| section.script)),
        ("data/overview.js".to_owned(), chunks::overview(&overview)?),
        ("data/figures.js".to_owned(), chunks::figures(sections)?),
    ];
    files.extend(chunks::rows(&overview, rows)?);
    files.extend(figures::files(sections));
    files.push(chunks::figure_data(&figures::data(sections)?));
    // Last, so that a page is never older than what it links to.
    files.push(("index.html".to_owned(), page::render(run, rows, &overview, sections).into_bytes()));

    let mut written = Vec::with_capacity(files.len());
    for (name, bytes) in files {
        let path = out.join(name);
        featherbench_results::atomic_write(&path, &bytes)?;
        written.push(path);
    }
    Ok(ReportPaths { index: out.join("index.html"), files: written })
}
