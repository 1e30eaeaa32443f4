//! Loops in MJCF: `<equality>`, with a pair of sites for each loop that holds frames.
//!
//! | loop | element | exact |
//! |---|---|---|
//! | spherical, or a point along all axes | `connect` of two sites | yes |
//! | fixed | `weld` of two sites | yes, up to the rotation of a quaternion |
//! | mimic | `joint` with `polycoef` | yes: joints are written without `ref` |
//!
//! MuJoCo holds these by forces of finite stiffness; that is no part of a description.

use super::quaternion::quaternion;
use crate::export::xml::Xml;
use crate::export::{Loss, Reason};
use featherbench_model::{Description, Loop, LoopKind, LoopMotion};

/// What is added to a loop's name for the sites at its first and its second end.
const ENDS: [&str; 2] = [" first", " second"];

/// What MJCF calls a loop; none where it has no such constraint.
fn element(tie: &Loop) -> Option<&'static str> {
    match &tie.kind {
        LoopKind::Joint { motion: LoopMotion::Spherical, .. } | LoopKind::Point { axes: [true, true, true], .. } => Some("connect"),
        LoopKind::Joint { motion: LoopMotion::Fixed, .. } => Some("weld"),
        LoopKind::Mimic { .. } => Some("joint"),
        LoopKind::Joint { .. } | LoopKind::Point { .. } | LoopKind::Distance { .. } | LoopKind::Gear { .. } => None,
    }
}

/// Whether MJCF can hold a loop. `is_written` tells whether a body is one of the file.
fn is_held(tie: &Loop, is_written: &impl Fn(usize) -> bool) -> bool {
    let on_written = |ends: &[featherbench_model::LoopEnd; 2]| ends.iter().all(|end| end.body.is_none_or(is_written));
    element(tie).is_some() && tie.ends().is_none_or(on_written)
}

/// The sites on a body, or in the world, of the loops that MJCF can hold.
pub(super) fn sites(xml: &mut Xml, robot: &Description, body: Option<usize>, is_written: &impl Fn(usize) -> bool) {
    for tie in robot.loops.iter().filter(|tie| is_held(tie, is_written)) {
        for (end, suffix) in tie.ends().into_iter().flatten().zip(ENDS).filter(|(end, _)| end.body == body) {
            xml.empty("site", |attributes| {
                attributes.text("name", &format!("{}{suffix}", tie.name));
                attributes.numbers("pos", &end.placement.translation).numbers("quat", &quaternion(&end.placement.rotation).0);
            });
        }
    }
}

/// The section of the file, if there is any loop that it can hold.
pub(super) fn section(xml: &mut Xml, robot: &Description, is_written: &impl Fn(usize) -> bool) {
    let held: Vec<&Loop> = robot.loops.iter().filter(|tie| is_held(tie, is_written)).collect();
    if held.is_empty() {
        return;
    }
    xml.open("equality", |_| {});
    for tie in held {
        let Some(element) = element(tie) else { continue };
        xml.empty(element, |attributes| {
            attributes.text("name", &tie.name);
            if let LoopKind::Mimic { follower, leader, polynomial } = &tie.kind {
                let joint = |body: &usize| &robot.bodies[*body].joint.name;
                attributes.text("joint1", joint(follower)).text("joint2", joint(leader)).numbers("polycoef", polynomial);
            } else {
                let [first, second] = ENDS.map(|suffix| format!("{}{suffix}", tie.name));
                attributes.text("site1", &first).text("site2", &second);
            }
        });
    }
    xml.close();
}

/// The loops that MJCF cannot hold.
pub(super) fn losses<'a>(robot: &'a Description, is_written: &'a impl Fn(usize) -> bool) -> impl Iterator<Item = Loss> + 'a {
    let lost = robot.loops.iter().enumerate().filter(|(_, tie)| !is_held(tie, is_written));
    lost.map(|(index, tie)| Loss { about: format!("loops[{index}] '{}'", tie.name), reason: Reason::Loop { kind: tie.kind.name() } })
}
