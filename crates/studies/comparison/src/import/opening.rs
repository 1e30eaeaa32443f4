//! What the first page says of imports, one line for each robot and engine.
//!
//! A line says whether the engine loads the file as it is written, and whether M and τ are the same. It gives the largest change, and what
//! to do.

use super::answers::{Answer, Loads, answers};
use featherbench_report::numbers::{count, short};
use featherbench_report::{Overview, Part, engine, robot};
use featherbench_results::Row;
use maud::{Markup, html};

/// Lines on the first page; the others are a part of their own.
const TOLD: usize = 12;

/// The table of the first page, those first where something differs, and the part with all lines if there are more.
pub(super) fn opening(overview: &Overview, rows: &[Row]) -> (Markup, Option<Part>) {
    let mut all = answers(rows);
    all.sort_by_key(rank);
    let alike = all.iter().filter(|answer| rank(answer) == ALIKE).count();
    let part = (all.len() > TOLD).then(|| Part {
        name: "import-answers".into(),
        title: "Every robot in every engine".into(),
        body: html! { div.scroll.tall { (table(overview, &all)) } },
    });
    let markup = html! {
        div #import-opening {
            h3 { "How each engine loads the file" }
            p { b { (alike) " of " (count(all.len(), "reading")) } " take the file as it is written and have the same M and τ." }
            div.scroll { (table(overview, &all[..all.len().min(TOLD)])) }
            @if let Some(part) = &part { details { summary { (count(all.len() - TOLD, "more reading")) } (part.place()) } }
        }
    };
    (markup, part)
}

/// The rank of a reading that differs in nothing that enters M and τ.
const ALIKE: u8 = 3;

/// The order of the lines: not loaded, another M or τ, altered or without an answer, alike.
fn rank(answer: &Answer) -> u8 {
    match (answer.loads, answer.same) {
        (Loads::No, _) => 0,
        (_, Some(false)) => 1,
        (Loads::Yes, Some(true)) => ALIKE,
        _ => 2,
    }
}

fn table(overview: &Overview, answers: &[Answer]) -> Markup {
    html! {
        table.compact {
            thead { tr {
                th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "loads as written" } th scope="col" { "same M and τ" }
                th scope="col" { "largest change" } th scope="col" { "what to do" }
            } }
            tbody { @for answer in answers {
                tr {
                    th scope="row" { (robot(overview, &answer.robot)) }
                    td { (engine(overview, &answer.engine)) }
                    td { (answer.loads.name()) }
                    td { (answer.same_word()) }
                    td { @if let Some(largest) = &answer.largest { (largest.place()) @if let Some(effect) = largest.effect() { " by " (short(effect)) } } @else { "–" } }
                    td { (answer.advice) }
                }
            } }
        }
    }
}
