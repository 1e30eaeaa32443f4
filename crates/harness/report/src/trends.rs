//! Trends over the runs of a suite: lines for each engine and for each robot, engine upgrades, and change points.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{BESIDE, ChangePoint, ERROR_FACTOR, ERROR_FLOOR, Row, TIME_NOISE, Trend, Trended, Verdict, trends};
use maud::{Markup, PreEscaped, html};

use crate::changes::{Side, versions};
use crate::figure::{Axis, Plot, Point, Series, style};
use crate::labels;
use crate::numbers::{count, larger, short};

/// Change points that are listed.
const LISTED: usize = 30;

/// The trends of a suite; nothing for one run.
pub(crate) fn section(suite: &str, runs: &[Side]) -> Markup {
    let [_, .., _] = runs else { return html! {} };
    let machines: Vec<String> = runs.iter().map(|run| format!("{}, {}", run.info.host.cpu, run.info.host.cores)).collect();
    let rows: Vec<&[Row]> = runs.iter().map(|run| run.rows).collect();
    let all = trends(&rows, &machines);
    let events = upgrades(runs);
    let robots: BTreeSet<&str> = all.iter().map(|trend| trend.row.robot.as_str()).filter(|robot| !robot.is_empty()).collect();
    html! {
        section {
            h2 { "Trends of suite " (suite) " over " (count(runs.len(), "run")) }
            p.lead {
                "Each line is a geometric mean over the numbers that all runs have, so that it compares the same numbers. Times are of the last run's "
                "machine. A dashed line marks an engine of another version."
            }
            (changes(&all, runs))
            (drawn(&errors(&all.iter().collect::<Vec<_>>(), runs.len()), "Error", "geometric mean of the errors", &events))
            (drawn(&times(&all.iter().collect::<Vec<_>>()), "Time", "geometric mean of the times, ns", &events))
            (drawn(&unpassed(runs), "Rows that do not pass", "rows", &events))
            @if !robots.is_empty() {
                details {
                    summary { "The history of each of " (count(robots.len(), "robot")) }
                    @for robot in robots {
                        @let of: Vec<&Trend> = all.iter().filter(|trend| trend.row.robot == robot).collect();
                        h3 { (robot) }
                        (drawn(&errors(&of, runs.len()), &format!("Error, {robot}"), "geometric mean of the errors", &events))
                        (drawn(&times(&of), &format!("Time, {robot}"), "geometric mean of the times, ns", &events))
                    }
                }
            }
        }
    }
}

/// The line of each engine: places of runs, and values.
type Lines = BTreeMap<String, Vec<(usize, f64)>>;

/// Geometric means over the trends of each engine that are in `due` runs. All of them have the same runs then.
fn means<'a>(all: impl Iterator<Item = &'a Trend<'a>>, due: usize, value: fn(f64) -> f64) -> Lines {
    let mut of_engine: BTreeMap<&str, Vec<&Trend>> = BTreeMap::new();
    for trend in all.filter(|trend| trend.points.len() == due) {
        of_engine.entry(&trend.row.engine).or_default().push(trend);
    }
    let line = |trends: &[&Trend]| {
        (0..due)
            .filter_map(|place| Some((trends.first()?.points.get(place)?.run, place)))
            .map(|(run, place)| {
                let logs = trends.iter().filter_map(|trend| trend.points.get(place)).map(|point| value(point.value).ln());
                (run, (logs.sum::<f64>() / trends.len() as f64).exp())
            })
            .collect()
    };
    of_engine.into_iter().map(|(engine, trends)| (engine.to_owned(), line(&trends))).collect()
}

fn errors<'a>(all: &[&'a Trend<'a>], runs: usize) -> Lines {
    let floored = |error: f64| larger(error.abs(), ERROR_FLOOR);
    means(all.iter().copied().filter(|trend| trend.kind == Trended::Error && trend.row.bound.is_some()), runs, floored)
}

fn times<'a>(all: &[&'a Trend<'a>]) -> Lines {
    let of = || all.iter().copied().filter(|trend| trend.kind == Trended::Time && trend.row.metric == "ns_per_call");
    let due = of().map(|trend| trend.points.len()).max().unwrap_or(0);
    means(of().filter(|trend| trend.points.iter().all(|point| point.value > 0.0)), due, |time| time)
}

/// How many rows of each engine fail, have no answer or deviate as is known.
fn unpassed(runs: &[Side]) -> Lines {
    let bad = |row: &&Row| matches!(row.verdict, Verdict::Fail | Verdict::Error | Verdict::Deviation);
    let engines: BTreeSet<&str> = runs.iter().flat_map(|run| run.rows).filter(bad).map(|row| row.engine.as_str()).collect();
    let number = |run: &Side, engine: &str| run.rows.iter().filter(bad).filter(|row| row.engine == engine).count() as f64;
    engines
        .into_iter()
        .filter(|engine| !engine.is_empty())
        .map(|engine| (engine.to_owned(), runs.iter().enumerate().map(|(place, run)| (place, number(run, engine))).collect()))
        .collect()
}

