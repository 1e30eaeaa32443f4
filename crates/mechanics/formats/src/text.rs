//! Text files: reading within limits, places in them, writing completely or not at all.

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use thiserror::Error;

/// A place in a file: the file's name, and line and column counted from 1 if they are known.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Place {
    /// The file as the caller named it.
    pub file: String,
    /// Line and column.
    pub position: Option<(usize, usize)>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}", self.file),
            None => write!(f, "{}", self.file),
        }
    }
}

/// A file that cannot be read or written: the place, and why.
#[derive(Debug)]
pub struct FileError<P> {
    /// The file, and the position where it is known.
    pub place: Place,
    /// What is wrong.
    pub problem: Box<P>,
}

impl<P> FileError<P> {
    pub(crate) fn new(file: impl Into<String>, position: Option<(usize, usize)>, problem: impl Into<P>) -> Self {
        Self { place: Place { file: file.into(), position }, problem: Box::new(problem.into()) }
    }
}

impl<P: fmt::Display> fmt::Display for FileError<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.problem)
    }
}

impl<P: std::error::Error> std::error::Error for FileError<P> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.problem.source()
    }
}

/// The document of an XML text. Entities are off, and the parser keeps its own stack.
pub(crate) fn xml(text: &str) -> Result<roxmltree::Document<'_>, roxmltree::Error> {
    // More nodes than any robot has; each costs some hundred bytes.
    let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..roxmltree::ParsingOptions::default() };
    roxmltree::Document::parse_with_options(text, options)
}

/// What the parser of XML found, without its place; and line and column.
pub(crate) fn of_parser(error: &roxmltree::Error) -> (String, (usize, usize)) {
    let (place, message) = (error.pos(), error.to_string());
    let message = message.strip_suffix(&format!(" at {place}")).unwrap_or(&message).to_owned();
    (message, (place.row as usize, place.col as usize))
}

/// Why a file is not text that can be read.
#[derive(Debug, Error)]
pub enum TextError {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file is larger than any robot.
    #[error("is larger than {limit} bytes; a robot description is smaller (meshes belong in files of their own)")]
    TooBig {
        /// The limit.
        limit: usize,
    },
    /// The file is not UTF-8.
    #[error("is not UTF-8 text (byte {byte} is no part of a character); is it a binary file, or in another encoding?")]
    NotText {
        /// The first bad byte, counted from 0.
        byte: usize,
    },
    /// The file is empty.
    #[error("is empty")]
    Empty,
}

/// The text of a file of at most `limit` bytes.
pub(crate) fn read(path: &Path, limit: usize) -> Result<String, TextError> {
    let mut bytes = Vec::new();
    // One byte more than allowed shows that the file is too long; reading devices and pipes ends there too.
    File::open(path)?.take(limit as u64 + 1).read_to_end(&mut bytes)?;
    of_bytes(&bytes, limit).map(str::to_owned)
}

/// The text of the content of a file of at most `limit` bytes.
pub(crate) fn of_bytes(bytes: &[u8], limit: usize) -> Result<&str, TextError> {
    if bytes.len() > limit {
        return Err(TextError::TooBig { limit });
    }
    std::str::from_utf8(bytes).map_err(|error| TextError::NotText { byte: error.valid_up_to() })
}

/// The text without a byte-order mark; an error when it is too long or blank.
pub(crate) fn check(text: &str, limit: usize) -> Result<&str, TextError> {
    if text.len() > limit {
        return Err(TextError::TooBig { limit });
    }
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(TextError::Empty);
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Writes the file completely or not at all: into a temporary file beside it, which is then renamed.
pub(crate) fn write(path: &Path, text: &str) -> io::Result<()> {
    write_by(path, |file| file.write_all(text.as_bytes()))
}

/// The same, where `content` writes the text piece by piece.
pub(crate) fn write_by(path: &Path, content: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "this is no file name"))?;
    let neighbour = path.with_file_name(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
    let written = File::create(&neighbour)
        .and_then(|mut file| content(&mut file).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&neighbour, path));
    if written.is_err() {
        // Only the first error is reported.
        let _ = std::fs::remove_file(&neighbour);
    }
    written
}

/// Line and column (counted from 1, columns in characters) of a byte offset.
pub(crate) fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.bytes().filter(|&byte| byte == b'\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// The byte offsets of the lines of a text: they turn many offsets into line numbers.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    pub fn new(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(newline, _)| newline).collect())
    }

    /// The line of a byte offset, counted from 1.
    pub fn line(&self, offset: usize) -> usize {
        self.0.partition_point(|&newline| newline < offset) + 1
    }
}
