//! A child process that exchanges messages, with limits of time and memory.

use crate::clock::{Clock, SystemClock, wait};
use crate::memory::Memory;
use crate::message::{Message, MessageError};
use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Limits of an oracle process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Longest wait for one answer.
    pub answer: Duration,
    /// Address space in bytes.
    pub memory: u64,
}

impl Default for Limits {
    /// Two minutes and 8 GiB. The slowest right answer of the default suite takes a few seconds, an import from a cold disk half a minute.
    /// Pinocchio's workspace takes 1.4 GB at 300 dofs; Drake maps 3 GB at its start.
    fn default() -> Self {
        Self { answer: Duration::from_secs(120), memory: 8 << 30 }
    }
}

/// How many lines at the end of standard error are kept for the reason of a failure.
const KEPT_LINES: usize = 6;

/// How long a process that no longer answers may take to exit, and the end of its standard error to arrive. A process that crashes on a
/// busy machine needs some time; without it, it could not be told from one that goes on.
const GRACE: Duration = Duration::from_secs(5);
/// How long a process may take to exit after its input ended: an engine's libraries clean up.
const LEAVE: Duration = Duration::from_secs(10);
/// The interval at which it is checked whether the process has exited.
const LOOK: Duration = Duration::from_millis(5);

/// A running oracle. Dropping it ends the process.
pub struct Process {
    child: Child,
    /// To the thread that writes: so a process that does not read cannot block us.
    requests: Option<Sender<Vec<u8>>>,
    answers: Receiver<Result<Option<Message>, MessageError>>,
    last_lines: Arc<Mutex<VecDeque<String>>>,
    /// Closes when standard error closes.
    errors_closed: Receiver<()>,
    limits: Limits,
    /// The clock that decides whether an answer is late.
    clock: Arc<dyn Clock>,
    alive: bool,
    /// The number of the last request.
    asked: u64,
}

impl Process {
    /// Starts a program: its path or name, and its arguments.
    ///
    /// # Errors
    /// A sentence, when it does not start.
    pub fn start(command: &[OsString], limits: Limits) -> Result<Self, String> {
        Self::start_by(command, limits, Arc::new(SystemClock::default()))
    }

