//! From nested bodies to a description.

use super::element::Element;
use super::error::{At, MjcfProblem};
use super::settings::Settings;
use super::{inertial, joint, told};
use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement};
use featherbench_spatial::{Mat3, Transform, Vec3};
use roxmltree::Node;
use std::collections::HashSet;
use std::path::Path;

/// Elements of a body that make bodies, or place them.
const MAKERS: [&str; 6] = ["frame", "replicate", "attach", "composite", "flexcomp", "include"];

/// A body that is still to be read.
struct Open<'d> {
    node: Node<'d, 'd>,
    /// The class of what does not say its own.
    class: Option<&'d str>,
    parent: Home,
}

/// Where an MJCF body is: the description's body that it belongs to, and its frame in that body's.
#[derive(Clone, Copy)]
struct Home {
    body: Option<usize>,
    place: Transform<f64>,
    /// Whether a joint is between it and the world.
    moves: bool,
}

/// What is being made.
struct Tree<'a, 'd> {
    settings: &'a Settings<'d>,
    bodies: Vec<BodyDescription>,
    frames: Vec<Frame>,
    /// Byte offset of the element of each body.
    offsets: Vec<usize>,
    /// Number of bodies and of joints so far, by which those without a name are called, as MuJoCo numbers them.
    counts: [usize; 2],
    /// Names of the joints.
    joints: HashSet<String>,
    /// Bodies that are no more than a joint of the next.
    parts: HashSet<String>,
    notes: Vec<(usize, String)>,
}

