//! Writes an example report with made-up rows: `cargo run -p featherbench-studies --example demo -- FOLDER`.

use std::error::Error;
use std::path::PathBuf;

#[path = "../tests/sections/made_up/mod.rs"]
mod made_up;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).ok_or("name the folder to write to")?;
    let run = made_up::run_info();
    let rows = made_up::rows(&run);
    featherbench_results::write_run(&folder, &run, &rows)?;
    let paths = featherbench_report::write(&run, &rows, &featherbench_studies::sections(&run, &rows), &folder)?;
    println!("{} rows: {}", rows.len(), paths.index.display());
    Ok(())
}
