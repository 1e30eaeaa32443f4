//! Causes that need more than one number: an edit of a neighbouring body, of its chain, or of the whole robot.

use super::comparison::SingleDifference;
use super::fields::{self, Precision};
use super::{Cause, Difference, Field};
use featherbench_model::{BodyDescription, Description, JointType, Placement};
use featherbench_spatial::{Sym3, Transform, Vec3};

/// Names causes for the remaining differences; `written` is their robot in our frames, `theirs` in its own, with the partners of our
/// bodies.
pub(super) fn explain(
    ours: &Description,
    theirs: (&Description, &[Option<usize>]),
    written: &[Option<BodyDescription>],
    findings: &mut [SingleDifference],
    reach: f64,
    precision: Precision,
) {
    let tested = precision.tested();
    planar_axis(ours, theirs, findings, reach, tested);
    if one_factor(ours, written, tested) {
        let whole = |difference: &&mut Difference| matches!(difference.field, Field::Mass | Field::Inertia);
        unexplained(findings).filter(whole).for_each(|difference| difference.cause = Cause::TotalMass);
    }
    between_joints(ours, written, findings, reach, tested);
    other_root(ours, written, findings, reach, tested);
}

/// Differences without a cause yet.
fn unexplained(findings: &mut [SingleDifference]) -> impl Iterator<Item = &mut Difference> {
    findings.iter_mut().map(|finding| &mut finding.difference).filter(|difference| difference.cause == Cause::Number)
}

/// A planar joint whose plane is z, whatever axis the file gives: the link has the joint's own frame. `chained` writes the joint as two
/// slides and a rotation, and our parser leaves a frame where the link is in the plane.
fn planar_axis(
    ours: &Description,
    (theirs, partner): (&Description, &[Option<usize>]),
    findings: &mut [SingleDifference],
    reach: f64,
    tested: f64,
) {
    for end in 2..ours.bodies.len() {
        let body = &ours.bodies[end];
        let first = end - 2;
        let of_plane = ours.bodies[first].name == format!("{}/0", body.name);
        let Some(frame) = ours.frames.iter().find(|frame| of_plane && frame.body == Some(end) && frame.placement.translation == [0.0; 3])
        else {
            continue;
        };
        let (link, back) = (frame.placement.to_transform(), frame.placement.to_transform().inverse());
        let placed = |i: usize, placement: Transform<f64>| {
            let mut body = ours.bodies[i].clone();
            body.joint.placement = Placement::from_transform(&placement);
            body
        };
        let mut due =
            vec![(first, placed(first, ours.bodies[first].joint.placement.to_transform().compose(&link)), vec![Field::Placement])];
        let mut turned = body.clone();
        turned.com = back.point(Vec3::from_array(body.com)).to_array();
        turned.inertia = Sym3::from_array(body.inertia).rotate(back.rotation).to_array();
        due.push((end, turned, vec![Field::Com, Field::Inertia]));
        for child in (end + 1..ours.bodies.len()).filter(|&child| ours.bodies[child].parent == Some(end)) {
            due.push((child, placed(child, back.compose(&ours.bodies[child].joint.placement.to_transform())), vec![Field::Placement]));
        }
        let same = |(i, due, fields): &(usize, BodyDescription, Vec<Field>)| {
            let held = partner[*i].map(|j| &theirs.bodies[j]);
            held.is_some_and(|held| fields.iter().all(|&field| fields::size(field, due, held, reach) <= tested))
        };
        if due.iter().all(same) {
            let names: Vec<&str> = (first..=end).chain(due.iter().map(|(i, ..)| *i)).map(|i| ours.bodies[i].name.as_str()).collect();
            let moved = |difference: &&mut Difference| {
                names.contains(&difference.body.as_str())
                    && matches!(difference.field, Field::Axis | Field::Placement | Field::Com | Field::Inertia)
            };
            findings.iter_mut().map(|finding| &mut finding.difference).filter(moved).for_each(|difference| {
                difference.cause = Cause::PlanarAxis;
                difference.account = None;
            });
        }
    }
}

