//! `featherbench run --shard i/n`: some of the cells of a run, for `merge`.

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::message::say;
use crate::progress::Bar;
use crate::run::again::Again;
use crate::run::{Prepared, opening};
use ::featherbench_results::RunInfo;
use featherbench_bench::run::Run;
use featherbench_bench::shard::{Costs, Plan, Shard, ShardFile, journal};
use featherbench_bench::{Entries, HarnessError, OUTCOMES_NAME};
use serde_json::json;
use std::collections::HashSet;
use std::fs::File;
use std::path::Path;

/// The plan of a run; its costs are those of earlier runs where they are known.
pub fn plan(prepared: &Prepared, args: &RunArgs) -> Result<Plan, Fail> {
    let costs = Costs::read(&args.costs)?;
    Ok(Plan::new(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell), &costs))
}

/// The file whose lock the process has that evaluates a shard. Another one waits: a task may be started again while its first process lives on.
const LOCK_NAME: &str = "lock";

/// Evaluates a shard into its folder.
pub fn evaluate(prepared: &Prepared, args: &RunArgs, shard: Shard, folder: &Path, info: RunInfo) -> Result<(), Fail> {
    let (plan, started) = (plan(prepared, args)?, info.started.clone());
    let ids: Vec<String> = plan.part(shard).into_iter().map(|planned| planned.id.clone()).collect();
    let mut run = Run::open_shard(folder, opening(args), info, shard, ids.iter().map(String::as_str))?;
    run.new_process = Some(Box::new(Again::of(args)));
    prepared.check_filter(args)?;
    let lock = File::create(folder.join(LOCK_NAME)).and_then(|file| file.lock().map(|()| file));
    let _lock = lock.map_err(|source| HarnessError::io(folder, source))?;
    let mine: HashSet<String> = ids.iter().cloned().collect();
    let kept = if folder.join(OUTCOMES_NAME).exists() { Entries::open(folder)?.cells().count() } else { 0 };
    // A shard's journal has its processes.
    let line = [("process", json!(std::process::id())), ("time", json!(started)), ("cells", json!(ids.len())), ("kept", json!(kept))];
    journal::append(folder, line)?;
    run.evaluate(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell), &mine, &Bar::of_run(folder))?;
    let file = ShardFile::new(shard, &run.info, args.defining(), ids).finish(folder)?;
    say!("shard {shard}: {} of {} cells, {:.1} s of work, in {}", file.cells.len(), plan.cells.len(), file.seconds, folder.display());
    say!("when all shards are there: featherbench merge DIR… --out DIR");
    Ok(())
}
