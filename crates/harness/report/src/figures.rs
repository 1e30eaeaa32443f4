//! Section: the figures for papers, each with its caption, its files and its data.

use featherbench_results::RunInfo;
use maud::{Markup, html};

use crate::error::ReportError;
use crate::figure::Figure;
use crate::section::Section;

/// The folder of the figures in that of the report.
const FOLDER: &str = "figures";

/// All figures, in the order of the sections.
pub fn of(sections: &[Section]) -> impl Iterator<Item = &Figure> {
    sections.iter().flat_map(|section| &section.figures)
}

/// Writes the section; `None` without a figure.
pub fn section(run: &RunInfo, sections: &[Section]) -> Option<Section> {
    of(sections).next()?;
    Some(Section::new("figures", "Figures", body(run, sections)))
}

fn body(run: &RunInfo, sections: &[Section]) -> Markup {
    html! {
        section #figures {
            h2 { "Figures for papers" }
            p.lead {
                "Drawn once, as SVG: the page, print and a paper show the same file. An engine has one colour and one mark; hollow marks and dashed lines are builds of an engine. "
                code { "featherbench report " (run.run) " --figures DIR" } " writes them with their data, captions and references."
            }
            div.papers {
                @for figure in of(sections) {
                    figure id={ "figure-" (figure.name) } {
                        img src={ (FOLDER) "/" (figure.name) ".svg" } alt={ (figure.title) ". " (figure.caption) } loading="lazy"
                            width=(figure.size[0].round()) height=(figure.size[1].round());
                        figcaption { b { (figure.title) ". " } (figure.caption) }
                        p.chart-tools {
                            a href={ (FOLDER) "/" (figure.name) ".svg" } download={ (figure.name) ".svg" } { "Save as SVG" }
                            a href={ (FOLDER) "/" (figure.name) ".csv" } download={ (figure.name) ".csv" } { "Save data as CSV" }
                            button.copy-data type="button" data-figure=(figure.name) { "Copy data" }
                        }
                    }
                }
            }
        }
    }
}

/// The files of the figures, by their names in the folder of the report.
pub fn files(sections: &[Section]) -> impl Iterator<Item = (String, Vec<u8>)> {
    of(sections).flat_map(|figure| {
        let file = |ending: &str, text: &str| (format!("{FOLDER}/{}.{ending}", figure.name), text.as_bytes().to_vec());
        [file("svg", &figure.svg), file("csv", &figure.csv)]
    })
}

/// The data of all figures as one object, for the button that copies them.
pub fn data(sections: &[Section]) -> Result<String, ReportError> {
    let texts: serde_json::Map<String, serde_json::Value> =
        of(sections).map(|figure| (figure.name.into(), figure.csv.as_str().into())).collect();
    Ok(serde_json::to_string(&texts)?)
}
