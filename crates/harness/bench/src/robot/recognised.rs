//! What kind of file a robot comes in, told by its content, with advice where it is none that engines read.

use crate::{FileContent, FileFormat, HarnessError};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Endings of files that hold shapes.
const MESHES: [&str; 9] = ["stl", "obj", "dae", "ply", "gltf", "glb", "msh", "3ds", "fbx"];
/// How much of a file is looked at: comments may stand before the root element.
const HEAD: u64 = 1 << 20;
/// Elements within each other, as `oracles/featherbench_oracles/core/examination.py` has it.
const DEEPEST: usize = 500;

impl FileContent {
    /// Reads a robot's file and recognises its format.
    ///
    /// # Errors
    /// [`HarnessError::Config`] with advice, when engines do not read such a file.
    pub fn recognised(path: &Path) -> Result<Self, HarnessError> {
        let recognised = recognised(path).map_err(|message| HarnessError::Config { path: path.to_owned(), message });
        recognised.map(|(format, bytes)| Self { path: path.to_owned(), format, bytes })
    }
}

fn recognised(path: &Path) -> Result<(FileFormat, Vec<u8>), String> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if path.is_dir() {
        return Err("this is a folder; name the robot's file in it".into());
    }
    if MESHES.contains(&ending.as_str()) {
        return Err(format!("a .{ending} file holds a shape and no joints; name the robot's file that uses it"));
    }
    // What is no robot's file is not read to its end.
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(|error| error.to_string())?;
    file.by_ref().take(HEAD).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if is_usd(&bytes, &ending) {
        file.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        return Ok((FileFormat::Usd, bytes));
    }
    if let Some(advice) = no_text(&bytes) {
        return Err(advice);
    }
    let head = bytes.len();
    file.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    format(&bytes, head, &ending).map(|format| (format, bytes))
}

/// Whether bytes begin as USD does: as text, in its binary form, or as an archive of that ending.
fn is_usd(head: &[u8], ending: &str) -> bool {
    head.starts_with(b"#usda") || head.starts_with(b"PXR-USDC") || ending == "usdz" && head.starts_with(b"PK")
}

/// Advice about bytes that are no text in UTF-8.
fn no_text(head: &[u8]) -> Option<String> {
    if head.iter().all(u8::is_ascii_whitespace) {
        return Some("the file is empty; name a robot's file".into());
    }
    if let Some(encoding) = other_encoding(head) {
        return Some(format!(
            "the file is {encoding}; engines read UTF-8: `iconv -f {encoding} -t UTF-8 FILE > robot.xml`, and let its XML declaration say UTF-8"
        ));
    }
    let binary = "this is a binary file (a mesh, or a compiled model?); name the robot's file that it was made from";
    head.contains(&0).then(|| binary.into())
}

/// The format of a text, told by its head.
fn format(bytes: &[u8], head: usize, ending: &str) -> Result<FileFormat, String> {
    let text = String::from_utf8_lossy(&bytes[..head]);
    // What xacro wrote keeps the declaration of its names, and its macros in comments; a macro that is called must still be run.
    if ending == "xacro" || without_comments(&text).contains("<xacro:") {
        return Err("this is a xacro file, a program that writes URDF; run it first: `xacro FILE > robot.urdf`".into());
    }
    if text.contains("<!ENTITY") {
        return Err("the file declares a document type with entities, which no parser here expands; write their text out and remove the <!DOCTYPE …> \
                    (`xmllint --noent --dropdtd FILE > robot.xml`)"
            .into());
    }
    // As far as it is well-formed: one pass over the tags, without a stack.
    let deepest = depth(&without_comments(&String::from_utf8_lossy(bytes)));
    if deepest > DEEPEST {
        return Err(format!(
            "its elements are nested {deepest} deep; engines' parsers call themselves for each level and run out of stack, so the limit is {DEEPEST}: \
             make the chain of bodies shorter, or write it as URDF, which is flat"
        ));
    }
    match root_element(&text) {
        Some("robot") => Ok(FileFormat::Urdf),
        Some("mujoco") => Ok(FileFormat::Mjcf),
        Some("mujocoinclude") => Err("this is a part that an MJCF file includes; name the file whose root element is <mujoco>".into()),
        Some("sdf") => Ok(FileFormat::Sdf),
        Some(other) => Err(format!("the root element is <{other}>; a URDF begins with <robot>, an MJCF with <mujoco>, an SDF with <sdf>")),
        None if text.trim_start().starts_with('{') => {
            Err("this looks like a description file, which no engine reads; put it into datasets/models and name it in a suite".into())
        }
        None if ending == "urdf" || ending == "xml" || ending == "mjcf" => {
            Err("there is no XML element in it; a URDF begins with <robot>, an MJCF with <mujoco>, an SDF with <sdf>".into())
        }
        None => Err("this is neither URDF, MJCF, SDF nor USD; name a file whose root element is <robot>, <mujoco> or <sdf>, or that begins with #usda".into()),
    }
}

