//! Section: what the numbers mean, what is and is not included, and how to get them again.

use featherbench_results::RunInfo;
use maud::{Markup, html};

use crate::figures::Figures;
use crate::labels::QUANTITIES;
use crate::overview::Overview;

/// Writes the section.
pub fn section(run: &RunInfo, overview: &Overview, figures: &Figures) -> Markup {
    let quantities = [overview.quantities.as_slice(), &figures.accuracy.quantities()].concat();
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
                        @if !figures.accuracy.answers.is_empty() { " Accuracy of forward dynamics are in the 2-norm for the comparison with published tables." }
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
                        @if !figures.accuracy.answers.is_empty() {
                            dt { "Truth" }
                            dd { "The reference of the digits is the answer in double-double arithmetic, 32 digits, from the description's own numbers. A gate on forward dynamics there is on ‖Δq̈‖_M / ‖q̈‖_M, against what a backward error of its size amounts to at that state." }
                            dt { "Accuracy lost" }
                            dd { "log₁₀(error/2⁻⁵²), none below. Medians and quartiles are over the states." }
                            dt { "Structured floor" }
                            dd { "How far the true q̈ moves, in the 2-norm and relative to itself, when q, q̇, τ and every mass, length and inertia moves by half a unit in its last place and all of it adds up: a worst case. Roundings of random sign leave about a tenth of it, so an error may lie below the floor." }
                        }
                        @if !figures.times.is_empty() {
                            dt { "Times" }
                            dd { "One thread, pinned to one core where the system allows it, after all accuracy work is done. stream reads another state at each call, hot the same one again. Inside the clock is everything from q, q̇, q̈ or τ to the result: sines and cosines, gravity, rotors' inertia; only factorization and solve start from a mass matrix or factors made before. Everyone who is timed has one block per round, in random order, beside a second copy of ours; a value is the median over the rounds, its bars the 95 % interval of a bootstrap that draws whole epochs, each with a memory layout of its own." }
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
    for label in QUANTITIES.iter().filter(|label| !label.measure.is_empty() && quantities.contains(&label.name)) {
        match measures.last_mut().filter(|(_, measure)| *measure == label.measure) {
            Some((titles, _)) => titles.push(label.title),
            None => measures.push((vec![label.title], label.measure)),
        }
    }
    measures
}