/// The canonical description of a file, and what was left out, in the order of the file.
pub(super) fn assemble(root: Node<'_, '_>, file: &str) -> Result<(Description, Vec<(usize, String)>), At> {
    let settings = Settings::read(root)?;
    let mut tree = Tree {
        settings: &settings,
        bodies: Vec::new(),
        frames: Vec::new(),
        offsets: Vec::new(),
        counts: [0; 2],
        joints: HashSet::new(),
        parts: HashSet::new(),
        notes: told::left_out(root),
    };
    let world = Home { body: None, place: Transform::identity(), moves: false };
    let mut open = Vec::new();
    for section in root.children().filter(Node::is_element) {
        let name = section.tag_name().name();
        let offset = section.range().start;
        match name {
            "worldbody" => {
                tree.refuse_makers(section)?;
                let bodies: Vec<_> = section.children().filter(|child| child.has_tag_name("body")).collect();
                // The sections' bodies are in the order of the file: what is taken last is read first.
                open.splice(
                    0..0,
                    bodies.into_iter().rev().map(|node| Open { node, class: section.attribute("childclass"), parent: world }),
                );
            }
            "include" => return Err(MjcfProblem::NotRead { what: "<include>".to_owned() }.at(offset)),
            _ => {}
        }
    }
    while let Some(next) = open.pop() {
        let (class, parent) = tree.body(&next)?;
        let children: Vec<_> = next.node.children().filter(|child| child.has_tag_name("body")).collect();
        open.extend(children.into_iter().rev().map(|node| Open { node, class, parent }));
    }
    let stem = || Path::new(file).file_stem().map_or_else(|| "robot".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let name = root.attribute("model").map_or_else(stem, str::to_owned);
    let Tree { bodies, frames, offsets, parts, mut notes, .. } = tree;
    let at = |name: &str| bodies.iter().position(|body| body.name == name).map_or(0, |k| offsets[k]);
    let description = Description { name, gravity: settings.gravity, bodies: bodies.clone(), frames, ..Description::default() };
    let canonical = description.canonical().map_err(|malformed| {
        let offset = malformed.about().map(at);
        At { offset, problem: malformed.into() }
    })?;
    if let Some(body) = canonical.bodies.iter().find(|body| body.mass == 0.0 && !parts.contains(&body.name)) {
        return Err(MjcfProblem::Massless { owner: format!("body '{}'", body.name) }.at(at(&body.name)));
    }
    notes.sort_by_key(|note| note.0);
    Ok((canonical, notes))
}

impl<'d> Tree<'_, 'd> {
    fn refuse_makers(&self, node: Node<'d, 'd>) -> Result<(), At> {
        let maker = node.children().find(|child| child.is_element() && MAKERS.contains(&child.tag_name().name()));
        maker.map_or(Ok(()), |maker| Err(MjcfProblem::NotRead { what: format!("<{}>", maker.tag_name().name()) }.at(maker.range().start)))
    }

    /// Reads one body; gives the class and the place of its children.
    fn body(&mut self, Open { node, class, parent }: &Open<'d>) -> Result<(Option<&'d str>, Home), At> {
        self.refuse_makers(*node)?;
        self.counts[0] += 1;
        let name = node.attribute("name").map_or_else(|| format!("body {}", self.counts[0]), str::to_owned);
        let owner = format!("body '{name}'");
        let offset = node.range().start;
        let class = node.attribute("childclass").or(*class);
        let body = Element { node: *node, owner: &owner, class: None };
        if body.flag("mocap")? == Some(true) {
            return Err(body.problem(MjcfProblem::NotRead { what: format!("the mocap of {owner}") }));
        }
        if body.number("gravcomp")?.is_some_and(|x| x != 0.0) {
            self.notes.push((offset, format!("the gravity compensation of {owner} is left out")));
        }
        let drawn = Transform::new(
            body.orientation(self.settings)?.unwrap_or(Mat3::identity()),
            Vec3::from_array(body.numbers("pos")?.unwrap_or_default()),
        );
        let joints = self.joints(*node, &owner, class, parent)?;
        let (mass, com, inertia) = self.inertial(*node, &owner, class, parent.moves || !joints.is_empty())?;
        // The joints' frames, one after the other.
        let (mut carrier, mut before) = (parent.body, None);
        let last = joints.len().wrapping_sub(1);
        for (k, joint) in joints.into_iter().enumerate() {
            let free = joint.described.kind == JointType::Free;
            let on_parent = match before {
                // A free joint's coordinates are relative to the world, wherever the file draws the body.
                None if free => Transform::identity(),
                None => parent.place.compose(&drawn).compose(&joint.here),
                Some(before) => Transform::inverse(&before).compose(&joint.here),
            };
            let placement = Placement::from_transform(&on_parent.compose(&joint.back));
            let described = JointDescription { placement, ..joint.described };
            let named = if k == last { name.clone() } else { format!("{name}/{}", described.name) };
            if k != last {
                self.parts.insert(named.clone());
            }
            let moved = if k == last { (mass, inertia) } else { (0.0, [0.0; 6]) };
            let back = joint.here.translation;
            let com = if k == last { (Vec3::from_array(com) - back).to_array() } else { [0.0; 3] };
            self.push(offset, BodyDescription { name: named, parent: carrier, mass: moved.0, com, inertia: moved.1, joint: described });
            (carrier, before) = (Some(self.bodies.len() - 1), Some(joint.here));
        }
        let Some(before) = before else {
            let placement = Placement::from_transform(&parent.place.compose(&drawn));
            let joint = JointDescription { name: format!("{name}_fixed"), placement, ..JointDescription::default() };
            self.push(offset, BodyDescription { name, parent: parent.body, mass, com, inertia, joint });
            let body = Some(self.bodies.len() - 1);
            return Ok((class, Home { body, place: Transform::identity(), moves: parent.moves }));
        };
        let place = before.inverse();
        if before.translation != Vec3::zero() {
            // The body's own frame is not where its joint is.
            self.frames.push(Frame { name, body: carrier, placement: Placement::from_transform(&place) });
        }
        Ok((class, Home { body: carrier, place, moves: true }))
    }

    fn push(&mut self, offset: usize, body: BodyDescription) {
        self.offsets.push(offset);
        self.bodies.push(body);
    }

    fn joints(&mut self, node: Node<'d, 'd>, owner: &str, class: Option<&'d str>, parent: &Home) -> Result<Vec<joint::Joint>, At> {
        let of_body = |child: &Node| child.has_tag_name("joint") || child.has_tag_name("freejoint");
        let mut joints = Vec::new();
        for node in node.children().filter(of_body) {
            // A free joint has no class: nothing of it can be set.
            let class = if node.has_tag_name("freejoint") { None } else { self.settings.class(node, owner, class)? };
            let element = Element { node, owner, class };
            let name = node.attribute("name").map_or_else(|| format!("joint {}", self.counts[1]), str::to_owned);
            self.counts[1] += 1;
            let joint = joint::read(element, name, self.settings)?;
            if !self.joints.insert(joint.described.name.clone()) {
                let name = joint.described.name;
                return Err(MjcfProblem::RepeatedJoint { owner: owner.to_owned(), name }.at(node.range().start));
            }
            for what in &joint.left_out {
                self.notes.push((node.range().start, format!("the {what} of joint '{}' is left out", joint.described.name)));
            }
            joints.push(joint);
        }
        let free = joints.iter().any(|joint| joint.described.kind == JointType::Free);
        let below = |found| MjcfProblem::FreeBelow { owner: owner.to_owned(), found }.at(node.range().start);
        if free && joints.len() > 1 {
            return Err(below("beside another joint"));
        }
        if free && (parent.body.is_some() || node.parent().is_none_or(|parent| !parent.has_tag_name("worldbody"))) {
            return Err(below("below another body"));
        }
        Ok(joints)
    }

    /// Mass properties; those of a body that never moves have no effect, and are not read.
    fn inertial(&self, node: Node<'d, 'd>, owner: &str, class: Option<&'d str>, moves: bool) -> Result<inertial::Inertial, At> {
        if !moves {
            return Ok((0.0, [0.0; 3], [0.0; 6]));
        }
        let shapes: Vec<Node> = node.children().filter(|child| child.has_tag_name("geom")).collect();
        let written = node.children().find(|child| child.has_tag_name("inertial"));
        match written {
            Some(node) if !self.settings.from_shapes || shapes.is_empty() => {
                inertial::written(Element { node, owner, class: None }, self.settings)
            }
            _ => {
                let elements: Result<Vec<_>, At> =
                    shapes.into_iter().map(|node| Ok(Element { node, owner, class: self.settings.class(node, owner, class)? })).collect();
                inertial::of_shapes(elements?.into_iter(), self.settings)
            }
        }
    }
}
