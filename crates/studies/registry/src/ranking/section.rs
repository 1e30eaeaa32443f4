//! Section: the ranking as a table of the page and of the terminal, and the figure of error against time.

use featherbench_bench::OWN;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Line, Point, Series, style};
use featherbench_report::numbers::{aligned, count, grouped, short};
use featherbench_report::{Lead, Overview, Part, Section, engine, labels, robot};
use featherbench_results::{Errors, Ranked, Ranking, Row, RunInfo, Times};
use featherbench_speed::disturbed;
use featherbench_study::figures::{drawing, errors};
use maud::{Markup, html};

use super::machines::recorded;
use super::{QUANTITIES, TIMED, ranking};

/// The spacing of doubles at one: errors are multiples of it.
const EPSILON: f64 = f64::EPSILON;
/// No value.
pub(super) const NONE: &str = "–";
/// What the quantities are called in narrow columns.
pub(super) const NARROW: [&str; TIMED.len()] = ["FD", "ID", "M", "∂FD"];

/// Makes the section; a run without errors and times of engines has none.
pub(crate) fn section(run: &RunInfo, rows: &[Row], overview: &Overview) -> Option<Section> {
    let ranking = ranking(run, rows);
    if ranking.engines.iter().all(|engine| engine.errors.is_empty() && engine.times.is_empty()) {
        return None;
    }
    let (drawn, mut parts) = figure(&ranking);
    let (recorded, of_machines) = recorded(overview, &run.recorded_times);
    parts.extend(of_machines);
    let note = note(disturbed(run, rows), &ranking);
    let lead = Lead { body: html! { (table(&note, overview, &ranking)) (drawn) }, lines: lines(&note, &ranking) };
    let body = html! {
        section #engines {
            h2 { "Engines" }
            p.lead { (coded(&note)) }
            div.scroll { (whole(overview, &ranking)) }
            (recorded)
        }
    };
    Some(Section { lead: Some(lead), parts, style: include_str!("ranking.css"), ..Section::new("engines", "Engines", body) })
}

/// `99.6 %`: to the digit that tells that not all are right.
fn share(right: usize, asked: usize) -> String {
    let percent = 100.0 * right as f64 / asked as f64;
    match asked - right {
        0 => "100 %".into(),
        _ if percent > 99.9 => "> 99.9 %".into(),
        _ => format!("{percent:.1} %"),
    }
}

fn right(engine: &Ranked) -> String {
    if engine.asked == 0 { NONE.into() } else { format!("{} of {}", share(engine.right, engine.asked), grouped(engine.asked)) }
}

/// An error in units of rounding.
fn units(error: f64) -> String {
    short(error / EPSILON)
}

/// A ratio of times: two digits, as more do not hold from machine to machine.
pub(super) fn ratio(median: f64, estimated: bool) -> String {
    format!("{}{}", if estimated { "≈\u{202f}" } else { "" }, short(median))
}

fn ratio_of(times: &Times) -> String {
    ratio(times.median, times.estimated)
}

/// The table of the first page: a line for each engine.
fn table(note: &str, overview: &Overview, ranking: &Ranking) -> Markup {
    let ranked = ranking.engines.iter();
    html! {
        div.scroll.of-ranking { table.compact.ranking #ranking {
            thead {
                tr {
                    th scope="col" rowspan="2" { "engine" } th scope="col" rowspan="2" { "right" }
                    th scope="colgroup" colspan=(QUANTITIES.len()) { "error, in units of rounding 2⁻⁵²" }
                    th scope="colgroup" colspan=(TIMED.len()) { "time over ours" }
                    th scope="col" rowspan="2" { "gravest finding" }
                }
                tr {
                    @for (quantity, short) in QUANTITIES.iter().chain(&TIMED).zip(NARROW[..QUANTITIES.len()].iter().chain(&NARROW)) {
                        th.number scope="col" title=(labels::quantity(quantity)) { (short) }
                    }
                }
            }
            tbody { @for of in ranked {
                tr {
                    th scope="row" { (engine(overview, &of.name)) " " small { (of.version) } }
                    td data-of="right" { b { (if of.asked == 0 { NONE.to_owned() } else { share(of.right, of.asked) }) } @if of.asked > 0 { " " small { "of " (grouped(of.asked)) } } }
                    @for (quantity, short) in QUANTITIES.into_iter().zip(NARROW) { td.number data-of={ (short) ", error" } { (error_cell(of.errors.get(quantity), overview)) } }
                    @for (quantity, short) in TIMED.into_iter().zip(NARROW) { td.number data-of={ (short) ", time" } { (time_cell(of, quantity)) } }
                    td.gravest { (of.gravest) }
                }
            } }
        } }
        p.note { (coded(note)) " " a href="#engines" { "Every number" } "." }
    }
}

