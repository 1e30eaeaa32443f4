//! `featherbench oracles check`: the conformance test of a program that answers as an engine.

use crate::args::CheckArgs;
use crate::fail::Fail;
use crate::message;
use crate::oracles::external;
use crate::oracles::package;
use crate::root::Root;
use featherbench_engines::Limits;
use featherbench_engines::conformance::{Conformance, Remark, Standing, check_program};
use std::io::IsTerminal;
use std::time::Duration;

/// Tests the program and prints what was found. In a project the program may import the package of its oracles.
pub fn check(root: Option<&Root>, args: &CheckArgs) -> Result<(), Fail> {
    external::find(&args.command)?;
    let command = root.map_or_else(|| Ok(args.command.clone()), |root| package::reachable(root, &args.command)).map_err(Fail::input)?;
    let limits = Limits { answer: Duration::from_secs(args.timeout), memory: args.memory << 20 };
    let terminal = std::io::stderr().is_terminal();
    let watch = |what: &str| {
        if terminal {
            message::aside(&format!("\r\x1b[2K{what} …"));
        }
    };
    let conformance = check_program(&command, limits, &watch).map_err(Fail::Input)?;
    if terminal {
        message::aside("\r\x1b[2K");
    }
    message::text(&text(&conformance, args.all));
    let wrong = conformance.of(Standing::Wrong).count();
    if wrong == 0 {
        return Ok(());
    }
    Err(Fail::Gate(format!("{wrong} of {} findings are wrong; oracles/PROTOCOL.md says what is due", conformance.findings.len())))
}

/// The table: what is right in short or in full, what is lacking, what is wrong and what to do about it.
fn text(conformance: &Conformance, all: bool) -> String {
    let mut text = format!("engine  {}\n", if conformance.engine.is_empty() { "unknown" } else { &conformance.engine });
    for (quantity, methods) in &conformance.methods {
        text += &format!("offers  {quantity} by {}\n", methods.join(", "));
    }
    if !conformance.steps.is_empty() {
        text += &format!("offers  steps by {}\n", conformance.steps.join(", "));
    }
    let sections = [("right", Standing::Right), ("lacks", Standing::Lacks), ("wrong", Standing::Wrong)];
    for (title, standing) in sections {
        let findings: Vec<&Remark> = conformance.of(standing).collect();
        let shown = all || standing != Standing::Right;
        text += &format!("\n{title}   {}\n", findings.len());
        // What is right says little, but for the errors of values.
        for finding in findings.into_iter().filter(|finding| shown || !finding.found.is_empty()) {
            let colon = if finding.found.is_empty() { "" } else { ": " };
            text += &format!("  {}{colon}{}\n", finding.what, finding.found);
            text.extend(finding.advice.iter().map(|line| format!("      {line}\n")));
        }
    }
    let verdict = if conformance.conforms() { "conforms: `featherbench run --engine NAME=PROGRAM` takes it" } else { "does not conform" };
    text + &format!("\n{verdict}\n")
}
