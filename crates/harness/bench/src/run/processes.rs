//! Cells that are evaluated in a new process of the program.
//!
//! Where a process has its code and data changes its times for as long as it lives. So a study may ask for some of its cells in processes of
//! their own ([`Study::process`](crate::Study::process)), one after another. Such a process reads the ids of its cells from standard input, a
//! line each, and writes an entry for each outcome to standard output.

use crate::run::entries::{from_message, to_message};
use crate::run::guarded;
use crate::{Cell, Context, HarnessError, NoAnswer, Outcome, Study};
use featherbench_protocol::Message;
use std::collections::HashMap;
use std::fmt::Debug;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Starts this program again.
pub trait NewProcess: Debug + Sync {
    /// The command whose process evaluates cells of a study as [`answer`] does.
    fn command(&self, study: &str) -> Command;
}

/// Evaluates cells in one new process, and gives each outcome when it comes, with the time that it took. A process that cannot be started or
/// ends before it has evaluated all of them is the outcome of those that are left.
pub(super) fn evaluate(
    command: Command,
    cells: &[&Cell],
    each: &mut dyn FnMut(&Cell, &Outcome, Duration) -> Result<(), HarnessError>,
) -> Result<(), HarnessError> {
    let mut due: HashMap<String, &Cell> = cells.iter().map(|cell| (cell.id(), *cell)).collect();
    let ended = match started(command, cells) {
        Ok(mut child) => {
            let told = heard(&mut child, &mut due, each)?;
            // One that goes on after something that is no entry would wait for a reader.
            let _ = child.kill();
            let status = child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
            told.unwrap_or(status)
        }
        Err(error) => error.to_string(),
    };
    for cell in cells.iter().filter(|cell| due.contains_key(&cell.id())) {
        let reason = format!("the process that was to evaluate it ended before: {ended}");
        each(cell, &Outcome::NoAnswer(NoAnswer::Failed(reason)), Duration::ZERO)?;
    }
    Ok(())
}

fn started(mut command: Command, cells: &[&Cell]) -> io::Result<Child> {
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let ids: String = cells.iter().map(|cell| cell.id() + "\n").collect();
    // A process that has ended already does not read: its outcomes are missing, which is told with its status.
    drop(child.stdin.take().map(|mut ids_in| ids_in.write_all(ids.as_bytes())));
    Ok(child)
}

/// Takes the outcomes that a process writes, until it writes no more; what is wrong with them, if something is.
fn heard(
    child: &mut Child,
    due: &mut HashMap<String, &Cell>,
    each: &mut dyn FnMut(&Cell, &Outcome, Duration) -> Result<(), HarnessError>,
) -> Result<Option<String>, HarnessError> {
    let Some(stdout) = child.stdout.take() else { return Ok(Some("it has no standard output".into())) };
    let mut entries = BufReader::new(stdout);
    loop {
        let start = Instant::now();
        let entry = match Message::read(&mut entries) {
            Ok(Some(entry)) => entry,
            Ok(None) => return Ok(None),
            Err(error) => return Ok(Some(error.to_string())),
        };
        let bytes = entry.to_bytes();
        let (id, outcome) = match from_message(entry, &bytes) {
            Ok(told) => told,
            Err(what) => return Ok(Some(what)),
        };
        match due.remove(&id) {
            Some(cell) => each(cell, &outcome, start.elapsed())?,
            None => return Ok(Some(format!("it evaluated the cell {id}, which it was not asked for"))),
        }
    }
}

/// What such a process does: evaluates the cells of a study whose ids are the lines of `ids`, and writes an entry for each.
///
/// # Errors
/// When `ids` cannot be read, a line is no cell of the study, or an entry cannot be written.
pub fn answer(study: &dyn Study, context: &Context, ids: impl BufRead, mut entries: impl Write) -> Result<(), HarnessError> {
    let io = |source| HarnessError::io(Path::new("a process of the run"), source);
    let cells: HashMap<String, Cell> = study.plan(context).into_iter().map(|cell| (cell.id(), cell)).collect();
    let ids: Vec<String> = ids.lines().collect::<Result<_, _>>().map_err(io)?;
    for id in ids {
        let cell = cells.get(&id).ok_or_else(|| io(io::Error::other(format!("{} has no cell {id}", study.name()))))?;
        let entry = to_message(&id, cell, &guarded(study, context, cell), None);
        entries.write_all(&entry.to_bytes()).and_then(|()| entries.flush()).map_err(io)?;
    }
    Ok(())
}