fn error_cell(errors: Option<&Errors>, overview: &Overview) -> Markup {
    html! {
        @match errors {
            None => span.none { (NONE) },
            Some(errors) => {
                b { (units(errors.median)) }
                small { "worst " (units(errors.worst)) " on " (robot(overview, &errors.worst_robot)) }
            }
        }
    }
}

fn time_cell(of: &Ranked, quantity: &str) -> Markup {
    html! {
        @match of.times.get(quantity) {
            _ if of.name == OWN => b { "1" },
            None => span.none { (NONE) },
            Some(times) => {
                b { (ratio_of(times)) }
                small { (short(times.least)) " to " (short(times.most)) }
            }
        }
    }
}

/// What the numbers are, in two or three sentences, and what disturbed the times.
fn note(disturbed: Option<String>, ranking: &Ranking) -> String {
    let most = |number: fn(&Errors) -> usize| ranking.engines.iter().flat_map(|of| of.errors.values()).map(number).max();
    let mut text = String::new();
    if let Some((robots, states)) = most(|errors| errors.robots).zip(most(|errors| errors.states)) {
        text = format!(
            "Right: answers within their bound, of all questions that have one. FD: forward dynamics. ID: inverse dynamics. M: mass matrix. ∂FD: ∂FD/∂q. \
             Errors are against the truth in 32 digits, in units of 2⁻⁵²: the median of up to {} at {}, and the worst robot.",
            count(robots, "robot"),
            count(states, "state")
        );
    }
    let times = || ranking.engines.iter().filter(|of| of.name != OWN).flat_map(|of| of.times.values());
    let robots = times().map(|times| times.robots).max().map(|robots| count(robots, "robot"));
    let machines = times().map(|times| times.machines).max();
    text += &match (machines, robots) {
        (None, _) | (_, None) => " No time of another engine counts here: `run --suite timing --live` measures them.".to_owned(),
        (Some(0), Some(robots)) => {
            format!(" Times are medians over up to {robots}, with the least and the most; measured on this machine.")
        }
        (Some(machines), Some(robots)) => format!(
            " Times are medians over up to {robots}, with the least and the most. What this run did not measure was recorded on {}; `run --suite timing --live` measures all.",
            count(machines, "other machine")
        ),
    };
    text + &disturbed.map(|sentences| format!(" {sentences}")).unwrap_or_default()
}

/// A text in which what stands between backticks is code.
fn coded(text: &str) -> Markup {
    html! { @for (index, part) in text.split('`').enumerate() { @if index % 2 == 1 { code { (part) } } @else { (part) } } }
}

