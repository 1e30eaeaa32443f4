//! What merging costs: makes seven shards of a synthetic run, merges them, and prints time and peak memory.
//!
//! `cargo run --release -p featherbench-bench --example merge -- 1000000` (the number of rows)
//!
//! Answers have the size of those of a robot with thirty dofs at twenty states. The study stands for one whose rows all belong to robots.

use featherbench_bench::run::{Opening, Run, Silent};
use featherbench_bench::shard::{Costs, Merge, Part, Plan, Shard, ShardFile};
use featherbench_bench::{Asked, Cell, Context, Finished, Gates, NoAnswer, OUTCOMES_NAME, Outcome, Robot, Study, provenance};
use featherbench_results::{Dictionary, ModelOrigin, Relation, Row, RunInfo, Verdict};
use featherbench_robots::{Family, Random};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Cells of a robot, rows of a cell, numbers of an answer.
const CELLS: usize = 100;
const ROWS: usize = 10;
const NUMBERS: usize = 600;
const SHARDS: usize = 7;
/// The most memory in MiB that merging a million rows may take.
const MOST: u64 = 2048;

/// A study whose answers are random numbers of its cells.
struct Synthetic;

impl Study for Synthetic {
    fn name(&self) -> &'static str {
        "synthetic"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let cell = |robot: &Robot, method: usize| Cell {
            study: self.name().into(),
            robot: robot.name.clone(),
            robot_hash: robot.hash.clone(),
            params: serde_json::json!({"states": 20}),
            engine: ["pinocchio", "mujoco", "drake"][method % 3].into(),
            version: "1.2.3".into(),
            method: format!("method {method}"),
            quantity: "forward_dynamics".into(),
            scalar: "f64".into(),
        };
        context.robots.iter().flat_map(|robot| (0..CELLS).map(move |method| cell(robot, method))).collect()
    }

    fn evaluate(&self, &Asked { context, cell, .. }: &Asked) -> Outcome {
        let mut random = Random::named(context.seed, &cell.id());
        Outcome::Values((0..NUMBERS).map(|_| random.uniform(0.0, 1.0)).collect())
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn compare(&self, _: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let rows = |(cell, outcome): &Finished| {
            let row = |value: Result<f64, &NoAnswer>| {
                let blank = Row {
                    cell: cell.id(),
                    study: cell.study.clone(),
                    robot: robot.name.clone(),
                    family: robot.family.clone(),
                    engine: cell.engine.clone(),
                    engine_version: cell.version.clone(),
                    method: cell.method.clone(),
                    quantity: cell.quantity.clone(),
                    metric: "scaled".into(),
                    unit: "1".into(),
                    ..Row::default()
                };
                match value {
                    Ok(value) => blank.gated(value, Relation::Le, 1.0),
                    Err(reason) => blank.without_value(Verdict::Error, reason.to_string()),
                }
            };
            match outcome {
                Outcome::NoAnswer(reason) => vec![row(Err(reason))],
                _ => outcome.values().unwrap_or_default().iter().take(ROWS).map(|value| row(Ok(*value))).collect(),
            }
        };
        finished.iter().flat_map(rows).collect()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let wanted: usize = std::env::args().nth(1).ok_or("say how many rows")?.parse()?;
    let count = wanted.div_ceil(CELLS * ROWS);
    let description = Family::parse("chain:n=3")?.generate()?;
    let pattern = Robot::new(&description, "chain", ModelOrigin::Generated, 1, 1)?;
    let robots: Vec<Robot> = (0..count).map(|k| Robot { name: format!("chain-{k}"), ..pattern.clone() }).collect();
    let gates = Gates::default();
    let context = Context { robots: &robots, engines: &[], gates: &gates, seed: 1 };
    let studies: Vec<Box<dyn Study>> = vec![Box::new(Synthetic)];
    let root = PathBuf::from(std::env::var_os("TMPDIR").unwrap_or_else(|| "/tmp".into())).join(format!("merge-{}", std::process::id()));

    let plan = Plan::new(&studies, &context, &|_| true, &Costs::default());
    let mut folders = Vec::new();
    for number in 1..=SHARDS {
        let folder = root.join(number.to_string());
        evaluate(&studies, &context, &plan, format!("{number}/{SHARDS}").parse()?, &folder)?;
        folders.push(folder);
    }
    let stored: u64 = folders.iter().map(|folder| std::fs::metadata(folder.join(OUTCOMES_NAME)).map_or(0, |file| file.len())).sum();
    println!("{} cells in {SHARDS} shards, {} bytes of outcomes, peak {} MiB before the merge", plan.cells.len(), stored, peak());

    let start = Instant::now();
    let parts = folders.iter().map(|folder| Part::open(folder)).collect::<Result<Vec<_>, _>>()?;
    let merge = Merge::of(parts, &plan, &provenance::fingerprint(&RunInfo::default()), false);
    if !merge.refused.is_empty() || !merge.missing.is_empty() {
        return Err(format!("{:?}, {} cells missing", merge.refused, merge.missing.len()).into());
    }
    let mut run = Run::open(&root.join("merged"), Opening::New, RunInfo::default())?;
    merge.write(&plan, &run.folder)?;
    let rows = run.assemble(&studies, &context, &|_| true)?;
    run.write(&rows, &Dictionary::default())?;
    let size = std::fs::metadata(run.folder.join(featherbench_results::CSV_NAME))?.len();
    println!("{} rows, {size} bytes, merged in {:.1} s, peak {} MiB", rows.len(), start.elapsed().as_secs_f64(), peak());
    std::fs::remove_dir_all(root)?;
    if wanted <= 1_000_000 && peak() > MOST {
        return Err(format!("the peak is above {MOST} MiB").into());
    }
    Ok(())
}

/// Evaluates a shard, as `featherbench run --shard` does.
fn evaluate(studies: &[Box<dyn Study>], context: &Context, plan: &Plan, shard: Shard, folder: &Path) -> Result<(), Box<dyn Error>> {
    let info = RunInfo::default();
    let ids: Vec<String> = plan.part(shard).into_iter().map(|planned| planned.id.clone()).collect();
    let run = Run::open_shard(folder, Opening::New, info, shard, ids.iter().map(String::as_str))?;
    run.evaluate(studies, context, &|_| true, &ids.iter().cloned().collect(), &Silent)?;
    ShardFile::new(shard, &run.info, Vec::new(), ids).finish(folder)?;
    Ok(())
}

/// The most memory that this process has had, in MiB.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()).map_or(0, |kilobytes| kilobytes >> 10)
}
