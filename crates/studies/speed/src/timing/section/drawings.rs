//! Drawings of the sections: time against size, ratios of times, and time against true error.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::statistics::NOISE;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Line, Plot, Point, Rows, Series, Style};
use featherbench_report::numbers::larger;
use featherbench_report::{Overview, Part, labels, robot_chunk};
use maud::Markup;

use super::STUDY;
use super::ratios::{Ratio, Speed};
use super::time::{TimeLine, TimePoint, case_words};
use super::tradeoff::Tradeoff;
use featherbench_study::figures::{ZERO, drawing, errors, fitted, joined, point, told};

/// The quantity whose times stand on the page at first.
const OPENING: &str = "fd";
/// The family of robots that have nothing in common but that they are real.
const UNRELATED: &str = "robot";
/// The fewest points through which a fit is drawn: through three a line goes nearly always.
const FITTED: usize = 4;
/// Characters of a robot's name along an axis.
const NAME: usize = 22;

/// The different words, in the order in which they come.
fn different<'a>(words: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for word in words {
        if !found.contains(&word) {
            found.push(word);
        }
    }
    found
}

/// Counts what has the same key: the first is 0.
fn next<K: Ord>(counts: &mut BTreeMap<K, usize>, key: K) -> usize {
    let count = counts.entry(key).or_insert(0);
    *count += 1;
    *count - 1
}

/// What is said of a time or ratio that is an estimate or does not count.
fn flags(estimated: bool, valid: bool) -> [String; 2] {
    let words = |is: bool, words: &str| if is { words.to_owned() } else { String::new() };
    [words(estimated, "estimate"), words(!valid, "does not count")]
}

/// Time against size, by what is computed, kind of inputs and family: all at once could not be read.
pub fn times(overview: &Overview, times: &[TimeLine], opening: &str) -> (Markup, Vec<Part>) {
    // `stream` first, as it is more realistic: every call reads another state.
    let mut cases = different(times.iter().map(|line| line.cache));
    cases.sort_by_key(|case| std::cmp::Reverse(*case));
    let families = different(times.iter().map(|line| line.family));
    let mut quantities = different(times.iter().map(|line| line.algorithm));
    quantities.sort_by_key(|quantity| labels::quantity_rank(quantity));
    let mut drawings = Vec::new();
    for quantity in &quantities {
        for case in &cases {
            for family in &families {
                let same = |line: &&TimeLine| line.algorithm == *quantity && line.cache == *case && line.family == *family;
                let lines: Vec<&TimeLine> = times.iter().filter(same).collect();
                if !lines.is_empty() {
                    drawings.push(([*quantity, case, family].map(str::to_owned).into(), against_size(overview, &lines)));
                }
            }
        }
    }
    let options = quantities.iter().map(|quantity| ((*quantity).to_owned(), labels::quantity(quantity).to_owned())).collect();
    let lists = vec![
        List { id: "time-quantity", label: "Compute", options },
        List { id: "time-case", label: "Inputs", options: cases.iter().map(|case| ((*case).to_owned(), case_words(case))).collect() },
        List::of("time-family", "Family", families.iter().copied()),
    ];
    let quantity = if quantities.contains(&OPENING) { OPENING } else { quantities.first().copied().unwrap_or_default() };
    let opening = [quantity, cases.first().copied().unwrap_or_default(), opening].map(str::to_owned).into();
    Choices { name: "time-choices", title: "Time against size", lists, opening, drawings }.made()
}

fn against_size(overview: &Overview, lines: &[&TimeLine]) -> Markup {
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let series = lines.iter().map(|line| {
        let index = next(&mut methods, line.engine);
        let name =
            joined(&[overview.engines[line.engine], labels::method(line.method), if line.scalar == "f64" { "" } else { line.scalar }]);
        let points = line.points.iter().map(|point| time(overview, line, point)).collect();
        let series = Series { dash: index, ..Series::new(name.clone(), overview.styles[line.engine].method(index), points) };
        // Robots that no parameter leads from one to the other have no growth.
        if line.family == UNRELATED {
            return Series { line: Line::Marks, ..series };
        }
        let Some(fit) = line.per_call.filter(|fit| fit.points >= FITTED) else { return series };
        let ends = line.points.first().zip(line.points.last());
        let broad = ends.map(|(first, last)| [first.size, last.size].map(|size| fitted(fit, size as f64)).into());
        Series { name: format!("{name}, p = {:.2} ± {:.2}", fit.slope, fit.error), broad: broad.unwrap_or_default(), ..series }
    });
    let quantity = lines.first().map_or("", |line| labels::quantity(line.algorithm));
    let title = joined(&["Time against size", quantity, lines.first().map_or("", |line| line.family)]);
    drawing("time-plot", &title, Axis::log("degrees of freedom nv"), Axis::log("ns per call"), series.collect())
}

