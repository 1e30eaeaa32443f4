//! What an entry of a derivative costs, of a run that times derivatives.

use featherbench_bench::Quantity;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, labels, opener};
use featherbench_results::Row;
use maud::{Markup, html};

/// The study of times.
const TIMING: &str = "timing";

/// Time per call and per entry of each candidate. Nothing if the run has no such times.
pub(super) fn table(overview: &Overview, rows: &[Row]) -> Markup {
    let timed: Vec<(&Row, f64, usize)> = rows
        .iter()
        .filter(|row| row.study == TIMING && row.metric == "ns_per_call" && row.cache == "stream")
        .filter_map(|row| Some((row, row.value?, entries(row)?)))
        .collect();
    html! {
        @if !timed.is_empty() {
            h3 { "Cost of an entry" }
            div.scroll.tall { table.compact.sortable {
                thead { tr {
                    th scope="col" { "robot" } th scope="col" { "quantity" } th scope="col" { "engine" } th scope="col" { "method" }
                    th.number scope="col" { "entries" } th.number scope="col" { "ns per call" } th.number scope="col" { "ns per entry" }
                } }
                tbody { @for (row, ns, entries) in &timed {
                    tr {
                        th scope="row" { (opener(&overview.chunk_of(row), &[("study", TIMING), ("quantity", &row.quantity)], &row.robot)) }
                        td { (labels::quantity(&row.quantity)) } td { (row.engine) } td { (row.method) }
                        td.number { (entries) } td.number { (short(*ns)) } td.number { (short(ns / *entries as f64)) }
                    }
                } }
            } }
            p.note { "Entries of the dense answer, zeros included. Times are those of the timing study; its section has their intervals." }
        }
    }
}

/// The entries of a row's answer, if its quantity is a derivative.
fn entries(row: &Row) -> Option<usize> {
    let quantity = Quantity::parse(&row.quantity).filter(|quantity| Quantity::DERIVATIVES.contains(quantity))?;
    let (nv, bodies) = (row.nv? as usize, row.bodies? as usize);
    let width = if quantity == Quantity::TorqueRegressor { bodies * featherbench_bench::layout::PARAMETERS } else { nv };
    Some(nv * width).filter(|entries| *entries > 0)
}
