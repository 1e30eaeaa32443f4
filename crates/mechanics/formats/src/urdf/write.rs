//! Writing URDF: links and joints that [`read`](super::read) gives back.

use super::angles::angles;
use super::tree::GRAVITY;
use crate::export::names::{self, Names, ROOT};
use crate::export::order::{Item, carried};
use crate::export::xml::{Attributes, Xml};
use crate::export::{self, ExportError, Loss, OnLoss, Reason};
use featherbench_model::{Description, Frame, JointDescription, JointType, LoopKind, Placement};
use std::path::Path;

/// Writes a URDF file, completely or not at all, and returns what was left out.
///
/// # Errors
/// [`ExportError`], listing everything that URDF cannot hold.
pub fn write(description: &Description, path: impl AsRef<Path>, on_loss: OnLoss) -> Result<Vec<Loss>, ExportError> {
    let (text, losses) = to_string(description, on_loss)?;
    export::write(path.as_ref(), &text)?;
    Ok(losses)
}

/// The robot's canonical form as the text of a URDF file, and what was left out.
///
/// The root link is called `world` and does not move; a free body has a `floating` joint to it. So the file is imported with
/// [`Base::Fixed`](super::Base::Fixed). Frames are links of their own, fixed. Scalars, vectors and inertias are imported to the bit.
/// Rotations are within 8ε, and equal to the bit if angles can express them. Writing an imported file again gives the same text.
/// The provenance is a comment of the file.
///
/// # Errors
/// [`ExportError`], listing everything that URDF cannot hold.
pub fn to_string(description: &Description, on_loss: OnLoss) -> Result<(String, Vec<Loss>), ExportError> {
    let robot = description.canonical()?;
    let losses = export::settle("URDF", losses(&robot), on_loss)?;
    let mut joint_names = Names::default();
    robot.bodies.iter().for_each(|body| _ = joint_names.fresh(&body.joint.name));

    let mut xml = Xml::default();
    xml.open("robot", |attributes| _ = attributes.text("name", &robot.name));
    if let Some(provenance) = &robot.provenance {
        xml.comment(&format!("{}; {}", provenance.source, provenance.licence));
    }
    xml.empty("link", |attributes| _ = attributes.text("name", ROOT));
    let followed = followed(&robot);
    let carried = carried(&robot);
    let mut stack: Vec<Item> = carried[0].iter().rev().copied().collect();
    while let Some(item) = stack.pop() {
        match item {
            Item::Body(i) => {
                body(&mut xml, &robot, i, followed.iter().find(|mimic| mimic.follower == i));
                stack.extend(carried[i + 1].iter().rev());
            }
            Item::Frame(k) if is_root(&robot.frames[k]) => {}
            Item::Frame(k) => frame(&mut xml, &robot, &robot.frames[k], &mut joint_names),
        }
    }
    Ok((xml.finish(), losses))
}

/// Whether a frame is the world itself: the root link is imported as that.
fn is_root(frame: &Frame) -> bool {
    frame.name == ROOT && frame.body.is_none() && frame.placement == Placement::default()
}

fn body(xml: &mut Xml, robot: &Description, i: usize, mimic: Option<&Followed>) {
    let body = &robot.bodies[i];
    xml.open("link", |attributes| _ = attributes.text("name", &body.name));
    xml.open("inertial", |_| {});
    xml.empty("origin", |attributes| _ = attributes.numbers("xyz", &body.com));
    xml.empty("mass", |attributes| _ = attributes.numbers("value", &[body.mass]));
    xml.empty("inertia", |attributes| {
        for (name, entry) in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].into_iter().zip(body.inertia) {
            attributes.numbers(name, &[entry]);
        }
    });
    xml.close();
    xml.close();

    let joint = &body.joint;
    let (kind, axis) = match joint.kind {
        JointType::Revolute { axis } => {
            (if joint.lower.is_empty() || !limits_are_whole(joint) { "continuous" } else { "revolute" }, Some(axis))
        }
        JointType::Prismatic { axis } => ("prismatic", Some(axis)),
        JointType::Free => ("floating", None),
        JointType::Planar => ("planar", Some([0.0, 0.0, 1.0])),
        // The canonical form has no fixed joint, and the others gave an error before.
        _ => ("fixed", None),
    };
    open_joint(xml, &joint.name, kind, &joint.placement, parent(robot, body.parent), &body.name);
    if let Some(axis) = axis {
        xml.empty("axis", |attributes| _ = attributes.numbers("xyz", &axis));
    }
    if kind != "floating" && kind != "planar" {
        properties(xml, joint);
    }
    if let Some(&Followed { leader, offset, multiplier, .. }) = mimic {
        let leader = &robot.bodies[leader].joint.name;
        xml.empty("mimic", |attributes| {
            _ = attributes.text("joint", leader).numbers("multiplier", &[multiplier]).numbers("offset", &[offset]);
        });
    }
    xml.close();
}

/// A loop that URDF can hold: a joint that follows another by a straight line.
struct Followed {
    /// Its place among the loops.
    index: usize,
    follower: usize,
    leader: usize,
    offset: f64,
    multiplier: f64,
}

/// The loops that URDF can hold; a joint has one at most.
fn followed(robot: &Description) -> Vec<Followed> {
    let mut found: Vec<Followed> = Vec::new();
    for (index, tie) in robot.loops.iter().enumerate() {
        let LoopKind::Mimic { follower, leader, polynomial: [offset, multiplier, 0.0, 0.0, 0.0] } = tie.kind else { continue };
        if found.iter().all(|known| known.follower != follower) {
            found.push(Followed { index, follower, leader, offset, multiplier });
        }
    }
    found
}

