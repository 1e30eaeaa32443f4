//! A stage as text: prims within each other, with their properties.

use std::fmt::Write;

/// A text in the form `usda` while it is written.
pub(super) struct Stage {
    text: String,
    depth: usize,
}

impl Stage {
    /// The head, which names the prim that stands for the file.
    pub fn new(default: &str, doc: Option<&str>) -> Self {
        let doc = doc.map_or_else(String::new, |doc| format!("    doc = \"{}\"\n", quoted(doc)));
        let text = format!(
            "#usda 1.0\n(\n    defaultPrim = \"{default}\"\n{doc}    kilogramsPerUnit = 1\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n"
        );
        Self { text, depth: 0 }
    }

    /// Opens a prim with the schemas that are applied to it.
    pub fn open(&mut self, kind: &str, name: &str, schemas: &[&str]) {
        let applied: Vec<String> = schemas.iter().map(|schema| format!("\"{schema}\"")).collect();
        let applied = if applied.is_empty() { String::new() } else { format!(" (prepend apiSchemas = [{}])", applied.join(", ")) };
        self.line(&format!("def {kind} \"{name}\"{applied}"));
        self.line("{");
        self.depth += 1;
    }

    /// Closes the prim opened last.
    pub fn close(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        self.line("}");
    }

    /// A property: its type and name, and its value as text.
    pub fn set(&mut self, property: &str, value: &str) {
        self.line(&format!("{property} = {value}"));
    }

    /// The text, every prim closed.
    pub fn finish(mut self) -> String {
        while self.depth > 0 {
            self.close();
        }
        self.text
    }

    fn line(&mut self, line: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{:width$}{line}", "", width = 4 * self.depth);
    }
}

/// Single numbers, each the shortest decimal that is read back to its bits.
pub(super) fn single(values: &[f64]) -> String {
    list(values.iter().map(|&x| format!("{:?}", x as f32 + 0.0)))
}

/// Double numbers.
pub(super) fn double(values: &[f64]) -> String {
    list(values.iter().map(|x| format!("{:?}", x + 0.0)))
}

fn list(numbers: impl Iterator<Item = String>) -> String {
    let numbers: Vec<String> = numbers.collect();
    if numbers.len() == 1 { numbers.concat() } else { format!("({})", numbers.join(", ")) }
}

/// A text between quotation marks.
fn quoted(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().replace('\\', "\\\\").replace('"', "\\\"")
}
