//! `featherbench report`, and how a run ends: its page and its findings.

pub mod diff;
pub mod explain;
pub mod export;
pub mod figures;
pub mod gate;
pub mod history;
pub mod instructions;
pub mod parquet;
pub mod ranges;

use crate::args::ReportArgs;
use crate::fail::Fail;
use crate::message::say;
use ::featherbench_results::{Row, RunInfo};
use featherbench_reduction::{CATALOGUE, Catalogue};
use featherbench_report::{Findings, Section};
use std::path::{Path, PathBuf};

/// Writes the report of a finished run again, and its figures for a paper and opens it if that is wanted.
pub fn write(args: &ReportArgs) -> Result<(), Fail> {
    let (info, records) = ::featherbench_results::read_run(&args.folder)?;
    let page = render(&args.folder, &info, &records)?;
    if let Some(folder) = &args.figures {
        let counts = args.instructions.as_deref().map(instructions::read).transpose()?;
        let counted = counts.map(|counts| featherbench_speed::instructions(&info, &records, &counts));
        figures::write(folder, &info, &sections(&args.folder, &info, &records)?, counted)?;
    }
    if args.json {
        let ranking = featherbench_registry::ranking(&info, &records);
        let text = serde_json::to_string_pretty(&ranking).map_err(|error| Fail::input(error.to_string()))?;
        say!("{text}");
    } else {
        say!("report: {}", page.display());
    }
    show(&page, args.open)
}

/// Renders the report into the run's folder and returns its page.
pub fn render(folder: &Path, info: &RunInfo, records: &[Row]) -> Result<PathBuf, Fail> {
    let paths = featherbench_report::write(info, records, &sections(folder, info, records)?, folder)
        .map_err(|error| Fail::input(error.to_string()))?;
    Ok(paths.index)
}

/// The sections of a run's report: those of its studies, and that of the catalogue of its failures, if `reduce` has made one.
fn sections(folder: &Path, info: &RunInfo, records: &[Row]) -> Result<Vec<Section>, Fail> {
    let catalogue = Catalogue::read(&folder.join(CATALOGUE))?.map(|catalogue| featherbench_reduction::section(&catalogue));
    Ok(featherbench_registry::sections(info, records).into_iter().chain(catalogue).collect())
}

/// Prints whether the run passed, what was found and how fast we are, and the report's page last.
pub fn conclude(info: &RunInfo, records: &[Row], page: &Path, open: bool) -> Result<(), Fail> {
    let sections = featherbench_registry::sections(info, records);
    featherbench_report::summary(info, records, &sections).iter().for_each(|line| say!("{line}"));
    say!("report: {}", page.display());
    show(page, open)?;
    gate::conclude(info, &Findings::of(info, records))
}

/// Opens a page by the program that the system has for it.
fn show(page: &Path, wanted: bool) -> Result<(), Fail> {
    if !wanted {
        return Ok(());
    }
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let failed = |what: String| Fail::input(format!("--open: {program} {}: {what}; open the page by hand", page.display()));
    let status = std::process::Command::new(program).arg(page).status().map_err(|error| failed(error.to_string()))?;
    if status.success() { Ok(()) } else { Err(failed(status.to_string())) }
}
