//! Writing MJCF: nested bodies with their joints.

use super::equality;
use super::joints::{Part, is_part_of_child, parts};
use super::quaternion::quaternion;
use crate::export::names::{self, Names, ROOT};
use crate::export::order::{Item, carried};
use crate::export::xml::{Attributes, Xml};
use crate::export::{self, ExportError, Loss, OnLoss, Reason};
use featherbench_model::{BodyDescription, Description, Frame, JointType, Placement, Warning};
use featherbench_spatial::Sym3;
use std::collections::HashSet;
use std::path::Path;

/// Writes an MJCF file, completely or not at all, and returns what was left out.
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
/// A joint that MuJoCo does not have becomes several joints in one body, named after it. If such joints were imported as massless bodies,
/// these become joints of one body again. Frames are bodies without joints. Loops are equality constraints. MuJoCo's compiler is told to edit nothing.
/// Scalars and vectors are imported to the bit, rotations and inertias within 8ε, and a second round trip changes nothing.
/// The provenance is a comment of the file.
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
    // A body that is written as a joint of another has no place for a site.
    let is_written = |body: usize| row(&robot, &carried, body).len() == 1;
    equality::sites(&mut xml, &robot, None, &is_written);
    // Each item with its depth.
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
                equality::sites(&mut xml, &robot, Some(last), &is_written);
                stack.extend(carried[last + 1].iter().rev().map(|&item| (depth + 1, item)));
            }
        }
    }
    while xml.depth() >= world {
        xml.close();
    }
    equality::section(&mut xml, &robot, &is_written);
    Ok((xml.finish(), losses))
}

/// A body, followed by the bodies that are written as one with it: each is no more than a joint of the next.
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
    // One number for a hinge or slide; a ball or free joint has equal ones, or no place for limits.
    let of = |list: &[f64]| list.get(dofs.start).copied();
    xml.empty("joint", |attributes| {
        attributes.text("name", &format!("{}{suffix}", joint.name)).text("type", kind);
        if let Some(axis) = axis {
            attributes.numbers("axis", axis);
        }
        for (name, list) in [("armature", &joint.armature), ("damping", &joint.damping), ("frictionloss", &joint.friction)] {
            if let Some(value) = of(list).filter(|&value| value != 0.0) {
                attributes.numbers(name, &[value]);
            }
        }
        if dofs.len() > 1 {
            return;
        }
        if let Some((lower, upper)) = of(&joint.lower).zip(of(&joint.upper)).filter(|(lower, upper)| lower < upper) {
            attributes.text("limited", "true").numbers("range", &[lower, upper]);
        }
        if let Some(effort) = of(&joint.effort).filter(|&effort| effort > 0.0) {
            attributes.text("actuatorfrclimited", "true").numbers("actuatorfrcrange", &[-effort, effort]);
        }
    });
}

/// MuJoCo needs at least this mass (kg) and principal moment (kg·m²) of a moving body.
const LEAST: f64 = 1e-15;

/// Everything that MJCF cannot hold, in the order of the description.
fn losses(robot: &Description, carried: &[Vec<Item>]) -> Vec<Loss> {
    let mut losses = Vec::from_iter(names::of_robot(&robot.name));
    let (mut bodies, mut joints) = (Names::default(), Names::default());
    bodies.fresh(ROOT);
    let unphysical: HashSet<String> = robot
        .warnings()
        .into_iter()
        .filter_map(|warning| if let Warning::Unphysical { body, .. } = warning { Some(body) } else { None })
        .collect();
    for (i, body) in robot.bodies.iter().enumerate() {
        bodies.take("body", &body.name, &mut losses);
        let about = || format!("body '{}'", body.name);
        if unphysical.contains(&body.name) {
            losses.push(Loss { about: about(), reason: Reason::Unphysical });
        }
        if light(body) && row(robot, carried, i).len() == 1 {
            losses.push(Loss { about: about(), reason: Reason::Massless });
        }
        match parts(&body.joint) {
            Ok(parts) => parts.iter().for_each(|part| joints.take("joint", &format!("{}{}", part.joint.name, part.suffix), &mut losses)),
            Err(_) => joints.take("joint", &body.joint.name, &mut losses),
        }
        let reasons = joint_losses(body).into_iter();
        losses.extend(reasons.map(|reason| Loss { about: format!("joint '{}'", body.joint.name), reason }));
    }
    for frame in robot.frames.iter().filter(|frame| !is_world(frame)) {
        bodies.take("frame", &frame.name, &mut losses);
    }
    let mut ties = Names::default();
    robot.loops.iter().for_each(|tie| ties.take("loop", &tie.name, &mut losses));
    losses.extend(export::deforming(robot));
    losses.extend(equality::losses(robot, &|body| row(robot, carried, body).len() == 1));
    losses.extend(export::residuals(robot));
    losses
}

/// Whether a body has less mass or a smaller principal moment than MuJoCo needs.
fn light(body: &BodyDescription) -> bool {
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let pivots = Sym3::from_array([xx - LEAST, xy, xz, yy - LEAST, yz, zz - LEAST]).factor().pivots.to_array();
    body.mass < LEAST || !pivots.iter().all(|&pivot| pivot > 0.0)
}

fn joint_losses(body: &BodyDescription) -> Vec<Reason> {
    let joint = &body.joint;
    let mut reasons = Vec::new();
    if joint.kind == JointType::Free {
        reasons.extend(body.parent.is_some().then_some(Reason::FreeBelow));
        reasons.extend((joint.placement != Placement::default()).then_some(Reason::FreePlacement));
    }
    reasons.extend(parts(joint).err());
    reasons.extend((!joint.velocity.is_empty()).then_some(Reason::Property { field: "velocity" }));
    reasons.extend((joint.lower.is_empty() != joint.upper.is_empty()).then_some(Reason::OneSided));
    let is_one = |part: &Part| part.dofs.len() == 1;
    if parts(joint).is_ok_and(|parts| parts.iter().all(is_one)) {
        let empty_range = |(lower, upper): (&f64, &f64)| lower >= upper;
        reasons.extend(joint.lower.iter().zip(&joint.upper).any(empty_range).then_some(Reason::EmptyRange { field: "position limits" }));
        reasons.extend(joint.effort.contains(&0.0).then_some(Reason::EmptyRange { field: "effort" }));
        return reasons;
    }
    for (field, list) in [("armature", &joint.armature), ("damping", &joint.damping), ("friction", &joint.friction)] {
        reasons.extend(list.iter().any(|x| *x != list[0]).then_some(Reason::Unequal { field }));
    }
    for (field, list) in [("lower", &joint.lower), ("upper", &joint.upper), ("effort", &joint.effort)] {
        reasons.extend((!list.is_empty()).then_some(Reason::SeveralDofs { field }));
    }
    reasons
}
