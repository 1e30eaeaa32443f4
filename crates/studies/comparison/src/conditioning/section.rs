//! Section: the growth of the condition number of M with a chain's length, and how little it says about lost digits; and the condition numbers of
//! floating bases.

mod drawings;
mod floating_base;

use std::collections::BTreeMap;

use super::floating_base::METHOD;
use featherbench_report::fit::{Fit, power_law};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, labels, opener, robot_chunk};
use featherbench_results::{Row, RunInfo, Verdict};
use maud::{Markup, html};

/// The study's name in rows.
const STUDY: &str = "conditioning";

/// One family of chains.
#[derive(Debug)]
pub struct Family<'a> {
    /// Its name.
    pub name: &'a str,
    /// One per robot, by size.
    pub points: Vec<Point<'a>>,
    /// Growth of κ(M).
    pub raw: Option<Fit>,
    /// Growth of κ(D^-½ M D^-½).
    pub scaled: Option<Fit>,
}

/// One robot.
#[derive(Debug, Default)]
pub struct Point<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Degrees of freedom.
    pub size: u64,
    /// κ(M).
    pub raw: Option<f64>,
    /// κ(D^-½ M D^-½).
    pub scaled: Option<f64>,
    /// The conditioning bound of forward dynamics.
    pub floor: Option<f64>,
    /// Local exponents of both, with their verdicts.
    exponents: [Option<(f64, Verdict)>; 2],
    /// Why there is no number.
    reason: &'a str,
}

/// Collects a run's rows.
fn families<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<Family<'a>> {
    let mut found: BTreeMap<&str, BTreeMap<(u64, usize), Point>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY && row.method != METHOD) {
        let Some(robot) = overview.robot(&row.robot) else { continue };
        let Some(size) = overview.robots[robot].nv.filter(|&size| size > 0) else { continue };
        let point = found.entry(&row.family).or_default().entry((size, robot)).or_default();
        (point.robot, point.size) = (robot, size);
        point.floor = point.floor.or(row.floor);
        let judged = row.value.map(|value| (value, row.verdict));
        match row.metric.as_str() {
            "kappa" => point.raw = row.value,
            "kappa_scaled" => point.scaled = row.value,
            "kappa_exponent" => point.exponents[0] = judged,
            "kappa_scaled_exponent" => point.exponents[1] = judged,
            _ => point.reason = &row.reason,
        }
    }
    let family = |(name, points): (&'a str, BTreeMap<_, Point<'a>>)| {
        let points: Vec<Point> = points.into_values().collect();
        let fit = |of: fn(&Point) -> Option<f64>| power_law(points.iter().filter_map(|point| Some((point.size as f64, of(point)?))));
        let (raw, scaled) = (fit(|point| point.raw), fit(|point| point.scaled));
        Family { name, points, raw, scaled }
    };
    found.into_iter().map(family).collect()
}

/// Makes the section, if the run has condition numbers.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let (families, bases) = (families(overview, rows), floating_base::bases(overview, rows));
    if families.is_empty() && bases.is_empty() {
        return Vec::new();
    }
    let body = html! {
        section #conditioning {
            h2 { "Conditioning" }
            @if !families.is_empty() { (chains(overview, &families)) }
            @if !bases.is_empty() { (floating_base::body(overview, &bases)) }
        }
    };
    vec![Section::new("conditioning", "Conditioning", body)]
}

fn chains(overview: &Overview, families: &[Family]) -> Markup {
    html! {
        p.lead {
            "How the condition number of M grows with the length of a straight chain, and how little it says. Left: κ of M, and of M scaled to a unit diagonal. "
            "Right, on one scale: the relative error that κ would excuse, κ·2⁻⁵³, and the conditioning bound, which rounding the inputs makes unavoidable."
        }
        div.pair {
            (drawings::chains(overview, families))
        }
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "robot" } th scope="col" { "family" } th.number scope="col" { "n" } th.number scope="col" { "κ(M)" } th.number scope="col" { "local exponent" }
                        th.number scope="col" { "κ scaled" } th.number scope="col" { "local exponent" } th.number scope="col" { "bound" } th.number scope="col" { "κ·2⁻⁵³ / bound" }
                    }
                }
                tbody { @for family in families { @for point in &family.points { (row(overview, family, point)) } } }
            }
        }
        p.note {
            "Local exponent: log₂ κ(n)/κ(n/2). κ of a straight chain grows as n⁴ (Featherstone 2004), scaled or not. "
            "κ scaled is of D^-½ M D^-½ with D = diag M. Both by eigenvalues at the straight configuration."
        }
    }
}

fn row(overview: &Overview, family: &Family, point: &Point) -> Markup {
    let number = |value: Option<f64>| value.map(|value| format!("{value:.3e}")).unwrap_or_default();
    let exponent = |exponent: Option<(f64, Verdict)>| {
        html! {
            @if let Some((value, verdict)) = exponent {
                @if !matches!(verdict, Verdict::Info) { span.badge.(verdict.as_str()) { (labels::glyph(verdict)) } " " }
                (format!("{value:.3}"))
            }
        }
    };
    let excess = point.raw.zip(point.floor).filter(|&(_, floor)| floor > 0.0).map(|(raw, floor)| 0.5 * f64::EPSILON * raw / floor);
    html! {
        tr {
            th scope="row" { (opener(&robot_chunk(point.robot), &[("study", STUDY)], overview.robots[point.robot].name)) }
            td { (family.name) }
            td.number { (point.size) }
            @if point.raw.is_none() && !point.reason.is_empty() {
                td colspan="6" { (point.reason) }
            } @else {
                td.number { (number(point.raw)) }
                td.number { (exponent(point.exponents[0])) }
                td.number { (number(point.scaled)) }
                td.number { (exponent(point.exponents[1])) }
                td.number { (number(point.floor)) }
                td.number { @if let Some(excess) = excess { (short(excess)) } }
            }
        }
    }
}
