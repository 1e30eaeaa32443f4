//! The part on floating bases: condition numbers of M and of both Schur complements, raw and scaled, robot by robot.

use std::collections::BTreeMap;

use super::STUDY;
use crate::conditioning::floating_base::{METHOD, METRICS};
use featherbench_report::{Overview, labels, opener, robot_chunk};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

/// One robot.
#[derive(Debug, Default)]
pub struct Base<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// κ of M, S_bb and S_jj, each raw and scaled, in the order of [`METRICS`].
    pub kappa: [Option<f64>; METRICS.len()],
    /// The largest error of a complement, with its verdict.
    error: Option<(f64, Verdict)>,
    /// The larger of κ(S_bb)/κ(M) and κ(S_jj)/κ(M), with its verdict.
    ratio: Option<(f64, Verdict)>,
    /// Why there is no number.
    reason: &'a str,
}

/// Collects a run's rows, robot by robot in the order of the run.
pub(super) fn bases<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<Base<'a>> {
    let mut found: BTreeMap<usize, Base> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY && row.method == METHOD) {
        let Some(robot) = overview.robot(&row.robot) else { continue };
        let base = found.entry(robot).or_insert_with(|| Base { robot, ..Base::default() });
        let judged = row.value.map(|value| (value, row.verdict));
        match (METRICS.iter().position(|metric| *metric == row.metric), row.metric.as_str()) {
            (Some(place), _) => base.kappa[place] = row.value,
            (None, "complement_error") => base.error = judged,
            (None, "complement_over_whole") => base.ratio = judged,
            (None, _) => base.reason = &row.reason,
        }
    }
    found.into_values().collect()
}

/// The figure and the table.
pub(super) fn body(overview: &Overview, bases: &[Base]) -> Markup {
    html! {
        h3 { "Floating bases" }
        p.lead {
            "The mass matrix in blocks, of the base b and of the joints j. S_bb = M_bb − M_bj M_jj⁻¹ M_jb is what the base meets while the joints are free. "
            "S_jj = M_jj − M_jb M_bb⁻¹ M_bj is what the joints meet while the base floats. Each point is the condition number of one matrix of one robot: "
            "to the right before, upwards after scaling to a unit diagonal."
        }
        (super::drawings::bases(overview, bases))
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "robot" } th.number scope="col" { "n" }
                        @for name in ["κ(M)", "scaled", "κ(S_bb)", "scaled", "κ(S_jj)", "scaled", "κ(S)/κ(M) at most", "error of S"] { th.number scope="col" { (name) } }
                    }
                }
                tbody { @for base in bases { (row(overview, base)) } }
            }
        }
        p.note {
            "Medians over random states; the last two columns are the largest. κ depends on the units of length and angle, κ scaled does not. "
            "Neither complement has a larger κ than M: its inverse is a block of M⁻¹. The error is against double-double arithmetic, as the change of M, over √(M_ii M_jj), that it needs."
        }
    }
}

fn row(overview: &Overview, base: &Base) -> Markup {
    let judged = |judged: Option<(f64, Verdict)>| {
        html! {
            @if let Some((value, verdict)) = judged {
                @if !matches!(verdict, Verdict::Info) { span.badge.(verdict.as_str()) { (labels::glyph(verdict)) } " " }
                (format!("{value:.2e}"))
            }
        }
    };
    let robot = &overview.robots[base.robot];
    html! {
        tr {
            th scope="row" { (opener(&robot_chunk(base.robot), &[("study", STUDY)], robot.name)) }
            td.number { @if let Some(nv) = robot.nv { (nv) } }
            @if base.kappa[0].is_none() && !base.reason.is_empty() {
                td colspan="8" { (base.reason) }
            } @else {
                @for kappa in base.kappa { td.number { @if let Some(kappa) = kappa { (format!("{kappa:.2e}")) } } }
                td.number { (judged(base.ratio)) }
                td.number { (judged(base.error)) }
            }
        }
    }
}
