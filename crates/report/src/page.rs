//! The page: its frame, and its sections in order.

use featherbench_results::{CSV_NAME, RUN_NAME, Row, RunInfo, SCHEMA_NAME};
use maud::{DOCTYPE, Markup, html};

use crate::figures::Figures;
use crate::findings::Findings;
use crate::imports::Imports;
use crate::overview::{Overview, REPRODUCTIONS};
use crate::truth::Truth;
use crate::{
    accuracy_section, conditioning, conventions, heatmap, imports, joint_matrix, known, method, pairwise, plots, provenance, speed_section,
    steps, tradeoff, truth, unpassed, verdict,
};

/// The sections: anchor, entry in the navigation.
const SECTIONS: &[(&str, &str)] = &[
    ("verdict", "Verdict"),
    ("agreement", "Agreement"),
    ("import", "Imports"),
    ("joints", "Joints"),
    ("accuracy", "Accuracy"),
    ("depth", "Error"),
    ("time", "Time"),
    ("speed", "Speed"),
    ("tradeoff", "Work–precision"),
    ("conditioning", "Conditioning"),
    ("steps", "Steps"),
    ("pairs", "Pairs"),
    ("conventions", "Conventions"),
    ("known", "Known deviations"),
    ("provenance", "Provenance"),
    ("method", "Method"),
    ("unpassed", "Not passed"),
];

/// The whole page as text.
pub fn render(run: &RunInfo, records: &[Row], overview: &Overview, figures: &Figures) -> String {
    let findings = Findings::of(run, overview, records);
    let truth = Truth::of(overview, &figures.accuracy, records);
    let readings = Imports::of(overview, records);
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
                (header(run, overview, figures, &readings))
                main {
                    (verdict::section(run, overview, records, &findings, truth::markup(overview, &figures.accuracy, &truth)))
                    (heatmap::section(overview, &findings))
                    (imports::section(overview, &readings))
                    (joint_matrix::section(overview, &figures.joints))
                    (accuracy_section::section(overview, &figures.accuracy))
                    (plots::depth(figures))
                    (plots::time(overview, figures))
                    (speed_section::section(run, overview, &figures.speed))
                    (tradeoff::section(overview, &figures.tradeoffs))
                    (conditioning::section(overview, &figures.conditions))
                    (steps::section(overview, &figures.steps))
                    (pairwise::section(overview, records))
                    (conventions::section(run))
                    (known::section(records))
                    (provenance::section(run, overview))
                    (method::section(run, overview, figures))
                    (unpassed::section(records))
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

/// A button that opens rows: those of a chunk whose columns have the given values.
pub fn opener(chunk: &str, filters: &[(&str, &str)], text: &str) -> Markup {
    let filters: serde_json::Map<String, serde_json::Value> =
        filters.iter().filter(|(_, value)| !value.is_empty()).map(|&(column, value)| (column.to_owned(), value.into())).collect();
    html! {
        button.open type="button" data-chunk=(chunk) data-filter=(serde_json::Value::from(filters)) { (text) }
    }
}

/// The sections of this run: some need rows of their own.
fn sections(overview: &Overview, figures: &Figures, readings: &Imports) -> impl Iterator<Item = (&'static str, &'static str)> {
    let absent = |anchor| match anchor {
        "import" => readings.is_empty(),
        "joints" => figures.joints.rows.is_empty(),
        "accuracy" => figures.accuracy.answers.is_empty(),
        "speed" => figures.speed.is_empty(),
        "tradeoff" => figures.tradeoffs.is_empty(),
        "conditioning" => figures.conditions.is_empty(),
        "known" => !overview.studies.contains(&REPRODUCTIONS),
        "steps" => figures.steps.is_empty(),
        _ => false,
    };
    SECTIONS.iter().copied().filter(move |&(anchor, _)| !absent(anchor))
}

fn header(run: &RunInfo, overview: &Overview, figures: &Figures, readings: &Imports) -> Markup {
    html! {
        header {
            div.bar {
                a.brand href="#verdict" {
                    (logo())
                    span { "featherbench" }
                }
                nav aria-label="Sections" {
                    @for (anchor, name) in sections(overview, figures, readings) { a href={ "#" (anchor) } { (name) } }
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
