//! Section: what the numbers mean, what is and is not included, and how to get them again.

use featherbench_results::{Quantity, RunInfo};
use maud::{Markup, html};

use crate::section::Section;

/// Writes the section, with the quantities and terms of the sections of studies.
pub fn section(run: &RunInfo, sections: &[Section]) -> Section {
    Section::new("method", "Method", body(run, sections))
}

fn body(run: &RunInfo, sections: &[Section]) -> Markup {
    let quantities: Vec<&str> = sections.iter().flat_map(|section| &section.quantities).map(String::as_str).collect();
    html! {
        section #method {
            h2 { "How it was measured" }
            @if !run.command.is_empty() {
                p { "This command reproduces the run:" }
                div.command {
                    pre #command { code { (run.command) } }
                    button #copy type="button" { "Copy" }
                }
            }
            div.columns {
                div {
                    h3 { "Error, in quantities that mean something" }
                    dl.measures {
                        @for (titles, measure) in measures(&quantities) {
                            dt { (titles.join(", ")) }
                            dd { (measure) }
                        }
                    }
                    p.note {
                        "Every error is divided by a size that belongs to it, entry by entry; sums of magnitudes replace every vector of a recursion by its length and every sum by the sum of lengths. "
                        "Zero over zero is zero, anything else over zero infinite. Norms over mixed units, which hide a wrong entry behind large right ones, judge nothing between engines."
                    }
                }
                div {
                    h3 { "What is included" }
                    dl.measures {
                        dt { "Verdict" }
                        dd { "A value stands to its gate as its row says (≤, ≥, =, or |value| ≤). What could not be computed is a row too: an error or a skip with its reason, never a gap. A skip is a question that the engine does not offer to answer: it counts neither for nor against it. A known deviation is a failure, or an error, whose cause is written down; a failure also needs a range that was measured on its robot, and is none beyond it." }
                        dt { "Margin" }
                        dd { "log₁₀(bound/|value|), or log₁₀(value/bound) where the bound is a least value; positive inside; an error of exactly zero counts as 16 decades." }
                        dt { "States" }
                        dd { "random: drawn from the seed; zero: no velocity, acceleration and force; straight: the neutral configuration at random rates; fast: rates a thousand times larger; limit: at the joints' limits, where the robot has any." }
                        dt { "Terms" }
                        dd { "M, inverse and forward dynamics contain the rotors' inertia; inverse and forward dynamics and the bias force contain gravity; damping and dry friction are left out for every engine." }
                        @for (term, definition) in sections.iter().flat_map(|section| section.terms) {
                            dt { (term) }
                            dd { (definition) }
                        }
                        dt { "Recorded and live" }
                        dd {
                            @if run.live { "The engines were asked during this run. " } @else { "The engines' answers were recorded earlier with the versions above, and are compared here anew. " }
                            "Exact rows come out the same, to the byte, whenever the run is repeated; measured rows and this machine's description do not."
                        }
                    }
                }
            }
        }
    }
}

/// The measures of the run's quantities, each with the quantities that share it.
fn measures(quantities: &[&str]) -> Vec<(Vec<&'static str>, &'static str)> {
    let mut measures: Vec<(Vec<&str>, &str)> = Vec::new();
    for quantity in Quantity::ALL.into_iter().filter(|quantity| !quantity.error().is_empty() && quantities.contains(&quantity.name())) {
        match measures.last_mut().filter(|(_, measure)| *measure == quantity.error()) {
            Some((titles, _)) => titles.push(quantity.title()),
            None => measures.push((vec![quantity.title()], quantity.error())),
        }
    }
    measures
}
