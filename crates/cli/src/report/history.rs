//! `featherbench history`: a page over a folder of runs, and the times of our kernels, night after night, one file per machine.

use crate::args::HistoryArgs;
use crate::fail::Fail;
use crate::message::{say, tell};
use crate::report::instructions;
use crate::root::Root;
use ::featherbench_results::{CHECKSUMS_NAME, CSV_NAME, Host, RUN_NAME, Row, RunInfo, atomic_write, read_run};
use featherbench_report::runs::{self, Past};
use featherbench_speed::InstructionCounts;
use std::path::Path;

/// The header of a history file.
const HEADER: &str = "date,revision,kernel,model,ns,ns_low,ns_high,instructions";
/// A history is cut to this many bytes, the oldest nights first: the data of this repository are small.
const LIMIT: usize = 24_000;

/// Writes a page over the runs of a folder, or appends the times of one run to the history of its machine.
pub fn history(root: &dyn Fn() -> Result<Root, Fail>, args: &HistoryArgs) -> Result<(), Fail> {
    if [RUN_NAME, CHECKSUMS_NAME].iter().any(|name| args.folder.join(name).is_file()) || !args.folder.is_dir() {
        return append(root, args);
    }
    let mut runs = Vec::new();
    for entry in std::fs::read_dir(&args.folder).map_err(|error| failed(&args.folder, &error))? {
        let path = entry.map_err(|error| failed(&args.folder, &error))?.path();
        // A run that has not ended has no checksums yet.
        if [CSV_NAME, RUN_NAME].iter().any(|name| path.join(name).is_file()) && !path.join(CHECKSUMS_NAME).is_file() {
            tell!(
                "note: {}: the run is left out: it has no {CHECKSUMS_NAME}, so it did not finish, or an older version wrote it",
                path.display()
            );
        } else if path.join(CHECKSUMS_NAME).is_file() {
            let (info, rows) = read_run(&path)?;
            runs.push(Past { folder: path.file_name().unwrap_or_default().to_string_lossy().into_owned(), info, rows });
        }
    }
    if runs.is_empty() {
        return Err(failed(&args.folder, &"it is no run, and no folder in it is one"));
    }
    let (page, number) = (args.folder.join("index.html"), runs.len());
    atomic_write(&page, runs::render(runs).as_bytes())?;
    say!("history of {number} runs: {}", page.display());
    Ok(())
}

/// Appends a run's times of our kernels on one robot to the history of its machine. It is in the folder that is named, or else in
/// `reports/history` of the project. Only then the project must be found.
fn append(root: &dyn Fn() -> Result<Root, Fail>, args: &HistoryArgs) -> Result<(), Fail> {
    let (run, records) = read_run(&args.folder)?;
    let counts = args.instructions.as_deref().map(instructions::read).transpose()?.unwrap_or_default();
    let (lines, invalid) = lines(&run, &records, &args.model, &counts);
    if lines.is_empty() {
        let message = format!("{} holds no valid times of own kernels on '{}' ({invalid} do not count)", args.folder.display(), args.model);
        return Err(Fail::input(message));
    }
    let folder = args.to.clone().map_or_else(|| root().map(|root| root.reports().join("history")), Ok)?;
    let path = folder.join(format!("{}.csv", machine(&run.host)));
    let before = if path.exists() { std::fs::read_to_string(&path).map_err(|error| failed(&path, &error))? } else { String::new() };
    let text = merged(&before, &lines).map_err(|what| failed(&path, &what))?;
    atomic_write(&path, text.as_bytes())?;
    say!(
        "{} kernels in {}{}",
        lines.len(),
        path.display(),
        if invalid > 0 { format!("; {invalid} times that do not count left out") } else { String::new() }
    );
    Ok(())
}

/// A short name of a machine that is the same every night: its processor, its cores, and a hash of both.
fn machine(host: &Host) -> String {
    let words: String = host.cpu.to_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { ' ' }).collect();
    let words: Vec<&str> = words.split_whitespace().take(4).collect();
    let hash = featherbench_bench::hash::of(format!("{}/{}", host.cpu, host.cores).as_bytes());
    let mut parts: Vec<String> = words.into_iter().map(str::to_owned).collect();
    parts.extend([host.cores.to_string(), hash[..6].to_owned()]);
    parts.join("-")
}

