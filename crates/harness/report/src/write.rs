//! Writing the report's folder.

use std::path::{Path, PathBuf};

use featherbench_results::{CHECKSUMS_NAME, Row, RunInfo, checksum};

use crate::chunks::{self, NamedFile};
use crate::drawings::{Brought, Drawings};
use crate::error::ReportError;
use crate::figures;
use crate::files;
use crate::overview::Overview;
use crate::page::Page;
use crate::parts::{self, Piece};
use crate::section::Section;
use crate::sheet::sheet;
use crate::subjects::Subjects;

/// The report's scripts; sections add to them.
const SCRIPT: &str = concat!(
    include_str!("../assets/core.js"),
    include_str!("../assets/parts.js"),
    include_str!("../assets/rows.js"),
    include_str!("../assets/grid.js"),
    include_str!("../assets/map.js"),
    include_str!("../assets/drawing.js"),
    include_str!("../assets/figures.js"),
    include_str!("../assets/robot.js"),
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
/// `run.json` and `schema.json` beside it. The sections stand in the order given here. Files of an older report there that this one does not
/// have are removed.
///
/// # Errors
/// [`ReportError`] if a file cannot be written, or if a section's data are no JSON.
pub fn write(run: &RunInfo, rows: &[Row], sections: &[Section], out: &Path) -> Result<ReportPaths, ReportError> {
    let overview = Overview::of(run, rows);
    let mut written = Vec::new();
    // File by file, so that no more than one is held.
    let mut put = |(name, bytes): NamedFile| -> Result<(), ReportError> {
        // The rows are safe already; a report can be written again.
        featherbench_results::quick_write(&out.join(&name), &bytes)?;
        written.push(name);
        Ok(())
    };
    let style: String = std::iter::once(sheet().as_str()).chain(sections.iter().map(|section| section.style)).collect();
    put(("style.css".to_owned(), style.into_bytes()))?;
    put(("app.js".to_owned(), script(sections).into_bytes()))?;
    put(("data/overview.js".to_owned(), chunks::overview(&overview)?))?;
    put(("data/figures.js".to_owned(), chunks::figures(sections)?))?;
    chunks::rows(run, &overview, rows).try_for_each(|file| put(file?))?;
    figures::files(sections).try_for_each(&mut put)?;
    put(chunks::figure_data(&figures::data(sections)?))?;
    let drawings = Drawings::of(run, rows, &overview, sections);
    // The run's files are written already, and this one has the checksums of all.
    let archive = std::fs::read(out.join(CHECKSUMS_NAME)).ok().map(|sums| checksum(&sums));
    let page = Page::of(run, rows, &drawings, sections, archive.as_deref());
    for piece in parts::of(&page.sections()) {
        put(chunks::piece(&piece)?)?;
        put((format!("{}/{}.html", parts::FOLDER, piece.name), page.piece(&piece).into_bytes()))?;
    }
    for Brought { name, robot, body } in drawings.brought() {
        put(chunks::piece(&Piece { name: &name, title: &robot, body: &body })?)?;
    }
    for subject in Subjects::of(run, rows, &drawings, sections).pages() {
        put((subject.path.clone(), page.subject(&subject).into_bytes()))?;
    }
    // After the others, so that it is never older than what it links to.
    put(("index.html".to_owned(), page.index().into_bytes()))?;
    let list = files::renew(out, written.iter().map(String::as_str))?;
    let files = written.iter().map(|name| out.join(name)).chain([out.join(list)]).collect();
    Ok(ReportPaths { index: out.join("index.html"), files })
}

/// The report's scripts, then those of the sections, each of which runs when its section is shown.
fn script(sections: &[Section]) -> String {
    let mut text = SCRIPT.to_owned();
    for section in sections.iter().filter(|section| !section.script.is_empty()) {
        text += &format!("featherbench.section(\"{}\", () => {{\n{}}});\n", section.anchor, section.script);
    }
    text
}
