//! Rapier3d in double precision as an oracle: its reduced-coordinate multibodies, and its free bodies in contact. It speaks `../../PROTOCOL.md` on
//! standard input and output.

mod coordinates;
mod refusal;
mod robot;
mod scenes;
mod session;
mod world;

use featherbench_protocol::Message;
use refusal::{Refusal, failed};
use serde_json::json;
use session::Session;
use std::any::Any;
use std::io::{BufRead, Write, stdin, stdout};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

fn main() -> ExitCode {
    match converse(&mut stdin().lock(), &mut stdout().lock()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

/// Answers requests until the input ends, or is not a message: after a message that cannot be read, the beginning of the next is unknown.
fn converse(input: &mut impl BufRead, output: &mut impl Write) -> Result<(), String> {
    let mut session = Session::default();
    loop {
        let request = match Message::read(input) {
            Ok(Some(request)) => request,
            Ok(None) => return Ok(()),
            Err(error) => {
                answered(Err(failed(&error))).write(output).map_err(|error| error.to_string())?;
                return Err(error.to_string());
            }
        };
        // Rapier panics if it has no answer. A `prepare` or `states` that panicked leaves nothing.
        let result = catch_unwind(AssertUnwindSafe(|| session.answer(&request)));
        let mut answer = answered(result.unwrap_or_else(|panic| Err(failed(format!("rapier panicked: {}", words(&*panic))))));
        if let Some(id) = request.header.get("id") {
            answer.header.insert("id".into(), id.clone());
        }
        answer.write(output).map_err(|error| error.to_string())?;
    }
}

/// An answer with its status.
fn answered(result: Result<Message, Refusal>) -> Message {
    match result {
        Ok(mut message) => {
            message.header.insert("status".into(), "ok".into());
            message
        }
        Err(refusal) => {
            let (status, reason) = refusal.told();
            Message::new(json!({"status": status, "reason": reason}), Vec::new())
        }
    }
}

/// The message of a panic.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a word")
}