/// One line per kernel over the stream, and how many times do not count.
fn lines(run: &RunInfo, records: &[Row], model: &str, counts: &InstructionCounts) -> (Vec<String>, usize) {
    let featherbench =
        |row: &&Row| row.study == "timing" && row.engine == featherbench_bench::OWN && row.cache == "stream" && row.robot == model;
    let rows: Vec<&Row> = records.iter().filter(featherbench).collect();
    let (mut lines, mut invalid) = (Vec::new(), 0);
    for row in rows.iter().filter(|row| row.metric == "ns_per_call") {
        let Some(ns) = row.value else { continue };
        if !row.valid {
            invalid += 1;
            continue;
        }
        let (low, high) = (row.ci_low.unwrap_or(ns), row.ci_high.unwrap_or(ns));
        let kernel = format!("{}/{}", row.quantity, row.method);
        let count = counts.get(&(kernel.clone(), model.to_owned())).map_or_else(String::new, u64::to_string);
        let date: String = run.started.chars().take(10).collect();
        let revision: String = run.git.revision.chars().take(10).collect();
        lines.push(format!("{date},{revision},{kernel},{model},{ns:.1},{low:.1},{high:.1},{count}"));
    }
    (lines, invalid)
}

/// The history with a night's lines: a line of the same date, revision, kernel and model is replaced; the oldest nights make room.
fn merged(before: &str, lines: &[String]) -> Result<String, String> {
    let key = |line: &str| line.split(',').take(4).map(str::to_owned).collect::<Vec<_>>();
    let mut old = before.lines();
    if !before.is_empty() && old.next() != Some(HEADER) {
        return Err(format!("line 1 is not '{HEADER}'; move the file away to begin a new history"));
    }
    let fresh: Vec<Vec<String>> = lines.iter().map(|line| key(line)).collect();
    let mut kept: Vec<&str> = old.filter(|line| !fresh.contains(&key(line))).chain(lines.iter().map(String::as_str)).collect();
    // Dates sort as text; the order within a night stays.
    kept.sort_by_key(|line| line.split(',').next().unwrap_or_default().to_owned());
    let size = |kept: &[&str]| HEADER.len() + 1 + kept.iter().map(|line| line.len() + 1).sum::<usize>();
    while size(&kept) > LIMIT && kept.len() > lines.len() {
        let oldest = kept[0].split(',').next().unwrap_or_default().to_owned();
        kept.retain(|line| !line.starts_with(&oldest));
    }
    Ok(format!("{HEADER}\n{}\n", kept.join("\n")))
}

fn failed(path: &Path, what: &dyn std::fmt::Display) -> Fail {
    Fail::input(format!("{}: {what}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn night(date: &str, kernels: usize) -> Vec<String> {
        (0..kernels).map(|kernel| format!("{date},abcdef0123,kernel{kernel}/x,humanoid,100.0,99.0,101.0,5000")).collect()
    }

    #[test]
    fn nights_are_added_replaced_and_the_oldest_make_room() {
        let one = merged("", &night("2026-01-02", 2)).unwrap();
        assert_eq!(one.lines().count(), 3);
        assert_eq!(merged(&one, &night("2026-01-02", 2)).unwrap(), one, "the same night again");
        let two = merged(&one, &night("2026-01-01", 2)).unwrap();
        assert!(two.lines().nth(1).unwrap().starts_with("2026-01-01"), "sorted by date");
        assert!(merged("date;kernel\n", &night("2026-01-02", 1)).unwrap_err().contains("line 1"));
        let mut text = String::new();
        for day in 0..60 {
            text = merged(&text, &night(&format!("2026-02-{day:02}"), 20)).unwrap();
            assert!(text.len() <= LIMIT && text.starts_with(HEADER) && text.contains(&format!("2026-02-{day:02}")));
        }
        assert!(!text.contains("2026-02-00") && text.contains("2026-02-58"));
    }

    #[test]
    fn a_machine_has_one_name() {
        let host = |cpu: &str, cores| Host { cpu: cpu.into(), cores, ..Host::default() };
        let name = machine(&host("AMD EPYC 9B45, 2.6 GHz", 2));
        assert!(name.starts_with("amd-epyc-9b45-2-2-"), "{name}");
        assert_eq!(name, machine(&host("AMD EPYC 9B45, 2.6 GHz", 2)));
        assert_ne!(name, machine(&host("AMD EPYC 9B45, 2.6 GHz", 4)));
        assert!(machine(&Host::default()).len() >= 6);
    }
}
