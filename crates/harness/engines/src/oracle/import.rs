//! The answer to the operation `import`: what an engine's own parser has made of a file.

use super::folders::without_folders;
use featherbench_bench::{Import, ImportNote, ImportVariant, Rewritten};
use featherbench_model::{BodyDescription, Description};
use featherbench_protocol::Message;
use serde_json::Value;
use std::path::PathBuf;

/// The result in an answer to `import`.
///
/// # Errors
/// A sentence, when its bodies are not in an order in which states and answers can be given.
pub(crate) fn reading(answer: &Message) -> Result<Import, String> {
    let model = answer.header.get("model").ok_or("there is no model")?;
    let description = parsed(model)?;
    let canonical = canonical(&description)?;
    // States and answers are in the order of the bodies. An order that changed here would mix them up. Numbers may be normalised.
    let order = |robot: &Description| robot.bodies.iter().map(|body| (body.name.clone(), body.parent)).collect::<Vec<_>>();
    if order(&canonical) != order(&description) {
        let moved = description.bodies.iter().zip(&canonical.bodies).find(|(given, due)| given.name != due.name);
        let found = moved.map_or_else(
            || "the last ones are fixed to others".to_owned(),
            |(given, due)| format!("{} stands where {} is due", given.name, due.name),
        );
        return Err(format!("its bodies are not in depth-first order without fixed joints: {found}"));
    }
    for (key, due) in [("nq", canonical.nq()), ("nv", canonical.nv())] {
        let found = answer.header.get(key).unwrap_or(&Value::Null);
        if found.as_u64() != Some(due as u64) {
            return Err(format!("{key} is {found}, the model has {due}"));
        }
    }
    let keyframes = keyframes(answer, canonical.nq())?;
    let notes = answer.header.get("notes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let written = answer.header.get("written").map(parsed).transpose().map_err(|error| format!("as written: {error}"))?;
    if let Some(written) = written.as_ref().filter(|written| !same_tree(written, &canonical)) {
        return Err(format!("'{}' as written has other bodies or joints than as read", written.name));
    }
    Ok(Import { description: canonical, notes: notes.iter().map(note).collect(), keyframes, written })
}

/// The result in an answer to `variants`.
///
/// # Errors
/// A sentence, when a variant is no robot.
pub(crate) fn variants(answer: &Message) -> Result<Vec<ImportVariant>, String> {
    let listed = answer.header.get("variants").and_then(Value::as_array).ok_or("there are no variants")?;
    listed.iter().map(variant).collect()
}

/// The files in an answer to `rewrite`.
///
/// # Errors
/// A sentence, when one has no writer, or neither a file nor a reason.
pub(crate) fn rewritten(answer: &Message) -> Result<Vec<Rewritten>, String> {
    let listed = answer.header.get("written").and_then(Value::as_array).ok_or("there is no list `written`")?;
    let one = |given: &Value| {
        let text = |key: &str| given.get(key).and_then(Value::as_str);
        let by = text("by").ok_or("one has no `by`")?.to_owned();
        let file = match (text("file"), text("reason")) {
            (Some(file), None) => Ok(PathBuf::from(file)),
            (None, Some(reason)) => Err(without_folders(reason)),
            _ => return Err(format!("{by} has not one of `file` and `reason`")),
        };
        Ok(Rewritten { by, file })
    };
    listed.iter().map(one).collect()
}

fn parsed(model: &Value) -> Result<Description, String> {
    featherbench_formats::neutral::parse(&model.to_string(), "the model").map_err(|error| error.to_string())
}

/// The canonical form. A robot without a body stays one: an engine that holds no joint has read the file all the same.
fn canonical(description: &Description) -> Result<Description, String> {
    if description.bodies.is_empty() {
        return Ok(description.clone());
    }
    description.canonical().map_err(|error| error.to_string())
}

/// The robot that the file would be, if one thing were read otherwise.
fn variant(given: &Value) -> Result<ImportVariant, String> {
    let text = |key: &str| given.get(key).and_then(Value::as_str).map(str::to_owned).ok_or_else(|| format!("a variant has no {key}"));
    let (cause, text) = (text("cause")?, text("text")?);
    let model = given.get("model").ok_or_else(|| format!("variant {cause} has no model"))?;
    let description = parsed(model).and_then(|model| canonical(&model)).map_err(|error| format!("variant {cause}: {error}"))?;
    let edits = given.get("edits").and_then(Value::as_u64).unwrap_or(1);
    Ok(ImportVariant { cause, text, edits, description })
}

/// Whether two descriptions have the same bodies on the same joints: states of one are states of the other.
fn same_tree(a: &Description, b: &Description) -> bool {
    let known =
        |x: &BodyDescription, y: &BodyDescription| (&x.name, x.parent, x.joint.kind.name()) == (&y.name, y.parent, y.joint.kind.name());
    a.bodies.len() == b.bodies.len() && a.bodies.iter().zip(&b.bodies).all(|(x, y)| known(x, y))
}

/// The configurations that the file names, if any.
fn keyframes(answer: &Message, nq: usize) -> Result<Vec<Vec<f64>>, String> {
    let Some(block) = answer.block("keyframes") else { return Ok(Vec::new()) };
    if nq == 0 || block.shape.get(1..) != Some(&[nq]) {
        return Err(format!("block 'keyframes' has the shape {:?}, rows of {nq} numbers are due", block.shape));
    }
    if let Some(at) = block.data.iter().position(|x| !x.is_finite()) {
        return Err(format!("keyframe {} is not finite", at / nq));
    }
    Ok(block.data.chunks_exact(nq).map(<[f64]>::to_vec).collect())
}

/// A parser's note; a field that is not text is left empty.
fn note(note: &Value) -> ImportNote {
    let text = |key: &str| note.get(key).and_then(Value::as_str).map(str::to_owned);
    let numbers: Option<Vec<f64>> = note.get("numbers").and_then(Value::as_array).and_then(|list| list.iter().map(Value::as_f64).collect());
    ImportNote {
        cause: text("cause").unwrap_or_default(),
        about: text("about"),
        text: text("text").map(|text| without_folders(&text)).unwrap_or_default(),
        numbers: numbers.unwrap_or_default(),
    }
}
