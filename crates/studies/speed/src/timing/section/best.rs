//! Our methods beside the best of some engines: the rows `best_other`, over the robots.

use std::collections::BTreeMap;

use featherbench_report::numbers::{aligned, count, listed};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;
use maud::{Markup, html};

use super::STUDY;
use super::ratios::{Ratio, mean};
use super::speed::times;
use crate::timing::BEST_OTHER;

/// One of our methods for a quantity, over the robots.
pub struct Best<'a> {
    /// One of its ratios, for names.
    of: Ratio<'a>,
    /// The valid ratios with their robots, the least first.
    valid: Vec<(f64, usize)>,
    /// The robots whose ratio does not count.
    void: usize,
    /// On how many robots each engine is the best.
    engines: BTreeMap<&'a str, usize>,
}

/// Collects the rows: by quantity, `stream` before `hot`, by method.
pub fn summaries<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<Best<'a>> {
    let mut groups: BTreeMap<_, Best> = BTreeMap::new();
    for ratio in rows.iter().filter(|row| row.study == STUDY && row.metric == BEST_OTHER).filter_map(|row| Ratio::of(overview, row)) {
        let key = (labels::quantity_rank(ratio.quantity), std::cmp::Reverse(ratio.cache), ratio.method, ratio.precision);
        let group = groups.entry(key).or_insert_with(|| Best { of: ratio.clone(), valid: Vec::new(), void: 0, engines: BTreeMap::new() });
        if ratio.valid && ratio.value > 0.0 {
            group.valid.push((ratio.value, ratio.robot));
            *group.engines.entry(engine(ratio.reference)).or_default() += 1;
        } else {
            group.void += 1;
        }
    }
    let mut all: Vec<Best> = groups.into_values().collect();
    all.iter_mut().for_each(|best| best.valid.sort_by(|a, b| a.0.total_cmp(&b.0)));
    all
}

/// The engine of a reference `engine method`.
fn engine(reference: &str) -> &str {
    reference.split(' ').next().unwrap_or(reference)
}

/// A table for the terminal: a line for each quantity at many states with our fastest single-state method, and the batch beside it.
pub fn lines(all: &[Best]) -> Vec<String> {
    let mean_of = |best: &Best| mean(best.valid.iter().map(|(ratio, _)| *ratio));
    let counted = || all.iter().filter(|best| best.of.cache == "stream" && !best.valid.is_empty());
    let mut quantities: Vec<&str> = counted().map(|best| best.of.quantity).collect();
    quantities.dedup();
    let line = |quantity: &str| {
        let of = |batch: bool| counted().filter(move |best| best.of.quantity == quantity && best.of.is_batch() == batch);
        let fastest = |best: &&Best, other: &&Best| mean_of(best).total_cmp(&mean_of(other));
        let (one, many) = (of(false).max_by(fastest), of(true).max_by(fastest));
        let words = |best: Option<&Best>, number: fn(&Best) -> Option<f64>| best.and_then(number).map_or_else(|| "–".to_owned(), times);
        [
            labels::quantity(quantity).to_owned(),
            one.map_or_else(|| "–".to_owned(), |best| best.of.way()),
            one.map_or_else(|| "–".to_owned(), |best| times(mean_of(best))),
            words(one, |best| best.valid.first().map(|(least, _)| *least)),
            many.map_or_else(|| "–".to_owned(), |best| times(mean_of(best))),
        ]
    };
    if quantities.is_empty() {
        return Vec::new();
    }
    let heads = ["the best other over ours", "our method", "mean", "least", "batch"].map(str::to_owned);
    aligned(&[vec![heads], quantities.into_iter().map(line).collect()].concat(), &[0, 1])
}

/// Writes the table.
pub fn table(overview: &Overview, all: &[Best]) -> Markup {
    let mut engines: Vec<String> = all.iter().flat_map(|best| best.engines.keys()).map(|&engine| engine.to_owned()).collect();
    engines.sort_unstable();
    engines.dedup();
    html! {
        @if !all.is_empty() {
            h3 { "Ours beside the best other" }
            p.note {
                "On each robot: the time of the fastest method of the engines that the suite names in " code { "best_of" }
                @if !engines.is_empty() { " (fastest somewhere: " (listed(&engines)) ")" }
                ", over that of our method, in the same rounds. Above 1 ours is faster. A method whose answers fail the check is not among them. "
                "Void: robots whose ratio does not count, by the A/A controls or the check of our answers. Rows " code { (BEST_OTHER) } "."
            }
            div.scroll.tall { table.compact.sortable #speed-best {
                thead { tr {
                    th scope="col" { "compute" } th scope="col" { "inputs" } th scope="col" { "our method" }
                    th.number scope="col" { "robots" } th.number scope="col" { "void" }
                    th.number scope="col" { "geometric mean" } th.number scope="col" { "least" } th scope="col" { "on" }
                    th.number scope="col" { "largest" } th scope="col" { "on" } th scope="col" { "the best, on robots" }
                } }
                tbody { @for best in all { (line(overview, best)) } }
            } }
        }
    }
}

fn line(overview: &Overview, best: &Best) -> Markup {
    let ends = best.valid.first().zip(best.valid.last());
    let engines: Vec<String> = best.engines.iter().map(|(engine, robots)| format!("{engine} {robots}")).collect();
    html! {
        tr {
            th scope="row" { (labels::quantity(best.of.quantity)) } td { (best.of.cache) } td { (best.of.way()) }
            td.number { (best.valid.len()) } td.number { (best.void) }
            @if let Some(((least, on), (most, at))) = ends {
                td.number { (times(mean(best.valid.iter().map(|(ratio, _)| *ratio)))) }
                td.number { (times(*least)) } td { (overview.robots[*on].name) }
                td.number { (times(*most)) } td { (overview.robots[*at].name) }
                td { (engines.join(", ")) }
            } @else {
                td colspan="6" { "none of " (count(best.void, "robot")) " counts" }
            }
        }
    }
}
