//! Our own kernels in a process of their own: the same limits of memory and time as other engines have, and the same count of memory.
//!
//! [`command`] is this same program as `featherbench alone`. It answers one request by [`serve`], on standard input and output.

use crate::oracle::{checked, shaped};
use featherbench_bench::alone::{self, Measured, Question};
use featherbench_bench::{Limits, Memory, NoAnswer, OWN, Quantity, Robot};
use featherbench_kernels::{Featherbench, reads_description};
use featherbench_protocol::{Block, Message, Process};
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::{BufReader, Write, stdin, stdout};
use std::path::Path;

/// The command line of the child process.
pub fn command(program: &Path) -> Vec<OsString> {
    vec![program.into(), "alone".into()]
}

/// Asks a child process to measure our own kernels.
///
/// # Errors
/// [`NoAnswer`], with the reason of the process' end if it ended.
pub fn ask(command: &[OsString], question: &Question) -> Result<Measured, NoAnswer> {
    let mut process = Process::start(command, question.limits).map_err(NoAnswer::Failed)?;
    let Question { robot, quantity, method, threads, seed, seconds, .. } = question;
    let header = json!({
        "op": "measure", "robot": robot, "quantity": quantity.name(), "method": method, "threads": threads, "seed": seed,
        "seconds": seconds,
    });
    let answer = checked(process.ask(&Message::new(header, Vec::new())).map_err(NoAnswer::Failed)?)?;
    let length = |name: &str| answer.block(name).map_or(0, |block| block.data.len());
    let bytes = |key: &str| answer.header.get(key).and_then(Value::as_u64);
    Ok(Measured {
        dofs: answer.header.get("dofs").and_then(Value::as_u64).and_then(|dofs| usize::try_from(dofs).ok()).unwrap_or_default(),
        build: answer.header.get("build").and_then(Value::as_f64).unwrap_or(f64::NAN),
        calls: shaped(&answer, "calls", &[length("calls")])?,
        memory: bytes("peak").zip(bytes("resident")).map(|(peak, resident)| Memory { peak, resident }),
        answer: shaped(&answer, "value", &[length("value")])?,
    })
}

/// Answers one request to measure.
///
/// # Errors
/// A sentence, when the stream fails.
pub fn serve() -> Result<(), String> {
    let Some(request) = Message::read(&mut BufReader::new(stdin())).map_err(|error| error.to_string())? else { return Ok(()) };
    let answer = match question(&request).and_then(|question| measure(&question)) {
        Ok(Measured { dofs, build, calls, memory, answer }) => {
            let mut header = json!({"status": "ok", "dofs": dofs, "build": build});
            if let Some(Memory { peak, resident }) = memory {
                (header["peak"], header["resident"]) = (peak.into(), resident.into());
            }
            let blocks = vec![Block::new("calls", &[calls.len()], &calls), Block::new("value", &[answer.len()], &answer)];
            Message::new(header, blocks)
        }
        Err(NoAnswer::NotOffered(reason)) => Message::new(json!({"status": "unsupported", "reason": reason}), Vec::new()),
        Err(NoAnswer::Failed(reason)) => Message::new(json!({"status": "error", "reason": reason}), Vec::new()),
    };
    let mut output = stdout().lock();
    answer.write(&mut output).and_then(|()| output.flush()).map_err(|error| format!("standard output: {error}"))
}

/// The question of a request.
fn question(request: &Message) -> Result<Question, NoAnswer> {
    let wrong = |key: &str| NoAnswer::Failed(format!("the request has no {key}"));
    Ok(Question {
        engine: OWN.into(),
        robot: request.text("robot").to_owned(),
        quantity: Quantity::parse(request.text("quantity")).ok_or_else(|| wrong("quantity"))?,
        method: request.text("method").to_owned(),
        threads: request
            .header
            .get("threads")
            .and_then(Value::as_u64)
            .and_then(|n| usize::try_from(n).ok())
            .ok_or_else(|| wrong("threads"))?,
        seed: request.header.get("seed").and_then(Value::as_u64).ok_or_else(|| wrong("seed"))?,
        seconds: request.header.get("seconds").and_then(Value::as_f64).ok_or_else(|| wrong("seconds"))?,
        limits: Limits::default(),
    })
}

/// Measures our kernels in this process, inside a pool of as many threads: so the entry into the pool is not part of a call.
fn measure(question: &Question) -> Result<Measured, NoAnswer> {
    let mut robot: Robot = alone::robot(&question.robot, question.seed)?;
    // Algorithms take the model alone. What is resident then is the model, the state and the workspace. Refinement reads the description
    // in extended precision.
    if !reads_description(&question.method) {
        robot.description.bodies = Vec::new();
    }
    let pool = ThreadPoolBuilder::new().num_threads(question.threads).build();
    let pool = pool.map_err(|error| NoAnswer::Failed(format!("{} threads: {error}", question.threads)))?;
    pool.install(|| alone::measure(&Featherbench::new(), &robot, question, || Memory::of(None)))
}
