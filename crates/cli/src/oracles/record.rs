//! `featherbench record`: asks the engines and keeps, or checks, their answers.

use crate::args::RecordArgs;
use crate::fail::Fail;
use crate::message::say;
use crate::oracles;
use crate::oracles::engines::{self, Asked};
use crate::progress::Bar;
use crate::robots;
use crate::root::Root;
use ::featherbench_results::Verdict;
use featherbench_bench::measure::{ForwardScale, scaled_error, worst};
use featherbench_bench::run::Progress;
use featherbench_bench::{Cell, Context, Gates, Outcome, OutcomeStore, Quantity, Robot, SLACK, Study};
use featherbench_comparison::{Agreement, Repeatability};
use featherbench_engines::{EngineRecording, Limits, Recording, recording_name};
use featherbench_speed::OperationCounts;
use std::path::Path;

/// An answer may move by this much, unit-free, before the recording counts as stale: the same binary on the same processor.
const STALE: f64 = 8.0 * f64::EPSILON;
/// The same on another processor, which has other vector kernels: the gate of an answer (`ci/gates.toml`). Where an engine is known to lose
/// more, it may move by the known size of its error, as each of the two answers has one.
const STALE_ELSEWHERE: f64 = 1e-14;
/// The file beside the recordings that names the processor on which they were made.
const PROCESSOR: &str = "processor.txt";

/// The processor here: its model and its vector units.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field =
        |name: &str| text.lines().find(|line| line.starts_with(name)).and_then(|line| line.split_once(':')).map_or("", |(_, value)| value);
    let vector = field("flags").split_whitespace().filter(|flag| flag.starts_with("avx") || *flag == "fma");
    format!("{}\n{}\n", field("model name").trim(), vector.collect::<Vec<_>>().join(" "))
}

/// Records, or checks the recordings of, a suite.
pub fn record(root: &Root, args: &RecordArgs) -> Result<(), Fail> {
    let loaded = robots::load(root, &args.suite, false, None, None)?;
    let gates = root.read_gates()?;
    let engines = loaded.suite.engines();
    let opened = engines::open(root, &Asked::live(root, engines, Limits::default()))?;
    if let Some(missing) = opened.missing(engines).first() {
        let message = format!("{} does not answer: {}", missing.name, missing.reason);
        return Err(Fail::Missing { message, advice: "look at `featherbench oracles status`".into() });
    }
    let context = Context { robots: &loaded.robots, engines: &opened.engines, gates: &gates, seed: loaded.suite.seed };
    let scratch = root.engines().join(format!("record-{}", std::process::id()));
    let io = |source| Fail::from(featherbench_bench::HarnessError::io(&scratch, source));
    std::fs::create_dir_all(&scratch).map_err(io)?;
    let store = OutcomeStore::open(&scratch)?;
    let bar = Bar::new();
    let mut finished = Vec::new();
    let described = oracles::described(root)?;
    let recorded = described.names(|engine| engine.recorded);
    let recorded = |cell: &Cell| recorded.contains(&cell.engine.as_str());
    let studies: [&dyn Study; 2] = [&Agreement, &OperationCounts];
    for study in studies {
        let cells = featherbench_bench::run::plan(study, &context, &recorded);
        finished.extend(featherbench_bench::run::evaluate(study, &context, cells, &store, &bar as &dyn Progress)?);
    }
    // What is recorded is never asked again in a run: an engine whose answers vary is found here.
    let repeatability = Repeatability { key: featherbench_bench::provenance::collect(root.path()).binary_hash };
    let again = featherbench_bench::run::evaluate(
        &repeatability,
        &context,
        featherbench_bench::run::plan(&repeatability, &context, &recorded),
        &store,
        &bar as &dyn Progress,
    )?;
    let rows = featherbench_bench::run::compare(&repeatability, &context, again);
    std::fs::remove_dir_all(&scratch).map_err(io)?;
    let varying: Vec<String> = rows
        .iter()
        .filter(|row| row.verdict != Verdict::Pass)
        .map(|row| format!("  {} about {}: {}", row.engine, row.robot, row.reason))
        .collect();
    if !varying.is_empty() {
        return Err(Fail::Gate(format!("nothing was recorded: the same question has two answers:\n{}", varying.join("\n"))));
    }

    let folder = args.recorded.clone().unwrap_or_else(|| root.recorded());
    std::fs::create_dir_all(&folder).map_err(|source| featherbench_bench::HarnessError::io(&folder, source))?;
    let there = std::fs::read_to_string(folder.join(PROCESSOR)).unwrap_or_default();
    let bounds = Bounds { here: there == processor(), gates: &gates };
    if !args.check {
        ::featherbench_results::atomic_write(&folder.join(PROCESSOR), processor().as_bytes())?;
    }
    let mut stale = Vec::new();
    for robot in &loaded.robots {
        let engines = opened.engines[1..].iter().map(|engine| {
            let identity = engine.identity().clone();
            let of_this = finished.iter().filter(|(cell, _)| cell.engine == identity.name && cell.robot == robot.name);
            let outcomes =
                of_this.filter_map(|(cell, outcome)| Some((Quantity::parse(&cell.quantity)?, cell.method.clone(), outcome.clone())));
            EngineRecording { outcomes: outcomes.collect(), identity }
        });
        let recording = Recording { engines: engines.filter(|engine| !engine.outcomes.is_empty()).collect() };
        let path = folder.join(recording_name(&robot.name));
        if recording.engines.is_empty() {
            continue;
        }
        if args.check {
            stale.extend(check(&path, &recording, robot, &bounds));
        } else {
            ::featherbench_results::atomic_write(&path, &recording.to_bytes(robot))?;
        }
    }
    if !stale.is_empty() {
        let shown: Vec<_> = stale.iter().take(20).map(|line| format!("  {line}")).collect();
        let message = format!("{} recorded answers do not match their engines:\n{}", stale.len(), shown.join("\n"));
        return Err(Fail::Gate(message));
    }
    say!("{} {}", if args.check { "the engines answer as recorded in" } else { "recorded in" }, folder.display());
    Ok(())
}