fn time(overview: &Overview, line: &TimeLine, at: &TimePoint) -> Point {
    let robot = overview.robots[at.robot].name;
    let [estimate, uncounted] = flags(at.estimated, at.valid);
    let about = [
        format!("nv {}", at.size),
        format!("{} ns per call", told(at.ns)),
        format!("{} ns per joint", told(at.ns / at.joints as f64)),
        estimate,
        uncounted,
    ];
    let filters = [("study", STUDY), ("engine", overview.engines[line.engine]), ("quantity", line.algorithm), ("cache", line.cache)];
    Point {
        // The interval where the run has it, its deciles otherwise.
        upwards: [at.low.or(at.p10), at.high.or(at.p90)],
        hollow: !at.valid,
        estimated: at.estimated,
        rows: Some(Rows::of(robot_chunk(at.robot), robot, &filters)),
        ..point(robot, at.size as f64, at.ns, about)
    }
}

/// Ratios of times with their intervals, robots along the paper, by quantity and kind of inputs.
pub fn ratios(overview: &Overview, speed: &Speed) -> (Markup, Vec<Part>) {
    let cases = [("stream", case_words("stream")), ("hot", case_words("hot"))];
    let mut drawings = Vec::new();
    for [quantity, title] in &speed.quantities {
        for (case, _) in &cases {
            let own: Vec<&Ratio> = speed.ratios.iter().filter(|ratio| ratio.quantity == *quantity && ratio.cache == *case).collect();
            if !own.is_empty() {
                drawings.push(([*quantity, case].map(str::to_owned).into(), side_by_side(overview, &own, title)));
            }
        }
    }
    let options = speed.quantities.iter().map(|[quantity, title]| ((*quantity).to_owned(), (*title).to_owned())).collect();
    let lists = vec![
        List { id: "speed-quantity", label: "Compute", options },
        List {
            id: "speed-case",
            label: "Inputs",
            options: cases.iter().map(|(case, words)| ((*case).to_owned(), words.clone())).collect(),
        },
    ];
    // The quantity of which most candidates are drawn; the first of several.
    let candidates = |quantity: &str| {
        let own = speed.ratios.iter().filter(|ratio| ratio.quantity == quantity);
        own.map(|ratio| (ratio.engine, ratio.method, ratio.precision)).collect::<BTreeSet<_>>().len()
    };
    let opening = speed.quantities.iter().rev().max_by_key(|[quantity, _]| candidates(quantity));
    let opening = opening.map(|[quantity, _]| [*quantity, cases[0].0].map(str::to_owned).into()).unwrap_or_default();
    Choices { name: "speed-choices", title: "Speed, side by side", lists, opening, drawings }.made()
}

fn side_by_side(overview: &Overview, ratios: &[&Ratio], title: &str) -> Markup {
    let size = |robot: usize| overview.robots[robot].nv.unwrap_or(0);
    let mut robots: Vec<usize> = ratios.iter().map(|ratio| ratio.robot).collect();
    robots.sort_by_key(|&robot| (size(robot), robot));
    robots.dedup();
    let way = |ratio: &Ratio| (ratio.engine, ratio.method.to_owned(), ratio.precision.to_owned());
    let mut candidates = Vec::new();
    for ratio in ratios {
        if !candidates.contains(&way(ratio)) {
            candidates.push(way(ratio));
        }
    }
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let last = candidates.len().saturating_sub(1).max(1) as f64;
    let series = candidates.iter().enumerate().map(|(place, candidate)| {
        let (engine, method, precision) = candidate;
        let index = next(&mut methods, *engine);
        // Marks of one robot stand beside each other, so that their bars can be seen.
        let beside = if candidates.len() < 2 { 0.0 } else { 0.5 * (place as f64 / last - 0.5) };
        let of = |ratio: &&Ratio| {
            let at = robots.iter().position(|robot| *robot == ratio.robot).unwrap_or(0) as f64;
            let [estimate, uncounted] = flags(ratio.estimated, ratio.valid);
            let robot = overview.robots[ratio.robot].name;
            let about = [
                format!("nv {}", size(ratio.robot)),
                format!("{}{:.3} × {}", if ratio.estimated { "≈ " } else { "" }, ratio.value, ratio.reference),
                format!("[{:.3}, {:.3}]", ratio.low, ratio.high),
                estimate,
                uncounted,
            ];
            let filters = [
                ("study", STUDY),
                ("engine", overview.engines[*engine]),
                ("method", ratio.method),
                ("quantity", ratio.quantity),
                ("cache", ratio.cache),
            ];
            Point {
                upwards: [Some(ratio.low), Some(ratio.high)],
                hollow: !ratio.valid,
                estimated: ratio.estimated,
                rows: Some(Rows::of(robot_chunk(ratio.robot), robot, &filters)),
                ..point(robot, at + beside, ratio.value, about)
            }
        };
        let points = ratios.iter().filter(|ratio| way(ratio) == *candidate).map(of).collect();
        let name = joined(&[overview.engines[*engine], labels::method(method), if precision == "f64" { "" } else { precision }]);
        Series { line: Line::Marks, ..Series::new(name, overview.styles[*engine].method(index), points) }
    });
    let series: Vec<Series> = series.collect();
    let short =
        |name: &str| if name.chars().count() > NAME { name.chars().take(NAME - 1).chain(['…']).collect() } else { name.to_owned() };
    let names = robots.iter().map(|&robot| short(overview.robots[robot].name)).collect();
    let upwards = format!("{title}: times {}", ratios.first().map_or("ours", |ratio| ratio.reference));
    let bands = vec![[1.0 / (1.0 + NOISE), 1.0 + NOISE], [1.0, 1.0]];
    let plot = Plot { bands, ..Plot::new(format!("Ratios of times, {title}"), Axis::named("", names), Axis::log(upwards), series) };
    plot.drawing("speed-plot", "no ratio has a place")
}

