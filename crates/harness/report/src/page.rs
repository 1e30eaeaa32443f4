//! The page: its frame, and its sections in order.

use featherbench_results::{CSV_NAME, RUN_NAME, Row, RunInfo, SCHEMA_NAME};
use maud::{DOCTYPE, Markup, html};

use crate::drawings::Drawings;
use crate::parts::{self, Piece};
use crate::section::Section;
use crate::subjects::Subject;
use crate::{conventions, figures, method, provenance, unpassed, verdict};

/// The frame's sections at the end of the page.
const LAST: usize = 3;

/// All sections of a run: those of the studies, and the frame's own around them.
pub struct Page<'a> {
    run: &'a RunInfo,
    own: Vec<Section>,
    studies: &'a [Section],
}

impl<'a> Page<'a> {
    /// Makes the frame's own sections. `archive` is the checksum of the run's files.
    pub fn of(run: &'a RunInfo, rows: &[Row], drawings: &Drawings, studies: &'a [Section], archive: Option<&str>) -> Self {
        let overview = drawings.overview;
        let own = [verdict::section(run, drawings, rows, studies), conventions::section(run)].into_iter();
        let last = [provenance::section(run, overview, archive), method::section(run, studies), unpassed::section(overview, rows)];
        Self { run, own: own.chain(figures::section(run, studies)).chain(last).collect(), studies }
    }

    /// The sections in the order of the page. The figures stand behind the results, the conventions behind the figures.
    pub fn sections(&self) -> Vec<&Section> {
        let [first, conventions, others @ ..] = &self.own[..] else { return Vec::new() };
        let (figures, last) = others.split_at(others.len() - LAST);
        let of_studies = |appendix: bool| self.studies.iter().filter(move |section| section.appendix == appendix);
        [first].into_iter().chain(of_studies(false)).chain(figures).chain([conventions]).chain(of_studies(true)).chain(last).collect()
    }

    /// The first page.
    pub fn index(&self) -> String {
        let sections = self.sections();
        frame(self.run, &sections, None, &html! { @for section in &sections { (parts::on_first_page(section)) } })
    }

    /// The page of a piece that the first page leaves out.
    pub fn piece(&self, piece: &Piece) -> String {
        let is_section = self.sections().iter().any(|section| section.anchor == piece.name);
        let body = html! { h1.page { (piece.title) } @if is_section { (piece.body) } @else { section { (piece.body) } } };
        let path = format!("{}/{}.html", parts::FOLDER, piece.name);
        frame(self.run, &self.sections(), Some([piece.title, &path]), &body)
    }

    /// The page of an engine, a robot or a study.
    pub fn subject(&self, subject: &Subject) -> String {
        frame(self.run, &self.sections(), Some([&subject.title, &subject.path]), &subject.body)
    }
}

/// A page: the first one, or one with title and address in a folder below it, all of whose links start at the first page.
fn frame(run: &RunInfo, sections: &[&Section], below: Option<[&str; 2]>, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                @if below.is_some() { base href="../index.html"; }
                title { @if let Some([title, _]) = below { (title) ", " } "featherbench: " (run.suite) " " (run.run) }
                link rel="stylesheet" href="style.css";
                // It is small, defines the function that the data scripts call, and sets the theme before anything is drawn.
                script src="app.js" {}
                script defer src="data/overview.js" {}
            }
            body {
                a.to-content href={ @if let Some([_, path]) = below { (path) } "#content" } { "Skip to the content" }
                (header(run, sections))
                main #content { (body) }
                footer {
                    p {
                        "Made by featherbench " (run.version) " from the rows of run " code { (run.run) } ": "
                        a href=(CSV_NAME) { (CSV_NAME) } ", "
                        a href=(RUN_NAME) { (RUN_NAME) } ", columns described in "
                        a href=(SCHEMA_NAME) { (SCHEMA_NAME) } "."
                    }
                    @if below.is_none() { p { button.more #everything type="button" { "Bring every section, to search the page" } } }
                }
                (rows_dialog())
                div #tip role="tooltip" hidden {}
                noscript { p.notice { "Without scripts each section is read on its own page; the rows behind each cell need them." } }
            }
        }
    };
    page.into_string()
}

fn header(run: &RunInfo, sections: &[&Section]) -> Markup {
    html! {
        header {
            div.bar {
                a.brand href="#verdict" aria-label="featherbench: the verdict" {
                    (logo())
                    span { "featherbench" }
                }
                button #menu type="button" popovertarget="sections" { "☰ Sections" }
                nav #sections popover aria-label="Sections" {
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
            dl #rows-about {}
            details #rows-narrow {
                summary { "Filters" }
                form #rows-filters method="dialog" {}
            }
            div #rows-table tabindex="0" {}
        }
    }
}