/// How far answers may move.
struct Bounds<'a> {
    /// Whether they were recorded on this processor.
    here: bool,
    gates: &'a Gates,
}

impl Bounds<'_> {
    fn of(&self, engine: &str, quantity: Quantity, method: &str, robot: &Robot) -> f64 {
        if self.here {
            return STALE;
        }
        let known = self.gates.ranges().iter().filter(|(key, _)| {
            (key.engine.as_str(), key.quantity.as_str(), key.method.as_str(), &key.robot) == (engine, quantity.name(), method, &robot.name)
        });
        known.map(|(_, range)| SLACK * range.high).fold(STALE_ELSEWHERE, worst)
    }
}

/// What in a recording differs from what the engines answer now.
fn check(path: &Path, now: &Recording, robot: &Robot, bounds: &Bounds) -> Vec<String> {
    let then = match Recording::read(path, robot) {
        Ok(then) => then,
        Err(error) => return vec![error.to_string()],
    };
    let mut stale = Vec::new();
    let mut complain = |what: String| stale.push(format!("{}: {what}", path.display()));
    if then.engines.len() != now.engines.len() {
        complain(format!("{} engines are recorded, {} answer", then.engines.len(), now.engines.len()));
    }
    let at = robot.magnitudes();
    let forward = ForwardScale::all(robot, &at);
    for (then, now) in then.engines.iter().zip(&now.engines) {
        let name = &now.identity.name;
        if (&then.identity.name, &then.identity.version) != (name, &now.identity.version) {
            complain(format!("recorded from {} {}, asked {name} {}", then.identity.name, then.identity.version, now.identity.version));
        }
        if then.outcomes.len() != now.outcomes.len() {
            complain(format!("{name}: {} outcomes are recorded, {} are answered", then.outcomes.len(), now.outcomes.len()));
        }
        for ((quantity, method, recorded), (_, _, answered)) in then.outcomes.iter().zip(&now.outcomes) {
            let label = format!("{name}: {} by {method}", quantity.name());
            match (recorded, answered) {
                (Outcome::Values(recorded), Outcome::Values(answered)) => {
                    let size = quantity.size(robot);
                    let states = recorded.chunks_exact(size).zip(answered.chunks_exact(size)).enumerate();
                    let error = states.fold(0.0, |error, (k, (old, new))| {
                        let moved = match quantity {
                            // How far a backward error of 8 ε may carry the answer.
                            Quantity::ForwardDynamics => forward[k].forward_error(old, new) / forward[k].amplification.max(1.0),
                            _ => scaled_error(robot, *quantity, &at[k], old, new),
                        };
                        worst(error, moved)
                    });
                    if recorded.len() != answered.len() || error.is_nan() || error > bounds.of(name, *quantity, method, robot) {
                        complain(format!("{label} moved by {error:e}"));
                    }
                }
                (Outcome::NoAnswer(recorded), Outcome::NoAnswer(answered)) if recorded == answered => {}
                _ => complain(format!("{label} was {} and is {}", brief(recorded), brief(answered))),
            }
        }
    }
    stale
}

fn brief(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Values(values) => format!("{} numbers", values.len()),
        Outcome::Text(text) => format!("a text of {} characters", text.chars().count()),
        Outcome::NoAnswer(no_answer) => format!("'{no_answer}'"),
    }
}
