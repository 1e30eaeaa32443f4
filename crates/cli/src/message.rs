//! What the command says on standard output. A reader that leaves early, as in `| head -1`, is not an error: the rest has no reader, and the
//! exit code stays what was found.

use std::io::{ErrorKind, Result, Write, stdout};

/// Standard output. What is written after its reader left is dropped.
pub struct Output;

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        unless_closed(stdout().write(bytes), bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        unless_closed(stdout().flush(), ())
    }
}

fn unless_closed<T>(result: Result<T>, done: T) -> Result<T> {
    match result {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(done),
        other => other,
    }
}

/// Prints text.
///
/// # Panics
/// Where standard output cannot be written for another reason, a full disk for example.
pub fn text(text: &str) {
    Output.write_all(text.as_bytes()).and_then(|()| Output.flush()).unwrap_or_else(|error| panic!("standard output: {error}"));
}

/// Prints a line, in the words of `format!`.
macro_rules! say {
    ($($words:tt)*) => { $crate::message::text(&(format!($($words)*) + "\n")) };
}
pub(crate) use say;