/// Whether all masses of the robot are ours times one factor other than one.
fn one_factor(ours: &Description, written: &[Option<BodyDescription>], tested: f64) -> bool {
    let pairs =
        || ours.bodies.iter().zip(written).filter_map(|(body, theirs)| Some((body, theirs.as_ref()?))).filter(|(body, _)| body.mass > 0.0);
    let Some(factor) = pairs().map(|(body, theirs)| theirs.mass / body.mass).next() else { return false };
    let same = |a: f64, b: f64, size: f64| (a - b).abs() <= tested * size;
    let scaled = |(body, theirs): (&BodyDescription, &BodyDescription)| same(theirs.mass, factor * body.mass, theirs.mass);
    pairs().count() > 1 && (factor - 1.0).abs() > tested && factor > 0.0 && pairs().all(scaled)
}

/// A floating base whose coordinates are those of another link: one that is fixed to our root, if the parser drops an empty root.
fn other_root(ours: &Description, written: &[Option<BodyDescription>], findings: &mut [SingleDifference], reach: f64, tested: f64) {
    for (root, theirs) in written.iter().enumerate() {
        let Some(theirs) = theirs.as_ref().filter(|theirs| theirs.joint.kind == JointType::Free) else { continue };
        let Some(frame) = ours.frames.iter().find(|frame| frame.body == Some(root) && frame.name == theirs.name) else { continue };
        let from_root = frame.placement.to_transform();
        for (child, body) in ours.bodies.iter().enumerate().filter(|(_, body)| body.parent == Some(root)) {
            let Some(theirs) = &written[child] else { continue };
            let behind = Placement::from_transform(&from_root.compose(&theirs.joint.placement.to_transform()));
            let moved =
                BodyDescription { joint: featherbench_model::JointDescription { placement: behind, ..body.joint.clone() }, ..body.clone() };
            let same = fields::size(Field::Placement, body, &moved, reach) <= tested;
            let of_child = |difference: &&mut Difference| difference.field == Field::Placement && difference.body == body.name;
            unexplained(findings)
                .filter(|difference| same && of_child(difference))
                .for_each(|difference| difference.cause = Cause::OtherRoot);
        }
    }
}

/// The joints of one link are a chain of massless bodies before it. If the whole chain leads to the same place and its parts do not, the
/// link's pose was put at another joint of the chain.
fn between_joints(ours: &Description, written: &[Option<BodyDescription>], findings: &mut [SingleDifference], reach: f64, tested: f64) {
    for end in 0..ours.bodies.len() {
        let mut chain = vec![end];
        while let Some(parent) = ours.bodies[chain[chain.len() - 1]].parent.filter(|&parent| ours.bodies[parent].mass == 0.0) {
            chain.push(parent);
        }
        let theirs: Option<Vec<&BodyDescription>> = chain.iter().map(|&i| written[i].as_ref()).collect();
        let Some(theirs) = theirs.filter(|theirs| theirs.len() > 1) else { continue };
        let through = |bodies: &mut dyn Iterator<Item = &BodyDescription>| {
            bodies.fold(Transform::identity(), |behind, body: &BodyDescription| body.joint.placement.to_transform().compose(&behind))
        };
        let (a, b) = (through(&mut chain.iter().map(|&i| &ours.bodies[i])), through(&mut theirs.into_iter()));
        let turned = a.rotation.to_array().iter().zip(b.rotation.to_array()).any(|(x, y)| (x - y).abs() > tested);
        if turned || fields::norm((a.translation - b.translation).to_array()) > tested * reach {
            continue;
        }
        let of_chain = |difference: &&mut Difference| {
            difference.field == Field::Placement && chain.iter().any(|&i| ours.bodies[i].name == difference.body)
        };
        unexplained(findings).filter(of_chain).for_each(|difference| difference.cause = Cause::BetweenJoints);
    }
}
