//! XML as text: each element on its own line, every attribute escaped, every number the shortest decimal that reads back to its bits.

use std::fmt::Write;

/// A document while it is written.
#[derive(Default)]
pub struct Xml {
    text: String,
    open: Vec<&'static str>,
}

/// An element's attributes while they are written.
pub struct Attributes<'a>(&'a mut String);

impl Xml {
    /// Opens an element.
    pub fn open(&mut self, name: &'static str, attributes: impl FnOnce(&mut Attributes)) {
        self.begin(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name);
    }

    /// Closes the element opened last.
    pub fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.indent();
            self.text.push_str(&format!("</{name}>\n"));
        }
    }

    /// An element without content.
    pub fn empty(&mut self, name: &'static str, attributes: impl FnOnce(&mut Attributes)) {
        self.begin(name, attributes);
        self.text.push_str("/>\n");
    }

    /// A comment; it must not contain two hyphens in a row.
    pub fn comment(&mut self, text: &str) {
        self.indent();
        let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        self.text.push_str(&format!("<!-- {} -->\n", text.replace('-', "\u{2010}")));
    }

    /// How many elements are open.
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// The text, every element closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn begin(&mut self, name: &str, attributes: impl FnOnce(&mut Attributes)) {
        self.indent();
        self.text.push('<');
        self.text.push_str(name);
        attributes(&mut Attributes(&mut self.text));
    }

    /// One space per level, up to a depth where indentation would outgrow the content.
    fn indent(&mut self) {
        let width = self.open.len().min(40);
        self.text.extend(std::iter::repeat_n(' ', width));
    }
}

impl Attributes<'_> {
    /// An attribute of words.
    pub fn text(&mut self, name: &str, value: &str) -> &mut Self {
        let escaped = value.chars().fold(String::with_capacity(value.len()), |mut escaped, c| {
            match c {
                '&' => escaped.push_str("&amp;"),
                '<' => escaped.push_str("&lt;"),
                '>' => escaped.push_str("&gt;"),
                '"' => escaped.push_str("&quot;"),
                c => escaped.push(c),
            }
            escaped
        });
        self.0.push_str(&format!(" {name}=\"{escaped}\""));
        self
    }

    /// An attribute of numbers. `Debug` writes the shortest decimal that reads back to the same bits.
    pub fn numbers(&mut self, name: &str, values: &[f64]) -> &mut Self {
        self.0.push_str(&format!(" {name}=\""));
        for (k, value) in values.iter().enumerate() {
            let space = if k == 0 { "" } else { " " };
            // Writing to a string cannot fail.
            let _ = write!(self.0, "{space}{value:?}");
        }
        self.0.push('"');
        self
    }
}