/// Time against true error, robot by robot.
pub fn tradeoffs(overview: &Overview, points: &[Tradeoff], robots: &[(usize, usize)], opening: Option<usize>) -> (Markup, Vec<Part>) {
    let of = |&(robot, _): &(usize, usize)| {
        let own: Vec<&Tradeoff> = points.iter().filter(|point| point.robot == robot).collect();
        (vec![robot.to_string()], against_error(overview, robot, &own))
    };
    let options = robots.iter().map(|&(robot, _)| (robot.to_string(), overview.robots[robot].name.to_owned())).collect();
    let lists = vec![List { id: "tradeoff-robot", label: "Robot", options }];
    let opening = opening.map(|robot| robot.to_string()).into_iter().collect();
    let drawings = robots.iter().map(of).collect();
    Choices { name: "tradeoff-choices", title: "Work–precision of robots", lists, opening, drawings }.made()
}

/// One robot's methods; those that nothing beats are filled and joined.
fn against_error(overview: &Overview, robot: usize, points: &[&Tradeoff]) -> Markup {
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let name = overview.robots[robot].name;
    let of = |at: &&Tradeoff| {
        let engine = overview.engines[at.engine];
        let label = joined(&[engine, labels::method(at.method), if at.scalar == "f64" { "" } else { at.scalar }]);
        let about = [
            format!("{} ns per call", told(at.ns)),
            format!("median error {}", told(at.error)),
            if at.front { "unbeaten".into() } else { String::new() },
        ];
        let mark = Point {
            upwards: [at.q1, at.q3],
            across: [at.p10, at.p90],
            hollow: !at.front,
            rows: Some(Rows::of(robot_chunk(robot), name, &[("engine", engine), ("method", at.method), ("quantity", "fd")])),
            ..point(name, at.ns, at.error, about)
        };
        let index = next(&mut methods, at.engine);
        Series { line: Line::Marks, ..Series::new(label, overview.styles[at.engine].method(index), vec![mark]) }
    };
    let series: Vec<Series> = points.iter().map(of).collect();
    let front = Series { name: "front".into(), style: Style::NEUTRAL, broad: front(points), ..Series::default() };
    let title = format!("Error of {} against its time, {name}", labels::quantity("fd"));
    let all = [front].into_iter().chain(series).collect();
    drawing("tradeoff-plot", &title, Axis::log("ns per call"), errors("median relative error of forward dynamics"), all)
}

/// The corners of the front. It goes on beyond its ends: as slow as one likes at the least error, as wrong as one likes at the least time.
fn front(points: &[&Tradeoff]) -> Vec<[f64; 2]> {
    let front: Vec<[f64; 2]> = points.iter().filter(|point| point.front).map(|point| [point.ns, point.error.max(ZERO)]).collect();
    let (Some(first), Some(last)) = (front.first(), front.last()) else { return Vec::new() };
    let largest = |of: fn(&Tradeoff) -> f64| points.iter().map(|point| of(point)).fold(ZERO, larger);
    let mut way = vec![[first[0], 2.0 * largest(|point| point.error)], *first];
    for pair in front.windows(2) {
        way.extend([[pair[1][0], pair[0][1]], pair[1]]);
    }
    way.push([2.0 * largest(|point| point.ns), last[1]]);
    way
}