/// Every number of the ranking.
fn whole(overview: &Overview, ranking: &Ranking) -> Markup {
    let heads = ["method", "robots", "states", "median error", "worst", "on", "most over the bound", "time over ours", "robots timed"];
    html! {
        table.compact.sortable {
            thead { tr { th scope="col" { "engine" } th scope="col" { "compute" } @for head in heads { th scope="col" { (head) } } } }
            tbody {
                @for of in &ranking.engines {
                    @for quantity in TIMED {
                        @let (errors, times) = (of.errors.get(quantity), of.times.get(quantity));
                        @if errors.is_some() || times.is_some() {
                            tr {
                                th scope="row" { (engine(overview, &of.name)) }
                                td { (labels::quantity(quantity)) }
                                @if let Some(errors) = errors {
                                    td { (errors.method) } td.number { (errors.robots) } td.number { (grouped(errors.states)) }
                                    td.number { (units(errors.median)) } td.number { (units(errors.worst)) } td { (robot(overview, &errors.worst_robot)) }
                                    td.number { @match errors.of_bound { Some(times) => (short(times)), None => (NONE) } }
                                } @else { td colspan="7" { "no error in this run" } }
                                @if let Some(times) = times {
                                    td.number { (ratio_of(times)) @if times.machines > 0 { " (recorded)" } } td.number { (times.robots) }
                                } @else { td.number { (NONE) } td.number { "0" } }
                            }
                        }
                    }
                }
            }
        }
        p.note { "The conditioning bound is the error that half a unit of rounding in the inputs can make. Ours over ours is 1." }
    }
}

/// Error against time, a mark for each engine, by quantity.
fn figure(ranking: &Ranking) -> (Markup, Vec<Part>) {
    let mut drawings = Vec::new();
    for quantity in QUANTITIES {
        let mark = |of: &Ranked| {
            let (errors, times) = of.errors.get(quantity).zip(of.times.get(quantity))?;
            let about = vec![
                format!("error {} units, worst {} on {}", units(errors.median), units(errors.worst), errors.worst_robot),
                format!("time over ours {}, {} to {}", ratio_of(times), short(times.least), short(times.most)),
            ];
            let point = Point {
                upwards: [None, Some(errors.worst)],
                across: [Some(times.least), Some(times.most)],
                estimated: times.estimated,
                about,
                ..Point::new(of.name.clone(), times.median, errors.median)
            };
            Some(Series { line: Line::Marks, ..Series::new(of.name.clone(), style(&of.name), vec![point]) })
        };
        let marks: Vec<Series> = ranking.engines.iter().filter_map(mark).collect();
        // One mark alone compares nothing.
        if marks.len() > 1 {
            let title = format!("Error against time, {}", labels::quantity(quantity));
            let (x, y) = (Axis::log("time over ours, median over robots"), errors("error, median and worst over robots"));
            drawings.push((vec![quantity.to_owned()], drawing("ranking-plot", &title, x, y, marks)));
        }
    }
    let Some((opening, _)) = drawings.first() else { return (html! {}, Vec::new()) };
    let options = drawings.iter().map(|(choice, _)| (choice[0].clone(), labels::quantity(&choice[0]).to_owned())).collect();
    let (opening, lists) = (opening.clone(), vec![List { id: "ranking-quantity", label: "Compute", options }]);
    Choices { name: "ranking-choices", title: "Error against time", lists, opening, drawings }.made()
}

/// The table of the terminal.
fn lines(note: &str, ranking: &Ranking) -> Vec<String> {
    let heads = ["engine", "right", "FD error", "worst", "on", "time FD", "ID", "M", "∂FD", "gravest finding"].map(str::to_owned);
    let line = |of: &Ranked| {
        let errors = of.errors.get("fd");
        let error = |text: fn(&Errors) -> String| errors.map_or_else(|| NONE.to_owned(), text);
        let time =
            |quantity: &str| if of.name == OWN { "1".to_owned() } else { of.times.get(quantity).map_or_else(|| NONE.to_owned(), ratio_of) };
        [
            format!("{} {}", of.name, of.version).trim_end().to_owned(),
            right(of),
            error(|errors| units(errors.median)),
            error(|errors| units(errors.worst)),
            error(|errors| errors.worst_robot.clone()),
            time("fd"),
            time("id"),
            time("mass_matrix"),
            time("fd_dq"),
            of.gravest.clone(),
        ]
    };
    let table: Vec<_> = std::iter::once(heads).chain(ranking.engines.iter().map(line)).collect();
    let mut lines: Vec<String> = aligned(&table, &[0, 1, 4, 9]).into_iter().map(|line| format!("  {line}")).collect();
    lines.push(format!("  {note}"));
    lines
}
