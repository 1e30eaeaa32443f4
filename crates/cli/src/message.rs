//! What the command says on standard output. A reader that leaves early, as in `| head -1`, is not an error: the rest has no reader, and the
//! exit code stays what was found. Where it cannot be written for another reason, a full disk for example, the command goes on with its files
//! and says so at its end.

use std::io::{ErrorKind, Result, Write, stderr, stdout};
use std::sync::OnceLock;

/// Why something that was said could not be written: the first error.
static LOST: OnceLock<String> = OnceLock::new();

/// Standard output. What cannot be written is dropped.
pub struct Output;

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        or_dropped(stdout().write(bytes), bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        or_dropped(stdout().flush(), ())
    }
}

fn or_dropped<T>(result: Result<T>, done: T) -> Result<T> {
    match result {
        // It is tried again by who writes.
        Err(error) if error.kind() == ErrorKind::Interrupted => Err(error),
        Err(error) => {
            if error.kind() != ErrorKind::BrokenPipe {
                LOST.get_or_init(|| error.to_string());
            }
            Ok(done)
        }
        written => written,
    }
}

/// Why something that was said could not be written, if so.
pub fn lost() -> Option<&'static str> {
    LOST.get().map(String::as_str)
}

/// Prints text.
pub fn text(text: &str) {
    // `Output` keeps what went wrong.
    let _ = Output.write_all(text.as_bytes()).and_then(|()| Output.flush());
}

/// Prints text on standard error. What cannot be written is dropped.
pub fn aside(text: &str) {
    let _ = stderr().write_all(text.as_bytes());
}

/// Prints a line, in the words of `format!`.
macro_rules! say {
    ($($words:tt)*) => { $crate::message::text(&(format!($($words)*) + "\n")) };
}
pub(crate) use say;

/// Prints a line on standard error, in the words of `format!`. What cannot be written is dropped: a note is no reason to stop.
macro_rules! tell {
    ($($words:tt)*) => { $crate::message::aside(&(format!($($words)*) + "\n")) };
}
pub(crate) use tell;
