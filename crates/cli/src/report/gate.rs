//! `featherbench gate`: what turned a run's gates red, and by how much.

use crate::args::{GateArgs, RunArgs};
use crate::fail::Fail;
use crate::message::{self, say};
use crate::report::ranges;
use crate::robots;
use crate::root::Root;
use ::featherbench_results::{Expectation, GateKind, Row, RunInfo, atomic_write};
use featherbench_bench::{Counts, Suite, provenance};
use featherbench_report::{Findings, forms, unmet};
use std::path::Path;

/// Findings that are printed; the forms for programs have all.
const TOLD: usize = 50;

/// Judges a finished run again, by today's gates of its suite.
pub fn gate(root: &Root, args: &GateArgs) -> Result<(), Fail> {
    let (mut info, records) = ::featherbench_results::read_run(&args.folder)?;
    if args.ranges {
        return ranges::measure(root, args, &info, &records);
    }
    let (suite, _) = Suite::read(&root.suites().join(format!("{}.toml", info.suite)))?;
    if args.counts {
        return count(root, &suite, &info, &records, args.write);
    }
    info.expected = conditions(root, &suite, &args.folder, &info, &records)?;
    let findings = Findings::of(&info, &records);
    if let Some(path) = &args.junit {
        atomic_write(path, forms::junit(&info, &findings).as_bytes())?;
    }
    if let Some(path) = &args.markdown {
        atomic_write(path, forms::markdown(&info, &findings).as_bytes())?;
    }
    if args.json {
        say!("{:#}", forms::json(&info, &findings));
    } else {
        tell(&info, &findings);
        if args.annotations {
            message::text(&forms::annotations(&findings));
        }
    }
    conclude(&info, &findings)
}

/// Today's conditions on a run. Engines that were missing stay missing.
fn conditions(root: &Root, suite: &Suite, folder: &Path, info: &RunInfo, records: &[Row]) -> Result<Vec<Expectation>, Fail> {
    let externals = info.engines.iter().filter(|engine| engine.build.contains_key(provenance::PROGRAM)).map(|engine| engine.name.as_str());
    let gates = root.read_gates()?.with_external(&externals.collect::<Vec<_>>()).with_robots(ranges::properties(folder, info)?)?;
    let mut conditions = gates.conditions(suite, records, true);
    // A command that is none of `run` is that of an older program.
    if RunArgs::of_command(&info.command).is_none_or(|run| robots::is_own_size(suite, run.asked.size)) {
        conditions.extend(Counts::read(&root.counts())?.conditions(info, suite.engines(), records));
    }
    conditions.extend(info.expected.iter().filter(|condition| condition.kind == GateKind::Engine).cloned());
    Ok(conditions)
}

/// Prints what is new, from the gravest, each with its command; what is known is counted.
fn tell(info: &RunInfo, findings: &Findings) {
    say!("{}", findings.verdict());
    for (index, found) in findings.red().take(TOLD).enumerate() {
        say!("  {}. {}: {}", index + 1, found.level(), found.sentence());
        if !found.again.is_empty() {
            say!("     again: {}", found.again);
        }
    }
    let more = findings.red().count().saturating_sub(TOLD);
    if more > 0 {
        say!("  and {more} more; --json, --junit and --markdown have all");
    }
    let met = info.expected.iter().filter(|condition| condition.is_met()).count();
    unmet(info).for_each(|line| say!("{line}"));
    say!("{} among {}; {met} of {} gates met", findings.levels(), findings.extent(), info.expected.len());
}

/// The exit of a run by its findings and conditions.
pub fn conclude(info: &RunInfo, findings: &Findings) -> Result<(), Fail> {
    let unmet = info.expected.iter().filter(|condition| !condition.is_met()).count();
    match (unmet, findings.red().next()) {
        (0, None) => Ok(()),
        (_, first) => {
            let first = first.map_or_else(String::new, |found| format!("; first: {}", found.short()));
            Err(Fail::Gate(format!("{unmet} of {} gates failed{first}", info.expected.len())))
        }
    }
}

/// Prints the counts of a run, or writes them in the place of those of its suite.
fn count(root: &Root, suite: &Suite, info: &RunInfo, rows: &[Row], write: bool) -> Result<(), Fail> {
    let counts = Counts::of(&info.suite, suite.engines(), rows);
    if !write {
        message::text(&counts.to_csv());
        return Ok(());
    }
    let path = root.counts();
    let all = Counts::read(&path)?.with(&info.suite, counts);
    atomic_write(&path, all.to_csv().as_bytes())?;
    say!("written: {}", path.display());
    Ok(())
}
