//! Sections with plots: error against depth, time against size. The script draws them; their frames, choices and tables are made here.

use std::collections::BTreeSet;

use maud::{Markup, html};

use crate::figures::{Figures, TimeLine};
use crate::fit::Fit;
use crate::labels;
use crate::numbers::short;
use crate::overview::Overview;

/// Error against depth.
pub fn depth(figures: &Figures) -> Markup {
    // Forward dynamics loses digits first; if a run has it, it is the first plot shown.
    let opening = figures.errors.iter().position(|plot| plot.quantity == "fd").unwrap_or(0);
    html! {
        section #depth {
            h2 { "Error against depth" }
            p.lead { "How error grows with the longest path from the base. Each mark is a model's worst row under the choices made here; click it to see its rows." }
            @if figures.errors.is_empty() {
                p.empty { "This run holds no errors of models with a depth." }
            } @else {
                div.controls {
                    label { "Quantity " select #depth-quantity {
                        @for (index, plot) in figures.errors.iter().enumerate() { option value=(index) selected[index == opening] { (plot.title) } }
                    } }
                    label { "Family " select #depth-family { option value="" { "all" } } }
                    label { "States " select #depth-case { option value="" { "all" } } }
                }
                div #depth-plot.plot role="group" aria-label="Plot of error against depth" {}
                p.note {
                    "Dashed: the tightest gate at each depth. Dotted: half the spacing of doubles at 1, 2⁻⁵³. Hollow marks at the lower edge are errors of exactly zero. "
                    "Lines join the worst error at each depth."
                }
            }
        }
    }
}

/// Time against size.
pub fn time(overview: &Overview, figures: &Figures) -> Markup {
    let families: BTreeSet<&str> = figures.times.iter().map(|line| line.family).collect();
    // All families at once are hard to read: the plot first shows the one with the most points.
    let points = |family: &&&str| figures.times.iter().filter(|line| line.family == **family).map(|line| line.points.len()).sum::<usize>();
    let opening = families.iter().max_by_key(points).copied();
    let cases: BTreeSet<&str> = figures.times.iter().map(|line| line.cache).collect();
    html! {
        section #time {
            h2 { "Time against size" }
            p.lead { "Time of one call on one pinned core, against the degrees of freedom. Bars are 95 % intervals of the median, hollow marks times that do not count, crosses estimates." }
            @if figures.times.is_empty() {
                p.empty { "This run holds no times." }
            } @else {
                div.controls {
                    label { "Show " select #time-unit {
                        option value="call" { "ns per call" }
                        option value="joint" { "ns per joint" }
                    } }
                    label { "Inputs " select #time-case {
                        // `stream` first, as it is more realistic: every call reads another state.
                        @for case in cases.iter().rev() { option value=(case) { (case_words(case)) } }
                    } }
                    label { "Family " select #time-family {
                        option value="" { "all" }
                        @for family in &families { option value=(family) selected[Some(*family) == opening] { (family) } }
                    } }
                    label.check { input #time-fit type="checkbox" checked; " fitted lines" }
                }
                div #time-plot.plot role="group" aria-label="Plot of time against size" {}
                details {
                    summary { "Growth: fitted exponents" }
                    p.note { "Time ∝ nvᵖ by least squares on logarithms, with the standard error of p. Small models, where fixed costs rule, flatten a fit over all sizes." }
                    div.scroll { (growth(overview, &figures.times)) }
                }
            }
        }
    }
}

fn case_words(case: &str) -> String {
    match case {
        "stream" => "stream: another state each call".into(),
        "hot" => "hot: one state again and again".into(),
        other => other.to_owned(),
    }
}

fn growth(overview: &Overview, lines: &[TimeLine]) -> Markup {
    let exponent = |fit: Option<Fit>| match fit {
        Some(fit) => html! { (format!("{:.2} ± {:.2}", fit.slope, fit.error)) },
        None => html! { "too few" },
    };
    html! {
        table.compact.sortable {
            thead {
                tr {
                    th scope="col" { "engine" } th scope="col" { "algorithm" } th scope="col" { "family" } th scope="col" { "inputs" }
                    th.number scope="col" { "models" } th.number scope="col" { "p, per call" } th.number scope="col" { "p, per joint" }
                    th.number scope="col" { "largest nv" } th.number scope="col" { "ns per call there" } th.number scope="col" { "ns per joint there" }
                }
            }
            tbody {
                @for line in lines {
                    tr {
                        th scope="row" { (overview.engines[line.engine]) }
                        td { (labels::quantity(line.algorithm)) @if line.method != line.algorithm { " " small { (line.method) } } }
                        td { (line.family) }
                        td { (line.cache) }
                        td.number { (line.points.len()) }
                        td.number { (exponent(line.per_call)) }
                        td.number { (exponent(line.per_joint)) }
                        @if let Some(last) = line.points.last() {
                            td.number { (last.size) }
                            td.number { (short(last.ns)) }
                            td.number { (short(last.ns / last.joints as f64)) }
                        }
                    }
                }
            }
        }
    }
}
