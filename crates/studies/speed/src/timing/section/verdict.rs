//! The verdict on speed: who is fastest, at first sight. Our times, each engine's ratio with its interval, a map of ratios by engine and
//! quantity, and in one sentence what does not count.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::{BATCH, OWN, params};
use featherbench_report::numbers::{count, grouped, short};
use featherbench_report::{Overview, Part, TIMES, engine, labels, opener, robot};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

use super::STUDY;
use super::ratios::Ratio;
use super::speed::times;
use crate::timing::rows::RowParams;
use featherbench_bench::statistics::{LEAST, quantile_of};

/// The input regime of the verdict: another state at each call, as programs have it.
const REGIME: &str = "stream";
/// The arithmetic of the verdict.
const DOUBLE: &str = "f64";
/// Ratios nearer to 1 than this are called alike, as the paired experiment calls them.
const ALIKE: f64 = 0.02;

/// What a run says about speed.
pub struct SpeedVerdict<'a> {
    /// Robots and quantities with one of our times, by quantity, then by size.
    pub lines: Vec<Line<'a>>,
    /// Engines with a ratio, as indices of the overview.
    engines: Vec<usize>,
    /// Rows of times, ratios and controls.
    rows: usize,
    /// Those that do not count, by the kind of reason.
    void: [usize; 4],
}

/// One robot and quantity.
pub struct Line<'a> {
    pub robot: usize,
    pub quantity: &'a str,
    /// The time of our usual method.
    pub ours: &'a Row,
    /// The fastest method of each engine that answers rightly, over ours.
    pub ratios: BTreeMap<usize, Ratio<'a>>,
}

impl<'a> SpeedVerdict<'a> {
    /// Collects a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let timed: Vec<&Row> = rows.iter().filter(|row| row.study == STUDY && !row.robot.is_empty()).collect();
        let stream =
            || timed.iter().copied().filter(|row| row.cache == REGIME && row.value.is_some() && [DOUBLE, ""].contains(&&*row.precision));
        let mut ratios: BTreeMap<(&str, usize), BTreeMap<usize, Ratio>> = BTreeMap::new();
        for row in stream().filter(|row| row.metric == "ratio" && row.engine != OWN) {
            let Some(ratio) = Ratio::of(overview, row) else { continue };
            let known = ratios.entry((&row.quantity, ratio.robot)).or_default();
            // What counts is before what does not, then the fastest.
            let better = |old: &Ratio| (!ratio.valid, ratio.value) < (!old.valid, old.value);
            if known.get(&ratio.engine).is_none_or(better) {
                known.insert(ratio.engine, ratio);
            }
        }
        let mut ours: BTreeMap<(&str, usize), &Row> = BTreeMap::new();
        for row in stream().filter(|row| row.metric == "ns_per_call" && row.engine == OWN && row.method != BATCH) {
            let Some(robot) = overview.robot(&row.robot) else { continue };
            let key = (row.quantity.as_str(), robot);
            let usual = |row: &Row| {
                let name = format!("{OWN} {}", row.method);
                ratios.get(&key).is_some_and(|ratios| ratios.values().any(|ratio| ratio.reference == name))
            };
            let better = |old: &&Row| (!usual(row), row.value) < (!usual(old), old.value);
            if ours.get(&key).is_none_or(better) {
                ours.insert(key, row);
            }
        }
        let line = |((quantity, robot), ours): ((&'a str, usize), &'a Row)| Line {
            robot,
            quantity,
            ours,
            ratios: ratios.remove(&(quantity, robot)).unwrap_or_default(),
        };
        let mut lines: Vec<Line> = ours.into_iter().map(line).collect();
        lines.sort_by_key(|line| (labels::quantity_rank(line.quantity), overview.robots[line.robot].nv, line.robot));
        let engines: BTreeSet<usize> = lines.iter().flat_map(|line| line.ratios.keys().copied()).collect();
        Self { lines, engines: engines.into_iter().collect(), rows: counted(&timed).count(), void: void(&timed) }
    }

