//! `featherbench export`: the rows of a run for programs that analyse tables.

use crate::args::ExportArgs;
use crate::fail::Fail;
use crate::say::say;
use ::featherbench_results::{read_run, write_parquet};
use featherbench_bench::HarnessError;

/// Writes the rows of a run as Parquet.
pub fn export(args: &ExportArgs) -> Result<(), Fail> {
    let (_, rows) = read_run(&args.folder)?;
    let into = &args.parquet;
    let listed = into.exists().then(|| std::fs::read_dir(into)).transpose().map_err(|source| HarnessError::io(into, source))?;
    if listed.is_some_and(|mut entries| entries.next().is_some()) {
        // Readers take every file below the folder: those of another run would be counted with these.
        return Err(Fail::input(format!("{} is not empty; name a new folder with --parquet", into.display())));
    }
    for file in write_parquet(into, &rows)? {
        say!("{}", file.display());
    }
    say!("{} rows", rows.len());
    Ok(())
}
