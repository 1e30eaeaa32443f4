//! What a file says and is not read: every attribute and element is told by its name, unless it is listed here.
//!
//! So one that a later MJCF adds is told until somebody reads it, or lists it as having no part in a description.

use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet};

/// The attributes that place an element.
const PLACE: &[&str] = &["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Attributes of any element that have no part in a description: names, appearance, numbers for the user. Groups of shapes have none,
/// because the compiler's `inertiagrouprange` is refused.
const NO_PART: &[&str] = &["name", "class", "childclass", "user", "rgba", "material", "group"];

/// Elements that have no part in a description, with all that is in them: appearance, memory, states, words for the user. An asset has
/// none, because a shape whose mass is that of a mesh is refused.
const NO_PART_ELEMENTS: &[&str] = &[
    "asset",
    "camera",
    "custom",
    "keyframe",
    "lengthrange",
    "light",
    "material",
    "mesh",
    "site",
    "size",
    "statistic",
    "texture",
    "visual",
];

/// Sections that hold what a description does not have: they are told as a whole.
const SECTIONS: &[&str] = &["contact", "equality", "tendon", "actuator", "sensor", "deformable", "extension"];

/// The attributes that are read, or have no part in a file that is read; none for an element that is not known.
fn read(element: &str) -> Option<&'static [&'static [&'static str]]> {
    Some(match element {
        "mujoco" => &[&["model"]],
        "worldbody" | "default" => &[],
        "compiler" => &[
            &["alignfree", "angle", "autolimits", "balanceinertia", "boundinertia", "boundmass", "coordinate", "eulerseq"],
            &["inertiafromgeom", "inertiagrouprange", "settotalmass"],
            // Where files are, what is read faster, and what merges bodies that this reader merges in any case.
            &["assetdir", "meshdir", "texturedir", "strippath", "usethread", "fusestatic"],
        ],
        "option" | "flag" => &[&["gravity"]],
        "body" => &[PLACE, &["mocap", "gravcomp"]],
        "inertial" => &[PLACE, &["mass", "diaginertia", "fullinertia"]],
        "joint" => &[
            &["type", "pos", "axis", "ref", "range", "limited", "armature", "damping", "frictionloss", "stiffness", "align"],
            &["actuatorfrcrange", "actuatorfrclimited"],
        ],
        "freejoint" => &[&["align"]],
        "geom" => &[PLACE, &["type", "size", "fromto", "mass", "density", "shellinertia", "mesh", "fitscale"]],
        _ => return None,
    })
}

/// What is told of the elements of one name.
struct Found<'d> {
    /// Byte offset of the first of them.
    offset: usize,
    attributes: BTreeSet<&'d str>,
}

/// What is not read, each with the byte offset of its first element.
pub(super) fn left_out(root: Node<'_, '_>) -> Vec<(usize, String)> {
    let mut notes = Vec::new();
    let mut found: BTreeMap<&str, Found> = BTreeMap::new();
    // Nesting uses no stack. A class says what elements have, and is told as they are.
    let mut open = vec![(root, false)];
    while let Some((node, in_class)) = open.pop() {
        let (name, offset) = (node.tag_name().name(), node.range().start);
        if NO_PART_ELEMENTS.contains(&name) {
            continue;
        }
        let Some(known) = read(name) else {
            let count = node.children().filter(Node::is_element).count();
            if SECTIONS.contains(&name) && node.parent() == Some(root) {
                if count > 0 {
                    notes.push((offset, format!("<{name}> is left out: elements {count}")));
                }
            } else if !in_class {
                notes.push((offset, format!("<{name}> is left out")));
            }
            continue;
        };
        let unread = node.attributes().map(|attribute| attribute.name());
        let unread: BTreeSet<_> = unread.filter(|name| !NO_PART.contains(name) && !known.iter().any(|list| list.contains(name))).collect();
        if !unread.is_empty() {
            let of_name = found.entry(name).or_insert(Found { offset, attributes: BTreeSet::new() });
            if offset < of_name.offset {
                of_name.offset = offset;
            }
            of_name.attributes.extend(unread);
        }
        open.extend(node.children().filter(Node::is_element).map(|child| (child, in_class || name == "default")));
    }
    notes.extend(found.into_iter().map(|(name, Found { offset, attributes })| {
        let attributes: Vec<&str> = attributes.into_iter().collect();
        (offset, format!("of <{name}> is left out: {}", attributes.join(", ")))
    }));
    notes
}
