//! Comparison with the truth, in sentences: which engine and method passes its gates, which does not, and where.

use std::collections::BTreeMap;

use featherbench_report::numbers::{count, decades, larger, listed, short};
use featherbench_report::{Overview, engine, labels, opener, robot, sentence, worst_first};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

use super::data::{Accuracy, is_judged, rank, shown_quantity};

/// Number of sentences of one kind in the head of the page.
const TOLD: usize = 6;
/// Number of robots that a sentence names.
const NAMED: usize = 4;

/// One engine's method on one quantity: the row that decides for each of its robots.
type Account<'a> = BTreeMap<usize, &'a Row>;

/// The answers that pass every gate on a quantity.
struct Kept<'a> {
    quantity: &'a str,
    /// Each engine, with its methods if not all of them pass.
    answers: Vec<(&'a str, String)>,
    /// The fewest and the most robots of any answer.
    robots: (usize, usize),
    largest: f64,
}

/// Methods of one engine that fail gates on the same robots.
struct Missed<'a> {
    engine: &'a str,
    methods: Vec<&'a str>,
    quantity: &'a str,
    robots: Vec<&'a str>,
    of: usize,
    worst: &'a Row,
}

/// The engines' results against the truth.
pub struct Truth<'a> {
    kept: Vec<Kept<'a>>,
    failed: Vec<Missed<'a>>,
    known: Vec<Missed<'a>>,
    /// The largest median error of forward dynamics on any robot, per method, smallest first.
    medians: Vec<(usize, f64)>,
}

impl<'a> Truth<'a> {
    /// Collects a run's rows.
    pub fn of(overview: &Overview<'a>, accuracy: &Accuracy<'a>, rows: &'a [Row]) -> Self {
        let mut accounts: BTreeMap<((usize, &str), usize, &str), Account> = BTreeMap::new();
        for row in rows.iter().filter(|row| is_judged(row)) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            let account = accounts.entry((rank(shown_quantity(&row.quantity)), engine, &row.method)).or_default();
            let worst = account.entry(robot).or_insert(row);
            if worst_first(row) < worst_first(worst) {
                *worst = row;
            }
        }
        let missed = |miss: fn(&Row) -> bool| -> Vec<Missed<'a>> {
            let mut groups: BTreeMap<_, Missed> = BTreeMap::new();
            for ((quantity, engine, method), account) in &accounts {
                let rows: Vec<(usize, &Row)> = account.iter().filter(|(_, row)| miss(row)).map(|(&robot, &row)| (robot, row)).collect();
                let Some(worst) = rows.iter().map(|&(_, row)| row).min_by_key(|row| worst_first(row)) else { continue };
                let robots: Vec<usize> = rows.iter().map(|&(robot, _)| robot).collect();
                let group = groups.entry((*quantity, *engine, robots.clone())).or_insert_with(|| Missed {
                    engine: overview.engines[*engine],
                    methods: Vec::new(),
                    quantity: quantity.1,
                    robots: robots.iter().map(|&robot| overview.robots[robot].name).collect(),
                    of: account.len(),
                    worst,
                });
                group.methods.push(*method);
                if worst_first(worst) < worst_first(group.worst) {
                    group.worst = worst;
                }
            }
            let mut groups: Vec<Missed> = groups.into_values().collect();
            groups.sort_by_key(|group| worst_first(group.worst));
            groups
        };
        let failed = missed(|row| matches!(row.verdict, Verdict::Fail | Verdict::Error));
        // A known error (a singular M) is not an answer that could be compared with the truth.
        let known = missed(|row| row.verdict == Verdict::Deviation && row.value.is_some());
        let kept = kept(overview, &accounts);
        Self { kept, failed, known, medians: medians(accuracy) }
    }
}

