//! The times that other machines recorded, of the machine that the reader chooses.

use featherbench_bench::OWN;
use featherbench_report::choices::{Choices, List};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Part, engine, labels};
use featherbench_results::{Ranking, Times};
use maud::{Markup, html};

use super::TIMED;
use super::section::{NARROW, NONE, ratio};

/// The tables, one for each machine; nothing without any.
pub(super) fn recorded(overview: &Overview, machines: &[Ranking]) -> (Markup, Vec<Part>) {
    // Two records of one kind of machine have a day each.
    let name = |of: &Ranking| format!("{}, {}", of.machine, of.started.get(..10).unwrap_or(&of.started));
    let Some(first) = machines.first() else { return (html! {}, Vec::new()) };
    let lists = vec![List::of("ranking-machine", "Machine", machines.iter().map(name).collect::<Vec<_>>().iter().map(String::as_str))];
    let drawings = machines.iter().map(|of| (vec![name(of)], table(overview, of))).collect();
    let (body, parts) = Choices { name: "ranking-machines", title: "Recorded times", lists, opening: vec![name(first)], drawings }.made();
    let body = html! {
        h3 #recorded { "Recorded times over ours" }
        p { "Medians over robots, with the least and the most. The suite " code { "timing" } " measured them on that machine, ours too." }
        (body)
    };
    (body, parts)
}

/// What one machine measured.
fn table(overview: &Overview, machine: &Ranking) -> Markup {
    let measured = |times: &&Times| times.machines == 0;
    html! {
        div.scroll { table.compact {
            thead { tr { th scope="col" { "engine" } @for (quantity, short) in TIMED.into_iter().zip(NARROW) { th.number scope="col" title=(labels::quantity(quantity)) { (short) } } } }
            tbody { @for of in machine.engines.iter().filter(|of| of.name != OWN && of.times.values().any(|times| measured(&times))) {
                tr {
                    th scope="row" { (engine(overview, &of.name)) " " small { (of.version) } }
                    @for quantity in TIMED { td.number {
                        @match of.times.get(quantity).filter(measured) {
                            Some(times) => { b { (ratio(times)) } " " small { (short(times.least)) " to " (short(times.most)) ", " (times.robots) " robots" } },
                            None => (NONE),
                        }
                    } }
                }
            } }
        } }
    }
}
