//! The ranking: one line for each engine, over all studies. Who is right, by how much, and how fast.
//!
//! | column | definition |
//! |---|---|
//! | right | answers within their bound, of all questions that have one |
//! | error | of the engine's usual method against the truth in 32 digits, of a robot the median over its states: the median and the worst of the robots |
//! | time | of the engine's fastest method over that of our usual one, another state at each call: the median over the robots, with the least and the most |
//!
//! The usual method is, as in the figures, the first of those with the most robots. A ratio that does not count is never used. Without a ratio
//! of this run, an engine has those that other machines recorded.

mod machines;
mod section;

use featherbench_bench::statistics::quantile_of;
use featherbench_bench::{BATCH, OWN};
use featherbench_report::numbers::{larger, smaller};
use featherbench_report::{EVERYONE, Findings, Tally};
use featherbench_results::{Errors, Ranked, Ranking, Row, RunInfo, Times, Verdict};
use std::collections::BTreeMap;

pub(crate) use section::section;

/// Quantities with errors. Engines are ranked by the first of which one has errors.
const QUANTITIES: [&str; 3] = ["fd", "id", "mass_matrix"];
/// Quantities with times.
const TIMED: [&str; 4] = ["fd", "id", "mass_matrix", "fd_dq"];
/// M as a tree-sparse matrix.
const SPARSE: &str = "mass_matrix_sparse";
/// What a build of an engine has after the engine's name.
const BUILDS: [&str; 3] = ["-clang", "-gcc", "-native"];

/// Ranks the engines of a run.
pub fn ranking(run: &RunInfo, rows: &[Row]) -> Ranking {
    let findings = Findings::of(run, rows);
    let mut versions: BTreeMap<&str, &str> = BTreeMap::new();
    let of_run = run.engines.iter().map(|engine| (&engine.name, &engine.version));
    let of_rows = rows.iter().map(|row| (&row.engine, &row.engine_version));
    // Engines of which there are times alone have a line, too.
    let of_machines = run.recorded_times.iter().map(|times| (&times.engine, &times.version));
    for (name, version) in of_run.chain(of_rows).chain(of_machines) {
        if !name.is_empty() && name != EVERYONE {
            versions.entry(engine_of(name)).or_insert(version);
        }
    }
    let (mut errors, mut times) = (errors(rows), times(rows));
    let ranked = |(name, version): (&str, &str)| {
        let mut own = times.remove(name).unwrap_or_default();
        for quantity in TIMED.into_iter().filter(|_| name != OWN) {
            if !own.contains_key(quantity)
                && let Some(times) = recorded(run, name, quantity)
            {
                own.insert(quantity.to_owned(), times);
            }
        }
        let tally = Tally::of(rows.iter().filter(|row| engine_of(&row.engine) == name).map(|row| row.verdict));
        let (right, known) = (tally.get(Verdict::Pass), tally.get(Verdict::Deviation));
        let gravest = findings.of_engine(name).map(|found| match found.quantities.first() {
            Some(first) => format!("{}: {first}", found.level()),
            None => found.level().to_owned(),
        });
        Ranked {
            name: name.to_owned(),
            version: version.to_owned(),
            asked: right + known + tally.broken(),
            right,
            known,
            errors: errors.remove(name).unwrap_or_default(),
            times: own,
            gravest: gravest.unwrap_or_default(),
        }
    };
    let mut engines: Vec<Ranked> = versions.into_iter().map(ranked).collect();
    engines.retain(|engine| engine.asked > 0 || !engine.times.is_empty());
    let deciding =
        |engine: &Ranked| QUANTITIES.iter().find_map(|&quantity| engine.errors.get(quantity)).map_or(f64::INFINITY, |errors| errors.worst);
    engines.sort_by(|a, b| deciding(a).total_cmp(&deciding(b)).then_with(|| a.name.cmp(&b.name)));
    Ranking { suite: run.suite.clone(), started: run.started.clone(), machine: run.host.cpu.clone(), engines }
}

/// The engine of which this one is a build, or itself.
fn engine_of(name: &str) -> &str {
    BUILDS.iter().find_map(|build| name.strip_suffix(build)).unwrap_or(name)
}

/// An engine and a quantity.
type Asked<'a> = (&'a str, &'a str);

/// The error of a method on a robot.
struct OfRobot<'a> {
    robot: &'a str,
    states: usize,
    median: f64,
    bound: Option<f64>,
}