    /// Starts a program; its limits are measured by this clock.
    ///
    /// # Errors
    /// As of [`Process::start`].
    pub fn start_by(command: &[OsString], limits: Limits, clock: Arc<dyn Clock>) -> Result<Self, String> {
        let (program, arguments) = command.split_first().ok_or("no program is named")?;
        // The shell sets the limit of address space and then executes the program.
        let mut child = Command::new("sh")
            .arg("-c")
            .arg("ulimit -v \"$1\" && shift && exec \"$@\"")
            .arg("oracle")
            .arg((limits.memory >> 10).to_string())
            .arg(program)
            .args(arguments)
            .env("PYTHONDONTWRITEBYTECODE", "1")
            // The last lines are kept as the reason: a backtrace would stand in its place.
            .env("RUST_BACKTRACE", "0")
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| format!("cannot start {}: {error}", program.to_string_lossy()))?;
        let (output, errors) = (child.stdout.take().ok_or("no standard output")?, child.stderr.take().ok_or("no standard error")?);
        let mut input = child.stdin.take().ok_or("no standard input")?;
        let (requests, due) = channel::<Vec<u8>>();
        // When writing fails, the process has exited or does not read. Waiting for its answer shows which.
        thread::spawn(move || due.into_iter().try_for_each(|bytes| input.write_all(&bytes).and_then(|()| input.flush())));
        let (sender, answers) = sync_channel(1);
        thread::spawn(move || forward_answers(BufReader::new(output), &sender));
        let last_lines = Arc::new(Mutex::new(VecDeque::new()));
        let kept = Arc::clone(&last_lines);
        let (open, closed) = channel();
        thread::spawn(move || {
            keep_last_lines(BufReader::new(errors), &kept);
            drop(open);
        });
        Ok(Self { child, requests: Some(requests), answers, last_lines, errors_closed: closed, limits, clock, alive: true, asked: 0 })
    }

    /// Sends a request and waits for its answer.
    ///
    /// After an error the process is ended: a late answer must never be taken for the answer to a later question.
    ///
    /// # Errors
    /// A sentence, when no answer comes in time, or one that is not in the protocol. If the process has exited, it says how, with the last
    /// lines of its standard error.
    pub fn ask(&mut self, request: &Message) -> Result<Message, String> {
        let result = self.try_ask(request);
        if result.is_err() {
            self.end();
        }
        result
    }

    fn try_ask(&mut self, request: &Message) -> Result<Message, String> {
        self.asked += 1;
        let mut request = request.clone();
        let id = request.header.entry("id").or_insert_with(|| self.asked.into()).clone();
        let requests = self.requests.as_ref().ok_or("the oracle has ended")?;
        let answer = match self.answers.try_recv() {
            // Otherwise it would be taken for the answer to this question.
            Ok(Ok(Some(_))) => return Err("the oracle's answer is not in the protocol: it came before the question".into()),
            Ok(end) => Ok(end),
            Err(_) => {
                // A broken pipe says less than the exit reason of the process, which is found below.
                let _ = requests.send(request.to_bytes());
                wait(&*self.clock, &self.answers, self.limits.answer)
            }
        };
        match answer {
            Ok(Ok(Some(message))) => match message.header.get("id") {
                Some(answered) if *answered != id => Err(format!("the oracle's answer is to request {answered}, not to {id}")),
                _ => Ok(message),
            },
            Ok(Ok(None)) | Ok(Err(MessageError::Truncated)) | Err(RecvTimeoutError::Disconnected) => Err(self.exit_reason()),
            Ok(Err(error)) => Err(format!("the oracle's answer is not in the protocol: {error}")),
            Err(RecvTimeoutError::Timeout) => Err(format!("no answer within {} s", self.limits.answer.as_secs_f64())),
        }
    }

    /// Ends its input and waits for its exit.
    ///
    /// # Errors
    /// The reason, if it does not exit in time, exits with an error or sends something more.
    pub fn close(mut self) -> Result<(), String> {
        self.requests = None;
        match wait(&*self.clock, &self.answers, LEAVE) {
            Ok(Ok(None)) | Err(RecvTimeoutError::Disconnected) => {}
            Ok(Ok(Some(_))) => return Err("it sent an answer that nobody asked for".into()),
            Ok(Err(error)) => return Err(format!("something stands behind its last answer: {error}")),
            Err(RecvTimeoutError::Timeout) => return Err(format!("it goes on for {} s without input", LEAVE.as_secs())),
        }
        match self.status().as_str() {
            "exit status: 0" => Ok(()),
            status => Err(format!("it ended with {status}")),
        }
    }

    /// Whether the process may be asked again.
    pub fn alive(&self) -> bool {
        self.alive
    }

    /// The memory that it has, while it runs.
    pub fn memory(&self) -> Option<Memory> {
        Memory::of(Some(self.child.id())).filter(|_| self.alive)
    }

    fn exit_reason(&mut self) -> String {
        self.requests = None;
        let status = self.status();
        // Standard error closes when the process exits, unless a child of it keeps it open.
        let _ = wait(&*self.clock, &self.errors_closed, GRACE);
        let lines = self.last_lines.lock().unwrap_or_else(PoisonError::into_inner);
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let limit = self.limits.memory >> 20;
        format!(
            "the oracle exited ({status}; memory limit {limit} MiB): {}",
            if lines.is_empty() { "no message".into() } else { lines.join(" | ") }
        )
    }

    /// How the process exited. A process that closes its standard output and goes on is ended.
    fn status(&mut self) -> String {
        let start = self.clock.now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return status.to_string(),
                Ok(None) if self.clock.now().saturating_sub(start) < GRACE => thread::sleep(LOOK),
                Ok(None) => {
                    self.end();
                    return "it closed its standard output and did not end".into();
                }
                Err(error) => return error.to_string(),
            }
        }
    }

    fn end(&mut self) {
        self.alive = false;
        self.requests = None;
        // An error here means that it has exited already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.end();
    }
}

fn forward_answers(mut output: impl BufRead, answers: &SyncSender<Result<Option<Message>, MessageError>>) {
    loop {
        let message = Message::read(&mut output);
        let last = !matches!(message, Ok(Some(_)));
        if answers.send(message).is_err() || last {
            return;
        }
    }
}

fn keep_last_lines(mut errors: impl BufRead, kept: &Mutex<VecDeque<String>>) {
    let mut line = Vec::new();
    // A line without an end must not fill the memory: it is kept in pieces.
    while errors.by_ref().take(500).read_until(b'\n', &mut line).is_ok_and(|length| length > 0) {
        let text = String::from_utf8_lossy(&line).trim().to_owned();
        line.clear();
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        if !text.is_empty() {
            kept.push_back(text);
        }
        if kept.len() > KEPT_LINES {
            kept.pop_front();
        }
    }
}
