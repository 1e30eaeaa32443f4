//! The links of a file one by one, before fixed ones are merged. Edits by a parser are explained from these.

use super::elements::{Link, origin};
use super::error::At;
use super::xml::Element;
use crate::solid::{self, Solid};
use crate::text::Lines;
use featherbench_model::Placement;
use featherbench_spatial::{RigidBodyInertia, Sym3, Transform, Vec3};
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

/// Mass properties, in axes of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileInertial {
    /// kg.
    pub mass: f64,
    /// The centre of mass in the link's frame, m.
    pub com: [f64; 3],
    /// The rotation of the inertial's axes in the link's frame, row-major.
    pub rotation: [f64; 9],
    /// Inertia about the centre of mass in the inertial's axes: ixx, ixy, ixz, iyy, iyz, izz, kg·m².
    pub inertia: [f64; 6],
}

/// A link as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct FileLink {
    /// Its name.
    pub name: String,
    /// Its `<inertial>`.
    pub inertial: Option<FileInertial>,
    /// The mass properties of its collision geometry at a density. `None` without geometry, or with a shape other than box, sphere,
    /// cylinder and capsule.
    pub solids: Option<FileInertial>,
}

/// The links of a document, with their collision geometry at a density; none if one of them has an error.
pub(super) fn links(document: &Document, density: f64) -> Vec<FileLink> {
    let nodes = document.root_element().children().filter(|node| node.has_tag_name("link"));
    nodes.map(|node| link(Element { node, owner: "the link" }, density)).collect::<Result<_, At>>().unwrap_or_default()
}

/// A damping or friction of a file that no joint can have: it is negative, infinite or no number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadValue {
    /// Where its characters stand in the file.
    pub range: Range<usize>,
    /// What is wrong, with line and joint.
    pub text: String,
}

/// The bad values of a document. Words that are no numbers are for the import to refuse.
pub(super) fn bad_values(document: &Document, lines: &Lines) -> Vec<BadValue> {
    let mut found = Vec::new();
    for joint in document.root_element().children().filter(|node| node.has_tag_name("joint")) {
        for dynamics in joint.children().filter(|node| node.has_tag_name("dynamics")) {
            let bad = |word: &str| word.trim().parse::<f64>().is_ok_and(|x| !(x.is_finite() && x >= 0.0));
            for attribute in dynamics.attributes().filter(|a| ["damping", "friction"].contains(&a.name()) && bad(a.value())) {
                let (line, name) = (lines.line(attribute.range().start), joint.attribute("name").unwrap_or_default());
                let (word, value) = (attribute.name(), attribute.value());
                let text = format!("line {line}: joint '{name}' has {word}=\"{value}\", which no joint can have; it is left out");
                found.push(BadValue { range: attribute.range_value(), text });
            }
        }
    }
    found
}

/// A `<mimic>` of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mimic {
    /// The joint that has it is fixed.
    pub is_fixed: bool,
    /// The joint that it names is in the file.
    pub is_known: bool,
}

/// The mimics of a document.
pub(super) fn mimics(document: &Document) -> Vec<Mimic> {
    let joints: Vec<Node> = document.root_element().children().filter(|node| node.has_tag_name("joint")).collect();
    let known = |name: Option<&str>| name.is_some() && joints.iter().any(|joint| joint.attribute("name") == name);
    let of_joint = |joint: &Node| {
        let mimic = joint.children().find(|node| node.has_tag_name("mimic"))?;
        Some(Mimic { is_fixed: joint.attribute("type") == Some("fixed"), is_known: known(mimic.attribute("joint")) })
    };
    joints.iter().filter_map(of_joint).collect()
}

