//! The joint matrix: which engine's derivatives are right on which joint.

use super::super::STUDY;
use featherbench_model::JointType;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, labels, opener, worst_first};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};
use std::collections::{BTreeMap, BTreeSet};

/// The joint type of a robot named `joints-TYPE…`.
fn kind(robot: &str) -> Option<&str> {
    let kind = robot.strip_prefix("joints-")?.split('-').next()?;
    JointType::names().into_iter().find(|known| *known == kind)
}

/// Joint type × engine and quantity: the worst judged row over the robots named after the type. Nothing if the run has no such robots.
pub(super) fn table(overview: &Overview, rows: &[&Row]) -> Markup {
    let mut worst: BTreeMap<(usize, usize, (usize, &str)), &Row> = BTreeMap::new();
    for &row in rows.iter().filter(|row| row.verdict != Verdict::Info && row.metric == "true") {
        let (Some(kind), Some(engine)) = (kind(&row.robot), overview.engine(&row.engine)) else { continue };
        let place = JointType::names().iter().position(|known| *known == kind).unwrap_or(usize::MAX);
        let held = worst.entry((place, engine, labels::quantity_rank(&row.quantity))).or_insert(row);
        if worst_first(row) < worst_first(held) {
            *held = row;
        }
    }
    let columns: BTreeSet<(usize, (usize, &str))> = worst.keys().map(|&(_, engine, quantity)| (engine, quantity)).collect();
    let kinds: BTreeSet<usize> = worst.keys().map(|&(kind, ..)| kind).collect();
    html! {
        @if !kinds.is_empty() {
            h3 { "Which engine is right on which joint" }
            div.scroll {
                table #derivatives-joints.compact {
                    thead { tr {
                        th scope="col" { "joint" }
                        @for (engine, (_, quantity)) in &columns { th.number scope="col" { (overview.engines[*engine]) br; (labels::quantity(quantity)) } }
                    } }
                    tbody { @for &place in &kinds { tr {
                        th scope="row" { (JointType::names()[place]) }
                        @for &(engine, quantity) in &columns {
                            td.number { @match worst.get(&(place, engine, quantity)) {
                                Some(row) => (cell(overview, row)),
                                None => "–",
                            } }
                        }
                    } } }
                }
            }
            p.note { "The worst of the robots with this joint, on fixed and free bases and at every kind of state. ✓ keeps its gate, ≈ misses it by a known cause, ✕ misses it, – has no answer." }
        }
    }
}

fn cell(overview: &Overview, row: &Row) -> Markup {
    let filters = [("study", STUDY), ("engine", row.engine.as_str()), ("quantity", row.quantity.as_str())];
    let text = row.value.map_or_else(|| row.verdict.as_str().to_owned(), short);
    html! { span.badge.(row.verdict.as_str()) { (labels::glyph(row.verdict)) } " " (opener(&overview.chunk_of(row), &filters, &text)) }
}

#[cfg(test)]
mod tests {
    use super::kind;

    #[test]
    fn a_robot_is_named_after_its_joint() {
        assert_eq!([kind("joints-euler_zyx-free-armature"), kind("joints-all-fixed"), kind("humanoid")], [Some("euler_zyx"), None, None]);
    }
}