/// The runs with an engine of another version than in the run before.
fn upgrades(runs: &[Side]) -> Vec<(f64, String)> {
    let of = |(place, pair): (usize, &[Side])| {
        let named = pair[1]
            .info
            .engines
            .iter()
            .filter(|engine| pair[0].info.engines.iter().any(|before| before.name == engine.name && before.version != engine.version));
        named.map(move |engine| (place as f64 + 2.0, format!("{} {}", engine.name, engine.version))).collect::<Vec<_>>()
    };
    runs.windows(2).enumerate().flat_map(of).collect()
}

/// A figure of lines; nothing without a point.
fn drawn(lines: &Lines, title: &str, unit: &str, events: &[(f64, String)]) -> Markup {
    let series = lines.iter().map(|(engine, values)| {
        let points = values.iter().map(|&(run, value)| Point::new(format!("run {}", run + 1), run as f64 + 1.0, value)).collect();
        Series::new(engine, style(engine), points)
    });
    let counted = unit == "rows";
    let upwards = if counted { Axis::linear(unit) } else { Axis::log(unit) };
    let plot = Plot::new(title, Axis::linear("run, in the order of their start"), upwards, series.collect());
    html! {
        @if let Some(figure) = plot.figure_with("trend", String::new(), events) {
            figure.drawn { figcaption { (title) } (PreEscaped(figure.svg)) }
        }
    }
}

/// The change points, those that are confirmed first, then from the largest factor.
fn changes(all: &[Trend], runs: &[Side]) -> Markup {
    let mut found: Vec<(&Trend, ChangePoint)> =
        all.iter().flat_map(|trend| trend.change_points().into_iter().map(move |point| (trend, point))).collect();
    let size = |point: &ChangePoint| if point.factor.is_finite() && point.factor > 0.0 { point.factor.ln().abs() } else { f64::INFINITY };
    found.sort_by(|(_, a), (_, b)| b.confirmed.cmp(&a.confirmed).then_with(|| size(b).total_cmp(&size(a))));
    let confirmed = found.iter().filter(|(_, point)| point.confirmed).count();
    html! {
        h3 { "Change points: " (confirmed) " confirmed, " (found.len() - confirmed) " not yet" }
        p.note {
            "A change point lies between two runs if each of the last " (BESIDE) " values before it is apart from each of the first " (BESIDE)
            " after it, on the same side; so one run out of line is none. Times are apart when their intervals are and their ratio is beyond "
            (format!("{:.0} %", 100.0 * TIME_NOISE)) ", errors by a factor of " (ERROR_FACTOR) ", counts when they differ. Confirmed: there are " (BESIDE) " values on each side."
        }
        (listed(&found[..confirmed], runs))
        @if found.len() > confirmed {
            details { summary { (found.len() - confirmed) " not yet confirmed" } (listed(&found[confirmed..], runs)) }
        }
    }
}

/// Change points as a table; those of the largest factors if there are many.
fn listed(found: &[(&Trend, ChangePoint)], runs: &[Side]) -> Markup {
    html! {
        @if !found.is_empty() {
            div.scroll { table.compact {
                thead { tr {
                    th scope="col" { "first run after" } th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "quantity" }
                    th.number scope="col" { "factor" } th scope="col" { "with it" }
                } }
                tbody { @for (trend, point) in found.iter().take(LISTED) { (change(trend, point, runs)) } }
            } }
            @if found.len() > LISTED { p.note { (found.len() - LISTED) " more have smaller factors." } }
        }
    }
}

fn change(trend: &Trend, point: &ChangePoint, runs: &[Side]) -> Markup {
    let (row, old, new) = (trend.row, &runs[point.before], &runs[point.after]);
    // Only what was renewed of its own engine: others cannot be the cause.
    let of_engine = |words: &String| words.starts_with(&format!("{}:", row.engine)) || words.starts_with(&format!("{} ", row.engine));
    let renewed: Vec<String> = versions(old.info, new.info).into_iter().filter(of_engine).collect();
    let revision = |side: &Side| side.info.git.revision.chars().take(10).collect::<String>();
    let revised = (revision(old) != revision(new)).then(|| format!("revision {}", revision(new)));
    html! {
        tr {
            th scope="row" { (new.info.started) " (run " (point.after + 1) ")" }
            td { (row.robot) } td { (row.engine) " " (row.method) } td { (labels::error(&row.quantity, &row.metric)) }
            td.number { @if point.factor.is_finite() { (short(point.factor)) } @else { "–" } }
            td { (renewed.into_iter().chain(revised).collect::<Vec<_>>().join(" ")) }
        }
    }
}
