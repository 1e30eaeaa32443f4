//! `featherbench plan`: the cells of a suite, what they cost, and how they are cut into shards.

use crate::args::{PlanArgs, RunArgs};
use crate::fail::Fail;
use crate::message::{self, say};
use crate::root::Root;
use crate::run;
use crate::run::shard;
use ::featherbench_results::quoted;
use featherbench_bench::shard::{Plan, Planned};
use serde_json::{Value, json};

/// The time limit of a job over the estimate of its shard: estimates of cells that were never measured are rough.
const PATIENCE: f64 = 10.0;
/// The least time limit, in minutes: engines start and a suite's robots are read in each job.
const LEAST_MINUTES: f64 = 10.0;

/// Prints the plan of a suite.
pub fn plan(root: &Root, args: &PlanArgs) -> Result<(), Fail> {
    let whole = args.whole.run();
    let prepared = run::prepare(root, &whole)?;
    prepared.check_filter(&whole)?;
    let plan = shard::plan(&prepared, &whole)?;
    let shards = args.shards.get();
    let numbers = plan.cut(shards);
    let totals = totals(&plan, &numbers, shards);
    if args.json {
        say!("{:#}", to_json(&plan, &numbers, &totals));
    } else if args.slurm {
        let alone = plan.cells.iter().any(|planned| planned.exclusive);
        message::text(&slurm(&whole, &prepared.loaded.name, &totals, alone));
    } else {
        tell(&plan, &numbers, &totals);
    }
    Ok(())
}

/// The cells and the estimated cost of each shard.
pub fn totals(plan: &Plan, numbers: &[usize], shards: usize) -> Vec<(usize, f64)> {
    let mut totals = vec![(0, 0.0); shards];
    for (planned, number) in plan.cells.iter().zip(numbers) {
        if let Some((cells, seconds)) = totals.get_mut(number - 1) {
            *cells += 1;
            *seconds += planned.estimate.seconds;
        }
    }
    totals
}

fn tell(plan: &Plan, numbers: &[usize], totals: &[(usize, f64)]) {
    for (Planned { cell, id, exclusive, estimate }, number) in plan.cells.iter().zip(numbers) {
        let mark = if estimate.measured { ' ' } else { '~' };
        let alone = if *exclusive { "  alone" } else { "" };
        say!("{id}  {number:>5}  {mark}{:<9.2e} s  {}{alone}", estimate.seconds, cell.path());
    }
    for (at, (cells, seconds)) in totals.iter().enumerate() {
        say!("shard {}/{}: {cells} cells, {seconds:.2} s", at + 1, totals.len());
    }
    let measured = plan.cells.iter().filter(|planned| planned.estimate.measured).count();
    say!(
        "{} cells, {:.2} s on one core; the cost of {measured} is measured, of the others estimated (~)",
        plan.cells.len(),
        plan.seconds()
    );
}

fn to_json(plan: &Plan, numbers: &[usize], totals: &[(usize, f64)]) -> Value {
    let of = |(Planned { cell, id, exclusive, estimate }, number): (&Planned, &usize)| {
        json!({
            "cell": id, "study": cell.study, "robot": cell.robot, "engine": cell.engine, "quantity": cell.quantity, "method": cell.method,
            "exclusive": exclusive, "seconds": estimate.seconds, "measured": estimate.measured, "shard": number,
        })
    };
    let cells: Vec<Value> = plan.cells.iter().zip(numbers).map(of).collect();
    let shards: Vec<Value> = totals.iter().map(|(cells, seconds)| json!({"cells": cells, "seconds": seconds})).collect();
    json!({"seconds": plan.seconds(), "shards": shards, "cells": cells})
}

/// A job array with one task per shard. A task that is started again continues. If cells must run alone, each task has its node for itself.
fn slurm(args: &RunArgs, suite: &str, totals: &[(usize, f64)], alone: bool) -> String {
    let words = |list: Vec<String>| list.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ");
    let costs = args.costs.iter().flat_map(|folder| ["--costs".to_owned(), folder.to_string_lossy().into_owned()]).collect();
    let (run, costs, n) = (words(args.defining()), words(costs), totals.len());
    let exclusive = if alone { "#SBATCH --exclusive\n" } else { "" };
    let largest = totals.iter().map(|(_, seconds)| *seconds).max_by(f64::total_cmp).unwrap_or_default();
    let minutes = (PATIENCE * largest / 60.0).max(LEAST_MINUTES).ceil();
    format!(
        "#!/bin/bash
#SBATCH --job-name=featherbench-{suite}
#SBATCH --array=1-{n}
#SBATCH --cpus-per-task=1
#SBATCH --time={minutes}
{exclusive}# Each task evaluates one shard on one core. All nodes need this checkout, the same program and the same kind of processor.
# When all are done: featherbench merge \"$OUT\"/shard-*-of-{n} --out \"$OUT\"/merged
set -eu
OUT=${{OUT:-{suite}-shards}}
mkdir -p \"$OUT\"
shard=\"$OUT/shard-$SLURM_ARRAY_TASK_ID-of-{n}\"
resume=
if [ -e \"$shard/fingerprint.json\" ]; then resume=--resume; fi
export RAYON_NUM_THREADS=${{SLURM_CPUS_PER_TASK:-1}}
exec \"${{FEATHERBENCH:-featherbench}}\" run {run} {costs} --shard \"$SLURM_ARRAY_TASK_ID/{n}\" --out \"$shard\" $resume
"
    )
}
