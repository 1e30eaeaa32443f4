//! Writing MJCF: nested bodies with their joints.

use super::joints::{Part, is_part_of_child, parts};
use super::quaternion::quaternion;
use crate::export::names::{Names, ROOT};
use crate::export::order::{Item, carried};
use crate::export::xml::{Attributes, Xml};
use crate::export::{self, ExportError, Loss, OnLoss, Reason};
use model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement, Warning};
use std::path::Path;

/// Writes an MJCF file, whole or not at all, and tells what was left out.
///
/// # Errors
/// [`ExportError`], listing everything that MJCF cannot hold.
pub fn write(description: &Description, path: impl AsRef<Path>, on_loss: OnLoss) -> Result<Vec<Loss>, ExportError> {
    let (text, losses) = to_string(description, on_loss)?;
    export::write(path.as_ref(), &text)?;
    Ok(losses)
}

/// The robot's canonical form as the text of an MJCF file, and what was left out.
///
/// A joint that MuJoCo does not have as one becomes several in one body, named after it; where they are read back as massless bodies, those
/// become joints of one body again. Frames are bodies without joints. MuJoCo's compiler is told to edit nothing. Scalars and vectors are read
/// back to the bit, rotations and inertias within 8ε, and a second trip changes nothing. The provenance stands in a comment.
///
/// # Errors
/// [`ExportError`], listing everything that MJCF cannot hold.
pub fn to_string(description: &Description, on_loss: OnLoss) -> Result<(String, Vec<Loss>), ExportError> {
    let robot = description.canonical()?;
    let carried = carried(&robot);
    let losses = export::settle("MJCF", losses(&robot, &carried), on_loss)?;

    let mut xml = Xml::default();
    xml.open("mujoco", |attributes| _ = attributes.text("model", &robot.name));
    if let Some(provenance) = &robot.provenance {
        xml.comment(&format!("{}; {}", provenance.source, provenance.licence));
    }
    xml.empty("compiler", |attributes| {
        attributes.text("angle", "radian").text("autolimits", "false").text("inertiafromgeom", "false").text("balanceinertia", "false");
        attributes.text("boundmass", "0").text("boundinertia", "0").text("settotalmass", "-1").text("fusestatic", "false");
    });
    xml.empty("option", |attributes| _ = attributes.numbers("gravity", &robot.gravity));
    xml.open("worldbody", |_| {});
    let world = xml.depth();
    // Each item with the depth at which it stands.
    let mut stack: Vec<(usize, Item)> = carried[0].iter().rev().map(|&item| (world, item)).collect();
    while let Some((depth, item)) = stack.pop() {
        while xml.depth() > depth {
            xml.close();
        }
        match item {
            Item::Frame(k) if is_world(&robot.frames[k]) => {}
            Item::Frame(k) => frame(&mut xml, &robot.frames[k]),
            Item::Body(first) => {
                let row = row(&robot, &carried, first);
                let last = row[row.len() - 1];
                body(&mut xml, &row.iter().map(|&i| &robot.bodies[i]).collect::<Vec<_>>());
                stack.extend(carried[last + 1].iter().rev().map(|&item| (depth + 1, item)));
            }
        }
    }
    Ok((xml.finish(), losses))
}

/// A body, and behind it the bodies that are written as one with it: each is no more than a joint of the next.
fn row(robot: &Description, carried: &[Vec<Item>], first: usize) -> Vec<usize> {
    let mut row = vec![first];
    let mut last = first;
    while let [Item::Body(child)] = carried[last + 1][..]
        && is_part_of_child(&robot.bodies[last], &robot.bodies[child])
    {
        row.push(child);
        last = child;
    }
    row
}

/// Whether a frame is the world itself.
fn is_world(frame: &Frame) -> bool {
    frame.name == ROOT && frame.body.is_none() && frame.placement == Placement::default()
}