fn kept<'a>(overview: &Overview<'a>, accounts: &BTreeMap<((usize, &'a str), usize, &'a str), Account<'a>>) -> Vec<Kept<'a>> {
    let keeps = |account: &Account| {
        let answered = |row: &&&Row| row.value.is_some() || row.verdict == Verdict::Error;
        let judged: Vec<_> = account.values().filter(answered).collect();
        !judged.is_empty() && judged.iter().all(|row| row.verdict == Verdict::Pass)
    };
    let mut quantities: Vec<(usize, &str)> = accounts.keys().map(|&(quantity, ..)| quantity).collect();
    quantities.dedup();
    let mut kept = Vec::new();
    for quantity in quantities {
        let of_quantity: Vec<_> = accounts.iter().filter(|((other, ..), _)| *other == quantity).collect();
        let mut engines: Vec<usize> = of_quantity.iter().map(|((_, engine, _), _)| *engine).collect();
        engines.dedup();
        let mut answers = Vec::new();
        for engine in engines {
            let methods: Vec<_> = of_quantity.iter().filter(|((_, other, _), _)| *other == engine).collect();
            let good: Vec<String> =
                methods.iter().filter(|(_, account)| keeps(account)).map(|((_, _, method), _)| (*method).into()).collect();
            let name = overview.engines[engine];
            // If all methods of an engine pass their gates, the sentence does not name them.
            match good.len() {
                0 => {}
                all if all == methods.len() => answers.push((name, String::new())),
                _ => answers.push((name, format!(" {}", good.join("/")))),
            }
        }
        let rows = of_quantity.iter().filter(|(_, account)| keeps(account)).flat_map(|(_, account)| account.values());
        // An error over its conditioning bound is a ratio, not an error.
        let largest = rows.filter(|row| row.metric != "error_over_floor").filter_map(|row| row.value).fold(0.0, larger);
        let robots = || of_quantity.iter().filter(|(_, account)| keeps(account)).map(|(_, account)| account.len());
        let robots = robots().min().zip(robots().max());
        kept.extend(robots.map(|robots| Kept { quantity: quantity.1, answers, robots, largest }));
    }
    kept
}

fn medians(accuracy: &Accuracy) -> Vec<(usize, f64)> {
    let mut largest: BTreeMap<usize, f64> = BTreeMap::new();
    for cell in accuracy.cells.iter().filter(|cell| accuracy.answers[cell.answer].quantity == "fd") {
        let entry = largest.entry(cell.answer).or_default();
        *entry = larger(*entry, cell.median.unwrap_or_default());
    }
    let mut medians: Vec<(usize, f64)> = largest.into_iter().collect();
    medians.sort_by(|a, b| a.1.total_cmp(&b.1));
    medians
}

impl Missed<'_> {
    fn who(&self, overview: &Overview) -> Markup {
        let methods: Vec<String> = self.methods.iter().filter(|method| !method.is_empty()).map(|&method| method.to_owned()).collect();
        html! { (engine(overview, self.engine)) @if !methods.is_empty() { " " (listed(&methods)) } }
    }

    fn sentence(&self, overview: &Overview, verb: [&str; 2]) -> Markup {
        let mut names: Vec<Markup> = self.robots.iter().take(NAMED).map(|name| robot(overview, name)).collect();
        if self.robots.len() > NAMED {
            names.push(html! { (self.robots.len() - NAMED) " more" });
        }
        let verb = verb[usize::from(self.methods.len() > 1)];
        let of = if self.of == self.robots.len() { String::new() } else { format!(" of {}", self.of) };
        let robots = if of.is_empty() { count(self.robots.len(), "robot") } else { format!("{}{of} robots", self.robots.len()) };
        html! { (verb) " on " (robots) " in " (labels::quantity(self.quantity)) ": " (sentence(&names)) }
    }
}

fn missed(overview: &Overview, found: &[Missed], class: &str, verb: [&str; 2]) -> Markup {
    html! {
        @for missed in found.iter().take(TOLD) {
            li class=(class) {
                b { (missed.who(overview)) } " " (missed.sentence(overview, verb)) ". Worst: "
                @let row = missed.worst;
                (opener(
                    &overview.chunk_of(row),
                    &[("study", &row.study), ("engine", &row.engine), ("method", &row.method), ("quantity", &row.quantity)],
                    &match (row.value, row.bound) {
                        (Some(value), Some(bound)) => format!("{}, {} where {} is allowed", row.robot, short(value), short(bound)),
                        _ => format!("{}, {}", row.robot, row.reason),
                    },
                ))
                @if let Some(margin) = row.margin { " " span.number { "(" (decades(margin)) " decades)" } }
            }
        }
        @if found.len() > TOLD {
            li class=(class) { (found.len() - TOLD) " more: see " a href="#accuracy" { "accuracy" } "." }
        }
    }
}

/// The warning that the reference itself may be wrong; nothing if no row says so.
pub fn warning(overview: &Overview, accuracy: &Accuracy) -> Markup {
    html! {
        @if !accuracy.limited.is_empty() {
            p.warning role="note" {
                b { span aria-hidden="true" { "⚠ " } "The reference is the suspect: " }
                @for (index, row) in accuracy.limited.iter().take(NAMED).enumerate() {
                    @if index > 0 { "; " }
                    "at " (opener(&overview.chunk_of(row), &[("study", &row.study), ("metric", &row.metric)], &row.robot))
                    " " (count(row.value.unwrap_or_default() as usize, "engine")) " stop at the same error, well above the conditioning bound"
                }
                @if accuracy.limited.len() > NAMED { "; and so at " (count(accuracy.limited.len() - NAMED, "more robot")) }
                ". Errors that come of rounding differ from engine to engine; several at one place are no coincidence."
            }
        }
    }
}

/// The part of the page's head that says which engine is right.
pub fn markup(overview: &Overview, accuracy: &Accuracy, truth: &Truth) -> Markup {
    html! {
        h3 { "Against the truth" }
        (warning(overview, accuracy))
        ul.findings {
            @for kept in &truth.kept {
                li.pass {
                    @let names: Vec<Markup> = kept.answers.iter().map(|(name, methods)| html! { (engine(overview, name)) (methods) }).collect();
                    b { (sentence(&names)) } @if kept.answers.len() == 1 { " keeps" } @else { " keep" }
                    " every gate on " (labels::quantity(kept.quantity)) " " span.number { "(" (short(kept.largest)) ")" }
                    " over " @if kept.robots.0 < kept.robots.1 { (kept.robots.0) " to " } (count(kept.robots.1, "robot")) "."
                }
            }
            (missed(overview, &truth.failed, "fail", ["fails", "fail"]))
            (missed(overview, &truth.known, "known", ["misses by known cause", "miss by known cause"]))
        }
        @if !truth.medians.is_empty() {
            p.note {
                "Forward dynamics, the largest median error on any robot: "
                @for (index, &(answer, error)) in truth.medians.iter().enumerate() {
                    @if index > 0 { ", " }
                    span.nowrap { (accuracy.linked(overview, answer)) " " b { (short(error)) } }
                }
                "."
            }
        }
        p.note {
            "The truth is the answer in double-double arithmetic: here a row convicts or acquits the engine it names. In parentheses the largest judged error, "
            "of forward dynamics in the kinetic-energy norm. Every number is in " a href="#accuracy" { "accuracy" } "."
        }
    }
}
