//! The links and joints of a file, unchanged.

use super::Options;
use super::angles::{of_quaternion, rotation};
use super::error::{At, NoteAt, UrdfProblem};
use super::xml::Element;
use featherbench_model::{JointDescription, JointType, Placement};
use featherbench_spatial::{DoubleDouble, Mat3, Real, Sym3, Vec3, largest};
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, HashMap, HashSet};

/// A file's content.
pub(super) struct Robot {
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

/// A link: its inertia about the centre of mass in link axes.
pub(super) struct Link {
    pub offset: usize,
    pub name: String,
    pub has_inertial: bool,
    pub mass: f64,
    pub com: [f64; 3],
    pub inertia: [f64; 6],
}

/// A joint.
pub(super) struct Joint {
    pub offset: usize,
    /// As the file has it: a planar joint's frame is not yet turned into its plane.
    pub described: JointDescription,
    /// The normal of a planar joint's plane.
    pub normal: Option<[f64; 3]>,
    pub parent: String,
    pub child: String,
    /// The joint that it follows.
    pub mimics: Option<Mimicry>,
}

/// A `<mimic>`.
pub(super) struct Mimicry {
    /// Where it stands.
    pub place: usize,
    /// The joint that leads.
    pub of: String,
    /// Offset and multiplier; none of a joint that is read as independent.
    pub line: Option<[f64; 2]>,
}

/// An axis that deviates from length one by more is normalised at once. One that deviates by less keeps its bits: the canonical form
/// normalises it, with a warning. A quaternion that deviates by more is told to be normalised: files have six digits and more.
const UNIT_TOLERANCE: f64 = 1e-6;

impl Robot {
    pub fn read(document: &Document, options: &Options, notes: &mut Vec<NoteAt>) -> Result<Self, At> {
        let root = document.root_element();
        if let Some((_, kind)) = OTHER_ROOTS.into_iter().find(|(name, _)| *name == root.tag_name().name()) {
            return Err(UrdfProblem::AnotherKind { kind }.at(root.range().start));
        }
        refuse_macros(root)?;
        if root.tag_name().name() != "robot" {
            return Err(UrdfProblem::NotARobot { found: root.tag_name().name().to_owned() }.at(root.range().start));
        }
        let version = root.attribute("version").unwrap_or(OLDEST);
        if !VERSIONS.contains(&version) {
            return Err(UrdfProblem::Version { version: version.to_owned() }.at(root.range().start));
        }
        let name = root.attribute("name").unwrap_or("robot").to_owned();
        let mut robot = Self { name, links: Vec::new(), joints: Vec::new() };
        let mut names = HashSet::new();
        for node in root.children().filter(Node::is_element) {
            let what = match node.tag_name().name() {
                "link" => "link",
                "joint" => "joint",
                _ => continue,
            };
            let name = Element { node, owner: "the robot" }.attribute("name")?;
            if !names.insert((what, name)) {
                return Err(UrdfProblem::DuplicateName { what, name: name.to_owned() }.at(node.range().start));
            }
            let element = Element { node, owner: &format!("{what} '{name}'") };
            if what == "link" {
                robot.links.push(Link::read(element, name, notes)?);
            } else {
                robot.joints.push(Joint::read(element, name, options, notes)?);
            }
        }
        if robot.links.is_empty() {
            return Err(UrdfProblem::NoLinks.at(root.range().start));
        }
        note_mimics_of_nothing(&robot.joints, notes);
        robot.joints.iter().try_for_each(|joint| check_mimic(joint, &robot.joints))?;
        note_what_is_not_read(root, notes);
        Ok(robot)
    }
}

/// The version of a file that gives none.
const OLDEST: &str = "1.0";

/// The versions that are known.
const VERSIONS: [&str; 3] = [OLDEST, "1.1", "1.2"];

/// Root elements of files that are mistaken for URDF.
const OTHER_ROOTS: [(&str, &str); 5] = [
    ("COLLADA", "a COLLADA mesh"),
    ("mujoco", "an MJCF file"),
    ("sdf", "an SDF file"),
    ("html", "a web page"),
    ("launch", "a launch file"),
];

/// An error if xacro has not expanded the file: elements of its namespace, or expressions in attributes. (An expanded file keeps the
/// declaration of the namespace.)
fn refuse_macros(root: Node) -> Result<(), At> {
    for node in root.descendants().filter(Node::is_element) {
        let name = node.tag_name();
        if name.namespace().is_some_and(|namespace| namespace.contains("xacro")) {
            return Err(UrdfProblem::Xacro { found: format!("it has <xacro:{}>", name.name()) }.at(node.range().start));
        }
        let expression = |text: &str| text.contains("${") || text.contains("$(");
        if let Some(attribute) = node.attributes().find(|attribute| expression(attribute.value())) {
            let found = format!("it has {}=\"{}\"", attribute.name(), attribute.value());
            return Err(UrdfProblem::Xacro { found }.at(node.range().start));
        }
    }
    Ok(())
}

/// Notes joints that mimic a missing joint, and cycles of joints that mimic each other: no joint drives them.
fn note_mimics_of_nothing(joints: &[Joint], notes: &mut Vec<NoteAt>) {
    let index: HashMap<&str, usize> = joints.iter().enumerate().map(|(k, joint)| (joint.described.name.as_str(), k)).collect();
    for (k, joint) in joints.iter().enumerate() {
        let Some(Mimicry { of, place, .. }) = &joint.mimics else { continue };
        if !index.contains_key(of.as_str()) {
            let text = format!("joint '{}' mimics '{of}', which is not there", joint.described.name);
            notes.push(NoteAt::new(*place, text));
        }
        let follow = |k: &usize| joints[*k].mimics.as_ref().and_then(|mimic| index.get(mimic.of.as_str()).copied());
        let behind: Vec<usize> = std::iter::successors(follow(&k), follow).take(joints.len()).collect();
        // A cycle is noted once, at the first of its joints.
        let Some(length) = behind.iter().position(|&at| at == k) else { continue };
        let circle = &behind[..=length];
        if circle.iter().all(|&at| at >= k) {
            let names =
                std::iter::once(&k).chain(circle).map(|&at| format!("'{}'", joints[at].described.name)).collect::<Vec<_>>().join(" → ");
            let text = format!("the joints {names} mimic each other in a circle: nothing drives them");
            notes.push(NoteAt::new(*place, text));
        }
    }
}

/// An error if a joint that is to follow another cannot.
fn check_mimic(joint: &Joint, joints: &[Joint]) -> Result<(), At> {
    let Some(Mimicry { place, of, line: Some(_) }) = &joint.mimics else { return Ok(()) };
    let has_coordinate = |joint: &Joint| joint.described.kind.nv() == 1;
    let why = match joints.iter().find(|known| known.described.name == *of) {
        None => "which is not there",
        Some(_) if *of == joint.described.name => "which is itself",
        Some(_) if !has_coordinate(joint) => "and has not one degree of freedom itself",
        Some(leader) if !has_coordinate(leader) => "which has not one degree of freedom",
        Some(_) => return Ok(()),
    };
    Err(UrdfProblem::Mimic { joint: joint.described.name.clone(), of: of.clone(), why }.at(*place))
}

/// What is read: an element, its attributes and its children. All else is told.
const READ: [(&str, &[&str], &[&str]); 13] = [
    ("robot", &["name", "version"], &["link", "joint"]),
    ("link", &["name"], &["inertial"]),
    ("joint", &["name", "type"], &["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"]),
    ("inertial", &[], &["origin", "mass", "inertia"]),
    ("origin", &["xyz", "rpy", QUATERNION], &[]),
    ("mass", &["value"], &[]),
    ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], &[]),
    ("parent", &["link"], &[]),
    ("child", &["link"], &[]),
    ("axis", &["xyz"], &[]),
    ("limit", &["lower", "upper", "velocity", "effort"], &[]),
    ("dynamics", &["damping", "friction"], &[]),
    ("mimic", &["joint", "offset", "multiplier"], &[]),
];