/// The errors of each engine's usual method, by quantity.
fn errors(rows: &[Row]) -> BTreeMap<&str, BTreeMap<String, Errors>> {
    let measured = |row: &&Row| {
        row.study == "accuracy"
            && row.metric == "error_median"
            && row.precision == "f64"
            && row.method != BATCH
            && row.valid
            && QUANTITIES.contains(&row.quantity.as_str())
    };
    let mut methods: BTreeMap<Asked, Vec<(&str, Vec<OfRobot>)>> = BTreeMap::new();
    for (row, median) in rows.iter().filter(measured).filter_map(|row| Some((row, row.value?))) {
        let known = methods.entry((&row.engine, &row.quantity)).or_default();
        let at = known.iter().position(|(method, _)| *method == row.method).unwrap_or_else(|| {
            known.push((&row.method, Vec::new()));
            known.len() - 1
        });
        let states = row.param("states").and_then(|states| states.as_u64()).unwrap_or(0) as usize;
        known[at].1.push(OfRobot { robot: &row.robot, states, median, bound: row.floor });
    }
    let mut found: BTreeMap<&str, BTreeMap<String, Errors>> = BTreeMap::new();
    for ((engine, quantity), methods) in methods {
        // The last of equally good ones is taken: so the first of the reversed.
        let usual = methods.into_iter().rev().max_by_key(|(_, robots)| robots.len());
        if let Some(errors) = usual.and_then(|(method, robots)| over_robots(method, &robots)) {
            found.entry(engine).or_default().insert(quantity.to_owned(), errors);
        }
    }
    found
}

fn over_robots(method: &str, robots: &[OfRobot]) -> Option<Errors> {
    let medians: Vec<f64> = robots.iter().map(|of| of.median).collect();
    let worst = robots.iter().max_by(|a, b| a.median.total_cmp(&b.median))?;
    let of_bound = robots.iter().filter_map(|of| Some(of.median / of.bound.filter(|&bound| bound > 0.0)?)).reduce(larger);
    Some(Errors {
        method: method.to_owned(),
        robots: medians.len(),
        states: robots.iter().map(|of| of.states).sum(),
        median: quantile_of(&medians, 0.5),
        worst: worst.median,
        worst_robot: worst.robot.to_owned(),
        of_bound,
    })
}

/// The times of each engine over ours, by quantity. Ours over itself is 1.
fn times(rows: &[Row]) -> BTreeMap<&str, BTreeMap<String, Times>> {
    let counts = |row: &&Row| {
        row.study == "timing" && row.cache == "stream" && row.valid && ["f64", ""].contains(&row.precision.as_str()) && row.method != BATCH
    };
    // By robot, with whether it is an estimate.
    let mut fastest: BTreeMap<Asked, BTreeMap<&str, (f64, bool)>> = BTreeMap::new();
    for row in rows.iter().filter(counts) {
        // Of M, what is timed is the tree-sparse matrix.
        let timed = |quantity: &&str| row.quantity == if *quantity == "mass_matrix" { SPARSE } else { *quantity };
        let Some(quantity) = TIMED.into_iter().find(timed) else { continue };
        let own = row.engine == OWN;
        let ratio = match (own, row.metric.as_str()) {
            (true, "ns_per_call") => Some(1.0),
            (false, "ratio") => row.value.filter(|&ratio| ratio > 0.0),
            _ => None,
        };
        let Some(ratio) = ratio else { continue };
        let of_robot = fastest.entry((engine_of(&row.engine), quantity)).or_default().entry(&row.robot).or_insert((ratio, row.estimated));
        if ratio < of_robot.0 {
            *of_robot = (ratio, row.estimated);
        }
    }
    let mut found: BTreeMap<&str, BTreeMap<String, Times>> = BTreeMap::new();
    for ((engine, quantity), robots) in fastest {
        let ratios: Vec<f64> = robots.values().map(|&(ratio, _)| ratio).collect();
        let end = |fold: fn(f64, f64) -> f64| ratios.iter().copied().reduce(fold).unwrap_or(f64::NAN);
        let times = Times {
            robots: ratios.len(),
            median: quantile_of(&ratios, 0.5),
            least: end(smaller),
            most: end(larger),
            estimated: robots.values().any(|&(_, estimated)| estimated),
            machines: 0,
        };
        found.entry(engine).or_default().insert(quantity.to_owned(), times);
    }
    found
}

/// The times that other machines recorded: over the machines the median, and over all their robots the least and the most.
fn recorded(run: &RunInfo, engine: &str, quantity: &str) -> Option<Times> {
    let all = || run.recorded_times.iter().filter(|times| times.engine == engine && times.quantity == quantity);
    let medians: Vec<f64> = all().map(|times| times.median).collect();
    Some(Times {
        robots: all().map(|times| times.robots).max()?,
        median: quantile_of(&medians, 0.5),
        least: all().map(|times| times.least).reduce(smaller)?,
        most: all().map(|times| times.most).reduce(larger)?,
        estimated: all().any(|times| times.estimated),
        machines: medians.len(),
    })
}
