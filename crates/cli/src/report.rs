//! `featherbench report` and `featherbench gate`: reading a run again.

use crate::args::GateArgs;
use crate::fail::Fail;
use crate::ranges;
use crate::root::Root;
use crate::say::{self, say};
use ::featherbench_results::{Properties, RobotInfo, Row, RunInfo, Verdict};
use featherbench_bench::{Counts, Suite, provenance};
use std::path::{Path, PathBuf};

/// Writes the report of a finished run again.
pub fn write(folder: &Path) -> Result<(), Fail> {
    let (info, records) = ::featherbench_results::read_run(folder)?;
    let page = render(folder, &info, &records)?;
    say!("report: {}", page.display());
    Ok(())
}

/// Renders the report into the run's folder and returns its page.
pub fn render(folder: &Path, info: &RunInfo, records: &[Row]) -> Result<PathBuf, Fail> {
    let paths = featherbench_report::write(info, records, &featherbench_studies::sections(info, records), folder)
        .map_err(|error| Fail::input(error.to_string()))?;
    Ok(paths.index)
}

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
    let externals = info.engines.iter().filter(|engine| engine.build.contains_key(provenance::PROGRAM)).map(|engine| engine.name.as_str());
    let gates = root.read_gates()?.with_external(&externals.collect::<Vec<_>>()).with_robots(properties(&args.folder, &info)?)?;
    let missing: Vec<_> = info.expected.iter().filter(|condition| condition.what.starts_with("engine ")).cloned().collect();
    info.expected = gates.conditions(&suite, &records, true);
    info.expected.extend(Counts::read(&root.counts())?.conditions(&info, suite.engines(), &records));
    info.expected.extend(missing);
    conclude(&info, &records, &args.folder.join("index.html"))
}

/// The properties of a run's robots, which known deviations are told by.
pub fn properties(folder: &Path, info: &RunInfo) -> Result<Vec<(String, Properties)>, Fail> {
    let message =
        || format!("{}: run.json has no properties of its robots: another version wrote it; run the suite again", folder.display());
    info.robots.iter().map(RobotInfo::known_properties).collect::<Option<_>>().ok_or_else(|| Fail::input(message()))
}

/// Prints the counts of a run, or writes them in the place of those of its suite.
fn count(root: &Root, suite: &Suite, info: &RunInfo, rows: &[Row], write: bool) -> Result<(), Fail> {
    let counts = Counts::of(&info.suite, suite.engines(), rows);
    if !write {
        say::text(&counts.to_csv());
        return Ok(());
    }
    let path = root.counts();
    let all = Counts::read(&path)?.with(&info.suite, counts);
    ::featherbench_results::atomic_write(&path, all.to_csv().as_bytes())?;
    say!("written: {}", path.display());
    Ok(())
}

/// Prints the verdict, and the report's page last.
pub fn conclude(info: &RunInfo, records: &[Row], page: &Path) -> Result<(), Fail> {
    let count = |verdict: Verdict| records.iter().filter(|row| row.verdict == verdict).count();
    let counts: Vec<String> = Verdict::ALL.iter().map(|&verdict| format!("{} {verdict}", count(verdict))).collect();
    say!("{} rows: {}", records.len(), counts.join(", "));
    for row in records.iter().filter(|row| matches!(row.verdict, Verdict::Fail | Verdict::Error)).take(20) {
        say!(
            "  {}: {} {} {} {} {} [{}]: {}",
            row.verdict,
            row.robot,
            row.engine,
            row.quantity,
            row.method,
            row.metric,
            [row.body.as_str(), &row.states, &row.cache].concat(),
            row.reason
        );
    }
    let broken: Vec<_> = info.expected.iter().filter(|condition| condition.verdict != Verdict::Pass).collect();
    for condition in &broken {
        say!("  gate: {}: {}", condition.what, condition.reason);
    }
    let sections = featherbench_studies::sections(info, records);
    featherbench_report::summary(info, records, &sections).iter().for_each(|line| say!("{line}"));
    say!("report: {}", page.display());
    if broken.is_empty() {
        return Ok(());
    }
    Err(Fail::Gate(format!("{} of {} gates failed", broken.len(), info.expected.len())))
}
