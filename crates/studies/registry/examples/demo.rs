//! Writes an example report with made-up rows, of the given number or a little more, and prints what that took:
//! `cargo run --release -p featherbench-registry --example demo -- FOLDER [ROWS]`.
//!
//! It fails when a report of up to 50 000 rows takes longer, more memory or more room than a report may.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

#[path = "../tests/sections/made_up/mod.rs"]
mod made_up;

/// Rows up to which the limits hold.
const ROWS: usize = 50_000;
/// The most seconds, MiB of memory, MiB of files without rows, and nodes of the first page.
const MOST: [f64; 4] = [5.0, 500.0, 15.0, 3000.0];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = arguments.next().map(PathBuf::from).ok_or("name the folder to write to")?;
    let count = arguments.next().map(|text| text.to_string_lossy().parse::<usize>()).transpose()?.unwrap_or(1);
    let (run, rows) = made_up::large(count);
    featherbench_results::write_run(&folder, &run, &rows)?;
    let (start, before) = (Instant::now(), peak());
    let paths = featherbench_report::write(&run, &rows, &featherbench_registry::sections(&run, &rows), &folder)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut sizes = [0.0, 0.0];
    for path in &paths.files {
        let holds_rows = path.file_name().is_some_and(|name| made_up::holds_rows(&name.to_string_lossy()));
        sizes[usize::from(holds_rows)] += std::fs::metadata(path)?.len() as f64 / f64::from(1 << 20);
    }
    let nodes = made_up::nodes(&std::fs::read_to_string(&paths.index)?) as f64;
    let found = [seconds, peak(), sizes[0], nodes];
    println!("{} rows: {}", rows.len(), paths.index.display());
    println!(
        "{seconds:.2} s, peak {:.0} MiB ({before:.0} MiB before), {:.1} MiB and {:.1} MiB of rows, {nodes} nodes on the first page",
        found[1], sizes[0], sizes[1]
    );
    let names = ["seconds", "MiB of memory", "MiB of files", "nodes"];
    let over: Vec<&str> =
        names.into_iter().zip(found.iter().zip(MOST)).filter(|(_, (found, most))| *found > most).map(|(name, _)| name).collect();
    // Of a larger run, nothing is promised.
    if count <= ROWS && !over.is_empty() { Err(format!("too many {}", over.join(", ")).into()) } else { Ok(()) }
}

/// The most memory that this process has had, in MiB.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()).map_or(0.0, |kilobytes| kilobytes / 1024.0)
}
