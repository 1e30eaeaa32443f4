//! A section of the page: what a study hands to the report.

use maud::{Markup, html};
use serde::Serialize;

use crate::figure::Figure;

/// A section of the page, with everything that it adds to other places.
///
/// ```
/// use featherbench_report::Section;
///
/// let body = maud::html! { section #mine { h2 { "My question" } } };
/// let section = Section { lines: vec!["mine: answered".into()], ..Section::new("mine", "Mine", body) };
/// assert!(!section.appendix && section.script.is_empty());
/// ```
#[derive(Debug, Default)]
pub struct Section {
    /// The `id` of its element, by which the navigation finds it.
    pub anchor: &'static str,
    /// Its entry in the navigation.
    pub name: &'static str,
    /// The study that it is about, as rows name it: that study's page begins with what the section adds to the verdict.
    pub study: &'static str,
    /// Its element `section`, with the anchor as `id`.
    pub body: Markup,
    /// Its data, which its script finds as `featherbench.chunks.get("figures")[anchor]`; see [`Section::with_data`].
    pub data: Option<Result<String, serde_json::Error>>,
    /// Its script. It runs when the section is first near the window, after the report's own scripts, which offer tables and
    /// drill-down; the body and the data are at hand then.
    pub script: &'static str,
    /// Its style, if it needs more than the report's own.
    pub style: &'static str,
    /// What it answers at the head of the first page and of the terminal's lines, above the findings.
    pub lead: Option<Lead>,
    /// What it adds to the verdict.
    pub finding: Option<Finding>,
    /// What it answers on the first page in its full width, below the findings.
    pub answer: Option<Markup>,
    /// What is seen only when it is opened: a [`Part::place`] stands for each, in the body or in the answer.
    pub parts: Vec<Part>,
    /// The bodies that it marks in drawings of robots.
    pub marks: Vec<Mark>,
    /// Its figures for papers.
    pub figures: Vec<Figure>,
    /// The rows that its drawings show: a finding among them leads there.
    pub shows: Vec<Shown>,
    /// Quantities of whose errors it tells: the section on the method defines their measures.
    pub quantities: Vec<String>,
    /// Terms and their definitions, for the section on the method.
    pub terms: &'static [(&'static str, &'static str)],
    /// What it adds to the lines at the end of a run.
    pub lines: Vec<String>,
    /// Whether it stands with the facts about the run, behind the conventions, and not with the results.
    pub appendix: bool,
}

/// A piece of the report that the first page does not hold at first.
///
/// It is brought from its own script when it is opened. It has a page of its own, which needs no script.
#[derive(Debug)]
pub struct Part {
    /// Its name among all parts and sections; its page is `sections/NAME.html`.
    pub name: String,
    /// The title of its page.
    pub title: String,
    /// What it holds.
    pub body: Markup,
}

impl Part {
    /// What stands in its place until it is brought: a link to its page. In a closed `details` it is brought when that is opened.
    pub fn place(&self) -> Markup {
        html! { div data-part=(self.name) { a href={ "sections/" (self.name) ".html" } { (self.title) " on a page of its own" } } }
    }
}

/// Rows of the section's study that one of its drawings shows, and the choice that brings the drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// The quantity of the rows.
    pub quantity: String,
    /// Their metric; `None` stands for every one.
    pub metric: Option<String>,
    /// The `id` of the list of [`choices`](crate::choices), and the value to be chosen.
    pub choice: (&'static str, String),
}

/// A body of a robot in which an engine differs, for drawings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// The robot.
    pub robot: String,
    /// The engine.
    pub engine: String,
    /// The body.
    pub body: String,
}

/// What a section answers before anything else.
#[derive(Debug)]
pub struct Lead {
    /// On the first page.
    pub body: Markup,
    /// On the terminal, behind the verdict.
    pub lines: Vec<String>,
}

/// What a section adds to the verdict.
#[derive(Debug)]
pub struct Finding {
    /// Its place: a smaller rank stands first, equal ranks stand in the order of the sections.
    pub rank: u8,
    /// The text, with its heading.
    pub body: Markup,
}

impl Section {
    /// A section that adds nothing elsewhere.
    pub fn new(anchor: &'static str, name: &'static str, body: Markup) -> Self {
        Self { anchor, name, body, ..Self::default() }
    }

    /// The section with data for its script. If the data cannot be written as JSON, writing the report fails with that error.
    pub fn with_data(self, data: &impl Serialize) -> Self {
        Self { data: Some(serde_json::to_string(data)), ..self }
    }
}
