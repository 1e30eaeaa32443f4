//! Writes an example report with made-up rows: `cargo run -p featherbench-report --example demo -- FOLDER`.

use std::error::Error;
use std::path::PathBuf;

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).ok_or("name the folder to write to")?;
    let run = support::run_info();
    let records = support::records(&run);
    featherbench_results::write_run(&folder, &run, &records)?;
    let paths = featherbench_report::write(&run, &records, &folder)?;
    println!("{} rows: {}", records.len(), paths.index.display());
    Ok(())
}