    /// Quantities in their order.
    fn quantities(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = self.lines.iter().map(|line| line.quantity).collect();
        names.dedup();
        names
    }

    /// The median over the robots of an engine's valid ratios, the number of robots, and whether one is an estimate.
    pub fn median(&self, engine: usize, quantity: &str) -> Option<(f64, usize, bool)> {
        let of_engine = self.lines.iter().filter(|line| line.quantity == quantity).filter_map(|line| line.ratios.get(&engine));
        let valid: Vec<&Ratio> = of_engine.filter(|ratio| ratio.valid).collect();
        let values: Vec<f64> = valid.iter().map(|ratio| ratio.value).collect();
        (!values.is_empty()).then(|| (quantile_of(&values, 0.5), values.len(), valid.iter().any(|ratio| ratio.estimated)))
    }

    /// The engines and quantities of the map, each with [`SpeedVerdict::median`]; engines without one are left out.
    pub fn map(&self) -> (Vec<usize>, Vec<&'a str>) {
        let (engines, quantities) = (self.engines.iter().copied(), self.quantities());
        let some = |engine: usize, quantity: &str| self.median(engine, quantity).is_some();
        let engines: Vec<usize> = engines.filter(|&engine| quantities.iter().any(|quantity| some(engine, quantity))).collect();
        let quantities = quantities.into_iter().filter(|quantity| engines.iter().any(|&engine| some(engine, quantity))).collect();
        (engines, quantities)
    }

    /// How often ours is faster, alike or slower than the fastest other engine, over robots and quantities whose numbers count. Estimates,
    /// which are rather too long, decide nothing here.
    pub fn headline(&self) -> String {
        let timed = |line: &&Line| line.ratios.values().any(|ratio| !ratio.estimated);
        let all = self.lines.iter().filter(timed).count();
        if all == 0 {
            let estimated = self.lines.iter().any(|line| !line.ratios.is_empty());
            let others = if estimated { "others by estimates alone" } else { "no other engine" };
            return format!("This run timed featherbench, and {others}; the table of engines has recorded times");
        }
        let counts = |ratio: &&Ratio| ratio.valid && !ratio.estimated;
        let fastest = |line: &Line| line.ratios.values().filter(counts).map(|ratio| ratio.value).min_by(f64::total_cmp);
        let best: Vec<f64> = self.lines.iter().filter_map(fastest).collect();
        if best.is_empty() {
            return format!("None of the {} with another engine counts", count(all, "ratio"));
        }
        let number = |holds: fn(f64) -> bool| grouped(best.iter().filter(|&&ratio| holds(ratio)).count());
        format!(
            "Of {} robots and quantities with times of others, {} count: ours is the fastest for {}, within 2 % of the fastest other for {}, slower for {}",
            grouped(all),
            grouped(best.len()),
            number(|ratio| ratio > 1.0 + ALIKE),
            number(|ratio| (1.0 - ALIKE..=1.0 + ALIKE).contains(&ratio)),
            number(|ratio| ratio < 1.0 - ALIKE)
        )
    }

    /// What does not count, and why: one sentence.
    pub fn void_words(&self) -> String {
        let all: usize = self.void.iter().sum();
        let whys = [
            "the answers are missing or wrong",
            "the A/A control of their experiment is far from 1",
            "too many A/A controls of their robot are far from 1",
            "the core was at its fastest in too few processes",
        ];
        let parts: Vec<(usize, &str)> = self.void.into_iter().zip(whys).filter(|(number, _)| *number > 0).collect();
        let words = match &parts[..] {
            [] => return format!("All {} on speed count.", count(self.rows, "row")),
            [(_, why)] => format!("because {why}"),
            many => many.iter().map(|(number, why)| format!("{} because {why}", grouped(*number))).collect::<Vec<_>>().join(", "),
        };
        format!("{} of {} on speed do not count, {words}.", grouped(all), count(self.rows, "row"))
    }

