//! The factorizations of other engines: fill-in, and errors.

use super::data::{SCALING, worse};
use featherbench_report::numbers::{grouped, short};
use featherbench_report::{Overview, labels, opener, robot_chunk};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

/// A method of an engine on a robot.
#[derive(Debug)]
pub(in crate::scaling) struct Other<'a> {
    robot: usize,
    size: u64,
    engine: &'a str,
    method: &'a str,
    fill: Option<f64>,
    /// Errors per dof of the factors and of a solution.
    errors: [Option<f64>; 2],
    /// The worst verdict of its rows, and a reason.
    verdict: Verdict,
    reason: &'a str,
}

/// Puts a row to the method that it is about.
pub(super) fn add<'a>(others: &mut Vec<Other<'a>>, robot: usize, row: &'a Row) {
    let known = others.iter().position(|other| (other.robot, other.engine, other.method) == (robot, &*row.engine, &*row.method));
    let place = known.unwrap_or_else(|| {
        let (engine, method, size) = (&*row.engine, &*row.method, row.nv.unwrap_or(0));
        others.push(Other { robot, size, engine, method, fill: None, errors: [None; 2], verdict: row.verdict, reason: "" });
        others.len() - 1
    });
    let other = &mut others[place];
    match row.metric.as_str() {
        "fill_in" => other.fill = row.value,
        "factor_error_per_dof" => other.errors[0] = row.value,
        "solution_error_per_dof" => other.errors[1] = row.value,
        _ => {}
    }
    other.verdict = worse(other.verdict, row.verdict);
    if !row.reason.is_empty() {
        other.reason = &row.reason;
    }
}

/// The table of all methods on all robots.
pub(super) fn table(overview: &Overview, others: &[Other]) -> Markup {
    let number = |value: Option<f64>| value.map(short).unwrap_or_default();
    html! {
        h3 { "Factorizations of other engines" }
        p.note {
            "faer and nalgebra are libraries of linear algebra. They are given our M, and what their methods do with it is compared with it. Engines with robots make "
            "their own M, so that their errors have the difference in them, and are not judged here. Fill-in: numbers of the factor less those of M, "
            "by the engine's own symbolic analysis. Errors are per degree of freedom, in units of √(M_ii M_jj). Times are in the section on speed."
        }
        div.scroll {
            table #scaling-others.compact.sortable {
                thead { tr {
                    th scope="col" { "robot" } th.number scope="col" { "n" } th scope="col" { "engine" } th scope="col" { "method" }
                    th.number scope="col" { "fill-in" } th.number scope="col" { "LᵀDL − M" } th.number scope="col" { "solution" } th scope="col" { "why not" }
                } }
                tbody {
                    @for other in others {
                        tr {
                            th scope="row" { (opener(&robot_chunk(other.robot), &[("study", SCALING), ("engine", other.engine)], overview.robots[other.robot].name)) }
                            td.number { (grouped(other.size as usize)) }
                            td { @if other.verdict != Verdict::Info { span.badge.(other.verdict.as_str()) title=(labels::verdict(other.verdict)) { (labels::glyph(other.verdict)) } " " } (other.engine) }
                            td { (other.method) }
                            td.number { @if let Some(fill) = other.fill { (grouped(fill as usize)) } }
                            td.number { (number(other.errors[0])) }
                            td.number { (number(other.errors[1])) }
                            td { (other.reason) }
                        }
                    }
                }
            }
        }
    }
}
