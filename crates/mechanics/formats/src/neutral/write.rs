//! Writing: one layout, the same bytes for the same description.

use super::{NeutralError, NeutralProblem};
use crate::text;
use featherbench_model::{
    Acts, BodyDescription, Correlation, Description, Frame, JointDescription, JointType, Loop, LoopEnd, LoopKind, Malformed, Placement,
    Provenance, Uncertain, UncertainVariable,
};
use std::fmt;
use std::io;
use std::path::Path;

/// Writes a description file, completely or not at all. The text is written piece by piece, and never held as a whole.
///
/// # Errors
/// [`NeutralError`] when the description is malformed or the file cannot be written.
pub fn write(description: &Description, path: impl AsRef<Path>) -> Result<(), NeutralError> {
    let path = path.as_ref();
    let error = |problem: NeutralProblem| NeutralError::new(path.display().to_string(), None, problem);
    description.validate().map_err(|malformed| error(malformed.into()))?;
    text::write_by(path, |file| stream(description, file)).map_err(|io| error(NeutralProblem::Write(io)))
}

/// Writes the text of a description file piece by piece: the same text as [`to_string`].
///
/// # Errors
/// [`NeutralError`] when the description is malformed or the output does not take the text. `name` names the output in it.
pub fn write_to(description: &Description, output: &mut dyn io::Write, name: &str) -> Result<(), NeutralError> {
    let error = |problem: NeutralProblem| NeutralError::new(name, None, problem);
    description.validate().map_err(|malformed| error(malformed.into()))?;
    stream(description, output).map_err(|io| error(NeutralProblem::Write(io)))
}

/// Writes a valid description.
fn stream(description: &Description, output: &mut dyn io::Write) -> io::Result<()> {
    let mut writer = Writer::of_file();
    writer.output = Some(output);
    writer.file(description);
    writer.failed.map_or(Ok(()), Err)
}

/// The description as the text of a file: a few lines per body. [`super::parse`] gives back the same bits.
///
/// # Errors
/// [`Malformed`] when the description is not a robot (for example, JSON has no NaN).
pub fn to_string(description: &Description) -> Result<String, Malformed> {
    description.validate()?;
    let mut writer = Writer::of_file();
    writer.file(description);
    Ok(writer.text)
}

/// The robot alone on a single line without a newline, as oracles receive it. It is canonical (depth-first, fixed joints merged), and has
/// armature, damping and friction for every degree of freedom. It has no frames, no loops, no residuals, no uncertain parameters and no
/// provenance: an oracle computes with the tree.
///
/// # Errors
/// [`Malformed`] when the description is not a robot, or has bodies that deform.
pub fn to_line(description: &Description) -> Result<String, Malformed> {
    line(description, Sections::None)
}

/// The same with the section `loops`: what an engine is asked about that holds loops.
///
/// # Errors
/// As of [`to_line`].
pub fn to_line_with_loops(description: &Description) -> Result<String, Malformed> {
    line(description, Sections::Loops)
}

fn line(description: &Description, sections: Sections) -> Result<String, Malformed> {
    description.must_be_rigid()?;
    let canonical = description.canonical()?;
    let mut writer = Writer { per_dof: PerDof::Complete, separator: [""; 4], ..Writer::of_file() };
    writer.document(&canonical, sections);
    Ok(writer.text)
}

/// Whether a missing list of armature, damping or friction is left out or written as zeros.
#[derive(PartialEq)]
enum PerDof {
    AsGiven,
    Complete,
}

pub(super) struct Writer<'a> {
    /// What is written and not yet passed on.
    text: String,
    per_dof: PerDof,
    /// The separators of the lines of each level: the file's keys, their items, a body's joint, the joint's lists.
    separator: [&'static str; 4],
    /// Where the text is passed on to, if it is not kept.
    output: Option<&'a mut dyn io::Write>,
    /// The first error of the output.
    failed: Option<io::Error>,
}

/// Which optional sections are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sections {
    None,
    Loops,
    All,
}

/// The text is passed on in pieces of about this size.
const PIECE: usize = 1 << 16;