/// One note per kind of element and of attribute that is not read.
fn note_what_is_not_read(root: Node, notes: &mut Vec<NoteAt>) {
    let mut ignored: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let mut tally = |path: String, node: Node| ignored.entry(path).or_insert((0, node.range().start)).0 += 1;
    let mut waiting = vec![root];
    while let Some(node) = waiting.pop() {
        let element = node.tag_name().name();
        let Some((_, attributes, children)) = READ.into_iter().find(|(name, ..)| *name == element) else { continue };
        for attribute in node.attributes() {
            let prefix = attribute.namespace().and_then(|namespace| node.lookup_prefix(namespace));
            let name = prefix.map_or_else(|| attribute.name().to_owned(), |prefix| format!("{prefix}:{}", attribute.name()));
            if name == QUATERNION && element == "origin" && !knows_quaternions(node) {
                tally(format!("{name} in <{element}> (it needs <robot version=\"1.1\">)"), node);
            } else if !attributes.contains(&name.as_str()) {
                tally(format!("{name} in <{element}>"), node);
            }
        }
        let first = waiting.len();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if children.contains(&name) {
                waiting.push(child);
            } else if node == root {
                tally(format!("<{name}>"), child);
            } else {
                tally(format!("<{name}> in <{element}>"), child);
            }
        }
        // The last that waits is the next one: the file's order.
        waiting[first..].reverse();
    }
    for (what, (count, offset)) in ignored {
        let times = if count == 1 { String::new() } else { format!(" ({count} times)") };
        notes.push(NoteAt::new(offset, format!("{what} is not read{times}")));
    }
}

