//! `featherbench export`: the rows of a run for programs that analyse tables.

use crate::args::ExportArgs;
use crate::fail::Fail;
use crate::message::text;
use crate::report::parquet;
use ::featherbench_results::read_run;
use featherbench_bench::HarnessError;

/// Writes the rows of a run as Parquet.
pub fn export(args: &ExportArgs) -> Result<(), Fail> {
    // A run that cannot be read is told before anything is built.
    read_run(&args.folder)?;
    let into = &args.parquet;
    let listed = into.exists().then(|| std::fs::read_dir(into)).transpose().map_err(|source| HarnessError::io(into, source))?;
    if listed.is_some_and(|mut entries| entries.next().is_some()) {
        // Readers take every file below the folder: those of another run would be counted with these.
        return Err(Fail::input(format!("{} is not empty; name a new folder with --parquet", into.display())));
    }
    text(&parquet::rows(&args.folder, into)?);
    Ok(())
}
