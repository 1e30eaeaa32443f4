//! `featherbench-parquet`: what the command asks of Parquet, as a program of its own.

use featherbench_parquet::{table, write_rows};
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "featherbench-parquet: Parquet for featherbench, which starts this program

  featherbench-parquet rows RUN FOLDER   the rows of a run as Parquet, a folder for each study
  featherbench-parquet table FILE        the table of a Parquet file as CSV";

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let words: Vec<&Path> = arguments.iter().map(Path::new).collect();
    let said = match words[..] {
        [word, run, folder] if word == Path::new("rows") => rows(run, folder),
        [word, file] if word == Path::new("table") => table(file).map_err(|error| error.to_string()),
        _ => Err(USAGE.to_owned()),
    };
    match said.and_then(|text| print(&text).map_err(|error| format!("standard output: {error}"))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            // Its reader may be gone.
            let _ = writeln!(io::stderr(), "error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Writes the rows of a run, and says which files have them.
fn rows(run: &Path, folder: &Path) -> Result<String, String> {
    let (_, rows) = featherbench_results::read_run(run).map_err(|error| error.to_string())?;
    let files = write_rows(folder, &rows).map_err(|error| error.to_string())?;
    let lines = files.iter().map(|file| format!("{}\n", file.display()));
    Ok(lines.chain([format!("{} rows\n", rows.len())]).collect())
}

/// Prints a text. A reader that leaves early is no error.
fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
