//! Convicts a double: our own kernels beside copies of them that waste 0 %, 0.5 % and 5 % of their time, in the paired experiment of the
//! timing study. Run it on a quiet machine: `cargo run --release -p featherbench-registry --example slowed -- [SECONDS]`.
//!
//! Ends with 1 unless, on every quantity whose A/A control says that the machine was quiet, the last is found slower and the others are not.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Evaluation, Gates, Identity, NoAnswer, OutcomeStore, Quantity, Robot};
use featherbench_engines::Featherbench;
use featherbench_results::{ModelOrigin, Row};
use featherbench_robots::{Family, StateBatch};
use featherbench_speed::{Timing, TimingSettings};
use std::ops::Range;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Our kernels, and then some of the time again.
struct Slowed {
    identity: Identity,
    featherbench: Featherbench,
    waste: f64,
}

impl Slowed {
    fn by(waste: f64) -> Self {
        let featherbench = Featherbench::new();
        let identity = Identity { name: format!("slowed by {} %", 100.0 * waste), ..featherbench.identity().clone() };
        Self { identity, featherbench, waste }
    }
}

impl Engine for Slowed {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.featherbench.methods(quantity).into_iter().take(1).collect()
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let inner = self.featherbench.prepare(robot, quantity, method, states)?;
        Ok(Box::new(Wasting { inner, waste: self.waste }))
    }
}

struct Wasting<'a> {
    inner: Box<dyn Evaluation + 'a>,
    waste: f64,
}

impl Evaluation for Wasting<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.inner.run(range)
    }

    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
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

fn kernels(_: &Robot) -> Vec<(Quantity, &'static str)> {
    vec![
        (Quantity::InverseDynamics, "rnea_packed"),
        (Quantity::MassMatrixSparse, "crba"),
        (Quantity::ForwardDynamics, "aba"),
        (Quantity::Momentum, "kinematics_packed"),
    ]
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let seconds = std::env::args().nth(1).map_or(Ok(0.3), |text| text.parse())?;
    let doubles = [0.0, 0.005, 0.05].map(Slowed::by);
    let names: Vec<String> = doubles.iter().map(|double| double.identity.name.clone()).collect();
    let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
    engines.extend(doubles.map(|double| Box::new(double) as Box<dyn Engine>));
    let mut robots = Vec::new();
    for robot in ["chain:n=10,layout=spatial", "humanoid"] {
        robots.push(Robot::new(&Family::parse(robot)?.generate()?, "chain", ModelOrigin::Generated, 1, 1)?);
    }
    let gates = Gates::default();
    let context = Context { robots: &robots, engines: &engines, gates: &gates, seed: 1 };
    let study = Timing {
        settings: TimingSettings {
            states: 1000,
            seconds,
            engines: names.clone(),
            quantities: Vec::new(),
            best_of: Vec::new(),
            derivatives: false,
        },
        kernels,
    };
    let folder = tempfile::tempdir()?;
    let store = OutcomeStore::open(folder.path())?;
    let finished = evaluate(&study, &context, plan(&study, &context, &|_| true), &store, &Silent)?;
    let rows = compare(&study, &context, finished);

    let find = |of: &Row, engine: &str, metric: &str| {
        let same = |row: &&Row| {
            row.engine == engine && row.metric == metric && (&row.robot, &row.quantity, &row.cache) == (&of.robot, &of.quantity, &of.cache)
        };
        rows.iter().find(same).cloned().unwrap_or_default()
    };
    let numbers = |row: &Row| [row.value, row.ci_low, row.ci_high].map(|number| number.unwrap_or(f64::NAN));
    let (mut judged, mut wrong) = (0, 0);
    for control in rows.iter().filter(|row| row.metric == "control") {
        let [value, low, high] = numbers(control);
        let quiet = control.valid && control.value.is_some();
        let said = if quiet { "quiet" } else { "NOISY" };
        print!("{:<16} {:<19} {:<6} A/A {value:.4} [{low:.4}, {high:.4}] {said}", control.robot, control.quantity, control.cache);
        for (name, due) in names.iter().zip([0.0, 0.0, 1.0]) {
            let [ratio, low, high] = numbers(&find(control, name, "ratio"));
            let right = find(control, name, "finding").value == Some(due);
            judged += usize::from(quiet);
            wrong += usize::from(quiet && !right);
            print!("  {name}: {ratio:.4} [{low:.4}, {high:.4}]{}", if right { "" } else { " WRONG" });
        }
        println!();
    }
    println!("{judged} findings on a quiet machine, {wrong} wrong");
    Ok(if wrong == 0 && judged > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