    /// One robot's times in a sentence: of the robots with most quantities the middle one by size.
    pub fn first_times(&self, overview: &Overview) -> Option<Markup> {
        let mut robots: BTreeMap<usize, Vec<&Line>> = BTreeMap::new();
        for line in &self.lines {
            robots.entry(line.robot).or_default().push(line);
        }
        let most = robots.values().map(Vec::len).max()?;
        let mut full: Vec<(usize, Vec<&Line>)> = robots.into_iter().filter(|(_, lines)| lines.len() == most).collect();
        full.sort_by_key(|(robot, _)| overview.robots[*robot].nv);
        let (robot, lines) = full.swap_remove(full.len() / 2);
        let about = &overview.robots[robot];
        Some(html! {
            div #time-first {
                p.lead { "Ours on " b { (about.name) } @if let Some(nv) = about.nv { " (nv " (nv) ")" } ":" }
                dl { @for line in lines { div { dt { (labels::quantity(line.quantity)) } dd { (time(line.ours)) } } } }
            }
        })
    }

    /// Writes the verdict, and the table that it opens; nothing without a time.
    pub fn markup(&self, overview: &Overview) -> Option<(Markup, Part)> {
        if self.lines.is_empty() {
            return None;
        }
        let part = Part {
            name: "speed-by-robot".into(),
            title: "Times by robot and quantity".into(),
            body: html! { div.scroll.tall { (self.table(overview)) } },
        };
        let verdict = html! {
            div #speed-verdict {
                h3 { "How fast" }
                p { b { (self.headline()) } ". " (self.void_words()) " " a href="#time" { "More on times" } "." }
                (self.heat(overview))
                details {
                    summary { "By robot and quantity: our time, and each engine over it" }
                    (part.place())
                }
            }
        };
        Some((verdict, part))
    }

    fn heat(&self, overview: &Overview) -> Markup {
        let (engines, quantities) = self.map();
        html! {
            @if !engines.is_empty() {
                div.scroll { table.compact.speed-map {
                    thead { tr {
                        th scope="col" { "engine" }
                        @for quantity in &quantities { th.number scope="col" { (labels::quantity(quantity)) } }
                    } }
                    tbody {
                        @for &engine in &engines {
                            tr {
                                th scope="row" { (self::engine(overview, overview.engines[engine])) }
                                @for &quantity in &quantities {
                                    @match self.median(engine, quantity) {
                                        Some((median, robots, estimated)) => td class={ "number " (step(median)) } title={ "median over " (count(robots, "robot")) } {
                                            (opener(TIMES, &[("engine", overview.engines[engine]), ("quantity", quantity), ("cache", REGIME), ("metric", "ratio")],
                                                &format!("{}{}", if estimated { "≈\u{202f}" } else { "" }, ratio_words(median))))
                                        },
                                        None => td.number.none { "–" },
                                    }
                                }
                            }
                        }
                    }
                } }
                p.note { "The time of an engine's fastest method over that of our usual one, median over the robots, another state at each call. Above 1 (blue) ours is faster, below 1 (orange) the other. ≈: called through Python, an estimate." }
            }
        }
    }

    fn table(&self, overview: &Overview) -> Markup {
        html! {
            table.compact.sortable.speed-map #speed-by-robot {
                thead { tr {
                    th scope="col" { "compute" } th scope="col" { "robot" } th.number scope="col" { "nv" } th.number scope="col" { "ours" }
                    @for &engine in &self.engines { th.number scope="col" { (overview.engines[engine]) " / ours" } }
                } }
                tbody {
                    @for line in &self.lines {
                        tr {
                            th scope="row" { (labels::quantity(line.quantity)) } td { (robot(overview, overview.robots[line.robot].name)) }
                            td.number { @if let Some(nv) = overview.robots[line.robot].nv { (nv) } }
                            td.number.void[!line.ours.valid] { (time(line.ours)) }
                            @for engine in &self.engines {
                                @match line.ratios.get(engine) {
                                    Some(ratio) => td class={ "number " (if ratio.valid { step(ratio.value) } else { "void" }) } {
                                        @if ratio.estimated { "≈\u{202f}" }
                                        (times(ratio.value)) " " small { "[" (times(ratio.low)) ", " (times(ratio.high)) "]" }
                                    },
                                    None => td.number.none { "–" },
                                }
                            }
                        }
                    }
                }
            }
            p.note { "Intervals are 95 %. Colours as above: blue, ours is faster; orange, the other. Struck out: does not count." }
        }
    }
}

