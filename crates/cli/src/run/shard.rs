//! `featherbench run --shard i/n`: some of the cells of a run, for `merge`.

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::message::say;
use crate::progress::Bar;
use crate::run::{Prepared, opening};
use ::featherbench_results::{RunInfo, checksum_of};
use featherbench_bench::run::Run;
use featherbench_bench::shard::{Costs, Plan, Shard, ShardFile};
use featherbench_bench::{Entries, HarnessError, OUTCOMES_NAME};
use serde_json::json;
use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

/// The plan of a run; its costs are those of earlier runs where they are known.
pub fn plan(prepared: &Prepared, args: &RunArgs) -> Result<Plan, Fail> {
    let costs = Costs::read(&args.costs)?;
    Ok(Plan::new(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell), &costs))
}

/// What was started in a folder, one line of JSON each: the rounds of a sweep, the processes of a shard.
const JOURNAL_NAME: &str = "journal.jsonl";
/// The file whose lock the process has that evaluates a shard. Another one waits: a task may be started again while its first process lives on.
const LOCK_NAME: &str = "lock";

/// Evaluates a shard into its folder.
pub fn evaluate(prepared: &Prepared, args: &RunArgs, shard: Shard, folder: &Path, info: RunInfo) -> Result<(), Fail> {
    let (plan, started) = (plan(prepared, args)?, info.started.clone());
    let ids: Vec<String> = plan.part(shard).into_iter().map(|planned| planned.id.clone()).collect();
    let run = Run::open_shard(folder, opening(args), info, shard, ids.iter().map(String::as_str))?;
    prepared.check_filter(args)?;
    let lock = File::create(folder.join(LOCK_NAME)).and_then(|file| file.lock().map(|()| file));
    let _lock = lock.map_err(|source| HarnessError::io(folder, source))?;
    let mine: HashSet<String> = ids.iter().cloned().collect();
    let kept = if folder.join(OUTCOMES_NAME).exists() { Entries::open(folder)?.cells().count() } else { 0 };
    journal(folder, &json!({ "process": std::process::id(), "time": started, "cells": ids.len(), "kept": kept }))?;
    run.evaluate(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell), &mine, &Bar::new())?;
    let mut file = ShardFile::new(shard, &run.info, args.defining(), ids);
    let entries = Entries::open(folder)?;
    file.seconds = file.cells.iter().filter_map(|id| entries.seconds(id)).sum();
    file.outcomes = checksum_of(&folder.join(OUTCOMES_NAME))?;
    file.write(folder)?;
    say!("shard {shard}: {} of {} cells, {:.1} s of work, in {}", file.cells.len(), plan.cells.len(), file.seconds, folder.display());
    say!("when all shards are there: featherbench merge DIR… --out DIR");
    Ok(())
}

/// Appends a line to the journal of a folder.
pub fn journal(folder: &Path, line: &serde_json::Value) -> Result<(), Fail> {
    let path = folder.join(JOURNAL_NAME);
    let io = |source| HarnessError::io(&path, source);
    let mut file = OpenOptions::new().create(true).append(true).open(&path).map_err(io)?;
    // In one call: lines of two processes do not mix.
    file.write_all(format!("{line}\n").as_bytes()).map_err(io)?;
    Ok(())
}
