//! What an entry of a derivative costs, of a run that times derivatives.

use featherbench_bench::{OWN, Quantity};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, labels, opener};
use featherbench_results::{Extents, Row};
use maud::{Markup, html};

/// The study of times.
const TIMING: &str = "timing";
/// The quantity and method whose time is the unit of the last column.
const UNIT: (&str, &str) = ("id_dq", "analytic");

/// A time.
struct Cost<'a> {
    row: &'a Row,
    ns: f64,
    entries: usize,
    /// The time over that of our ∂ID on the same robot, if both count.
    over_id: Option<f64>,
}

/// Time per call and per entry of each candidate, and over the time of our ∂ID. Nothing if the run has no such times.
pub(super) fn table(overview: &Overview, rows: &[Row]) -> Markup {
    let costs = costs(rows);
    html! {
        @if !costs.is_empty() {
            h3 { "Cost of an entry" }
            div.scroll.tall { table.compact.sortable #derivatives-cost {
                thead { tr {
                    th scope="col" { "robot" } th scope="col" { "quantity" } th scope="col" { "engine" } th scope="col" { "method" }
                    th.number scope="col" { "entries" } th.number scope="col" { "ns per call" } th.number scope="col" { "ns per entry" }
                    th.number scope="col" { "over our ∂ID" } th scope="col" { "counts" }
                } }
                tbody { @for Cost { row, ns, entries, over_id } in &costs {
                    tr {
                        th scope="row" { (opener(&overview.chunk_of(row), &[("study", TIMING), ("quantity", &row.quantity)], &row.robot)) }
                        td { (labels::quantity(&row.quantity)) } td { (row.engine) } td { (row.method) }
                        td.number { (entries) } td.number { (short(*ns)) } td.number { (short(ns / *entries as f64)) }
                        td.number { @if let Some(ratio) = over_id { (format!("{ratio:.2}")) } @else { "–" } }
                        td { @if row.valid { "yes" } @else { "no" } }
                    }
                } }
            } }
            p.note {
                "Entries of the dense answer, zeros included. Times are those of the timing study, with another state at each call; its section has their intervals. "
                "Our ∂ID is ∂τ/∂q, ∂τ/∂v and M together, by the method " code { (UNIT.1) } ". "
                "∂²(μ·ID) and ∂²(λ·FD) are the second derivatives of a weighted sum of the dofs: four matrices, not the tensor, which takes one such call per dof."
            }
        }
    }
}

fn costs(rows: &[Row]) -> Vec<Cost<'_>> {
    let timed = || rows.iter().filter(|row| row.study == TIMING && row.metric == "ns_per_call" && row.cache == "stream");
    let is_unit = |row: &&Row| row.engine == OWN && (row.quantity.as_str(), row.method.as_str()) == UNIT && row.valid;
    let unit = |robot: &str| timed().filter(is_unit).find(|row| row.robot == robot).and_then(|row| row.value);
    let cost = |row| {
        let row: &Row = row;
        let (ns, entries) = (row.value?, entries(row)?);
        let over_id = unit(&row.robot).filter(|_| row.valid).map(|unit| ns / unit);
        Some(Cost { row, ns, entries, over_id })
    };
    timed().filter_map(cost).collect()
}

/// The entries of a row's answer, if its quantity is a derivative.
fn entries(row: &Row) -> Option<usize> {
    let quantity = Quantity::parse(&row.quantity).filter(|quantity| quantity.is_derivative())?;
    let (nv, bodies) = (row.nv? as usize, row.bodies? as usize);
    Some(quantity.size(Extents { nv, bodies, ..Extents::default() })).filter(|entries| *entries > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(robot: &str, quantity: &str, method: &str, ns: f64) -> Row {
        let text = |text: &str| text.to_owned();
        let row = Row { study: text(TIMING), robot: text(robot), engine: text(OWN), quantity: text(quantity), ..Row::default() };
        let row = Row { method: text(method), metric: text("ns_per_call"), cache: text("stream"), nv: Some(3), bodies: Some(2), ..row };
        row.informed(ns)
    }

    #[test]
    fn a_cost_is_over_our_first_derivative_of_the_same_robot() {
        let rows = [
            time("a", "id_dq", "analytic", 100.0),
            time("a", "id_second", "analytic", 250.0),
            time("b", "fd_second", "analytic", 900.0),
            time("b", "id_dq", "analytic", 300.0).invalid("the machine was not quiet"),
            time("a", "torque_regressor", "columns", 50.0).invalid("noise"),
            time("a", "fd", "aba", 1.0),
        ];
        let found: Vec<_> = costs(&rows).iter().map(|cost| (cost.entries, cost.over_id)).collect();
        assert_eq!(found, [(9, Some(1.0)), (36, Some(2.5)), (36, None), (9, None), (60, None)]);
    }
}
