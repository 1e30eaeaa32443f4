//! The section of the page for the catalogue of a run's failures.

use super::catalogue::{CATALOGUE, Catalogue, Line, Reduction, Status};
use featherbench_report::Section;
use featherbench_report::numbers::{count, short};
use maud::{Markup, html};

/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[(
    "Reduced case",
    "The smallest robot and state that still show a failure, with at least a tenth of its error by the measure of its study. It is found by steps, each of which takes something away: a subtree, a joint, a coordinate, a digit.",
)];

/// The section of a catalogue, which stands beside the pages of its run.
///
/// ```
/// use featherbench_reduction::{Catalogue, section};
///
/// let section = section(&Catalogue { runs: vec!["a".into()], lines: Vec::new() });
/// assert!(section.anchor == "catalogue" && section.appendix);
/// ```
pub fn section(catalogue: &Catalogue) -> Section {
    Section { appendix: true, terms: TERMS, ..Section::new("catalogue", "Catalogue", body(catalogue)) }
}

fn body(catalogue: &Catalogue) -> Markup {
    let cases: Vec<(&Line, &Reduction)> = catalogue.lines.iter().filter_map(|line| Some((line, line.reduction()?))).collect();
    let others = catalogue.lines.len() - cases.len();
    html! {
        section #catalogue {
            h2 { "Catalogue of failures" }
            p.lead {
                "Each known deviation of each engine, and each method that fails or has an error above rounding: "
                (count(cases.len(), "reduced case")) " among " (count(catalogue.lines.len(), "line")) ". A case has its robot, its state with the true "
                "answer, and where the engine has the joints a program in the engine's own interface. "
                a href={ (CATALOGUE) "/README.md" } { "The same as text" }
            }
            h3 { "Reduced cases" }
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "engine" } th scope="col" { "what" } th scope="col" { "robot" }
                            th.number scope="col" { "bodies" } th.number scope="col" { "error" }
                            th.number scope="col" { "bodies, reduced" } th.number scope="col" { "error, reduced" }
                            th scope="col" { "joints, reduced" } th scope="col" { "files" } th scope="col" { "cause" }
                        }
                    }
                    tbody { @for (line, case) in &cases { (reduced(line, case)) } }
                }
            }
            h3 { "Known deviations without a case: " (others) }
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "engine" } th scope="col" { "what" } th scope="col" { "why there is no case" }
                            th scope="col" { "reproduction" } th scope="col" { "cause" }
                        }
                    }
                    tbody { @for line in &catalogue.lines { @if let Status::None { why } = &line.status { (without(line, why)) } } }
                }
            }
        }
    }
}

fn reduced(line: &Line, case: &Reduction) -> Markup {
    let without = case.without.as_deref().unwrap_or_default();
    let error = |error: Option<f64>| error.map_or_else(|| without.to_owned(), short);
    let joints: Vec<String> =
        case.joints.iter().map(|(kind, many)| if *many == 1 { kind.clone() } else { format!("{many} {kind}") }).collect();
    html! {
        tr {
            th scope="row" { (line.engine) }
            td { (line.class) }
            td { (case.robot) }
            td.number { (case.bodies) }
            td.number { (error(case.error)) }
            td.number { (case.reduced_bodies) }
            td.number { (error(case.reduced_error)) }
            td { (joints.join(", ")) }
            td {
                @for (at, file) in case.files.iter().enumerate() {
                    @if at > 0 { ", " }
                    a href={ (CATALOGUE) "/" (line.name) "/" (file) } { (file) }
                }
            }
            td { (line.reason) }
        }
    }
}

fn without(line: &Line, why: &str) -> Markup {
    html! {
        tr {
            th scope="row" { (line.engine) }
            td { (line.class) }
            td { (why) }
            td { @match &line.reproduction { Some(name) => { code { (name) } }, None => { "none" } } }
            td { (line.reason) }
        }
    }
}
