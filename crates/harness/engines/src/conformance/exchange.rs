//! The messages to an oracle and its answers, and the findings about them.

use super::{Conformance, Remark, Standing};
use crate::request;
use featherbench_bench::Robot;
use featherbench_protocol::{Block, Message, Process};
use serde_json::{Value, json};

/// A connection to an oracle: a process, or what a test uses instead.
pub trait Connection {
    /// Sends a request and waits for its answer.
    ///
    /// # Errors
    /// A sentence, when there is no answer, or it is not a message. The connection cannot be used after that.
    fn ask(&mut self, request: &Message) -> Result<Message, String>;

    /// Ends the oracle's input and waits for its end.
    ///
    /// # Errors
    /// A sentence, when the oracle does not end, ends with an error, or sends something more.
    fn close(self: Box<Self>) -> Result<(), String>;
}

impl Connection for Process {
    fn ask(&mut self, request: &Message) -> Result<Message, String> {
        Self::ask(self, request)
    }

    fn close(self: Box<Self>) -> Result<(), String> {
        Self::close(*self)
    }
}

/// The messages to an oracle. After an error the next question opens another connection.
pub(super) struct Exchange<'a> {
    start: &'a dyn Fn() -> Result<Box<dyn Connection>, String>,
    connection: Option<Box<dyn Connection>>,
    /// Connections that were opened so far. An oracle at a new connection knows nothing of earlier messages.
    pub(super) opened: usize,
    pub(super) conformance: Conformance,
}

impl<'a> Exchange<'a> {
    pub(super) fn new(start: &'a dyn Fn() -> Result<Box<dyn Connection>, String>) -> Self {
        Self { start, connection: None, opened: 0, conformance: Conformance::default() }
    }

    /// Asks. It is an error if there is no answer, or one without a known status or without a reason.
    pub(super) fn ask(&mut self, header: Value, blocks: Vec<Block>) -> Result<Message, String> {
        let mut connection = match self.connection.take() {
            Some(connection) => connection,
            None => {
                self.opened += 1;
                (self.start)()?
            }
        };
        let answer = connection.ask(&Message::new(header, blocks))?;
        self.connection = Some(connection);
        match answer.text("status") {
            "ok" => Ok(answer),
            "unsupported" | "error" if !answer.text("reason").trim().is_empty() => Ok(answer),
            status @ ("unsupported" | "error") => Err(format!("its answer '{status}' gives no `reason`")),
            other => Err(format!("its answer has the status '{other}', which is none of ok, unsupported, error")),
        }
    }

    /// Asks, and notes whether the answer has one of the statuses. Returns the answer if it has.
    pub(super) fn expect(&mut self, what: &str, header: Value, blocks: Vec<Block>, allowed: &[&str]) -> Option<Message> {
        match self.ask(header, blocks) {
            Ok(answer) if allowed.contains(&answer.text("status")) => {
                self.note(Standing::Right, what, "", &[]);
                Some(answer)
            }
            Ok(answer) => {
                let reason = answer.text("reason");
                let said = if reason.is_empty() { String::new() } else { format!(" ({reason})") };
                let found = format!("answered '{}'{said}; due is {}", answer.text("status"), allowed.join(" or "));
                self.note(Standing::Wrong, what, &found, &[]);
                None
            }
            Err(reason) => {
                self.note(Standing::Wrong, what, &reason, advice(&reason));
                None
            }
        }
    }

    /// Notes a finding. It is not noted twice if an earlier one about the same thing was as good.
    pub(super) fn note(&mut self, standing: Standing, what: &str, found: &str, advice: &[&str]) {
        let advice = advice.iter().map(|&line| line.to_owned()).collect();
        let finding = Remark { standing, what: what.to_owned(), found: found.to_owned(), advice };
        if !self.conformance.findings.contains(&finding) {
            self.conformance.findings.push(finding);
        }
    }

    /// Lets the oracle build a robot.
    pub(super) fn prepare(&mut self, robot: &Robot) -> Result<Message, String> {
        self.ask(json!({"op": "prepare", "model": request::description(robot)?}), Vec::new())
    }

    /// Ends the oracle's input.
    pub(super) fn close(&mut self) -> Result<(), String> {
        match self.connection.take() {
            Some(connection) => connection.close(),
            None => (self.start)()?.close(),
        }
    }
}

/// What to do about a connection with an error.
fn advice(reason: &str) -> &'static [&'static str] {
    if reason.contains("not in the protocol") {
        &["standard output carries messages only: print everything else to standard error"]
    } else if reason.contains("no answer within") {
        &["answer every request at once and flush; read the blocks that its header announces, and no more"]
    } else if reason.contains("the oracle exited") {
        &["an oracle never ends because of a request: errors are answers"]
    } else {
        &[]
    }
}
