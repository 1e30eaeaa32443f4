//! What kind of file a robot comes in, told by its content, with advice where it is none that engines read.

use crate::fail::Fail;
use harness::{FileBase, FileFormat, RobotFile};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Endings of files that hold shapes.
const MESHES: [&str; 9] = ["stl", "obj", "dae", "ply", "gltf", "glb", "msh", "3ds", "fbx"];
/// How much of a file is looked at: comments may stand before the root element.
const HEAD: u64 = 1 << 20;

/// Recognises a robot's file.
pub fn open(path: &Path, floating: bool) -> Result<RobotFile, Fail> {
    let format = format(path).map_err(|problem| Fail::input(format!("{}: {problem}", path.display())))?;
    // An MJCF says itself what floats.
    let base = if floating && format == FileFormat::Urdf { FileBase::Free } else { FileBase::Fixed };
    Ok(RobotFile::open(path, format, base)?)
}

fn format(path: &Path) -> Result<FileFormat, String> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if path.is_dir() {
        return Err("this is a folder; name the robot's URDF or MJCF file in it".into());
    }
    if MESHES.contains(&ending.as_str()) {
        return Err(format!("a .{ending} file holds a shape and no joints; name the URDF or MJCF file that uses it"));
    }
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.map_err(|error| error.to_string())?;
    if head.iter().all(u8::is_ascii_whitespace) {
        return Err("the file is empty; name a URDF or MJCF file".into());
    }
    if head.contains(&0) {
        return Err("this is a binary file (a mesh, or a compiled model?); name the URDF or MJCF text that it was made from".into());
    }
    let text = String::from_utf8_lossy(&head);
    // What xacro wrote keeps the declaration of its names, and its macros in comments; a macro that is called must still be run.
    if ending == "xacro" || without_comments(&text).contains("<xacro:") {
        return Err("this is a xacro file, a program that writes URDF; run it first: `xacro FILE > robot.urdf`".into());
    }
    match root_element(&text) {
        Some("robot") => Ok(FileFormat::Urdf),
        Some("mujoco") => Ok(FileFormat::Mjcf),
        Some("mujocoinclude") => Err("this is a part that an MJCF file includes; name the file whose root element is <mujoco>".into()),
        Some("sdf") => Err("engines do not read SDF alike enough to compare; convert it to URDF or MJCF first".into()),
        Some(other) => Err(format!("the root element is <{other}>; a URDF begins with <robot>, an MJCF with <mujoco>")),
        None if text.trim_start().starts_with('{') => {
            Err("this looks like a description file, which no engine reads; put it into datasets/models and name it in a suite".into())
        }
        None if ending == "urdf" || ending == "xml" || ending == "mjcf" => {
            Err("there is no XML element in it; a URDF begins with <robot>, an MJCF with <mujoco>".into())
        }
        None => Err("this is neither URDF nor MJCF; name an XML file whose root element is <robot> or <mujoco>".into()),
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
    use super::{root_element, without_comments};

    #[test]
    fn comments_are_left_out() {
        assert_eq!(without_comments("<a/><!-- <xacro:b/> --><c/><!-- d"), "<a/><c/>");
        assert_eq!(without_comments("<a/>"), "<a/>");
    }

    #[test]
    fn the_root_element_is_behind_declarations_and_comments() {
        assert_eq!(root_element("<robot name='a'/>"), Some("robot"));
        assert_eq!(root_element("\u{feff}<?xml version='1.0'?>\n<!-- <sdf> -->\n<!DOCTYPE x>\n<mujoco>"), Some("mujoco"));
        assert_eq!(root_element("<!-- never ends <robot>"), None);
        assert_eq!(root_element("solid cube"), None);
        assert_eq!(root_element("< robot>"), None);
    }
}