impl Link {
    fn read(element: Element, name: &str, notes: &mut Vec<NoteAt>) -> Result<Self, At> {
        let mut link =
            Self { offset: element.offset(), name: name.to_owned(), has_inertial: false, mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] };
        let Some(inertial) = element.optional("inertial")? else {
            return Ok(link);
        };
        link.has_inertial = true;
        (link.mass, link.inertia) = Self::mass_and_tensor(inertial)?;
        if link.mass < 0.0 {
            return Err(inertial.required("mass")?.problem(UrdfProblem::NegativeMass { link: link.name, mass: link.mass }));
        }
        let origin = origin(inertial, notes)?;
        link.com = origin.translation;
        if origin.rotation != Placement::default().rotation {
            link.inertia = Sym3::from_array(link.inertia).rotate(Mat3::from_array(origin.rotation)).to_array();
        }
        Ok(link)
    }

    /// The numbers of an `<inertial>`, in its own axes.
    pub fn mass_and_tensor(inertial: Element) -> Result<(f64, [f64; 6]), At> {
        let mass = inertial.required("mass")?.number("value")?;
        let tensor = inertial.required("inertia")?;
        let mut inertia = [0.0; 6];
        for (entry, name) in inertia.iter_mut().zip(["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]) {
            *entry = tensor.number(name)?;
        }
        Ok((mass, inertia))
    }
}

impl Joint {
    fn read(element: Element, name: &str, options: &Options, notes: &mut Vec<NoteAt>) -> Result<Self, At> {
        let offset = element.offset();
        let word = element.attribute("type")?;
        let (parent, child) = (element.required("parent")?.attribute("link")?, element.required("child")?.attribute("link")?);
        let placement = origin(element, notes)?;
        let mut mimics = None;
        if let Some(mimic) = element.optional("mimic")? {
            let of = mimic.attribute("joint")?;
            let place = mimic.offset();
            let line = if options.independent_mimics {
                let text = format!("joint '{name}' mimics '{of}' and is read as a joint of its own");
                notes.push(NoteAt::new(place, text));
                None
            } else {
                Some([mimic.optional_number("offset")?.unwrap_or(0.0), mimic.optional_number("multiplier")?.unwrap_or(1.0)])
            };
            mimics = Some(Mimicry { place, of: of.to_owned(), line });
        }
        let mut axis = || axis(element, name, notes);
        let mut normal = None;
        let kind = match word {
            "fixed" => JointType::Fixed,
            "revolute" | "continuous" => JointType::Revolute { axis: axis()? },
            "prismatic" => JointType::Prismatic { axis: axis()? },
            "floating" => JointType::Free,
            "planar" => {
                normal = Some(axis()?);
                JointType::Planar
            }
            other => return Err(element.problem(UrdfProblem::UnknownJointType { joint: name.to_owned(), kind: other.to_owned() })),
        };
        let mut described = JointDescription { name: name.to_owned(), kind, placement, ..JointDescription::default() };
        Self::read_properties(&mut described, element, word == "continuous", notes)?;
        Ok(Self { offset, described, normal, parent: parent.to_owned(), child: child.to_owned(), mimics })
    }

