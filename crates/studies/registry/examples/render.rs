//! Writes the report of an existing run: `cargo run -p featherbench-registry --example render -- RUN_FOLDER [OUT]`.

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut folders = std::env::args_os().skip(1).map(PathBuf::from);
    let from = folders.next().ok_or("name the folder of the run")?;
    let out = folders.next().unwrap_or_else(|| from.clone());
    let (run, rows) = featherbench_results::read_run(&from)?;
    if out != from {
        featherbench_results::write_run(&out, &run, &rows)?;
    }
    let paths = featherbench_report::write(&run, &rows, &featherbench_registry::sections(&run, &rows), &out)?;
    println!("{} rows: {}", rows.len(), paths.index.display());
    Ok(())
}