/// The joints that are not fixed, depth-first, with siblings sorted by name. Fixed joints are siblings, too: what they carry has their place.
pub(super) fn sorted_joints(document: &Document) -> Vec<String> {
    let joints: Vec<Node> = document.root_element().children().filter(|node| node.has_tag_name("joint")).collect();
    let end = |joint: &Node, role: &str| joint.children().find(|node| node.has_tag_name(role))?.attribute("link").map(str::to_owned);
    let ends: Vec<_> = joints.iter().filter_map(|joint| Some((joint, end(joint, "parent")?, end(joint, "child")?))).collect();
    let children: HashSet<&String> = ends.iter().map(|(_, _, child)| child).collect();
    let mut carried: HashMap<&String, BTreeMap<&str, (Option<&str>, &String)>> = HashMap::new();
    for (joint, parent, child) in &ends {
        let name = joint.attribute("name").unwrap_or_default();
        let moving = (joint.attribute("type") != Some("fixed")).then_some(name);
        carried.entry(parent).or_default().insert(name, (moving, child));
    }
    let mut sorted = Vec::new();
    // Each link is left once, so a file that is no tree comes to its end, too.
    let root = carried.keys().find(|link| !children.contains(**link)).copied();
    let mut next: Vec<(Option<&str>, &String)> = root.map(|root| (None, root)).into_iter().collect();
    while let Some((joint, link)) = next.pop() {
        sorted.extend(joint.map(str::to_owned));
        next.extend(carried.remove(link).unwrap_or_default().into_values().rev());
    }
    sorted
}

fn link(element: Element, density: f64) -> Result<FileLink, At> {
    let name = element.attribute("name")?;
    let inertial = element.optional("inertial")?.map(|inertial| -> Result<FileInertial, At> {
        let place = origin(inertial, &mut Vec::new())?;
        let (mass, inertia) = Link::mass_and_tensor(inertial)?;
        Ok(FileInertial { mass, com: place.translation, rotation: place.rotation, inertia })
    });
    Ok(FileLink { name: name.to_owned(), inertial: inertial.transpose()?, solids: solids(element, density)? })
}

/// All collision geometry of a link together.
fn solids(link: Element, density: f64) -> Result<Option<FileInertial>, At> {
    let mut whole = RigidBodyInertia::zero();
    for node in link.node.children().filter(|node| node.has_tag_name("collision")) {
        let collision = Element { node, ..link };
        let shape = collision.optional("geometry")?.and_then(|geometry| geometry.node.children().find(Node::is_element));
        let Some((volume, moments)) = shape.map(|node| of_shape(Element { node, ..link })).transpose()?.flatten() else { return Ok(None) };
        let Placement { rotation, translation } = origin(collision, &mut Vec::new())?;
        let place = Transform::new(featherbench_spatial::Mat3::from_array(rotation), Vec3::from_array(translation));
        let mass = density * volume;
        let [x, y, z] = moments.map(|moment| mass * moment);
        whole += RigidBodyInertia::from_com(mass, Vec3::zero(), Sym3::from_array([x, 0.0, 0.0, y, 0.0, z])).to_parent(&place);
    }
    Ok((whole.mass > 0.0).then(|| {
        let com = whole.com();
        let about_com = (whole.rotational + Sym3::point_mass(-whole.mass, com)).to_array();
        FileInertial { mass: whole.mass, com: com.to_array(), rotation: Placement::default().rotation, inertia: about_com }
    }))
}

