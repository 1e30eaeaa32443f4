//! Section: counts, fill-in, time, memory and error as robots grow. Rows are of the studies `scaling` and `growth`.

mod answer;
mod data;
mod drawings;
mod figures;
mod others;
mod several;

use answer::{Answer, answer, memory};
use data::{Data, Error, GROWTH, Ratios, SCALING, Series, Tree};
use featherbench_report::numbers::{grouped, short};
use featherbench_report::{Overview, Section, labels, opener, robot_chunk};
use featherbench_results::{Row, RunInfo, Verdict};
use figures::memory as memory_figure;
use maud::{Markup, html};

/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[(
    "Scaling",
    "Counts are those of the theory: with d the depth of a degree of freedom, n + Σ(d−1) stored numbers, D1 = Σ(d−1) divisions and D2 = Σ d(d−1)/2 multiply-subtracts. Fill-in is what an order of elimination adds to the stored numbers of M. Every time and memory is of a process of its own, with limits of memory and time; the memory is what is resident after the last call, program and libraries included. Its growth per degree of freedom is between the last two sizes. Exponents are fitted to the last two decades of sizes, with bootstrap intervals over blocks of calls. The conditioning bound of large robots is an estimate.",
)];

/// Makes the section, if the run has rows of either study.
pub(crate) fn sections<'a>(run: &'a RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let data = Data::of(overview, rows);
    if data.is_empty() {
        return Vec::new();
    }
    let answer = answer(run, overview, &data);
    let (drawn, parts) = if data.series.is_empty() { (html! {}, Vec::new()) } else { drawings::drawings(overview, &data) };
    let body = body(overview, &data, &answer, &drawn);
    let lines = answer.own.iter().map(|own| format!("scaling: {own}")).collect();
    let figures = memory_figure(overview, &data).into_iter().collect();
    vec![Section { terms: TERMS, lines, figures, parts, ..Section::new("scaling", "Scaling", body) }]
}

fn body(overview: &Overview, data: &Data, answer: &Answer, drawn: &Markup) -> Markup {
    html! {
        section #scaling {
            h2 { "Scaling" }
            @if let Some(own) = &answer.own {
                p #scaling-answer { strong { (own) } }
            }
            @if !answer.others.is_empty() {
                ul #scaling-stops {
                    @for (engine, stop) in &answer.others { li { strong { (engine) } " " (stop) } }
                }
            }
            p.lead {
                "How time, memory and error grow with the degrees of freedom, and what the sparsity of trees saves. "
                "Every engine is measured in a process of its own, with a limit of memory and of time."
            }
            @if !data.series.is_empty() { (growth(overview, data, drawn)) }
            @if !data.ratios.is_empty() { (crossovers(data)) }
            @if !data.beside.is_empty() || !data.shares.is_empty() { (several::cores(overview, data)) }
            @if !data.errors.is_empty() { (errors(overview, &data.errors)) }
            @if !data.trees.is_empty() { (trees(overview, &data.trees)) }
            @if !data.others.is_empty() { (others::table(overview, &data.others)) }
        }
    }
}

/// The quantities that are measured, with their words.
fn quantities<'a>(data: &Data<'a>) -> Vec<&'a str> {
    ["fd", "id", "momentum", "mass_matrix_sparse", "factorization", "solve"]
        .into_iter()
        .filter(|name| data.series.iter().any(|one| one.quantity == *name))
        .collect()
}

fn growth(overview: &Overview, data: &Data, drawn: &Markup) -> Markup {
    html! {
        (drawn)
        p.note {
            "Time of one call, bars are 95 % intervals of the median. A cross is an estimate. A hollow mark does not count: that engine has no clock, "
            "and its time includes an exchange of messages. Memory is resident, program and libraries included. Error is ‖a − truth‖₂ / ‖truth‖₂. "
            "Ratio: our methods over the serial one, in time; the mass matrix over articulated bodies in counted operations too. A method's last number is its threads."
        }
        h3 { "How far each method goes" }
        div.scroll {
            table #scaling-limits.compact.sortable {
                thead { tr {
                    th scope="col" { "engine" } th scope="col" { "family" } th scope="col" { "quantity" } th scope="col" { "method" }
                    th.number scope="col" { "largest n" } th.number scope="col" { "exponent of time" } th.number scope="col" { "memory per dof" } th.number scope="col" { "exponent of memory" } th scope="col" { "why not larger" }
                } }
                tbody { @for one in &data.series { (limit(overview, one)) } }
            }
        }
    }
}

fn limit(overview: &Overview, one: &Series) -> Markup {
    let chunk = one.points.last().map(|point| robot_chunk(point.robot));
    let engine = overview.engines[one.engine];
    html! {
        tr {
            th scope="row" {
                @if let Some(chunk) = chunk {
                    (opener(&chunk, &[("study", GROWTH), ("engine", engine), ("method", one.method)], engine))
                } @else { (engine) }
            }
            td { (one.line) }
            td { (labels::quantity(one.quantity)) }
            td { (one.method) }
            td.number { @if let Some(largest) = one.largest { (grouped(largest as usize)) } @else { span.badge.error { (labels::glyph(Verdict::Error)) } } }
            td.number { @if let Some([p, low, high]) = one.exponent { (format!("{p:.2} [{low:.2}, {high:.2}]")) } }
            td.number { @if let Some(bytes) = one.memory_per_dof { (memory(bytes)) } }
            td.number { @if let Some(exponent) = one.memory_exponent { (format!("{exponent:.2}")) } }
            td { @if one.reason.is_empty() { "the largest that was asked" } @else { (one.reason) } }
        }
    }
}

