//! The study's figures for papers: ratios by engine and quantity, time against size, and the performance profile of Dolan and Moré.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::BATCH;
use featherbench_report::figure::{Axis, Figure, Heat, Plot};
use featherbench_report::numbers::{count, listed, short};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;

use super::STUDY;
use super::verdict::SpeedVerdict;
use crate::figures::{Measured, largest, shares};

/// Makes the figures.
pub fn figures(overview: &Overview, rows: &[Row], verdict: &SpeedVerdict) -> Vec<Figure> {
    let times = fastest(overview, rows);
    [heat(overview, verdict), against_size(overview, &times), profile(overview, &times)].into_iter().flatten().collect()
}

/// Time of an engine's fastest method, and whether it is an estimate.
type Times<'a> = BTreeMap<(&'a str, usize, usize), (f64, bool)>;

/// The fastest time of each engine, by quantity, robot and engine: one state at a time, another at each call, and only what counts.
fn fastest<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Times<'a> {
    let mut times = Times::new();
    let timed = rows.iter().filter(|row| row.study == STUDY && row.metric == "ns_per_call" && row.cache == "stream" && row.valid);
    for row in timed.filter(|row| row.method != BATCH && ["", "f64"].contains(&&*row.precision)) {
        let (Some(engine), Some(robot), Some(ns)) = (overview.engine(&row.engine), overview.robot(&row.robot), row.value) else { continue };
        let best = times.entry((&*row.quantity, robot, engine)).or_insert((ns, row.estimated));
        if ns < best.0 {
            *best = (ns, row.estimated);
        }
    }
    times
}

fn heat(overview: &Overview, verdict: &SpeedVerdict) -> Option<Figure> {
    let (engines, quantities) = verdict.map();
    let ratio = |engine: usize, quantity: &str| verdict.median(engine, quantity).map(|(ratio, ..)| ratio);
    let heat = Heat {
        title: "Time of each engine over ours".into(),
        unit: "median ratio of times".into(),
        rows: engines.iter().map(|&engine| overview.engines[engine].to_owned()).collect(),
        columns: quantities.iter().map(|quantity| labels::quantity(quantity).to_owned()).collect(),
        cells: engines.iter().map(|&engine| quantities.iter().map(|quantity| ratio(engine, quantity)).collect()).collect(),
    };
    let estimated =
        |engine: usize| quantities.iter().any(|quantity| verdict.median(engine, quantity).is_some_and(|(.., estimated)| estimated));
    let estimates: Vec<String> =
        engines.iter().filter(|&&engine| estimated(engine)).map(|&engine| overview.engines[engine].to_owned()).collect();
    let note = if estimates.is_empty() {
        String::new()
    } else {
        format!(" Of {} they are estimates, which are rather too long.", listed(&estimates))
    };
    let caption = format!(
        "{}. Each cell is the time of the engine's fastest method over that of our usual one, median over the robots; above 1 ours is faster.{note}",
        verdict.headline()
    );
    heat.figure("speed-ratios", caption)
}

/// Forward dynamics, as it is what simulation waits for.
fn against_size(overview: &Overview, times: &Times) -> Option<Figure> {
    let mut engines: BTreeMap<usize, Vec<Measured>> = BTreeMap::new();
    let mut estimates = BTreeSet::new();
    for (&(_, robot, engine), &(ns, estimated)) in times.iter().filter(|((quantity, ..), _)| *quantity == "fd") {
        if let Some(size) = overview.robots[robot].nv.filter(|&size| size > 0) {
            engines.entry(engine).or_default().push(Measured { robot: overview.robots[robot].name, x: size as f64, y: ns });
            if estimated {
                estimates.insert(engine);
            }
        }
    }
    let sizes: BTreeSet<u64> = engines.values().flatten().map(|value| value.x as u64).collect();
    let biggest = *sizes.last().filter(|_| sizes.len() > 1)?;
    let name = |engine: usize| format!("{}{}", overview.engines[engine], if estimates.contains(&engine) { " (estimate)" } else { "" });
    let at_end = |(&engine, values): (&usize, &Vec<Measured>)| {
        let last = values.iter().filter(|value| value.x as u64 == biggest).map(|value| value.y).max_by(f64::total_cmp)?;
        Some(format!("{} {} ns", overview.engines[engine], short(last)))
    };
    let words: Vec<String> = engines.iter().filter_map(at_end).collect();
    let caption = format!(
        "Forward dynamics of a robot with {biggest} degrees of freedom: {}. Each mark is the engine's fastest method on the slowest robot of that \
         size, one state per call on one core.",
        words.join(", ")
    );
    let plot = Plot {
        title: "Time of forward dynamics against size".into(),
        x: Axis::log("degrees of freedom nv"),
        y: Axis::log("time per call, ns"),
        series: engines.iter().map(|(&engine, values)| largest(overview.engines[engine], name(engine), values)).collect(),
    };
    plot.figure("time-size", caption)
}

/// The share of problems that an engine answers within a factor of the fastest time. A problem is a quantity of a robot that two engines
/// answer; one that an engine does not answer, or not rightly, counts against it. Engines with estimates are left out.
fn profile(overview: &Overview, times: &Times) -> Option<Figure> {
    let estimated: BTreeSet<usize> = times.iter().filter(|(_, (_, estimated))| *estimated).map(|((.., engine), _)| *engine).collect();
    let mut problems: BTreeMap<(&str, usize), BTreeMap<usize, f64>> = BTreeMap::new();
    for (&(quantity, robot, engine), &(ns, _)) in times.iter().filter(|((.., engine), _)| !estimated.contains(engine)) {
        problems.entry((quantity, robot)).or_default().insert(engine, ns);
    }
    problems.retain(|_, answers| answers.len() > 1);
    let all = problems.len();
    let mut factors: BTreeMap<usize, Vec<(f64, String)>> = BTreeMap::new();
    for ((quantity, robot), answers) in &problems {
        let least = answers.values().copied().min_by(f64::total_cmp)?;
        for (&engine, ns) in answers {
            let name = format!("{} of {}", labels::quantity(quantity), overview.robots[*robot].name);
            factors.entry(engine).or_default().push((ns / least, name));
        }
    }
    let first = |(&engine, factors): (&usize, &Vec<(f64, String)>)| {
        let first = factors.iter().filter(|(factor, _)| *factor <= 1.0).count();
        (first > 0).then(|| format!("{} of {first}", overview.engines[engine]))
    };
    let words: Vec<String> = factors.iter().filter_map(first).collect();
    let caption = format!(
        "Of {} (a quantity of a robot with times of two engines that count), the fastest engine: {}. A curve shows on which share of them an engine \
         takes at most so many times the time of the fastest; what it does not answer counts against it. Engines with estimated times are left out.",
        count(all, "problem"),
        words.join(", ")
    );
    let series =
        factors.into_iter().map(|(engine, factors)| shares(overview.engines[engine], overview.engines[engine].to_owned(), factors, all));
    let plot = Plot {
        title: "Performance profile of times".into(),
        x: Axis::log("time over that of the fastest engine"),
        y: Axis::linear("share of problems"),
        series: series.collect(),
    };
    plot.figure("speed-profile", caption)
}
