//! The times that other machines recorded, of the machine that the reader chooses.

use featherbench_report::choices::{Choices, List};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Part, engine, labels};
use featherbench_results::RecordedTimes;
use maud::{Markup, html};

use super::TIMED;
use super::section::{NARROW, NONE, ratio};

/// The tables, one for each machine; nothing without any.
pub(super) fn recorded(overview: &Overview, times: &[RecordedTimes]) -> (Markup, Vec<Part>) {
    let mut machines: Vec<(String, Vec<&RecordedTimes>)> = Vec::new();
    for of in times {
        // Two records of one kind of machine have a day each.
        let name = format!("{}, {}", of.machine, of.started.get(..10).unwrap_or(&of.started));
        match machines.iter_mut().find(|(known, _)| *known == name) {
            Some((_, own)) => own.push(of),
            None => machines.push((name, vec![of])),
        }
    }
    let Some((first, _)) = machines.first() else { return (html! {}, Vec::new()) };
    let lists = vec![List::of("ranking-machine", "Machine", machines.iter().map(|(name, _)| name.as_str()))];
    let (opening, title) = (vec![first.clone()], "Recorded times");
    let drawings = machines.into_iter().map(|(name, own)| (vec![name], table(overview, &own))).collect();
    let (body, parts) = Choices { name: "ranking-machines", title, lists, opening, drawings }.made();
    let body = html! {
        h3 #recorded { "Recorded times over ours" }
        p { "Medians over robots, with the least and the most. The suite " code { "timing" } " measured them on that machine, ours too." }
        (body)
    };
    (body, parts)
}

/// What one machine measured.
fn table(overview: &Overview, times: &[&RecordedTimes]) -> Markup {
    let mut engines: Vec<(&str, &str)> = times.iter().map(|of| (of.engine.as_str(), of.version.as_str())).collect();
    engines.dedup();
    html! {
        div.scroll { table.compact {
            thead { tr { th scope="col" { "engine" } @for (quantity, short) in TIMED.into_iter().zip(NARROW) { th.number scope="col" title=(labels::quantity(quantity)) { (short) } } } }
            tbody { @for (name, version) in engines {
                tr {
                    th scope="row" { (engine(overview, name)) " " small { (version) } }
                    @for quantity in TIMED { td.number {
                        @match times.iter().find(|of| of.engine == name && of.quantity == quantity) {
                            Some(of) => { b { (ratio(of.median, of.estimated)) } " " small { (short(of.least)) " to " (short(of.most)) ", " (of.robots) " robots" } },
                            None => (NONE),
                        }
                    } }
                }
            } }
        } }
    }
}