fn crossovers(data: &Data) -> Markup {
    let range = |points: &[(usize, u64, f64)]| match points {
        [(_, n, first), .., (_, m, last)] => {
            format!("{} at n = {} to {} at n = {}", short(*first), grouped(*n as usize), short(*last), grouped(*m as usize))
        }
        [(_, n, only)] => format!("{} at n = {}", short(*only), grouped(*n as usize)),
        [] => String::new(),
    };
    let predicted = |ratios: &Ratios, lanes: f64| ratios.predicted.iter().find(|(of, _)| *of == lanes).map(|(_, at)| *at);
    let at = |found: Option<f64>| found.map_or_else(|| "none".to_owned(), |at| format!("n = {}", short(at)));
    html! {
        h3 { "Mass matrix or articulated bodies" }
        p.note {
            "The way by M, h and LᵀDL over the articulated-body algorithm: below one the mass matrix is faster. Operations are counted: sums, products and "
            "fused multiply-adds weigh 1, divisions and roots 8. The mass matrix has several numbers to a register in all its parts, the articulated-body "
            "algorithm mostly one. So the crossing is predicted for 1, 4 and 8 numbers to a register."
        }
        div.scroll {
            table #scaling-crossovers.compact {
                thead { tr {
                    th scope="col" { "family" } th scope="col" { "operations, ratio" } th scope="col" { "times, ratio" }
                    th.number scope="col" { "crossing, 1 lane" } th.number scope="col" { "4 lanes" } th.number scope="col" { "8 lanes" } th.number scope="col" { "measured" }
                } }
                tbody {
                    @for ratios in &data.ratios {
                        tr {
                            th scope="row" { (ratios.line) }
                            td { (range(&ratios.work)) }
                            td { (range(&ratios.time)) }
                            @for lanes in [1.0, 4.0, 8.0] { td.number { @if !ratios.work.is_empty() { (at(predicted(ratios, lanes))) } } }
                            td.number { @if !ratios.time.is_empty() { (at(ratios.measured)) } }
                        }
                    }
                }
            }
        }
    }
}

fn badge(verdict: Verdict) -> Markup {
    html! { @if verdict != Verdict::Info { span.badge.(verdict.as_str()) title=(labels::verdict(verdict)) { (labels::glyph(verdict)) } " " } }
}

fn errors(overview: &Overview, errors: &[Error]) -> Markup {
    let number = |value: Option<f64>| value.map(short).unwrap_or_default();
    html! {
        h3 { "Our forward dynamics against the truth" }
        div.scroll {
            table #scaling-errors.compact.sortable {
                thead { tr {
                    th scope="col" { "robot" } th.number scope="col" { "n" } th scope="col" { "method" }
                    th.number scope="col" { "relative error" } th.number scope="col" { "conditioning bound (estimate)" } th.number scope="col" { "error / bound" }
                } }
                tbody {
                    @for error in errors {
                        tr {
                            th scope="row" { (opener(&robot_chunk(error.robot), &[("study", SCALING), ("method", error.method)], overview.robots[error.robot].name)) }
                            td.number { (grouped(error.size as usize)) }
                            td { (error.method) }
                            td.number { (badge(error.verdict)) (number(error.error)) @if error.error.is_none() { (error.reason) } }
                            td.number { (number(error.floor)) }
                            td.number { (number(error.over)) }
                        }
                    }
                }
            }
        }
    }
}

fn trees(overview: &Overview, trees: &[Tree]) -> Markup {
    let count = |tree: &Tree, metric: &str| tree.counts.get(metric).map(|&value| grouped(value as usize)).unwrap_or_default();
    let fill = |tree: &Tree, order: &str| tree.fill.get(order).map(|&value| grouped(value as usize)).unwrap_or_default();
    let number = |value: Option<f64>| value.map(short).unwrap_or_default();
    html! {
        h3 { "Counts and fill-in" }
        p.note {
            "Every count equals the theory's, or the row fails. Fill-in by order of elimination: leaves first, as ours; minimum degree; root first, the natural order. "
            "Errors are per degree of freedom, in units of √(M_ii M_jj)."
        }
        div.scroll {
            table #scaling-counts.compact.sortable {
                thead { tr {
                    th scope="col" { "robot" } th.number scope="col" { "n" } th.number scope="col" { "stored" } th.number scope="col" { "D1" } th.number scope="col" { "D2" } th scope="col" { "by" }
                    th.number scope="col" { "fill, leaves first" } th.number scope="col" { "minimum degree" } th.number scope="col" { "root first" }
                    th.number scope="col" { "LᵀDL − M" } th.number scope="col" { "solution" }
                } }
                tbody {
                    @for tree in trees {
                        tr {
                            th scope="row" {
                                @if let Some(verdict) = tree.verdict { (badge(verdict)) }
                                (opener(&robot_chunk(tree.robot), &[("study", SCALING)], overview.robots[tree.robot].name))
                            }
                            td.number { (grouped(tree.size as usize)) }
                            td.number { (count(tree, "stored")) }
                            td.number { (count(tree, "factor_divisions")) }
                            td.number { (count(tree, "factor_multiply_subtracts")) }
                            td { (tree.route) }
                            @for order in ["leaves_first", "minimum_degree", "root_first"] { td.number { (fill(tree, order)) } }
                            td.number { (number(tree.errors[0])) }
                            td.number { (number(tree.errors[1])) }
                        }
                    }
                }
            }
        }
    }
}
