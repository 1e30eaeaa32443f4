//! One robot on several cores: times beside the serial method, and counted work and span.

use super::badge;
use super::data::{Beside, Data, SCALING, Shares};
use featherbench_report::numbers::{grouped, short};
use featherbench_report::{Overview, labels, opener, robot_chunk};
use maud::{Markup, html};

/// Both tables.
pub(super) fn cores(overview: &Overview, data: &Data) -> Markup {
    let groups = groups(&data.beside);
    html! {
        h3 { "Our methods beside the serial one" }
        p.note {
            "The time over that of the serial method, at the largest size of both: below one it is faster. A method on several threads divides one robot "
            "between them; on one thread its ratio shows what dividing costs. The crossing is the size where both take the same time, with the most threads."
        }
        @if !groups.is_empty() {
            div.scroll {
                table #scaling-beside.compact.sortable {
                    thead { tr {
                        th scope="col" { "family" } th scope="col" { "quantity" } th scope="col" { "method" } th scope="col" { "beside" } th.number scope="col" { "n" }
                        @for threads in threads(&data.beside) { th.number scope="col" { (cores_of(threads)) } }
                        th.number scope="col" { "crossing" }
                    } }
                    tbody { @for group in &groups { (beside(group, &threads(&data.beside))) } }
                }
            }
        }
        @if !data.shares.is_empty() { (shares(overview, &data.shares)) }
    }
}

/// The entries of one method along one line, by threads.
fn groups<'a, 'b>(all: &'b [Beside<'a>]) -> Vec<Vec<&'b Beside<'a>>> {
    let mut groups: Vec<Vec<&Beside>> = Vec::new();
    for one in all {
        let key = |one: &Beside<'a>| (one.line, one.quantity, one.plain().to_owned());
        match groups.iter_mut().find(|group| group.first().is_some_and(|first| key(first) == key(one))) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups
}

/// The numbers of threads, ascending; a serial method has one.
fn threads(all: &[Beside]) -> Vec<usize> {
    let mut threads: Vec<usize> = all.iter().map(|one| one.threads.unwrap_or(1)).collect();
    threads.sort_unstable();
    threads.dedup();
    threads
}

fn cores_of(threads: usize) -> String {
    if threads == 1 { "ratio, 1 thread".to_owned() } else { format!("{threads} threads") }
}

fn beside(group: &[&Beside], threads: &[usize]) -> Markup {
    let Some(most) = group.iter().max_by_key(|one| one.threads) else { return Markup::default() };
    let largest = most.time.last().map(|(_, size, _)| *size);
    let ratio = |threads: usize| {
        let one = group.iter().find(|one| one.threads.unwrap_or(1) == threads)?;
        one.time.iter().find(|(_, size, _)| Some(*size) == largest).map(|(_, _, ratio)| short(*ratio))
    };
    html! {
        tr {
            th scope="row" { (most.line) }
            td { (labels::quantity(most.quantity)) }
            td { (most.plain()) }
            td { (most.over) }
            td.number { (largest.map(|size| grouped(size as usize)).unwrap_or_default()) }
            @for threads in threads { td.number { (ratio(*threads).unwrap_or_default()) } }
            td.number { (most.crossing.map_or_else(|| "none".to_owned(), |at| format!("n = {}", short(at)))) }
        }
    }
}

fn shares(overview: &Overview, shares: &[Shares]) -> Markup {
    let number = |value: Option<f64>| value.map(short).unwrap_or_default();
    let two = |share: &Shares| Some(0.5 * (share.work? + share.span?));
    html! {
        h3 { "Work and span on several cores" }
        p.note {
            "Counted operations over those of the serial algorithm. Work is all of them; span is what must wait for each other. "
            "On two cores no schedule that keeps them busy takes longer than (work + span) / 2."
        }
        div.scroll {
            table #scaling-shares.compact.sortable {
                thead { tr {
                    th scope="col" { "robot" } th.number scope="col" { "n" } th scope="col" { "quantity" } th scope="col" { "method" }
                    th.number scope="col" { "work" } th.number scope="col" { "span" } th.number scope="col" { "two cores, at most" }
                } }
                tbody {
                    @for share in shares {
                        tr {
                            th scope="row" { (badge(share.verdict)) (opener(&robot_chunk(share.robot), &[("study", SCALING), ("method", share.method)], overview.robots[share.robot].name)) }
                            td.number { (grouped(share.size as usize)) }
                            td { (labels::quantity(share.quantity)) }
                            td { (share.method) }
                            td.number { (number(share.work)) }
                            td.number { (number(share.span)) }
                            td.number { (number(two(share))) }
                        }
                    }
                }
            }
        }
    }
}
