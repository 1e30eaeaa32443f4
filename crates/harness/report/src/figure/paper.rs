//! A figure as a file: its paper, and how numbers and texts stand on it.

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
pub(super) fn csv_line<'t>(fields: impl IntoIterator<Item = &'t str>) -> String {
    let quoted = |field: &str| {
        if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.to_owned() }
    };
    fields.into_iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// A coordinate with one decimal, which keeps files small.
pub(super) fn at(value: f64) -> String {
    let text = format!("{value:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.to_owned() }
}

/// The width of a text. Without the font's own widths an average is taken, which is generous for a sans serif.
pub(super) fn width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

/// The whole file: white paper, so that a figure looks alike in dark mode, in print and in a paper.
pub(super) fn file(title: &str, size: [f64; 2], body: maud::Markup) -> String {
    drawing(Some("http://www.w3.org/2000/svg"), title, size, body)
}

/// The same within a page, which needs no name of its language.
pub(super) fn inline(title: &str, size: [f64; 2], body: maud::Markup) -> String {
    drawing(None, title, size, body)
}

fn drawing(language: Option<&str>, title: &str, [width, height]: [f64; 2], body: maud::Markup) -> String {
    let drawing = maud::html! {
        svg xmlns=[language] width=(at(width)) height=(at(height)) viewBox={ "0 0 " (at(width)) " " (at(height)) }
            font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" font-size="13" fill="#17212b" stroke-linejoin="round" role="img" {
            title { (title) }
            rect width=(at(width)) height=(at(height)) fill="#ffffff" {}
            (body)
        }
    };
    drawing.into_string() + "\n"
}
