//! A conformance test of any oracle: does it keep the protocol of `oracles/PROTOCOL.md`, and do its answers have the right meaning?
//!
//! It asks about small robots with every kind of joint. Something that the oracle does not offer is lacking, which is not a fault.
//! Answers are compared with those of our own kernels, in the measures of [`featherbench_bench::measure`]. So this test is beside
//! the engines and not in `featherbench_protocol`, which knows no quantity.
//! Where they differ, common mistakes of convention are tried as hypotheses, one by one and in pairs. The one that explains every answer is
//! named. An oracle that imports files is asked about the imported robot in the same way, and one that integrates about its steps.

mod answers;
mod contact_steps;
mod contacts;
mod coordinate_change;
mod exchange;
mod files;
mod hypotheses;
mod loops;
mod orders;
mod protocol;
mod residual;
mod robots;
mod rods;
mod scenes;
mod semidefinite;
mod steps;
mod values;

pub use exchange::Connection;

use crate::oracle::hello::Hello;
use answers::Answers;
use exchange::Exchange;
use featherbench_protocol::{Limits, Process};
use std::collections::BTreeMap;
use std::ffi::OsString;
use values::Scene;

/// The result of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// As the protocol says.
    Right,
    /// Not offered, which is no fault.
    Lacks,
    /// Against the protocol, or another answer than featherbench's.
    Wrong,
}

/// One remark about an oracle.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// Its result.
    pub standing: Standing,
    /// What was tested.
    pub what: String,
    /// What was found.
    pub found: String,
    /// What to do about it, line by line.
    pub advice: Vec<String>,
}

/// All findings about an oracle.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Conformance {
    /// The engine's name and version, as it gives them.
    pub engine: String,
    /// The methods that it offers, by quantity.
    pub methods: BTreeMap<String, Vec<String>>,
    /// The ways to step that it offers, if it integrates.
    pub steps: Vec<String>,
    /// The findings, in the order in which they were made.
    pub findings: Vec<Remark>,
}

impl Conformance {
    /// Whether nothing is wrong.
    pub fn conforms(&self) -> bool {
        self.findings.iter().all(|finding| finding.standing != Standing::Wrong)
    }

    /// The findings of one standing.
    pub fn of(&self, standing: Standing) -> impl Iterator<Item = &Remark> {
        self.findings.iter().filter(move |finding| finding.standing == standing)
    }
}

/// Tests a program; `watch` is called with the name of each part of the test.
///
/// # Errors
/// A sentence, when our own robots or files cannot be made. Whatever the program does is a finding.
pub fn check_program(command: &[OsString], limits: Limits, watch: &dyn Fn(&str)) -> Result<Conformance, String> {
    let start = || Process::start(command, limits).map(|process| Box::new(process) as Box<dyn Connection>);
    check(&start, watch)
}

/// Tests the oracle at the connections that `start` opens.
///
/// # Errors
/// A sentence, when our own robots or files cannot be made.
pub fn check(start: &dyn Fn() -> Result<Box<dyn Connection>, String>, watch: &dyn Fn(&str)) -> Result<Conformance, String> {
    let mut exchange = Exchange::new(start);
    watch("hello");
    let Some(hello) = protocol::hello(&mut exchange) else { return Ok(exchange.conformance) };
    let scenes: Vec<Scene> = robots::all()?.into_iter().map(|(shows, robot)| Scene::new(shows, robot, hello.rounding())).collect();
    watch("what has no answer");
    protocol::before_prepare(&mut exchange);
    // A solver of problems, or a residual, need not have quantities.
    if !hello.methods.is_empty() || !hello.solves_problems() {
        robots_of(&mut exchange, &scenes, &hello, watch)?;
    } else {
        exchange.note(
            Standing::Lacks,
            "robots",
            "optional for an oracle that solves problems or has a residual: it offers no quantity",
            &[],
        );
    }
    if let Some(offered) = hello.residual {
        watch("residual");
        residual::ask(&mut exchange, &scenes, offered);
    }
    watch("problems");
    contacts::ask(&mut exchange, &hello.contact_solvers, contacts::Law::Coulomb);
    contacts::ask(&mut exchange, &hello.contact_relaxations, contacts::Law::Relaxed);
    contact_steps::ask(&mut exchange, &hello.contact_steps());
    semidefinite::ask(&mut exchange, &hello.semidefinite_least_squares);
    if let Some(offered) = &hello.loops {
        watch("loops");
        loops::ask(&mut exchange, offered);
    }
    watch("rods");
    rods::ask(&mut exchange, &hello.rods);
    watch("scenes");
    scenes::ask(&mut exchange, &hello.scenes());
    watch("the end");
    protocol::end(&mut exchange);
    Ok(exchange.conformance)
}

/// What is asked about robots and files.
fn robots_of(exchange: &mut Exchange, scenes: &[Scene], hello: &Hello, watch: &dyn Fn(&str)) -> Result<(), String> {
    let (offered, extra) = (&hello.methods, hello.steps.clone().unwrap_or_default());
    // An oracle that only reads or writes files builds nothing.
    let built = if offered.is_empty() { None } else { protocol::first_built(exchange, scenes) };
    if let Some(scene) = built {
        protocol::with_robot(exchange, scene, offered);
    }
    let (mut answers, mut stepped) = (Answers::default(), steps::Found::default());
    for (index, scene) in scenes.iter().enumerate() {
        watch(scene.shows);
        if answers::ask(exchange, index, scene, offered, &mut answers) {
            steps::ask(exchange, scene, &extra, &mut stepped);
        }
    }
    watch("conventions");
    answers.judge(exchange, scenes, "");
    steps::judge(exchange, &extra, &stepped);
    answers::lacking(exchange, offered);
    watch("files");
    files::read(exchange, offered, hello.rounding())
}
