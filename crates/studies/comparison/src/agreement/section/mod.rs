//! The sections of this study: who agrees and by how much, with its finding; joint types; error against depth; every engine against every other.

mod cells;
mod depth;
mod findings;
mod heatmap;
mod joints;
mod pairs;

use featherbench_report::{Finding, Overview, Section};
use featherbench_results::{Relation, Row, RunInfo};

use cells::Cells;
use findings::WhoAgrees;
use joints::JointMatrix;

/// The study's name in rows.
const STUDY: &str = "agreement";
/// The metric of rows that compare two engines with each other.
const PAIRWISE: &str = "pairwise";
/// The metrics that are errors even without a gate.
const ERROR_METRICS: [&str; 3] = ["scaled", "forward", "backward"];

/// Makes the sections; the joint matrix appears only with its robots.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let (cells, who) = (Cells::of(overview, rows), WhoAgrees::of(overview, rows));
    let matrix = JointMatrix::of(overview, &cells.quantities, rows);
    let plots = depth::plots(overview, rows);
    let (body, parts) = heatmap::markup(overview, &cells, &who);
    let (depth, drawn) = depth::markup(overview, &plots);
    let (pairs, of_two) = pairs::markup(overview, rows);
    let mut sections = vec![
        Section { parts: of_two, style: include_str!("pairs.css"), ..Section::new("pairs", "Pairs", pairs) },
        Section {
            parts,
            script: include_str!("heatmap.js"),
            finding: Some(Finding { rank: 1, body: findings::markup(&who) }),
            quantities: cells.quantities.iter().map(|&name| name.to_owned()).collect(),
            ..Section::new("agreement", "Agreement", body).with_data(&cells.data())
        },
        Section { parts: drawn, shows: depth::shown(&plots), script: include_str!("depth.js"), ..Section::new("depth", "Error", depth) },
    ];
    if !matrix.rows.is_empty() {
        let body = joints::markup(overview, &cells.quantities, &matrix);
        let (script, style) = (include_str!("joints.js"), include_str!("joints.css"));
        sections.push(Section { script, style, ..Section::new("joints", "Joints", body).with_data(&matrix) });
    }
    sections
}

/// Whether a row is the error of an answer that has a reference.
fn is_error_measure(row: &Row) -> bool {
    let gated = matches!(row.relation, Some(Relation::Le | Relation::Within));
    row.study == STUDY && row.metric != PAIRWISE && (gated || ERROR_METRICS.contains(&row.metric.as_str()))
}