/// A shape as a solid; `None` of an unknown shape.
fn of_shape(shape: Element) -> Result<Option<Solid>, At> {
    Ok(match shape.node.tag_name().name() {
        "box" => shape.optional_vector("size")?.map(solid::cuboid),
        "sphere" => shape.optional_number("radius")?.map(solid::ball),
        "cylinder" => shape.optional_number("radius")?.zip(shape.optional_number("length")?).map(|(r, l)| solid::cylinder(r, l)),
        "capsule" => shape.optional_number("radius")?.zip(shape.optional_number("length")?).map(|(r, l)| solid::capsule(r, l)),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use crate::urdf::{FileLink, Parsed};

    fn one(inside: &str) -> FileLink {
        let text = format!(r#"<robot name="r"><link name="a">{inside}</link></robot>"#);
        Parsed::of(text.as_bytes(), "r.urdf").unwrap().links(1000.0).remove(0)
    }

    fn collision(origin: &str, shape: &str) -> String {
        format!(r#"<collision><origin {origin}/><geometry>{shape}</geometry></collision>"#)
    }

    #[test]
    fn solids_have_the_masses_and_moments_of_the_textbook() {
        let cuboid = one(&collision(r#"xyz="1 2 3""#, r#"<box size="0.1 0.2 0.3"/>"#)).solids.unwrap();
        assert!((cuboid.mass - 6.0).abs() < 1e-14, "{}", cuboid.mass);
        assert!(cuboid.com.iter().zip([1.0, 2.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-14), "{:?}", cuboid.com);
        // m/12 (b² + c²); the parallel axis of 14 m² leaves 1e-14 of its size.
        let due = [0.065, 0.0, 0.0, 0.05, 0.0, 0.025];
        assert!(cuboid.inertia.iter().zip(due).all(|(x, y)| (x - y).abs() < 1e-12), "{:?}", cuboid.inertia);
        let (r, l) = (0.1, 0.4);
        let cylinder = one(&collision(r#"rpy="1.5707963267948966 0 0""#, r#"<cylinder radius="0.1" length="0.4"/>"#)).solids.unwrap();
        let m = std::f64::consts::PI * r * r * l * 1000.0;
        assert!((cylinder.mass - m).abs() < 1e-13 * m);
        let (across, along) = (m * (3.0 * r * r + l * l) / 12.0, m * r * r / 2.0);
        let due = [across, 0.0, 0.0, along, 0.0, across];
        assert!(cylinder.inertia.iter().zip(due).all(|(x, y)| (x - y).abs() < 1e-15), "{:?}", cylinder.inertia);
    }

    /// Without a cylinder between them, the half balls of a capsule are a ball.
    #[test]
    fn a_capsule_of_no_length_is_a_ball_and_a_long_one_is_thin() {
        let ball = one(&collision("", r#"<sphere radius="0.2"/>"#)).solids.unwrap();
        let capsule = one(&collision("", r#"<capsule radius="0.2" length="0"/>"#)).solids.unwrap();
        assert!((ball.mass - capsule.mass).abs() < 1e-13 && (ball.inertia[0] - capsule.inertia[0]).abs() < 1e-14);
        assert!(
            (ball.mass - 4.0 / 3.0 * std::f64::consts::PI * 8.0).abs() < 1e-12 && (ball.inertia[0] - 0.4 * ball.mass * 0.04).abs() < 1e-14
        );
        // Summed over thin slices.
        let (r, l, n) = (0.1_f64, 0.3_f64, 200_000);
        let h = (l + 2.0 * r) / f64::from(n);
        let slice = |k: u32| {
            let z = -l / 2.0 - r + (f64::from(k) + 0.5) * h;
            let beyond = (z.abs() - l / 2.0).max(0.0);
            let square = r * r - beyond * beyond;
            let mass = std::f64::consts::PI * square * h * 1000.0;
            [mass, mass * (square / 4.0 + z * z), mass * square / 2.0]
        };
        let due = (0..n).map(slice).fold([0.0; 3], |sum, x| std::array::from_fn(|k| sum[k] + x[k]));
        let solid = one(&collision("", r#"<capsule radius="0.1" length="0.3"/>"#)).solids.unwrap();
        for (found, due) in [solid.mass, solid.inertia[0], solid.inertia[5]].into_iter().zip(due) {
            assert!((found - due).abs() < 1e-8 * due, "{found} {due}");
        }
    }

    #[test]
    fn several_shapes_add_up_and_a_mesh_is_unknown() {
        let two =
            collision(r#"xyz="1 0 0""#, r#"<box size="0.1 0.1 0.1"/>"#) + &collision(r#"xyz="-1 0 0""#, r#"<box size="0.1 0.1 0.1"/>"#);
        let solids = one(&two).solids.unwrap();
        assert!((solids.mass - 2.0).abs() < 1e-14 && solids.com.iter().all(|x| x.abs() < 1e-15));
        assert!((solids.inertia[3] - 2.0 * (1.0 + 0.01 / 6.0)).abs() < 1e-14, "{:?}", solids.inertia);
        assert_eq!(one(&(two + &collision("", r#"<mesh filename="a.stl"/>"#))).solids, None);
        assert_eq!(one("").solids, None);
        let text = r#"<inertial><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
            <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/></inertial>"#;
        let inertial = one(text).inertial.unwrap();
        assert_eq!((inertial.mass, inertial.com, inertial.inertia), (2.0, [1.0, 2.0, 3.0], [1.0, 0.0, 0.0, 2.0, 0.0, 3.0]));
        assert!((inertial.rotation[1] + 1.0).abs() < 1e-15, "{:?}", inertial.rotation);
    }
}
