//! Section: program, machine, engines and robots of the run.

use std::collections::BTreeMap;

use featherbench_results::{CHECKSUMS_NAME, RobotInfo, RunInfo};
use maud::{Markup, html};

use crate::blocks::{self, opener};
use crate::numbers::short;
use crate::overview::{Overview, robot_chunk};
use crate::section::Section;

/// The fact of an engine's build that has a column of its own: the interpreter of an oracle in Python.
const PYTHON: &str = "python";

/// Writes the section.
pub fn section(run: &RunInfo, overview: &Overview, archive: Option<&str>) -> Section {
    Section::new("provenance", "Provenance", body(run, overview, archive))
}

fn body(run: &RunInfo, overview: &Overview, archive: Option<&str>) -> Markup {
    html! {
        section #provenance {
            h2 { "Engines, machine and robots" }
            (engines(run, overview))
            div.columns { (build(run)) (machine(run)) }
            (robots(run, overview))
            h3 #cite { "Cite this run" }
            div.scroll { pre { (bibtex(run, archive)) } }
            p.note {
                "Keep the folder of the run: " code { (CHECKSUMS_NAME) } " has the checksum of each file, and the note above has that of "
                code { (CHECKSUMS_NAME) } " (" code { "b3sum " (CHECKSUMS_NAME) } "). The link below a figure is its address, with what is chosen."
            }
        }
    }
}

/// An entry of BibTeX: the suite, the day, and hashes that tell whether a run is this one.
fn bibtex(run: &RunInfo, archive: Option<&str>) -> String {
    let year: String = run.started.chars().take_while(|c| *c != '-').collect();
    // Braces and backslashes would end an entry or begin a command.
    let plain = |text: &str| text.replace(['{', '}', '\\'], "").replace('_', "\\_");
    let mut note = format!("version {}", run.version);
    for (what, hash) in
        [("revision", run.git.revision.as_str()), ("suite file", &run.suite_hash), ("checksums.txt", archive.unwrap_or_default())]
    {
        if !hash.is_empty() {
            note += &format!(", {what} {hash}");
        }
    }
    let key: String = run.run.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').collect();
    format!(
        "@misc{{featherbench-{key},\n  author = {{{{The featherbench authors}}}},\n  title  = {{featherbench: suite {}, run {}}},\n  year   = {{{year}}},\n  note   = {{{}}}\n}}",
        plain(&run.suite),
        plain(&run.run),
        plain(&note)
    )
}

fn engines(run: &RunInfo, overview: &Overview) -> Markup {
    html! {
        h3 { "Engines" }
        div.scroll {
            table.compact {
                thead { tr { th scope="col" { "engine" } th scope="col" { "version" } th scope="col" { "released" } th scope="col" { "Python" } th scope="col" { "answers" } th scope="col" { "status" } th scope="col" { "build" } } }
                tbody {
                    @for engine in &run.engines {
                        tr {
                            th scope="row" { (blocks::engine(overview, &engine.name)) }
                            td { code { (engine.version) } }
                            td.nowrap { (engine.released) }
                            td { @if let Some(python) = engine.build.get(PYTHON) { code { (python) } } }
                            td { (engine.source) }
                            td {
                                @if engine.status == "ok" { span.badge.pass { "✓ ok" } } @else { span.badge.error { "! " (engine.status) } }
                                @if !engine.reason.is_empty() { " " (engine.reason) }
                            }
                            td.build { @for (name, value) in engine.build.iter().filter(|(name, _)| *name != PYTHON) { span.nowrap { (name) "=" code { (value) } } " " } }
                        }
                    }
                }
            }
        }
    }
}

/// A list of facts; those that are not known say so.
fn facts(title: &str, facts: &[(&str, String)]) -> Markup {
    html! {
        div {
            h3 { (title) }
            dl.facts {
                @for (name, value) in facts {
                    dt { (name) }
                    dd { @if value.is_empty() { span.none { "unknown" } } @else { (value) } }
                }
            }
        }
    }
}

fn build(run: &RunInfo) -> Markup {
    let dirty = if run.git.dirty { ", with uncommitted changes" } else { "" };
    let revision = if run.git.revision.is_empty() { String::new() } else { format!("{}{dirty}", run.git.revision) };
    facts(
        "Program",
        &[
            ("featherbench", run.version.clone()),
            ("revision", revision),
            ("binary", run.binary_hash.clone()),
            ("compiler", run.rustc.clone()),
            ("profile", run.profile.clone()),
            ("target features", run.target_features.join(" ")),
            ("suite", format!("{} {}", run.suite, run.suite_hash)),
            ("seed", run.seed.to_string()),
        ],
    )
}

fn machine(run: &RunInfo) -> Markup {
    let host = &run.host;
    let phases: Vec<String> = run.seconds.iter().map(|(phase, &seconds)| format!("{phase} {} s", short(seconds))).collect();
    facts(
        "Machine",
        &[
            ("processor", host.cpu.clone()),
            ("logical cores", host.cores.to_string()),
            ("pinned to", host.affinity.clone()),
            ("governor", host.governor.clone()),
            ("load at start", host.load.map(|load| format!("{load:.2}")).unwrap_or_default()),
            ("memory", host.memory.map(|bytes| format!("{:.1} GiB", bytes as f64 / f64::from(1 << 30))).unwrap_or_default()),
            ("kernel", host.kernel.clone()),
            ("time spent", phases.join(", ")),
        ],
    )
}

fn robots(run: &RunInfo, overview: &Overview) -> Markup {
    let announced: BTreeMap<&str, &RobotInfo> = run.robots.iter().map(|robot| (robot.name.as_str(), robot)).collect();
    let size = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
    html! {
        h3 { "Robots" }
        div.scroll.tall {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "robot" } th scope="col" { "family" } th scope="col" { "origin" } th scope="col" { "rows" }
                        th.number scope="col" { "nv" } th.number scope="col" { "bodies" } th.number scope="col" { "depth" }
                        th scope="col" { "licence" } th scope="col" { "source" } th scope="col" { "hash" }
                    }
                }
                tbody {
                    @for (index, robot) in overview.robots.iter().enumerate() {
                        @let info = announced.get(robot.name);
                        tr {
                            th scope="row" { (blocks::robot(overview, robot.name)) }
                            td { (robot.family) }
                            td { @if let Some(info) = info { (info.origin) } }
                            td { (opener(&robot_chunk(index), &[], "rows")) }
                            td.number { (size(robot.nv)) }
                            td.number { (size(robot.bodies)) }
                            td.number { (size(robot.depth)) }
                            td.source { @if let Some(info) = info { (info.licence) } }
                            td.source { @if let Some(info) = info { (info.source) } }
                            td { @if let Some(info) = info { code title=(info.hash) { (info.hash.chars().take(12).collect::<String>()) } } }
                        }
                    }
                }
            }
        }
        @if run.robots.iter().any(|robot| !robot.notes.is_empty()) {
            h3 { "Notes on robots" }
            ul #robot-notes { @for robot in &run.robots { @for note in &robot.notes { li { b { (robot.name) } ": " (note) } } } }
        }
    }
}
