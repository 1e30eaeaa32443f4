//! The study's figures for papers: ratios by engine and quantity, time against size, the performance profile of Dolan and Moré, time
//! against error, and the share of the machine's peak.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::BATCH;
use featherbench_report::figure::{Axis, Figure, Heat, Line, Plot, Point, Series, style};
use featherbench_report::numbers::{count, larger, listed, scientific, short};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;

use super::STUDY;
use super::ratios::{OPERATIONS, Speed};
use super::tradeoff::{Tradeoff, richest};
use super::verdict::SpeedVerdict;
use featherbench_study::figures::{Measured, largest, shares};

/// Makes the figures.
pub fn figures(overview: &Overview, rows: &[Row], verdict: &SpeedVerdict, speed: &Speed, points: &[Tradeoff]) -> Vec<Figure> {
    let times = fastest(overview, rows);
    let all = [
        heat(overview, verdict),
        against_size(overview, &times),
        profile(overview, &times),
        precision(overview, points),
        share(overview, speed),
    ];
    all.into_iter().flatten().collect()
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
        ..Plot::default()
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
        ..Plot::default()
    };
    plot.figure("speed-profile", caption)
}

/// Time against error of every method, on the robot that most methods answer.
fn precision(overview: &Overview, points: &[Tradeoff]) -> Option<Figure> {
    let robot = richest(overview, points)?;
    let mut engines: BTreeMap<usize, Vec<&Tradeoff>> = BTreeMap::new();
    // An error of zero has no place on the axis; it is in the data.
    points.iter().filter(|point| point.robot == robot).for_each(|point| engines.entry(point.engine).or_default().push(point));
    let way = |point: &Tradeoff| if point.scalar == "f64" { point.method.to_owned() } else { format!("{} {}", point.method, point.scalar) };
    let front = |point: &&Tradeoff| {
        let engine = overview.engines[point.engine];
        format!("{engine} {} ({} ns, error {})", way(point), short(point.ns), scientific(point.error))
    };
    let unbeaten: Vec<String> = points.iter().filter(|point| point.robot == robot && point.front).map(|point| front(&point)).collect();
    let caption = format!(
        "Forward dynamics of {}. No method is both faster and more accurate than {}. An error is the median over the states, against the answer in \
         double-double arithmetic.",
        overview.robots[robot].name,
        listed(&unbeaten)
    );
    let mark = |point: &Tradeoff| Point::new(way(point), point.ns, point.error);
    let series = |(engine, points): (usize, Vec<&Tradeoff>)| Series {
        name: overview.engines[engine].to_owned(),
        style: style(overview.engines[engine]),
        line: Line::Marks,
        points: points.into_iter().map(mark).collect(),
        ..Series::default()
    };
    let plot = Plot {
        title: format!("Time against error of forward dynamics, {}", overview.robots[robot].name),
        x: Axis::log("time per call, ns"),
        y: Axis::log("median relative error"),
        series: engines.into_iter().map(series).collect(),
        ..Plot::default()
    };
    plot.figure("work-precision", caption)
}

/// The share of the core's peak that each engine's best method reaches, by the quantity with the most engines.
fn share(overview: &Overview, speed: &Speed) -> Option<Figure> {
    let counted = || speed.limits.iter().filter(|limit| limit.cache == "stream" && !limit.estimated && limit.method != BATCH);
    let engines_of =
        |quantity: &str| counted().filter(|limit| limit.quantity == quantity).map(|limit| limit.engine).collect::<BTreeSet<_>>().len();
    let (quantity, algorithm, operations) = OPERATIONS.into_iter().max_by_key(|(quantity, ..)| engines_of(quantity))?;
    let mut engines: BTreeMap<usize, Vec<Measured>> = BTreeMap::new();
    for limit in counted().filter(|limit| limit.quantity == quantity) {
        if let Some(size) = overview.robots[limit.robot].nv.filter(|&size| size > 0) {
            let measured = Measured { robot: overview.robots[limit.robot].name, x: size as f64, y: limit.least / limit.per_joint };
            engines.entry(limit.engine).or_default().push(measured);
        }
    }
    let best = |(&engine, values): (&usize, &Vec<Measured>)| {
        let share = values.iter().map(|value| value.y).fold(0.0, larger);
        format!("{} {} %", overview.engines[engine], short(100.0 * share))
    };
    let words: Vec<String> = engines.iter().map(best).collect();
    let caption = format!(
        "Largest share of the core's peak in full vectors, one state per call: {}. The count is that of {algorithm}, {operations} multiply-adds per \
         revolute joint, without sines and cosines; an engine that computes more reaches less. Each mark is the engine's best method on a robot \
         of that size.",
        words.join(", ")
    );
    let plot = Plot {
        title: format!("Share of the machine's peak, {}", labels::quantity(quantity)),
        x: Axis::log("degrees of freedom nv"),
        y: Axis::log("share of the peak of one core"),
        series: engines
            .iter()
            .map(|(&engine, values)| largest(overview.engines[engine], overview.engines[engine].to_owned(), values))
            .collect(),
        ..Plot::default()
    };
    plot.figure("peak-share", caption)
}
