//! `featherbench gate --ranges`: how large the known deviations are on each robot, over runs with different seeds.

use crate::args::GateArgs;
use crate::fail::Fail;
use crate::message::say;
use crate::root::Root;
use ::featherbench_results::{Properties, RobotInfo, Row, RunInfo};
use featherbench_bench::{Deviation, Engines, Gates, Ranges, RangesMeter, SEEDS, SLACK};
use std::path::Path;

/// Measures the ranges over the runs that the arguments name, the first of which is read already, prints them by cause, and writes them where
/// that is asked.
pub fn measure(root: &Root, args: &GateArgs, info: &RunInfo, first: &[Row]) -> Result<(), Fail> {
    let gates = Gates::read_without_ranges(&root.gates(), &Engines::read(&root.described())?)?;
    let of_run = |folder: &Path, info: &RunInfo| Ok::<_, Fail>(gates.clone().with_robots(properties(folder, info)?)?);
    let mut meter = RangesMeter::default();
    let mut seeds = vec![info.seed];
    meter.add(&of_run(&args.folder, info)?, first);
    for folder in &args.others {
        let (other, records) = ::featherbench_results::read_run(folder)?;
        check(folder, info, &other, &seeds)?;
        seeds.push(other.seed);
        meter.add(&of_run(folder, &other)?, &records);
    }
    let ranges = meter.ranges(&Ranges::read(&root.ranges())?).map_err(Fail::input)?;
    print(gates.deviations(), &ranges, seeds.len());
    let (up, down) = meter.leaps(&ranges);
    for (what, factors) in [("above the largest", up), ("below the smallest", down)] {
        if let (Some(median), Some(worst)) = (factors.get(factors.len() / 2), factors.last()) {
            let beyond = factors.iter().filter(|&&factor| factor > SLACK).count();
            say!(
                "of {} ranges, one run lies {what} of the others by a factor of at most {worst:.2} (median {median:.2}; beyond {SLACK}: {beyond})",
                factors.len()
            );
        }
    }
    if !args.write {
        return Ok(());
    }
    gates.with_ranges(ranges.clone(), &root.gates())?;
    let name = args.processor.as_ref().map_or_else(|| info.suite.clone(), |processor| format!("{}-{processor}", info.suite));
    let path = root.ranges().join(format!("{name}.csv"));
    ::featherbench_results::atomic_write(&path, ranges.to_csv().as_bytes())?;
    say!("written: {}", path.display());
    if (seeds.len() as u64) < SEEDS {
        say!("a range is that of {SEEDS} seeds; here are {}", seeds.len());
    }
    Ok(())
}

/// Runs must be of one suite and of different seeds: a seed that counts twice makes a range no wider and looks as if it had.
fn check(folder: &Path, first: &RunInfo, other: &RunInfo, seeds: &[u64]) -> Result<(), Fail> {
    if other.suite != first.suite {
        return Err(Fail::input(format!(
            "{}: it is a run of the suite {}, the first one of {}",
            folder.display(),
            other.suite,
            first.suite
        )));
    }
    if seeds.contains(&other.seed) {
        return Err(Fail::input(format!(
            "{}: another run has the seed {} already; run it with another --seed",
            folder.display(),
            other.seed
        )));
    }
    Ok(())
}

/// Prints each cause with the number of its robots and the span of their ranges.
fn print(deviations: &[Deviation], ranges: &Ranges, runs: usize) {
    for deviation in deviations.iter().filter(|deviation| deviation.is_measured()) {
        let of_it: Vec<_> = ranges.iter().filter(|(key, range)| deviation.has(key) && range.deviation == deviation.id).collect();
        let low = -of_it.iter().map(|(_, range)| -range.low).fold(f64::NEG_INFINITY, featherbench_bench::measure::worst);
        let high = of_it.iter().map(|(_, range)| range.high).fold(0.0, featherbench_bench::measure::worst);
        let always = of_it.iter().filter(|(_, range)| range.outside == range.seeds).count();
        let span = match of_it.len() {
            0 => "not seen".into(),
            count => format!("{count} ranges from {low:.1e} to {high:.1e}, {always} seen in all of {runs} runs"),
        };
        say!("{span}: {} {}: {}", deviation.engine, deviation.id, deviation.reason);
    }
}

/// The properties of a run's robots, which known deviations are told by.
pub fn properties(folder: &Path, info: &RunInfo) -> Result<Vec<(String, Properties)>, Fail> {
    let message =
        || format!("{}: run.json has no properties of its robots: another version wrote it; run the suite again", folder.display());
    info.robots.iter().map(RobotInfo::known_properties).collect::<Option<_>>().ok_or_else(|| Fail::input(message()))
}
