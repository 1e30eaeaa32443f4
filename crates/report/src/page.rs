//! The page: its frame, and its sections in order.

use featherbench_results::{CSV_NAME, RUN_NAME, Row, RunInfo, SCHEMA_NAME};
use maud::{DOCTYPE, Markup, html};

use crate::overview::Overview;
use crate::section::Section;
use crate::{conventions, figures, method, provenance, unpassed, verdict};

/// The whole page as text.
pub fn render(run: &RunInfo, rows: &[Row], overview: &Overview, sections: &[Section]) -> String {
    // The frame's own sections stand around those of the studies.
    let (first, conventions) = (verdict::section(run, overview, rows, sections), conventions::section(run));
    let figures = figures::section(run, sections);
    let last = [provenance::section(run, overview), method::section(run, sections), unpassed::section(rows)];
    let of_studies = |appendix: bool| sections.iter().filter(move |section| section.appendix == appendix);
    let all: Vec<&Section> =
        [&first].into_iter().chain(of_studies(false)).chain(&figures).chain([&conventions]).chain(of_studies(true)).chain(&last).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "featherbench: " (run.suite) " " (run.run) }
                link rel="stylesheet" href="style.css";
                // The first is small, defines the function that the data scripts call, and sets the theme before anything is drawn.
                script src="app.js" {}
                script defer src="data/overview.js" {}
                script defer src="data/figures.js" {}
            }
            body {
                a.to-content href="#verdict" { "Skip to the verdict" }
                (header(run, &all))
                main {
                    @for section in &all { (section.body) }
                }
                footer {
                    p {
                        "Made by featherbench " (run.version) " from the rows of run " code { (run.run) } ": "
                        a href=(CSV_NAME) { (CSV_NAME) } ", "
                        a href=(RUN_NAME) { (RUN_NAME) } ", columns described in "
                        a href=(SCHEMA_NAME) { (SCHEMA_NAME) } "."
                    }
                }
                (rows_dialog())
                div #tip role="tooltip" hidden {}
                noscript { p.notice { "Without scripts the tables can be read; plots and the rows behind each cell need them." } }
            }
        }
    };
    page.into_string()
}

fn header(run: &RunInfo, sections: &[&Section]) -> Markup {
    html! {
        header {
            div.bar {
                a.brand href="#verdict" {
                    (logo())
                    span { "featherbench" }
                }
                nav aria-label="Sections" {
                    @for section in sections { a href={ "#" (section.anchor) } { (section.name) } }
                }
                button #theme type="button" aria-label="Switch between light and dark" title="Light or dark" { "◐" }
            }
            p.run {
                span { "suite " b { (run.suite) } }
                @if !run.started.is_empty() { span { (run.started) } }
                @if !run.host.cpu.is_empty() { span { (run.host.cpu) } }
                span { @if run.live { "engines asked live" } @else { "recorded engine answers" } }
                span { "run " code { (run.run) } }
            }
        }
    }
}

/// The logo: a feather of three lines on a quill, like the bars of a chart.
fn logo() -> Markup {
    html! {
        svg viewBox="0 0 24 24" width="24" height="24" aria-hidden="true" {
            path d="M4 21 C6 14 10 8 20 3" fill="none" stroke="currentColor" stroke-width="1.8" stroke-linecap="round" {}
            path d="M7 15 H14 M9.5 11 H17.5 M13 7.2 H20" fill="none" stroke="currentColor" stroke-width="1.8" stroke-linecap="round" {}
        }
    }
}

/// The place for rows after a click; the script fills it.
fn rows_dialog() -> Markup {
    html! {
        dialog #rows aria-labelledby="rows-title" {
            div.rows-head {
                h2 #rows-title { "Rows" }
                p #rows-count role="status" {}
                button #rows-close type="button" aria-label="Close" { "✕" }
            }
            form #rows-filters method="dialog" {}
            div #rows-table tabindex="0" {}
        }
    }
}