/// The rows that may not count.
fn counted<'r, 'a: 'r>(timed: &'r [&'a Row]) -> impl Iterator<Item = &'a Row> + 'r {
    timed.iter().copied().filter(|row| ["ns_per_call", "ratio", "control"].contains(&&*row.metric) && row.value.is_some())
}

/// The rows that do not count: by their answers, by the A/A control of their experiment, by those of their robot, by the core's state.
fn void(timed: &[&Row]) -> [usize; 4] {
    let wrong: BTreeSet<[&str; 4]> = timed
        .iter()
        .filter(|row| row.metric == "worst_error" && row.verdict != Verdict::Pass)
        .map(|row| [&*row.robot, &*row.quantity, &*row.engine, &*row.method])
        .collect();
    let experiment = |row: &&'_ Row| -> [String; 3] { [row.robot.clone(), row.quantity.clone(), row.cache.clone()] };
    let loud: BTreeSet<[String; 3]> = timed.iter().filter(|row| row.metric == "control" && !row.valid).map(experiment).collect();
    let unsteady = |row: &Row| params::of_row::<RowParams>(row).and_then(|params| params.fastest).is_some_and(|fastest| fastest < LEAST);
    let mut kinds = [0; 4];
    for row in counted(timed).filter(|row| !row.valid) {
        let kind = if wrong.contains(&[&*row.robot, &*row.quantity, &*row.engine, &*row.method]) {
            0
        } else if unsteady(row) {
            3
        } else if loud.contains(&experiment(&row)) {
            1
        } else {
            2
        };
        kinds[kind] += 1;
    }
    kinds
}

/// A time with its interval, to the digit that the interval leaves: `312 ns [308, 317]`.
fn time(row: &Row) -> String {
    let Some(ns) = row.value else { return "– ns".into() };
    let Some((low, high)) = row.ci_low.zip(row.ci_high).filter(|(low, high)| low < high) else { return format!("{} ns", short(ns)) };
    let digit = (0.5 * (high - low)).log10().floor() as i32;
    let held = |value: f64| {
        let unit = 10.0_f64.powi(digit);
        format!("{:.*}", (-digit).clamp(0, 9) as usize, (value / unit).round() * unit)
    };
    format!("{} ns [{}, {}]", held(ns), held(low), held(high))
}

/// A ratio in a small cell.
fn ratio_words(ratio: f64) -> String {
    if ratio >= 10.0 { format!("{ratio:.0}") } else { format!("{ratio:.2}") }
}

/// The colour of a ratio: darker the farther from 1.
fn step(ratio: f64) -> &'static str {
    match ratio {
        r if r < 0.67 => "behind2",
        r if r < 1.0 - ALIKE => "behind1",
        r if r <= 1.0 + ALIKE => "alike",
        r if r < 1.5 => "ahead1",
        r if r < 3.0 => "ahead2",
        _ => "ahead3",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_the_digits_that_its_interval_leaves() {
        let told = |value: f64, low: f64, high: f64| time(&Row::default().measured(value, low, high));
        assert_eq!(told(19581.0, 18970.0, 20211.0), "19600 ns [19000, 20200]");
        assert_eq!(told(762.4, 760.9, 763.8), "762 ns [761, 764]");
        assert_eq!(told(33.512, 33.487, 33.541), "33.51 ns [33.49, 33.54]");
        assert_eq!(told(0.8, 0.2, 3.0), "1 ns [0, 3]");
        assert_eq!(told(100.0, 100.0, 100.0), "100 ns");
        assert_eq!(time(&Row::default()), "– ns");
    }
}