/// Limits and friction of a joint with one degree of freedom. Incomplete limits that gave no error are left out.
fn properties(xml: &mut Xml, joint: &JointDescription) {
    let limits = [("lower", &joint.lower), ("upper", &joint.upper), ("velocity", &joint.velocity), ("effort", &joint.effort)];
    let given = |attributes: &mut Attributes, lists: &[(&str, &Vec<f64>)]| {
        for (name, list) in lists.iter().filter(|(_, list)| !list.is_empty()) {
            attributes.numbers(name, list);
        }
    };
    if limits_are_whole(joint) && !joint.effort.is_empty() {
        xml.empty("limit", |attributes| given(attributes, &limits));
    }
    let dynamics = [("damping", &joint.damping), ("friction", &joint.friction)];
    if dynamics.iter().any(|(_, list)| !list.is_empty()) {
        xml.empty("dynamics", |attributes| given(attributes, &dynamics));
    }
}

fn frame(xml: &mut Xml, robot: &Description, frame: &Frame, joint_names: &mut Names) {
    xml.empty("link", |attributes| _ = attributes.text("name", &frame.name));
    let name = joint_names.fresh(&format!("{}_fixed", frame.name));
    // Merging on reading adds zeros, which makes negative ones positive.
    let placement = Placement { translation: frame.placement.translation.map(|x| x + 0.0), ..frame.placement };
    open_joint(xml, &name, "fixed", &placement, parent(robot, frame.body), &frame.name);
    xml.close();
}

fn open_joint(xml: &mut Xml, name: &str, kind: &str, placement: &Placement, parent: &str, child: &str) {
    xml.open("joint", |attributes| _ = attributes.text("name", name).text("type", kind));
    xml.empty("origin", |attributes| _ = attributes.numbers("xyz", &placement.translation).numbers("rpy", &angles(&placement.rotation)));
    xml.empty("parent", |attributes| _ = attributes.text("link", parent));
    xml.empty("child", |attributes| _ = attributes.text("link", child));
}

fn parent(robot: &Description, body: Option<usize>) -> &str {
    body.map_or(ROOT, |body| &robot.bodies[body].name)
}

/// Whether the limits are those that URDF parsers need: all four, or on a revolute joint none or speed and effort.
fn limits_are_whole(joint: &JointDescription) -> bool {
    let given = [&joint.lower, &joint.upper, &joint.velocity, &joint.effort].map(|list| !list.is_empty());
    let turns = matches!(joint.kind, JointType::Revolute { .. });
    let slides = matches!(joint.kind, JointType::Prismatic { .. });
    given == [true; 4] || turns && (given == [false; 4] || given == [false, false, true, true]) || !turns && !slides
}

/// Everything that URDF cannot hold, in the order of the description.
fn losses(robot: &Description) -> Vec<Loss> {
    let mut losses = Vec::from_iter(names::of_robot(&robot.name));
    if robot.gravity != GRAVITY {
        losses.push(Loss { about: "the robot".to_owned(), reason: Reason::Gravity });
    }
    let (mut links, mut joints) = (Names::default(), Names::default());
    links.fresh(ROOT);
    for body in &robot.bodies {
        links.take("body", &body.name, &mut losses);
        joints.take("joint", &body.joint.name, &mut losses);
        let reasons = joint_losses(&body.joint).into_iter();
        losses.extend(reasons.map(|reason| Loss { about: format!("joint '{}'", body.joint.name), reason }));
    }
    for frame in robot.frames.iter().filter(|frame| !is_root(frame)) {
        links.take("frame", &frame.name, &mut losses);
    }
    let held = followed(robot);
    for (index, tie) in robot.loops.iter().enumerate().filter(|(index, _)| held.iter().all(|mimic| mimic.index != *index)) {
        let about = format!("loops[{index}] '{}'", tie.name);
        losses.push(Loss { about, reason: Reason::Loop { kind: tie.kind.name() } });
    }
    losses.extend(export::deforming(robot));
    losses.extend(export::residuals(robot));
    losses
}

fn joint_losses(joint: &JointDescription) -> Vec<Reason> {
    let missing = |advice| Some(Reason::JointType { kind: joint.kind.name(), advice });
    let joint_type = match joint.kind {
        JointType::Revolute { .. } | JointType::Prismatic { .. } | JointType::Free | JointType::Planar | JointType::Fixed => None,
        JointType::Helical { .. } => missing("keep the robot in the neutral format"),
        JointType::Spherical => missing("describe it as three revolute joints, or keep the neutral format or MJCF"),
        _ => missing("describe it as revolute and prismatic joints in a row, or keep the neutral format or MJCF"),
    };
    let mut reasons = Vec::from_iter(joint_type);
    if joint.armature.iter().any(|&x| x != 0.0) {
        reasons.push(Reason::Property { field: "armature" });
    }
    if joint.kind.nv() == 1 {
        reasons.extend((!limits_are_whole(joint)).then_some(Reason::IncompleteLimits));
        return reasons;
    }
    for (field, list) in [("damping", &joint.damping), ("friction", &joint.friction)] {
        reasons.extend(list.iter().any(|&x| x != 0.0).then_some(Reason::SeveralDofs { field }));
    }
    for (field, list) in [("lower", &joint.lower), ("upper", &joint.upper), ("velocity", &joint.velocity), ("effort", &joint.effort)] {
        reasons.extend((!list.is_empty()).then_some(Reason::SeveralDofs { field }));
    }
    reasons
}
