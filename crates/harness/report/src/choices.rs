//! Drawings of which the reader chooses one: a list for each choice, and a drawing for each answer.

use maud::{Markup, html};

use crate::section::Part;

/// A list from which the reader chooses.
#[derive(Clone, Debug)]
pub struct List {
    /// The `id` of its element.
    pub id: &'static str,
    /// What is chosen.
    pub label: &'static str,
    /// Values and their words.
    pub options: Vec<(String, String)>,
}

impl List {
    /// A list whose values are their own words, each once.
    pub fn of<'a>(id: &'static str, label: &'static str, words: impl IntoIterator<Item = &'a str>) -> Self {
        let mut options: Vec<(String, String)> = Vec::new();
        for word in words {
            if options.iter().all(|(known, _)| known != word) {
                options.push((word.to_owned(), word.to_owned()));
            }
        }
        Self { id, label, options }
    }
}

/// Drawings, each with the values of the lists that show it.
///
/// The drawings of the opening value of the first list stand on the page; those of each other value are a [`Part`], which is brought when the
/// value is chosen. With one list, all others are one part. Without scripts all of them are read one after the other.
///
/// ```
/// use featherbench_report::choices::{Choices, List};
///
/// let lists = vec![List::of("colour", "Colour", ["red", "blue"])];
/// let drawings = ["red", "blue"].map(|word| (vec![word.to_owned()], maud::html! { p { (word) } }));
/// let choices = Choices { name: "colours", title: "Colours", lists, opening: vec!["red".into()], drawings: drawings.into() };
/// let (body, parts) = choices.made();
/// assert!(body.0.contains("<p>red</p>") && !body.0.contains("<p>blue</p>") && parts[0].body.0.contains("<p>blue</p>"));
/// ```
#[derive(Debug)]
pub struct Choices {
    /// The `id` of the element with the drawings; names of parts begin with it.
    pub name: &'static str,
    /// What they show.
    pub title: &'static str,
    /// The lists.
    pub lists: Vec<List>,
    /// The values that are chosen at first.
    pub opening: Vec<String>,
    /// Values, one of each list, and what is shown for them.
    pub drawings: Vec<(Vec<String>, Markup)>,
}

/// What separates values, and choices: no name has either.
const BETWEEN: [&str; 2] = ["\t", "\n"];

/// The attribute of what is shown for some choices.
pub fn shown_for<'a>(choices: impl IntoIterator<Item = &'a [String]>) -> String {
    choices.into_iter().map(|values| values.join(BETWEEN[0])).collect::<Vec<_>>().join(BETWEEN[1])
}

impl Choices {
    /// The lists, then the drawings; and the parts that are brought.
    pub fn made(self) -> (Markup, Vec<Part>) {
        let alone = self.lists.len() == 1;
        let is_open = |values: &[String]| values.first() == self.opening.first();
        let mut groups: Vec<Vec<&(Vec<String>, Markup)>> = Vec::new();
        for drawing in &self.drawings {
            let same = |other: &&(Vec<String>, Markup)| {
                if alone { is_open(&other.0) == is_open(&drawing.0) } else { other.0.first() == drawing.0.first() }
            };
            match groups.iter_mut().find(|group| group.first().is_some_and(same)) {
                Some(group) => group.push(drawing),
                None => groups.push(vec![drawing]),
            }
        }
        let mut parts = Vec::new();
        let mut place = |group: &[&(Vec<String>, Markup)]| {
            let word = |value: &str| {
                self.lists.first().and_then(|list| list.options.iter().find(|option| option.0 == value)).map(|option| option.1.as_str())
            };
            let first = group.first().and_then(|(values, _)| word(values.first()?)).filter(|_| !alone).unwrap_or("others");
            let part = Part {
                name: format!("{}-{}", self.name, parts.len() + 1),
                title: format!("{}: {first}", self.title),
                body: html! { div data-group=(self.name) { (each(group)) } },
            };
            let place = part.place();
            parts.push(part);
            place
        };
        let body = html! {
            div.controls {
                @for (list, opening) in self.lists.iter().zip(&self.opening) {
                    label { (list.label) " " select id=(list.id) { @for (value, words) in &list.options { option value=(value) selected[value == opening] { (words) } } } }
                }
            }
            div.chosen id=(self.name) data-lists=(self.lists.iter().map(|list| list.id).collect::<Vec<_>>().join(" ")) {
                @for group in &groups {
                    @if group.first().is_some_and(|(values, _)| is_open(values)) { (each(group)) }
                    @else { div data-choice=(shown_for(group.iter().map(|(values, _)| values.as_slice()))) { (place(group)) } }
                }
            }
        };
        (body, parts)
    }
}

fn each(group: &[&(Vec<String>, Markup)]) -> Markup {
    html! { @for (values, drawing) in group { div data-choice=(shown_for([values.as_slice()])) { (drawing) } } }
}
