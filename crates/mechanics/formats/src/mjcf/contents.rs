//! What an MJCF file holds that engines' parsers are known to refuse. MuJoCo itself reads the robot.

use roxmltree::Node;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// More files than any robot includes. An include of itself ends here.
const MOST_FILES: usize = 100;

/// What a file and the files that it includes hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// The model has a name.
    pub named: bool,
    /// A site is in the world body itself.
    pub world_site: bool,
    /// There is a height field.
    pub height_field: bool,
    /// A body with a mesh has no inertial element.
    pub mesh_without_inertial: bool,
    /// The endings of the mesh files, in lower case.
    pub mesh_formats: BTreeSet<String>,
}

/// The contents of an MJCF file of this text. Of what cannot be read, or is no XML, nothing is known.
pub fn contents(path: &Path, text: &str) -> Contents {
    let mut contents = Contents::default();
    // Names of included files are relative to the folder of the first one.
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = contents.add(text);
    let mut next = 0;
    while next < files.len().min(MOST_FILES - 1) {
        if let Ok(text) = std::fs::read_to_string(folder.join(&files[next])) {
            files.extend(contents.add(&text));
        }
        next += 1;
    }
    contents
}

impl Contents {
    /// Adds what one text holds; returns the files that it includes.
    fn add(&mut self, text: &str) -> Vec<PathBuf> {
        let Ok(document) = crate::text::xml(text) else { return Vec::new() };
        let root = document.root_element();
        self.named |= root.has_tag_name("mujoco") && root.has_attribute("model");
        let mut included = Vec::new();
        for node in root.descendants().filter(Node::is_element) {
            let has = |name: &'static str| node.children().any(|child| child.has_tag_name(name));
            match node.tag_name().name() {
                "include" => included.extend(node.attribute("file").map(PathBuf::from)),
                "hfield" => self.height_field = true,
                "worldbody" => self.world_site |= has("site"),
                "body" => self.mesh_without_inertial |= !has("inertial") && node.children().any(is_mesh),
                "mesh" => self.mesh_formats.extend(node.attribute("file").and_then(ending)),
                _ => {}
            }
        }
        included
    }
}

/// Whether an element is a geometry with a mesh.
fn is_mesh(node: Node) -> bool {
    node.has_tag_name("geom") && (node.has_attribute("mesh") || node.attribute("type") == Some("mesh"))
}

fn ending(file: &str) -> Option<String> {
    Path::new(file).extension().map(|ending| ending.to_string_lossy().to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_element_is_found_in_the_file_and_in_what_it_includes() {
        let folder = tempfile::tempdir().unwrap();
        let of = |text: &str| {
            let path = folder.path().join("robot.xml");
            std::fs::write(&path, text).unwrap();
            contents(&path, text)
        };
        assert_eq!(of("<mujoco/>"), Contents::default());
        assert_eq!(of("no XML"), Contents::default());
        assert_eq!(of("<mujoco model='m'><include file='robot.xml'/></mujoco>"), Contents { named: true, ..Contents::default() });
        let site = "<worldbody><site/></worldbody>";
        assert!(of(&format!("<mujoco>{site}</mujoco>")).world_site);
        assert!(!of("<mujoco><worldbody><body><site/></body></worldbody></mujoco>").world_site);
        std::fs::write(folder.path().join("part.xml"), format!("<mujocoinclude>{site}</mujocoinclude>")).unwrap();
        assert!(of("<mujoco><include file='part.xml'/></mujoco>").world_site);
        let asset = of("<mujoco><asset><hfield/><mesh file='a.STL'/><mesh file='b/c.obj'/></asset></mujoco>");
        assert!(asset.height_field);
        assert_eq!(asset.mesh_formats, ["obj", "stl"].map(str::to_owned).into());
        let body = |inside: &str| of(&format!("<mujoco><worldbody><body>{inside}</body></worldbody></mujoco>")).mesh_without_inertial;
        assert!(body("<geom mesh='a'/>") && body("<geom type='mesh'/>"));
        assert!(!body("<inertial/><geom mesh='a'/>") && !body("<geom type='box'/>"));
    }
}
