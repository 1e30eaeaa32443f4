//! `featherbench report RUN --figures DIR`: the figures of a run as a paper takes them. One SVG, one CSV and, with a browser, one PDF for
//! each; their captions; and references.

use crate::fail::Fail;
use crate::message::say;
use ::featherbench_results::{RunInfo, atomic_write};
use featherbench_registry::FIGURES;
use featherbench_report::Section;
use featherbench_report::figure::Figure;
use std::path::Path;
use std::process::{Command, Stdio};

/// Programs that print a page as PDF, in the order in which they are tried.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Writes the figures into a folder, and says which are absent and why. `counted` are those of instruction counts, if counts were given.
pub fn write(folder: &Path, info: &RunInfo, sections: &[Section], counted: Option<Vec<Figure>>) -> Result<(), Fail> {
    let figures: Vec<&Figure> = sections.iter().flat_map(|section| &section.figures).chain(counted.iter().flatten()).collect();
    let mut absent: Vec<String> = FIGURES
        .iter()
        .filter(|(name, _)| figures.iter().all(|figure| figure.name != *name))
        .map(|(name, needs)| format!("absent: {name}, which needs {needs}"))
        .collect();
    if counted.as_ref().is_some_and(Vec::is_empty) {
        absent.push("absent: instructions, whose robots this run does not have".into());
    }
    if figures.is_empty() {
        return Err(Fail::input(format!("--figures: run {} has no rows for any figure\n  {}", info.run, absent.join("\n  "))));
    }
    for figure in &figures {
        atomic_write(&folder.join(format!("{}.svg", figure.name)), figure.svg.as_bytes())?;
        atomic_write(&folder.join(format!("{}.csv", figure.name)), figure.csv.as_bytes())?;
    }
    atomic_write(&folder.join("captions.md"), captions(info, &figures).as_bytes())?;
    atomic_write(&folder.join("references.bib"), references(info).as_bytes())?;
    say!("figures: {} in {}: {}", figures.len(), folder.display(), figures.iter().map(|figure| figure.name).collect::<Vec<_>>().join(", "));
    absent.iter().for_each(|line| say!("{line}"));
    match print(folder, &figures) {
        Ok(program) => say!("printed as PDF by {program}"),
        Err(reason) => say!("not printed as PDF: {reason}"),
    }
    Ok(())
}

/// Title, caption and files of each figure, and the run that they show.
fn captions(info: &RunInfo, figures: &[&Figure]) -> String {
    let figure = |figure: &&Figure| {
        let Figure { name, title, caption, .. } = figure;
        format!("## {title}\n\n{caption}\n\nFiles: `{name}.svg`, `{name}.csv`.\n\n")
    };
    let command = if info.command.is_empty() { String::new() } else { format!(" This command repeats it: `{}`.", info.command) };
    format!(
        "# Figures of run {}\n\nSuite {}, {}.{command}\n\n{}",
        info.run,
        info.suite,
        info.started,
        figures.iter().map(figure).collect::<String>()
    )
}

/// An entry for featherbench and one for each engine that answered, with the version that was asked.
fn references(info: &RunInfo) -> String {
    let year: String = info.started.chars().take(4).collect();
    let own = env!("CARGO_PKG_NAME");
    let title = "featherbench: a benchmark and validation harness for the dynamics of complex robots";
    let first = entry(own, title, &info.version, &year, &format!("  url = {{{}}},\n", env!("CARGO_PKG_REPOSITORY")));
    let others = info.engines.iter().filter(|engine| engine.name != own && engine.status == "ok");
    first + &others.map(|engine| entry(&engine.name, &engine.name, &engine.version, &year, "")).collect::<String>()
}

/// One entry; `more` are whole lines.
fn entry(key: &str, title: &str, version: &str, year: &str, more: &str) -> String {
    // What ends a field or begins a command in BibTeX is no part of a name.
    let plain = |text: &str| text.chars().filter(|c| !"{}\\\"%#&$~^_".contains(*c)).collect::<String>();
    let key: String = key.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').collect();
    let (title, version, year) = (plain(title), plain(version), plain(year));
    let fields = [
        format!("  title = {{{{{title}}}}},\n"),
        format!("  author = {{{{The {key} authors}}}},\n"),
        format!("  version = {{{version}}},\n"),
        format!("  note = {{Version {version}, as asked in {year}}},\n"),
    ];
    format!("@misc{{{key},\n{}{more}}}\n", fields.concat())
}

/// Prints each figure as a page of its own size. The name of the program, or why there is no PDF.
fn print(folder: &Path, figures: &[&Figure]) -> Result<&'static str, String> {
    let runs = |program: &&&str| {
        Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
    };
    let program = BROWSERS.iter().find(runs).ok_or_else(|| format!("none of {} is on the path", BROWSERS.join(", ")))?;
    let folder = std::path::absolute(folder).map_err(|error| error.to_string())?;
    for figure in figures {
        // The browser takes the size of the paper from the page.
        let [width, height] = figure.size.map(f64::ceil);
        let page = folder.join(format!(".{}.html", figure.name));
        let text = format!(
            "<!DOCTYPE html><style>@page {{ size: {width}px {height}px; margin: 0 }} body {{ margin: 0 }} svg {{ display: block }}</style>{}",
            figure.svg
        );
        atomic_write(&page, text.as_bytes()).map_err(|error| error.to_string())?;
        let pdf = folder.join(format!("{}.pdf", figure.name));
        // The page is ours and loads nothing: the sandbox, which a container may forbid, guards nothing here.
        let ended = Command::new(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"])
            .arg(format!("--print-to-pdf={}", pdf.display()))
            .arg(&page)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        // The page is a step on the way.
        let removed = std::fs::remove_file(&page);
        let ended = ended.map_err(|error| format!("{program}: {error}"))?;
        removed.map_err(|error| format!("{}: {error}", page.display()))?;
        if !ended.success() || !pdf.is_file() {
            return Err(format!("{program} ended with {ended} and wrote no {}", pdf.display()));
        }
    }
    Ok(program)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::featherbench_results::{EngineInfo, EngineSource};

    #[test]
    fn references_name_featherbench_and_the_engines_that_answered() {
        let engine = |name: &str, version: &str, status: &str| EngineInfo {
            name: name.into(),
            version: version.into(),
            released: String::new(),
            source: EngineSource::Recorded,
            build: std::collections::BTreeMap::new(),
            status: status.into(),
            reason: String::new(),
        };
        let engines = vec![engine("pinocchio", "4.1.0", "ok"), engine("drake", "", "missing"), engine("x}y", "1{2", "ok")];
        let info = RunInfo { version: "0.1.0".into(), started: "2026-11-25T00:00:00Z".into(), engines, ..RunInfo::default() };
        let text = references(&info);
        assert_eq!(text.matches("@misc{").count(), 3, "{text}");
        assert!(text.contains("@misc{featherbench,") && text.contains("  url = {https://") && !text.contains("drake"), "{text}");
        assert!(
            text.contains("@misc{pinocchio,\n  title = {{pinocchio}},") && text.contains("note = {Version 4.1.0, as asked in 2026}"),
            "{text}"
        );
        assert_eq!(text.matches('{').count(), text.matches('}').count(), "a name cannot break the file: {text}");
    }
}
