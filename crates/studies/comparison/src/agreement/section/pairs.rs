//! Section: every engine against every other, one small matrix per quantity.

use std::collections::BTreeMap;

use featherbench_report::choices::{Choices, List};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Part, labels, opener, robot};
use featherbench_results::Row;
use maud::{Markup, html};

use super::PAIRWISE;

/// The largest difference of two engines on a quantity, and its row.
type Largest<'a> = BTreeMap<(usize, usize), (f64, &'a Row)>;

/// The choice of all engines.
const ALL: &str = "all";

/// Writes the section, and the tables of two engines, which are chosen.
pub fn markup(overview: &Overview, rows: &[Row]) -> (Markup, Vec<Part>) {
    let matrices = matrices(overview, rows);
    let (shown, parts) = if matrices.is_empty() { (html! {}, Vec::new()) } else { choices(overview, &matrices).made() };
    let body = html! {
        section #pairs {
            h2 { "Every engine against every other" }
            p.lead {
                "Largest difference over all robots and states. One engine apart from all others is suspect; "
                "engines of one school can share a mistake, so a majority proves nothing."
            }
            @if matrices.is_empty() {
                p.empty { "This run holds no rows that compare two engines." }
            } @else {
                (shown)
                p.note { "Stronger colour is larger. An empty cell was not compared. Click a number to see the rows of the robot on which it arose." }
            }
        }
    };
    (body, parts)
}

/// All matrices, and a table for any two engines.
fn choices<'a>(overview: &Overview, matrices: &[(&'a str, Largest<'a>)]) -> Choices {
    let name = |engine: usize| overview.engines[engine].to_owned();
    let compared = |engine: &usize| matrices.iter().any(|(_, largest)| largest.keys().any(|(one, other)| one == engine || other == engine));
    let engines: Vec<usize> = (0..overview.engines.len()).filter(compared).collect();
    let all = html! { div.matrices { @for (quantity, largest) in matrices { div.scroll { (matrix(overview, quantity, largest)) } } } };
    let mut drawings = vec![(vec![ALL.to_owned(); 2], all)];
    for &one in &engines {
        for &other in engines.iter().filter(|&&other| other != one) {
            let pair = (one.max(other), one.min(other));
            let found: Vec<_> = matrices.iter().filter_map(|(quantity, largest)| Some((*quantity, largest.get(&pair)?))).collect();
            if !found.is_empty() {
                drawings.push((vec![name(one), name(other)], table(overview, &found)));
            }
        }
    }
    let options = || -> Vec<(String, String)> {
        std::iter::once((ALL.to_owned(), "all engines".to_owned()))
            .chain(engines.iter().map(|&engine| (name(engine), name(engine))))
            .collect()
    };
    let lists =
        vec![List { id: "pairs-one", label: "Of", options: options() }, List { id: "pairs-other", label: "against", options: options() }];
    Choices { name: "pairs-choices", title: "Two engines", lists, opening: vec![ALL.to_owned(); 2], drawings }
}

/// The largest differences of two engines, quantity by quantity.
fn table(overview: &Overview, found: &[(&str, &(f64, &Row))]) -> Markup {
    html! {
        div.scroll { table.compact.sortable {
            thead { tr { th scope="col" { "compute" } th.number scope="col" { "largest difference" } th scope="col" { "on" } th scope="col" { "states" } } }
            tbody { @for (quantity, (value, row)) in found {
                tr {
                    th scope="row" { (labels::quantity(quantity)) }
                    td.number { (cell(overview, *value, row)) }
                    td { (robot(overview, &row.robot)) }
                    td { (row.states) }
                }
            } }
        } }
    }
}

/// The rows that compare two engines in the quantity's own measure; a backward error is another measure.
fn matrices<'a>(overview: &Overview, rows: &'a [Row]) -> Vec<(&'a str, Largest<'a>)> {
    let mut found: BTreeMap<(usize, &str), Largest> = BTreeMap::new();
    for row in rows.iter().filter(|row| [PAIRWISE, "scaled", "forward"].contains(&row.metric.as_str())) {
        let (Some(one), Some(other), Some(value)) = (overview.engine(&row.engine), overview.engine(&row.reference), row.value) else {
            continue;
        };
        if one == other {
            continue;
        }
        let pair = (one.max(other), one.min(other));
        let largest = found.entry(labels::quantity_rank(&row.quantity)).or_default().entry(pair).or_insert((value.abs(), row));
        if value.abs() > largest.0 {
            *largest = (value.abs(), row);
        }
    }
    found.into_iter().map(|((_, quantity), largest)| (quantity, largest)).collect()
}

fn matrix(overview: &Overview, quantity: &str, largest: &Largest) -> Markup {
    let engines: Vec<usize> =
        (0..overview.engines.len()).filter(|engine| largest.keys().any(|(one, other)| one == engine || other == engine)).collect();
    html! {
        table.matrix {
            caption { (labels::quantity(quantity)) }
            tbody {
                @for (position, &one) in engines.iter().enumerate() {
                    tr {
                        // A lower triangle: each row ends with its own name, which is the head of the column below.
                        @for &other in &engines[..position] {
                            @match largest.get(&(one, other)) {
                                Some((value, row)) => td class=(step(*value)) { (cell(overview, *value, row)) },
                                None => td {},
                            }
                        }
                        th { (overview.engines[one]) }
                    }
                }
            }
        }
    }
}

fn cell(overview: &Overview, value: f64, row: &Row) -> Markup {
    opener(
        &overview.chunk_of(row),
        &[("engine", &row.engine), ("reference", &row.reference), ("quantity", &row.quantity), ("metric", &row.metric)],
        &short(value),
    )
}

/// Colour steps by decades of error, from rounding to large differences.
fn step(value: f64) -> &'static str {
    match value {
        v if v <= 1e-15 => "d0",
        v if v <= 1e-14 => "d1",
        v if v <= 1e-12 => "d2",
        v if v <= 1e-9 => "d3",
        v if v <= 1e-6 => "d4",
        _ => "d5",
    }
}
