//! Elements and attributes, with the positions of errors in them.

use super::error::{At, UrdfProblem};
use crate::text;
use roxmltree::{Document, Node};

/// The document of a text.
pub(super) fn parse(text: &str) -> Result<Document<'_>, At> {
    text::xml(text).map_err(|error| match error {
        roxmltree::Error::DtdDetected => UrdfProblem::DocumentType.at(text.find("<!DOCTYPE").unwrap_or(0)),
        roxmltree::Error::UnknownNamespace(prefix, place) if prefix == "xacro" => {
            let position = (place.row as usize, place.col as usize);
            At { offset: Some(offset(text, position)), problem: UrdfProblem::Xacro { found: "it has elements of xacro".to_owned() } }
        }
        _ if mesh(text).is_some() => UrdfProblem::AnotherKind { kind: mesh(text).unwrap_or_default() }.at(0),
        other => {
            let (message, position) = text::of_parser(&other);
            At { offset: None, problem: UrdfProblem::Xml { message, position } }
        }
    })
}

/// The byte offset of a line and column, counted from 1.
fn offset(text: &str, (line, column): (usize, usize)) -> usize {
    let start = text.match_indices('\n').nth(line.wrapping_sub(2)).map_or(0, |(newline, _)| newline + 1);
    start + text[start..].char_indices().nth(column.saturating_sub(1)).map_or(0, |(place, _)| place)
}

/// The kind of mesh file, if a text that is not XML begins like one.
fn mesh(text: &str) -> Option<&'static str> {
    let mut lines = text.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.next()?;
    let word = first.split_ascii_whitespace().next().unwrap_or_default();
    match word {
        "solid" => Some("an STL mesh"),
        "ply" => Some("a PLY mesh"),
        "v" | "vn" | "vt" | "mtllib" | "o" => Some("an OBJ mesh"),
        _ if first.starts_with(['{', '[']) => Some("JSON"),
        _ => None,
    }
}

/// An element of the link or joint `owner`.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub node: Node<'a, 'a>,
    pub owner: &'a str,
}

impl<'a> Element<'a> {
    /// The byte offset where it begins.
    pub fn offset(&self) -> usize {
        self.node.range().start
    }

    /// A problem of this element.
    pub fn problem(&self, problem: UrdfProblem) -> At {
        problem.at(self.offset())
    }

    /// The only child of this name.
    pub fn optional(&self, name: &'static str) -> Result<Option<Self>, At> {
        let mut children = self.node.children().filter(|child| child.has_tag_name(name)).map(|node| Self { node, ..*self });
        let first = children.next();
        match children.next() {
            Some(second) => Err(second.problem(UrdfProblem::RepeatedElement { owner: self.owner.to_owned(), element: name })),
            None => Ok(first),
        }
    }

    /// The only child of this name, which must exist.
    pub fn required(&self, name: &'static str) -> Result<Self, At> {
        let missing = || self.problem(UrdfProblem::MissingElement { owner: self.owner.to_owned(), element: name });
        self.optional(name)?.ok_or_else(missing)
    }

    /// An attribute that must exist.
    pub fn attribute(&self, name: &'static str) -> Result<&'a str, At> {
        self.node.attribute(name).ok_or_else(|| {
            let element = self.node.tag_name().name().to_owned();
            self.problem(UrdfProblem::MissingAttribute { element, owner: self.owner.to_owned(), attribute: name })
        })
    }

    /// A number that must exist.
    pub fn number(&self, name: &'static str) -> Result<f64, At> {
        self.attribute(name).and_then(|value| self.parse::<1>(name, value, "a number", false)).map(|[x]| x)
    }

    /// A number that may be absent.
    pub fn optional_number(&self, name: &'static str) -> Result<Option<f64>, At> {
        self.node.attribute(name).map(|value| self.parse::<1>(name, value, "a number", false).map(|[x]| x)).transpose()
    }

    /// A limit: absent when it is missing or infinite.
    pub fn limit(&self, name: &'static str) -> Result<Option<f64>, At> {
        let found = self.node.attribute(name).map(|value| self.parse::<1>(name, value, "a number", true).map(|[x]| x)).transpose()?;
        Ok(found.filter(|x| x.is_finite()))
    }

    /// Three numbers that may be absent.
    pub fn optional_vector(&self, name: &'static str) -> Result<Option<[f64; 3]>, At> {
        self.node.attribute(name).map(|value| self.parse(name, value, "three numbers", false)).transpose()
    }

    /// Four numbers that may be absent.
    pub fn optional_quaternion(&self, name: &'static str) -> Result<Option<[f64; 4]>, At> {
        self.node.attribute(name).map(|value| self.parse(name, value, "four numbers", false)).transpose()
    }

    fn parse<const N: usize>(&self, attribute: &'static str, value: &str, expected: &'static str, infinite: bool) -> Result<[f64; N], At> {
        let (owner, text) = (|| self.owner.to_owned(), || value.to_owned());
        let numbers = value.split_ascii_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
        let Some(numbers) = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()) else {
            return Err(self.problem(UrdfProblem::NotNumbers { owner: owner(), attribute, value: text(), expected }));
        };
        if numbers.iter().any(|x| x.is_nan() || (x.is_infinite() && !infinite)) {
            return Err(self.problem(UrdfProblem::NotFinite { owner: owner(), attribute, value: text() }));
        }
        Ok(numbers)
    }
}
