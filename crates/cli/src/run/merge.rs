//! `featherbench merge`: the shards of a run as one run.

use crate::args::{MergeArgs, RunArgs};
use crate::fail::Fail;
use crate::message::tell;
use crate::root::Root;
use crate::run;
use crate::run::shard;
use ::featherbench_results::{Expectation, GateKind, RunInfo, ShardInfo, quoted};
use featherbench_bench::provenance;
use featherbench_bench::run::{Opening, Run};
use featherbench_bench::shard::{Merge, Part, ShardError, ShardFile};
use std::time::SystemTime;

/// Merges shards, compares and judges their outcomes, and writes the run.
pub fn merge(root: &Root, args: &MergeArgs) -> Result<(), Fail> {
    let (mut parts, mut refused) = (Vec::new(), Vec::new());
    for folder in &args.shards {
        match Part::open(folder) {
            Ok(part) => parts.push(part),
            Err(error) => refused.push(error),
        }
    }
    // What is wrong with the shards alone is told before engines are started.
    let Some(first) = parts.first().filter(|_| args.keep_good || refused.is_empty()) else { return Err(error_of(&refused, None)) };
    let of = first.folder.display();
    let whole =
        RunArgs::of(&first.file.arguments).map_err(|error| Fail::input(format!("{of}: its arguments are not those of a run: {error}")))?;
    let whole = RunArgs { open: args.open, ..whole };
    let command = command(&first.file.arguments);
    let prepared = run::prepare(root, &whole)?;
    let plan = shard::plan(&prepared, &whole)?;
    let info = RunInfo { command, ..prepared.describe(root, &whole, SystemTime::now())? };
    let mut merged = Merge::of(parts, &plan, &provenance::fingerprint(&info), args.allow_mixed);
    refused.append(&mut merged.refused);
    let gaps = gaps(&merged);
    let complete = refused.is_empty() && gaps.is_none();
    if !(args.keep_good || complete) || merged.parts.is_empty() {
        return Err(error_of(&refused, gaps));
    }
    refused.iter().map(ToString::to_string).chain(gaps).for_each(|what| tell!("note: left out: {what}"));

    let mut run = Run::open(&args.out, Opening::New, info)?;
    merged.write(&plan, &run.folder)?;
    run.info.shards = merged.parts.iter().map(info_of).collect();
    let rows = run.assemble(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell))?;
    let planned = plan.cells.len() as u64;
    let there = planned - merged.missing.len() as u64;
    let condition = || Expectation::new(GateKind::Counts, "cells that a shard has".into(), planned, there);
    // Only if it fails: a run without gaps is that of one process, gate for gate.
    let more = if merged.missing.is_empty() { Vec::new() } else { vec![condition()] };
    prepared.conclude(&whole, run, &rows, more)
}

/// The command of the run that one process would have made.
fn command(arguments: &[String]) -> String {
    let words = arguments.iter().map(|word| quoted(word));
    ["cargo run --release -- run".to_owned()].into_iter().chain(words).collect::<Vec<_>>().join(" ")
}

/// What the merged run keeps of a shard's origin.
fn info_of(part: &Part) -> ShardInfo {
    let ShardFile { shard, started, seconds, host, cells, .. } = &part.file;
    ShardInfo { shard: shard.clone(), started: started.clone(), seconds: *seconds, host: host.clone(), cells: cells.len() as u64 }
}

/// What is missing, in one sentence.
fn gaps(merged: &Merge) -> Option<String> {
    let first = merged.missing.first()?;
    let absent = merged.absent();
    let shards = if absent.is_empty() { String::new() } else { format!("there is no good shard {}; ", absent.join(", ")) };
    Some(format!("{shards}{} cells are in no shard, {first} first", merged.missing.len()))
}

/// All that is wrong, and what to do.
fn error_of(refused: &[ShardError], gaps: Option<String>) -> Fail {
    let told: Vec<String> = refused.iter().map(ToString::to_string).chain(gaps).collect();
    Fail::input(format!("{}\n  --keep-good merges what is good, and names the rest", told.join("\n  ")))
}