/// How deeply a text nests its elements.
fn depth(text: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for tag in text.split('<').skip(1) {
        if tag.starts_with('/') {
            depth = depth.saturating_sub(1);
        } else if !tag.starts_with(['?', '!']) {
            // A `>` may stand in an attribute: the tag ends at the last one before the next tag, or the text behind it.
            let mut quote = None;
            let end = tag.char_indices().find(|&(_, c)| match quote {
                Some(open) => {
                    quote = quote.filter(|_| c != open);
                    false
                }
                None => {
                    quote = Some(c).filter(|c| matches!(c, '"' | '\''));
                    c == '>'
                }
            });
            deepest = deepest.max(depth + 1);
            depth += usize::from(!end.is_some_and(|(at, _)| tag[..at].ends_with('/')));
        }
    }
    deepest
}

/// The name of an encoding other than UTF-8, told by its mark or by where the zeros of Latin letters stand.
fn other_encoding(head: &[u8]) -> Option<&'static str> {
    match head {
        [0xff, 0xfe, 0, 0, ..] | [b'<', 0, 0, 0, ..] => Some("UTF-32LE"),
        [0, 0, 0xfe, 0xff, ..] | [0, 0, 0, b'<', ..] => Some("UTF-32BE"),
        [0xff, 0xfe, ..] | [b'<', 0, ..] => Some("UTF-16LE"),
        [0xfe, 0xff, ..] | [0, b'<', ..] => Some("UTF-16BE"),
        _ => None,
    }
}

fn without_comments(text: &str) -> String {
    let mut pieces = text.split("<!--");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |kept, piece| kept + piece.split_once("-->").map_or("", |(_, behind)| behind))
}

/// The name of the first element behind declarations and comments.
fn root_element(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let skip = if rest.starts_with("<!--") {
            rest.find("-->")? + 3
        } else if rest.starts_with("<!DOCTYPE") && rest.find('[') < rest.find('>') && rest.contains('[') {
            // The declarations inside have their own ends.
            let inside = rest.find(']')?;
            inside + rest[inside..].find('>')? + 1
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            rest.find('>')? + 1
        } else {
            break;
        };
        rest = rest[skip..].trim_start();
    }
    let name = rest.strip_prefix('<')?;
    let end = name.find(|c: char| c.is_whitespace() || c == '>' || c == '/')?;
    Some(&name[..end]).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::{depth, other_encoding, root_element, without_comments};

    #[test]
    fn nesting_is_counted_without_a_parser() {
        assert_eq!(depth("<a/>"), 1);
        assert_eq!(depth("<?xml?><!DOCTYPE a><a><b x='1>2' y=\"/>\"/><c><d/></c></a>"), 3);
        assert_eq!(depth(&format!("{}{}", "<b>".repeat(600), "</b>".repeat(600))), 600);
        assert_eq!(depth(&"<b/>".repeat(600)), 1);
        assert_eq!(depth("</a></a><b>"), 1);
    }

    #[test]
    fn encodings_are_told_by_their_first_bytes() {
        let utf16 = |text: &str, mark: bool| -> Vec<u8> {
            let mark = mark.then_some(0xfeff);
            mark.into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
        };
        assert_eq!(other_encoding(&utf16("<robot/>", true)), Some("UTF-16LE"));
        assert_eq!(other_encoding(&utf16("<robot/>", false)), Some("UTF-16LE"));
        let swapped: Vec<u8> = utf16("<robot/>", true).chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect();
        assert_eq!(other_encoding(&swapped), Some("UTF-16BE"));
        assert_eq!(other_encoding(b"\xef\xbb\xbf<robot/>"), None);
        assert_eq!(other_encoding(b"\0\x01robot"), None);
    }

    #[test]
    fn comments_are_left_out() {
        assert_eq!(without_comments("<a/><!-- <xacro:b/> --><c/><!-- d"), "<a/><c/>");
        assert_eq!(without_comments("<a/>"), "<a/>");
    }

    #[test]
    fn the_root_element_is_behind_declarations_and_comments() {
        assert_eq!(root_element("<robot name='a'/>"), Some("robot"));
        assert_eq!(root_element("\u{feff}<?xml version='1.0'?>\n<!-- <sdf> -->\n<!DOCTYPE x>\n<mujoco>"), Some("mujoco"));
        assert_eq!(root_element("<!DOCTYPE robot [<!ELEMENT robot ANY>]>\n<robot/>"), Some("robot"));
        assert_eq!(root_element("<!-- never ends <robot>"), None);
        assert_eq!(root_element("solid cube"), None);
        assert_eq!(root_element("< robot>"), None);
    }
}
