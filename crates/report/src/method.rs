//! Section: what the numbers mean, what is and is not included, and how to get them again.

use maud::{Markup, html};
use record::RunInfo;

use crate::figures::Figures;
use crate::labels::QUANTITIES;
use crate::overview::Overview;

/// Writes the section.
pub fn section(run: &RunInfo, overview: &Overview, figures: &Figures) -> Markup {
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
                        @for (titles, measure) in measures(overview) {
                            dt { (titles.join(", ")) }
                            dd { (measure) }
                        }
                    }
                    p.note {
                        "Every error is divided by a size that belongs to it, entry by entry. Norms over mixed units, and Frobenius or 2-norms, "
                        "which hide a wrong entry behind large right ones, judge nothing here."
                    }
                }
                div {
                    h3 { "What is included" }
                    dl.measures {
                        dt { "Verdict" }
                        dd { "A value stands to its gate as its row says (≤, ≥, =, or |value| ≤). What could not be computed is a row too: an error or a skip with its reason, never a gap. A known deviation is a failure whose cause is written down." }
                        dt { "Margin" }
                        dd { "log₁₀(bound/|value|), or log₁₀(value/bound) where the bound is a least value; positive inside; an error of exactly zero counts as 16 decades." }
                        dt { "States" }
                        dd { "random: drawn from the seed; zero and straight: the configurations in which terms vanish; fast: velocities a thousand times larger; limit: at the joints' limits." }
                        dt { "Terms" }
                        dd { "M, inverse and forward dynamics and the bias force contain gravity and rotor inertia; damping and dry friction are left out for every engine." }
                        @if !figures.times.is_empty() {
                            dt { "Times" }
                            dd { "One thread on one pinned core, after all accuracy work is done. stream reads another state at each call, hot the same state from the cache. Loading a model, allocating workspaces and converting coordinates are outside the clock; reading the inputs and writing the result are inside." }
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
fn measures(overview: &Overview) -> Vec<(Vec<&'static str>, &'static str)> {
    let mut measures: Vec<(Vec<&str>, &str)> = Vec::new();
    for label in QUANTITIES.iter().filter(|label| overview.quantities.contains(&label.name)) {
        match measures.last_mut().filter(|(_, measure)| *measure == label.measure) {
            Some((titles, _)) => titles.push(label.title),
            None => measures.push((vec![label.title], label.measure)),
        }
    }
    measures
}
