//! A finding in a list: its level, its sentence with links, and the command that repeats it.

use featherbench_results::Severity;
use maud::{Markup, html};

use crate::blocks::{self, opener};
use crate::chunks::UNPASSED;
use crate::drawings::Drawings;
use crate::findings::{Findings, Found, clipped};
use crate::overview::Overview;

/// The class of a level: its colour.
pub fn class(level: Severity) -> &'static str {
    match level {
        Severity::PhysicsDiffers => "physics",
        Severity::MethodLosesDigits => "digits",
        Severity::NotOffered => "absent",
        Severity::Rounding => "rounding",
    }
}

/// The finding as an item of a list, which shows its robot when that is opened.
pub fn card(drawings: &Drawings, found: &Found) -> Markup {
    item(drawings, found, &drawings.place(&found.culprit))
}

/// The finding on the page of its robot, where the drawing is already.
pub fn card_of_robot(drawings: &Drawings, found: &Found) -> Markup {
    item(drawings, found, &html! {})
}

fn item(drawings: &Drawings, found: &Found, drawing: &Markup) -> Markup {
    let overview = drawings.overview;
    let level = found.severity.map_or("condition", class);
    html! {
        li class=(if found.new { "fail" } else { "known" }) {
            span class={ "level " (level) } { (found.level()) @if found.new { ", new" } } " "
            b { (who(drawings, found)) } ": " (found.size_words())
            @if let Some(worst) = found.worst {
                @let here = [("engine", worst.engine.as_str()), ("quantity", worst.quantity.as_str()), ("verdict", worst.verdict.as_str())];
                @let all = [("engine", worst.engine.as_str()), ("verdict", worst.verdict.as_str())];
                " on " @if !worst.robot.is_empty() { (blocks::robot(overview, &worst.robot)) ", " }
                (opener(&overview.chunk_of(worst), &here, &if found.case().is_empty() { worst.study.clone() } else { found.case() }))
                "; " (opener(UNPASSED, if found.quantities.len() == 1 { &here[..] } else { &all[..] }, &found.extent())) "."
                (drawings.figure(worst))
                @if !found.cause.is_empty() { " " span.cause { @if !found.new { "Known: " } (found.cause) } }
            } @else {
                @if !found.place().is_empty() { " (" (place(overview, found)) ")" }
                @if !found.cause.is_empty() { "; " span.cause { (clipped(&found.cause)) } }
            }
            @if !found.again.is_empty() {
                details.again { summary { "Repeat it" } pre { code { (found.again) } } }
            }
            (drawing)
        }
    }
}

/// The robot, which leads to its page, and the method.
fn place(overview: &Overview, found: &Found) -> Markup {
    let (robot, case) = (&found.culprit.robot, found.case());
    html! { (blocks::robot(overview, robot)) @if !(robot.is_empty() || case.is_empty()) { ", " } (case) }
}

/// The first line of a page, whose engine leads to its page.
pub fn headline(drawings: &Drawings, findings: &Findings) -> Markup {
    match findings.loudest() {
        Some(found) => html! { (who(drawings, found)) ": " (found.size_words()) },
        None => html! { (findings.headline()) },
    }
}

/// The engine, which leads to its page, and the quantities.
fn who(drawings: &Drawings, found: &Found) -> Markup {
    let words = found.who();
    match words.strip_prefix(found.culprit.engine.as_str()).filter(|_| !found.culprit.engine.is_empty()) {
        Some(rest) => html! { (blocks::engine(drawings.overview, &found.culprit.engine)) (rest) },
        None => html! { (words) },
    }
}