fn frame(xml: &mut Xml, frame: &Frame) {
    xml.empty("body", |attributes| {
        attributes.text("name", &frame.name);
        place(attributes, &frame.placement);
    });
}

fn place(attributes: &mut Attributes, placement: &Placement) {
    attributes.numbers("pos", &placement.translation).numbers("quat", &quaternion(&placement.rotation).0);
}

/// Opens the MJCF body of a row, with the inertia of the last and the joints of all.
fn body(xml: &mut Xml, row: &[&BodyDescription]) {
    let (first, last) = (row[0], row[row.len() - 1]);
    xml.open("body", |attributes| {
        attributes.text("name", &last.name);
        place(attributes, &first.joint.placement);
    });
    let [xx, xy, xz, yy, yz, zz] = last.inertia;
    xml.empty("inertial", |attributes| {
        _ = attributes.numbers("pos", &last.com).numbers("mass", &[last.mass]).numbers("fullinertia", &[xx, yy, zz, xy, xz, yz]);
    });
    for part in row.iter().filter_map(|body| parts(&body.joint).ok()).flatten() {
        joint(xml, &part);
    }
}

fn joint(xml: &mut Xml, part: &Part) {
    let Part { joint, suffix, kind, axis, dofs } = part;
    let of = |list: &[f64]| list.get(dofs.clone()).unwrap_or_default().to_vec();
    xml.empty("joint", |attributes| {
        attributes.text("name", &format!("{}{suffix}", joint.name)).text("type", kind);
        if let Some(axis) = axis {
            attributes.numbers("axis", axis);
        }
        for (name, list) in [("armature", &joint.armature), ("damping", &joint.damping), ("frictionloss", &joint.friction)] {
            if let Some(&value) = of(list).first().filter(|&&value| value != 0.0) {
                attributes.numbers(name, &[value]);
            }
        }
        if let ([lower], [upper]) = (&of(&joint.lower)[..], &of(&joint.upper)[..]) {
            attributes.text("limited", "true").numbers("range", &[*lower, *upper]);
        }
        if let [effort] = of(&joint.effort)[..] {
            attributes.text("actuatorfrclimited", "true").numbers("actuatorfrcrange", &[-effort, effort]);
        }
    });
}

/// MuJoCo moves no body with a mass or a principal moment below this, kg and kg·m².
const LEAST: f64 = 1e-15;

/// Everything that MJCF cannot hold, in the order of the description.
fn losses(robot: &Description, carried: &[Vec<Item>]) -> Vec<Loss> {
    let mut losses = Vec::new();
    let (mut bodies, mut joints) = (Names::default(), Names::default());
    bodies.fresh(ROOT);
    let unphysical: Vec<&str> = robot.bodies.iter().filter_map(unphysical).collect();
    for (i, body) in robot.bodies.iter().enumerate() {
        bodies.take("body", &body.name, &mut losses);
        let subject = || format!("body '{}'", body.name);
        if unphysical.contains(&body.name.as_str()) {
            losses.push(Loss { subject: subject(), reason: Reason::Unphysical });
        }
        if light(body) && row(robot, carried, i).len() == 1 {
            losses.push(Loss { subject: subject(), reason: Reason::Massless });
        }
        match parts(&body.joint) {
            Ok(parts) => parts.iter().for_each(|part| joints.take("joint", &format!("{}{}", part.joint.name, part.suffix), &mut losses)),
            Err(_) => joints.take("joint", &body.joint.name, &mut losses),
        }
        let reasons = joint_losses(body).into_iter();
        losses.extend(reasons.map(|reason| Loss { subject: format!("joint '{}'", body.joint.name), reason }));
    }
    for frame in robot.frames.iter().filter(|frame| !is_world(frame)) {
        bodies.take("frame", &frame.name, &mut losses);
        let reason = rotation_loss(&frame.placement);
        losses.extend(reason.map(|reason| Loss { subject: format!("frame '{}'", frame.name), reason }));
    }
    losses
}
