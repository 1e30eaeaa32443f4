//! Convicts a double: our own kernels beside copies of them that waste 0 %, 0.5 % and 5 % of their time, in the paired experiment of the
//! timing study. Run it on a quiet machine: `cargo run --release -p featherbench-studies --example slowed -- [SECONDS]`.
//!
//! Ends with 1 unless, on every quantity whose A/A control says that the machine was quiet, the last is found slower and the others are not.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Gates, Identity, OutcomeStore, Prepared, Problem, Quantity, Refusal, Subject};
use featherbench_engines::Native;
use featherbench_model::StateBatch;
use featherbench_model::generate::Family;
use featherbench_results::{ModelOrigin, Record};
use featherbench_studies::Timing;
use std::ops::Range;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Our kernels, and then some of the time again.
struct Slowed {
    identity: Identity,
    native: Native,
    waste: f64,
}

impl Slowed {
    fn by(waste: f64) -> Self {
        let native = Native::new();
        let identity = Identity { name: format!("slowed by {} %", 100.0 * waste), ..native.identity().clone() };
        Self { identity, native, waste }
    }
}

impl Subject for Slowed {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.native.methods(quantity).into_iter().take(1).collect()
    }

    fn prepare<'a>(
        &'a self,
        problem: &'a Problem,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Prepared + 'a>, Refusal> {
        let inner = self.native.prepare(problem, quantity, method, states)?;
        Ok(Box::new(Wasting { inner, waste: self.waste }))
    }
}

struct Wasting<'a> {
    inner: Box<dyn Prepared + 'a>,
    waste: f64,
}

impl Prepared for Wasting<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), Refusal> {
        self.inner.run(range)
    }

    fn clock(&mut self, range: Range<usize>) -> Result<Duration, Refusal> {
        let start = Instant::now();
        let end = self.inner.clock(range)?.mul_f64(1.0 + self.waste);
        while start.elapsed() < end {
            std::hint::spin_loop();
        }
        Ok(start.elapsed())
    }

    fn read(&self) -> &[f64] {
        self.inner.read()
    }
}

fn kernels(_: &Problem) -> Vec<(Quantity, &'static str)> {
    vec![
        (Quantity::InverseDynamics, "rnea"),
        (Quantity::MassMatrixSparse, "crba"),
        (Quantity::ForwardDynamics, "aba"),
        (Quantity::Momentum, "kinematics"),
    ]
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let seconds = std::env::args().nth(1).map_or(Ok(0.3), |text| text.parse())?;
    let doubles = [0.0, 0.005, 0.05].map(Slowed::by);
    let peers: Vec<String> = doubles.iter().map(|double| double.identity.name.clone()).collect();
    let mut subjects: Vec<Box<dyn Subject>> = vec![Box::new(Native::new())];
    subjects.extend(doubles.map(|double| Box::new(double) as Box<dyn Subject>));
    let mut problems = Vec::new();
    for robot in ["chain:n=10,layout=spatial", "humanoid"] {
        problems.push(Problem::new(&Family::parse(robot)?.generate()?, "chain", ModelOrigin::Generated, 1, 1)?);
    }
    let gates = Gates::default();
    let context = Context { problems: &problems, subjects: &subjects, gates: &gates, seed: 1 };
    let study = Timing { states: 1000, seconds, kernels, peers: peers.clone() };
    let folder = tempfile::tempdir()?;
    let store = OutcomeStore::open(folder.path())?;
    let finished = evaluate(&study, &context, plan(&study, &context, &|_| true), &store, &Silent)?;
    let rows = compare(&study, &context, finished);

    let value = |of: &Record, engine: &str, metric: &str| {
        let same = |row: &&Record| {
            row.engine == engine && row.metric == metric && (&row.model, &row.quantity, &row.case) == (&of.model, &of.quantity, &of.case)
        };
        rows.iter().find(same).and_then(|row| row.value).unwrap_or(f64::NAN)
    };
    let (mut judged, mut wrong) = (0, 0);
    for control in rows.iter().filter(|row| row.metric == "control") {
        let ends = ["control_low", "control_high"].map(|metric| value(control, "native", metric));
        let quiet = control.reason.is_empty();
        let said = if quiet { "quiet" } else { "VOID " };
        print!(
            "{:<16} {:<19} {:<6} A/A {:.4} [{:.4}, {:.4}] {said}",
            control.model,
            control.quantity,
            control.case,
            value(control, "native", "control"),
            ends[0],
            ends[1]
        );
        for (peer, due) in peers.iter().zip([0.0, 0.0, 1.0]) {
            let [ratio, low, high, finding] = ["ratio", "ratio_low", "ratio_high", "finding"].map(|metric| value(control, peer, metric));
            let right = finding == due;
            judged += usize::from(quiet);
            wrong += usize::from(quiet && !right);
            print!("  {peer}: {ratio:.4} [{low:.4}, {high:.4}]{}", if right { "" } else { " WRONG" });
        }
        println!();
    }
    println!("{judged} findings on a quiet machine, {wrong} wrong");
    Ok(if wrong == 0 && judged > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