impl Writer<'_> {
    fn of_file() -> Self {
        let separator = ["\n ", "\n  ", "\n   ", "\n    "];
        Self { text: String::new(), per_dof: PerDof::AsGiven, separator, output: None, failed: None }
    }

    fn file(&mut self, description: &Description) {
        self.document(description, Sections::All);
        self.push("\n");
        self.pass_on(0);
    }

    /// Passes the text on if it is longer than this.
    fn pass_on(&mut self, length: usize) {
        if let Some(output) = self.output.as_mut().filter(|_| self.text.len() > length) {
            if self.failed.is_none() {
                self.failed = output.write_all(self.text.as_bytes()).err();
            }
            self.text.clear();
        }
    }

    fn document(&mut self, description: &Description, sections: Sections) {
        let all = sections == Sections::All;
        self.put(format_args!("{{\"format\":{},\"name\":{},\"gravity\":", super::FORMAT, quoted(&description.name)));
        self.numbers(&description.gravity);
        if let Some(provenance) = description.provenance.as_ref().filter(|_| all) {
            self.key(0, "provenance");
            self.provenance(provenance);
        }
        self.key(0, "bodies");
        self.list(1, &description.bodies, Self::body);
        if all && !description.frames.is_empty() {
            self.key(0, "frames");
            self.list(1, &description.frames, Self::frame);
        }
        if sections != Sections::None && !description.loops.is_empty() {
            self.key(0, "loops");
            self.list(1, &description.loops, Self::tie);
        }
        if all && !description.continua.is_empty() {
            self.key(0, "continua");
            self.list(1, &description.continua, Self::continuum);
        }
        if all && !description.residuals.is_empty() {
            self.key(0, "residuals");
            self.list(1, &description.residuals, Self::residual);
        }
        if all && !description.uncertain.is_empty() {
            self.key(0, "uncertain");
            self.uncertain(&description.uncertain);
        }
        self.push("}");
    }

    fn provenance(&mut self, provenance: &Provenance) {
        let Provenance { source, licence, header, readme, notes } = provenance;
        let fields = [("source", source), ("licence", licence), ("header", header), ("readme", readme)];
        for (k, (name, value)) in fields.into_iter().enumerate() {
            self.push(if k == 0 { "{" } else { "," });
            self.push(self.separator[1]);
            self.put(format_args!("\"{name}\":{}", quoted(value)));
        }
        self.key(1, "notes");
        self.list(2, notes, |writer, note| writer.push(&quoted(note)));
        self.push("}");
    }

    fn body(&mut self, body: &BodyDescription) {
        self.put(format_args!("{{\"name\":{},\"mass\":{:?},\"com\":", quoted(&body.name), body.mass));
        self.numbers(&body.com);
        self.push(",\"inertia\":");
        self.numbers(&body.inertia);
        self.put(format_args!(",\"parent\":{}", index(body.parent)));
        self.key(2, "joint");
        self.joint(&body.joint);
        self.push("}");
    }

    fn joint(&mut self, joint: &JointDescription) {
        self.put(format_args!("{{\"name\":{},\"type\":\"{}\"", quoted(&joint.name), joint.kind.name()));
        if let Some(axis) = joint.kind.axis() {
            self.push(",\"axis\":");
            self.numbers(&axis);
        }
        if let JointType::Helical { pitch, .. } = joint.kind {
            self.put(format_args!(",\"pitch\":{pitch:?}"));
        }
        self.key(3, "placement");
        self.placement(&joint.placement);

        let zeros = vec![0.0; joint.kind.nv()];
        let properties = [("armature", &joint.armature), ("damping", &joint.damping), ("friction", &joint.friction)];
        let properties =
            properties.map(|(name, list)| (name, if list.is_empty() && self.per_dof == PerDof::Complete { &zeros } else { list }));
        let limits = [("lower", &joint.lower), ("upper", &joint.upper), ("velocity", &joint.velocity), ("effort", &joint.effort)];
        let mut first = true;
        for (name, list) in properties.into_iter().chain(limits).filter(|(_, list)| !list.is_empty()) {
            if first {
                self.key(3, name);
                first = false;
            } else {
                self.put(format_args!(",\"{name}\":"));
            }
            self.numbers(list);
        }
        self.push("}");
    }

    fn frame(&mut self, frame: &Frame) {
        self.put(format_args!("{{\"name\":{},\"body\":{},\"placement\":", quoted(&frame.name), index(frame.body)));
        self.placement(&frame.placement);
        self.push("}");
    }

    fn tie(&mut self, tie: &Loop) {
        self.put(format_args!("{{\"name\":{},\"type\":\"{}\"", quoted(&tie.name), tie.kind.name()));
        if let Some([first, second]) = tie.ends() {
            self.end("first", first);
            self.end("second", second);
        }
        match &tie.kind {
            LoopKind::Joint { .. } => {}
            LoopKind::Point { axes: [x, y, z], .. } => self.put(format_args!(",\"axes\":[{x},{y},{z}]")),
            LoopKind::Distance { length, .. } => self.put(format_args!(",\"length\":{length:?}")),
            LoopKind::Gear { terms, offset } => {
                self.key(2, "terms");
                for (k, (body, coefficient)) in terms.iter().enumerate() {
                    let before = if k == 0 { "[" } else { "," };
                    self.put(format_args!("{before}{{\"body\":{body},\"coefficient\":{coefficient:?}}}"));
                }
                self.put(format_args!("],\"offset\":{offset:?}"));
            }
            LoopKind::Mimic { follower, leader, polynomial } => {
                self.put(format_args!(",\"follower\":{follower},\"leader\":{leader},\"polynomial\":"));
                self.numbers(polynomial);
            }
        }
        self.push("}");
    }

    fn uncertain(&mut self, uncertain: &Uncertain) {
        self.push("{\"variables\":");
        self.list(1, &uncertain.variables, Self::variable);
        if !uncertain.correlations.is_empty() {
            self.key(0, "correlations");
            self.list(1, &uncertain.correlations, |writer, Correlation { first, second, value }| {
                writer.put(format_args!("{{\"first\":{first},\"second\":{second},\"value\":{value:?}}}"));
            });
        }
        self.push("}");
    }

    fn variable(&mut self, variable: &UncertainVariable) {
        let UncertainVariable { name, distribution, acts, on } = variable;
        self.put(format_args!("{{\"name\":{},\"distribution\":{{\"type\":\"{}\"", quoted(name), distribution.name()));
        distribution.numbers().into_iter().for_each(|(name, value)| self.put(format_args!(",\"{name}\":{value:?}")));
        let acts = match acts {
            Acts::Value => "value",
            Acts::Factor => "factor",
        };
        self.put(format_args!("}},\"acts\":\"{acts}\",\"on\":["));
        for (k, target) in on.iter().enumerate() {
            let ((field, index), before) = (target.field.name(), if k == 0 { "" } else { "," });
            self.put(format_args!("{before}{{\"body\":{},\"field\":\"{field}\"", target.body));
            index.into_iter().for_each(|index| self.put(format_args!(",\"index\":{index}")));
            self.push("}");
        }
        self.push("]}");
    }

    fn end(&mut self, name: &str, end: &LoopEnd) {
        self.key(2, name);
        self.put(format_args!("{{\"body\":{},\"placement\":", index(end.body)));
        self.placement(&end.placement);
        self.push("}");
    }

    pub(super) fn placement(&mut self, placement: &Placement) {
        self.push("{\"rotation\":");
        self.numbers(&placement.rotation);
        self.push(",\"translation\":");
        self.numbers(&placement.translation);
        self.push("}");
    }

    /// A list with one item per line of this level.
    fn list<T>(&mut self, level: usize, items: &[T], mut item: impl FnMut(&mut Self, &T)) {
        for (k, value) in items.iter().enumerate() {
            self.push(if k == 0 { "[" } else { "," });
            self.push(self.separator[level]);
            item(self, value);
            self.pass_on(PIECE);
        }
        self.push(if items.is_empty() { "[]" } else { "]" });
    }

    /// A key on a new line of this level, after a comma.
    pub(super) fn key(&mut self, level: usize, name: &str) {
        self.push(",");
        self.push(self.separator[level]);
        self.put(format_args!("\"{name}\":"));
    }

    /// Each number as the shortest decimal that reads back to the same bits. `Debug` writes that for finite numbers, and it is JSON.
    pub(super) fn numbers(&mut self, numbers: &[f64]) {
        for (k, number) in numbers.iter().enumerate() {
            self.push(if k == 0 { "[" } else { "," });
            self.put(format_args!("{number:?}"));
        }
        self.push(if numbers.is_empty() { "[]" } else { "]" });
    }

    pub(super) fn push(&mut self, text: &str) {
        self.text.push_str(text);
    }

    pub(super) fn put(&mut self, text: fmt::Arguments<'_>) {
        // A string takes every text: there is no error.
        let _ = fmt::Write::write_fmt(&mut self.text, text);
    }
}

pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

pub(super) fn index(body: Option<usize>) -> String {
    body.map_or("-1".to_owned(), |body| body.to_string())
}
