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
/// use featherbench_studies::reduce::{Catalogue, section};
///
/// let section = section(&Catalogue { run: "a".into(), lines: Vec::new() });
/// assert!(section.anchor == "catalogue" && section.appendix);
/// ```
pub fn section(catalogue: &Catalogue) -> Section {
    Section { appendix: true, terms: TERMS, ..Section::new("catalogue", "Catalogue of failures", body(catalogue)) }
}

fn body(catalogue: &Catalogue) -> Markup {
    let cases = catalogue.lines.iter().filter(|line| line.reduction().is_some()).count();
    html! {
        section #catalogue {
            h2 { "Catalogue of failures" }
            p.lead {
                "Each known deviation of each engine, and each method that fails or has an error above rounding: "
                (count(cases, "reduced case")) " among " (count(catalogue.lines.len(), "line")) ". A case has its robot, its state with the true answer, "
                "and where the engine has the joints a program in the engine's own interface. "
                a href={ (CATALOGUE) "/README.md" } { "The same as text" }
            }
            div.scroll {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "engine" } th scope="col" { "what" } th scope="col" { "cause" } th scope="col" { "robot" }
                            th.number scope="col" { "bodies" } th.number scope="col" { "error" }
                            th.number scope="col" { "bodies, reduced" } th.number scope="col" { "error, reduced" }
                            th scope="col" { "joints, reduced" } th scope="col" { "files" } th scope="col" { "reproduction" }
                        }
                    }
                    tbody { @for line in &catalogue.lines { (row(line)) } }
                }
            }
        }
    }
}

fn row(line: &Line) -> Markup {
    html! {
        tr {
            th scope="row" { (line.engine) }
            td { (line.class) }
            td { (line.reason) }
            @match &line.status {
                Status::Reduced(case) => { (reduced(line, case)) }
                Status::None { why } => {
                    td {} td {} td {} td {} td {} td {}
                    td { "no case: " (why) }
                }
            }
            td { @match &line.reproduction { Some(name) => { code { (name) } }, None => { "none" } } }
        }
    }
}

fn reduced(line: &Line, case: &Reduction) -> Markup {
    let without = case.without.as_deref().unwrap_or_default();
    let error = |error: Option<f64>| error.map_or_else(|| without.to_owned(), short);
    let joints: Vec<String> =
        case.joints.iter().map(|(kind, many)| if *many == 1 { kind.clone() } else { format!("{many} {kind}") }).collect();
    html! {
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
    }
}
