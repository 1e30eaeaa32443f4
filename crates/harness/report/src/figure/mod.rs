//! Figures, drawn once: the page, print and papers show the same drawing. A [`Figure`] is one for papers, with a caption and its data; a
//! [`Plot::drawing`] stands in a section of the page, where a script adds tips, zoom and the way to the rows (`assets/drawing.js`).
//!
//! # Why they are drawn here
//! | way | result |
//! |---|---|
//! | this module | SVG of 4 to 22 kB on the default run, deterministic to the byte, texts stay texts; no dependency, as maud writes the elements |
//! | a script of the page | needs a browser to make a file; what it draws is seen neither without scripts nor in a paper |
//! | plotly | its script alone has 4.65 MB, and its files come from a browser too |
//! | a plotting crate | not tried: a dependency more for axes and lines; what is most of this module, marks for each engine, the legend and captions, would remain |
//!
//! The paper is white in dark mode, too. A figure has a caption that says its finding, and its data as CSV. An engine has one colour and one mark in all of them: [`style`].

mod axis;
mod draw;
mod drawing;
mod heat;
mod marks;
mod plot;
mod style;

pub use axis::Axis;
pub use heat::Heat;
pub use plot::{Line, Plot, Point, Rows, Series};
pub use style::{COLOURS, Style, style};

/// A figure as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The name of its files, without what follows the dot.
    pub name: &'static str,
    /// What it shows.
    pub title: String,
    /// The finding, in one or two sentences.
    pub caption: String,
    /// Width and height, in pixels.
    pub size: [f64; 2],
    /// The drawing: a whole SVG file.
    pub svg: String,
    /// Its data: a whole CSV file.
    pub csv: String,
}

/// A line of CSV.
fn csv_line<'t>(fields: impl IntoIterator<Item = &'t str>) -> String {
    let quoted = |field: &str| {
        if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.to_owned() }
    };
    fields.into_iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// A coordinate with one decimal, which keeps files small.
fn at(value: f64) -> String {
    let text = format!("{value:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.to_owned() }
}

/// The width of a text. Without the font's own widths an average is taken, which is generous for a sans serif.
fn width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

/// The whole file: white paper, so that a figure looks alike in dark mode, in print and in a paper.
fn file(title: &str, [width, height]: [f64; 2], body: maud::Markup) -> String {
    let drawing = maud::html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(at(width)) height=(at(height)) viewBox={ "0 0 " (at(width)) " " (at(height)) }
            font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" font-size="13" fill="#17212b" stroke-linejoin="round" role="img" {
            title { (title) }
            rect width=(at(width)) height=(at(height)) fill="#ffffff" {}
            (body)
        }
    };
    drawing.into_string() + "\n"
}
