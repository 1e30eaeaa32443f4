//! Included files: one text in the place of all, and where each of its parts came from.
//!
//! The rules are MuJoCo's:
//!
//! - What stands in the root of the included file takes the place of `<include file="…"/>`, whatever the root is called.
//! - A file is looked for in the folder of the first file, and then in that of the file that names it.
//! - No file is included twice.

use super::error::At;
use super::{MjcfError, MjcfProblem, Note, parse};
use crate::text;
use roxmltree::Node;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A text made of files.
pub(super) struct Source {
    pub text: String,
    files: Vec<File>,
    /// Where each part begins in the text, from which file it is, and where it begins there. The first begins at 0.
    parts: Vec<(usize, usize, usize)>,
}

struct File {
    name: String,
    text: String,
    lines: text::Lines,
}

/// A part of a file that is still to be copied.
struct Rest {
    file: usize,
    range: Range<usize>,
    /// Includes that are still to come, in the order of the file: the element, and the file that it names.
    includes: std::vec::IntoIter<(Range<usize>, String)>,
}

impl Source {
    /// A text without included files.
    pub fn text(text: &str, name: &str) -> Self {
        Self { text: text.to_owned(), files: vec![File::new(name.to_owned(), text.to_owned())], parts: vec![(0, 0, 0)] }
    }

    /// Reads a file with all that it includes.
    ///
    /// # Errors
    /// [`MjcfError`], of the file that is wrong, or of the place that includes it.
    pub fn read(path: &Path) -> Result<Self, MjcfError> {
        let name = path.display().to_string();
        let whole = load(path, &name)?;
        let mut source = Self { text: String::new(), files: Vec::new(), parts: Vec::new() };
        let mut paths = vec![path.to_owned()];
        let mut open = vec![source.open(name, whole, Content::Whole)?];
        // Files wait while what they include is copied, so nesting uses no stack.
        while let Some(mut rest) = open.pop() {
            let Some((element, wanted)) = rest.includes.next() else {
                source.copy(rest.file, rest.range)?;
                continue;
            };
            source.copy(rest.file, rest.range.start..element.start)?;
            let at = |problem| source.error(rest.file, element.start, problem);
            let found = find(path, &paths[rest.file], &wanted);
            if paths.contains(&found) {
                return Err(at(MjcfProblem::IncludedTwice { file: wanted }));
            }
            let name = found.display().to_string();
            let text = load(&found, &name).map_err(|error| match *error.problem {
                MjcfProblem::Text(why) => at(MjcfProblem::Include { file: name.clone(), why }),
                _ => error,
            })?;
            paths.push(found);
            let included = source.open(name, text, Content::OfRoot)?;
            open.push(Rest { range: element.end..rest.range.end, ..rest });
            open.push(included);
        }
        Ok(source)
    }

    /// Finds the includes of a file.
    fn open(&mut self, name: String, text: String, content: Content) -> Result<Rest, MjcfError> {
        let file = self.files.len();
        self.files.push(File::new(name, text));
        let File { name, text, .. } = &self.files[file];
        let document = parse(text).map_err(|at| at.in_text(name, text))?;
        let root = document.root_element();
        let range = match content {
            Content::Whole => 0..text.len(),
            Content::OfRoot => match (root.first_child(), root.last_child()) {
                (Some(first), Some(last)) => first.range().start..last.range().end,
                _ => return Err(self.error(file, root.range().start, MjcfProblem::IncludesNothing)),
            },
        };
        let mut includes = Vec::new();
        for node in root.descendants().filter(|node| node.has_tag_name("include") && *node != root) {
            let problem = match node.attribute("file") {
                Some(_) if node.children().any(|child| Node::is_element(&child)) => MjcfProblem::IncludeWithContent,
                Some(wanted) => {
                    includes.push((node.range(), wanted.to_owned()));
                    continue;
                }
                None => MjcfProblem::MissingAttribute { element: "include".to_owned(), owner: "the file".to_owned(), attribute: "file" },
            };
            return Err(self.error(file, node.range().start, problem));
        }
        Ok(Rest { file, range, includes: includes.into_iter() })
    }

    /// Copies a part of a file to the end of the text.
    fn copy(&mut self, file: usize, range: Range<usize>) -> Result<(), MjcfError> {
        if self.text.len() + range.len() > super::LIMIT {
            let why = text::TextError::TooBig { limit: super::LIMIT };
            return Err(self.error(file, range.start, MjcfProblem::Text(why)));
        }
        self.parts.push((self.text.len(), file, range.start));
        self.text.push_str(&self.files[file].text[range]);
        Ok(())
    }

    /// An error of a file.
    fn error(&self, file: usize, offset: usize, problem: MjcfProblem) -> MjcfError {
        let File { name, text, .. } = &self.files[file];
        problem.at(offset).in_text(name, text)
    }

    /// The file of a byte of the text, and the byte's offset there.
    fn origin(&self, offset: usize) -> (usize, usize) {
        let part = self.parts.partition_point(|&(start, ..)| start <= offset).saturating_sub(1);
        self.parts.get(part).map_or((0, offset), |&(start, file, begins)| (file, offset - start + begins))
    }

    /// A problem of the text as an error of the file that it is in.
    pub fn blame(&self, At { offset, problem }: At) -> MjcfError {
        let (file, offset) = offset.map_or((0, None), |offset| (self.origin(offset).0, Some(self.origin(offset).1)));
        let File { name, text, .. } = &self.files[file];
        At { offset, problem }.in_text(name, text)
    }

    /// Something that was left out, at a byte of the text.
    pub fn note(&self, offset: usize, text: String) -> Note {
        let (file, offset) = self.origin(offset);
        let File { name, lines, .. } = &self.files[file];
        let text = if file == 0 { text } else { format!("{text} (of {name})") };
        Note { line: lines.line(offset), text }
    }
}

impl File {
    fn new(name: String, text: String) -> Self {
        let lines = text::Lines::new(&text);
        Self { name, text, lines }
    }
}

/// What of a file is taken.
enum Content {
    Whole,
    OfRoot,
}

/// The text of a file, without a byte-order mark.
fn load(path: &Path, name: &str) -> Result<String, MjcfError> {
    let checked = text::read(path, super::LIMIT).and_then(|text| text::check(&text, super::LIMIT).map(str::to_owned));
    checked.map_err(|error| MjcfError::new(name, None, error))
}

/// The file that an include names.
fn find(first: &Path, naming: &Path, wanted: &str) -> PathBuf {
    let beside = |path: &Path| path.with_file_name("").join(wanted);
    let (of_first, of_naming) = (beside(first), beside(naming));
    if !of_first.is_file() && of_naming.is_file() { of_naming } else { of_first }
}