    /// Limits and friction. URDF has one number each: on joints with several dofs they are left out.
    fn read_properties(joint: &mut JointDescription, element: Element, continuous: bool, notes: &mut Vec<NoteAt>) -> Result<(), At> {
        let (limit, dynamics) = (element.optional("limit")?, element.optional("dynamics")?);
        if joint.kind.nv() != 1 {
            if let Some(found) = limit.or(dynamics).filter(|_| joint.kind != JointType::Fixed) {
                let text = format!("limits and friction of joint '{}' are not read: it has more than one degree of freedom", joint.name);
                notes.push(NoteAt::new(found.offset(), text));
            }
            return Ok(());
        }
        if let Some(limit) = limit {
            let (lower, upper) = (limit.limit("lower")?, limit.limit("upper")?);
            let given = |name| limit.node.has_attribute(name);
            if !continuous && (given("lower") || given("upper")) {
                // If one limit is given, the other is zero: so URDF defines it.
                let side = |name, value: Option<f64>| if given(name) { value } else { Some(0.0) };
                joint.lower.extend(side("lower", lower));
                joint.upper.extend(side("upper", upper));
            } else if !continuous {
                notes.push(NoteAt::new(limit.offset(), format!("joint '{}' gives no position limits and has none", joint.name)));
            }
            joint.velocity.extend(limit.limit("velocity")?);
            joint.effort.extend(limit.limit("effort")?);
        } else if !continuous {
            notes.push(NoteAt::new(element.offset(), format!("joint '{}' has no <limit> and is unlimited", joint.name)));
        }
        if let Some(dynamics) = dynamics {
            joint.damping.extend(dynamics.optional_number("damping")?);
            joint.friction.extend(dynamics.optional_number("friction")?);
        }
        Ok(())
    }
}

/// The unit axis of a joint; x when the file gives none.
fn axis(element: Element, joint: &str, notes: &mut Vec<NoteAt>) -> Result<[f64; 3], At> {
    let Some(found) = element.optional("axis")? else {
        return Ok([1.0, 0.0, 0.0]);
    };
    found.attribute("xyz")?;
    let given = found.optional_vector("xyz")?.unwrap_or_default();
    let Some((unit, length)) = unit(given) else {
        return Err(found.problem(UrdfProblem::ZeroAxis { joint: joint.to_owned() }));
    };
    if unit != given {
        notes.push(NoteAt::new(found.offset(), format!("the axis of joint '{joint}' has length {length}; it is normalised")));
    }
    Ok(unit)
}

/// The direction of a vector and its length; `None` of a zero vector. An axis that a description may have keeps its bits.
fn unit(given: [f64; 3]) -> Option<([f64; 3], f64)> {
    // Scaled first, so that squares neither overflow nor underflow.
    let size = largest(given);
    if size == 0.0 {
        return None;
    }
    let scaled = Vec3::from_array(given.map(|x| DoubleDouble::from_f64(x) / DoubleDouble::from_f64(size)));
    let norm = scaled.norm();
    let length = size * norm.to_f64();
    let unit = if (length - 1.0).abs() <= UNIT_TOLERANCE { given } else { scaled.to_array().map(|x| (x / norm).to_f64()) };
    Some((unit, length))
}

/// The placement of an `<origin>`; the identity where there is none.
pub(super) fn origin(element: Element, notes: &mut Vec<NoteAt>) -> Result<Placement, At> {
    let Some(origin) = element.optional("origin")? else {
        return Ok(Placement::default());
    };
    let translation = origin.optional_vector("xyz")?.unwrap_or_default();
    let angles = origin.optional_vector("rpy")?;
    let Some(given) = origin.optional_quaternion(QUATERNION)?.filter(|_| knows_quaternions(origin.node)) else {
        return Ok(Placement { rotation: rotation(angles.unwrap_or_default()), translation });
    };
    let owner = || element.owner.to_owned();
    if angles.is_some() {
        return Err(origin.problem(UrdfProblem::TwoOrientations { owner: owner() }));
    }
    let (rotation, length) = of_quaternion(given).ok_or_else(|| origin.problem(UrdfProblem::ZeroQuaternion { owner: owner() }))?;
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        notes.push(NoteAt::new(origin.offset(), format!("the quaternion of {} has length {length}; it is normalised", element.owner)));
    }
    Ok(Placement { rotation, translation })
}

/// The attribute of an orientation since version 1.1. An older file's is ignored: so the specification demands.
const QUATERNION: &str = "quat_xyzw";

/// Whether an element's file has a version with quaternions.
fn knows_quaternions(node: Node) -> bool {
    node.document().root_element().attribute("version").is_some_and(|version| version != OLDEST)
}
