//! Writing USD: bodies and joints beside each other on a stage.

use super::stage::{Stage, double, single};
use crate::export::names::Names;
use crate::export::{self, ExportError, Loss, OnLoss, Reason};
use crate::mjcf::estimate;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_spatial::{Mat3, Sym3, Transform, Vec3};
use std::path::Path;

/// Gravity that a scene has if it says none, m/s².
const EARTH: [f64; 3] = [0.0, 0.0, -9.81];
/// Degrees of a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// Writes a USD file as text, completely or not at all, and returns what was left out.
///
/// # Errors
/// [`ExportError`], listing everything that USD cannot hold.
pub fn write(description: &Description, path: impl AsRef<Path>, on_loss: OnLoss) -> Result<Vec<Loss>, ExportError> {
    let (text, losses) = to_string(description, on_loss)?;
    export::write(path.as_ref(), &text)?;
    Ok(losses)
}

/// The robot's canonical form as the text of a USD file (`usda`), and what was left out.
///
/// Frames are not written. Names become identifiers: any other character than a letter, a digit or a low line becomes a low line, and what
/// changed is listed. The provenance is the file's `doc`.
///
/// # Errors
/// [`ExportError`], listing everything that USD cannot hold.
pub fn to_string(description: &Description, on_loss: OnLoss) -> Result<(String, Vec<Loss>), ExportError> {
    let robot = description.canonical()?;
    let losses = export::settle("USD", losses(&robot), on_loss)?;
    let (mut of_bodies, mut of_joints) = (Names::default(), Names::default());
    let bodies: Vec<String> = robot.bodies.iter().map(|body| of_bodies.fresh(&identifier(&body.name))).collect();
    let root = identifier(&robot.name);
    let provenance = robot.provenance.as_ref().map(|provenance| format!("{}; {}", provenance.source, provenance.licence));
    let mut stage = Stage::new(&root, provenance.as_deref());
    scene(&mut stage, robot.gravity);
    stage.open("Xform", &root, &["PhysicsArticulationRootAPI", "NewtonArticulationRootAPI"]);
    let mut places: Vec<Transform<f64>> = Vec::with_capacity(robot.bodies.len());
    for (body, name) in robot.bodies.iter().zip(&bodies) {
        let place = body.joint.placement.to_transform();
        let place = body.parent.map_or(place, |parent| places[parent].compose(&place));
        places.push(place);
        self::body(&mut stage, name, body, &place);
    }
    stage.open("Scope", &of_bodies.fresh("joints"), &[]);
    for (body, name) in robot.bodies.iter().zip(&bodies).filter(|(body, _)| body.joint.kind != JointType::Free) {
        let path = |name: &str| format!("</{root}/{name}>");
        let ends = [body.parent.map(|parent| path(&bodies[parent])), Some(path(name))];
        joint(&mut stage, &of_joints.fresh(&identifier(&body.joint.name)), &body.joint, &ends);
    }
    Ok((stage.finish(), losses))
}

fn scene(stage: &mut Stage, gravity: [f64; 3]) {
    stage.open("PhysicsScene", "scene", &[]);
    if gravity != EARTH {
        let size = gravity.iter().map(|x| x * x).sum::<f64>().sqrt();
        stage.set("float physics:gravityMagnitude", &single(&[size]));
        if size > 0.0 {
            stage.set("vector3f physics:gravityDirection", &single(&gravity.map(|x| x / size)));
        }
    }
    stage.close();
}

fn body(stage: &mut Stage, name: &str, body: &BodyDescription, place: &Transform<f64>) {
    let schemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "NewtonMassAPI"];
    stage.open("Xform", name, if body.mass > 0.0 { &schemas } else { &schemas[..1] });
    stage.set("double3 xformOp:translate", &double(&place.translation.to_array()));
    stage.set("quatd xformOp:orient", &double(&estimate(&place.rotation.to_array())));
    stage.set("uniform token[] xformOpOrder", "[\"xformOp:translate\", \"xformOp:orient\"]");
    if body.mass > 0.0 {
        let [xx, xy, xz, yy, yz, zz] = body.inertia;
        let (moments, axes) = Sym3::from_array(body.inertia).principal();
        stage.set("float physics:mass", &single(&[body.mass]));
        stage.set("point3f physics:centerOfMass", &single(&body.com));
        stage.set("float3 physics:diagonalInertia", &single(&moments));
        stage.set("quatf physics:principalAxes", &single(&estimate(&axes.to_array())));
        stage.set("double[] newton:inertia", &double(&[xx, yy, zz, xy, xz, yz]).replace('(', "[").replace(')', "]"));
    }
    stage.close();
}

fn joint(stage: &mut Stage, name: &str, joint: &JointDescription, ends: &[Option<String>; 2]) {
    let (kind, axis) = match joint.kind {
        JointType::Revolute { axis } => ("PhysicsRevoluteJoint", Some(axis)),
        JointType::Prismatic { axis } => ("PhysicsPrismaticJoint", Some(axis)),
        // The others gave an error before.
        _ => ("PhysicsSphericalJoint", None),
    };
    let (token, turn) = axis.map_or((None, Placement::default().rotation), along);
    let inner = Transform::new(Mat3::from_array(turn), Vec3::zero());
    let outer = joint.placement.to_transform().compose(&inner);
    stage.open(kind, name, &["NewtonJointAPI"]);
    for (k, (end, place)) in ends.iter().zip([outer, inner]).enumerate() {
        if let Some(path) = end {
            stage.set(&format!("rel physics:body{k}"), path);
        }
        stage.set(&format!("point3f physics:localPos{k}"), &single(&place.translation.to_array()));
        stage.set(&format!("quatf physics:localRot{k}"), &single(&estimate(&place.rotation.to_array())));
    }
    if let Some(token) = token {
        stage.set("uniform token physics:axis", &format!("\"{token}\""));
    }
    properties(stage, joint);
    stage.close();
}

/// The coordinate axis that a joint turns about or slides along, and the rotation that takes it to the axis.
fn along(axis: [f64; 3]) -> (Option<char>, [f64; 9]) {
    let identity = Placement::default().rotation;
    match axis {
        [1.0, 0.0, 0.0] => (Some('X'), identity),
        [0.0, 1.0, 0.0] => (Some('Y'), identity),
        [0.0, 0.0, 1.0] => (Some('Z'), identity),
        axis => {
            // Its first column is the axis. The second is that of the coordinate axes which is farthest from it, made perpendicular.
            let first = Vec3::from_array(axis);
            let least = (0..3).min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
            let across = first.cross(Vec3::from_array(std::array::from_fn(|k| f64::from(u8::from(k == least)))));
            let second = across * (1.0 / across.dot(across).sqrt());
            let columns = [first, second, first.cross(second)].map(|column| column.to_array());
            (Some('X'), std::array::from_fn(|k| columns[k % 3][k / 3]))
        }
    }
}

/// Limits, armature, damping and friction of a joint with one degree of freedom, or of a spherical one whose three are equal.
fn properties(stage: &mut Stage, joint: &JointDescription) {
    let turns = !matches!(joint.kind, JointType::Prismatic { .. });
    let angle = if turns { DEGREES } else { 1.0 };
    let given = [
        ("float physics:lowerLimit", &joint.lower, angle),
        ("float physics:upperLimit", &joint.upper, angle),
        ("float newton:armature", &joint.armature, 1.0),
        ("float newton:damping", &joint.damping, 1.0 / angle),
        ("float newton:friction", &joint.friction, 1.0),
        ("float newton:velocityLimit", &joint.velocity, angle),
        ("custom float urdf:limit:effort", &joint.effort, 1.0),
    ];
    for (name, list, factor) in given {
        let limit = name.ends_with("Limit") || name.ends_with("effort");
        if let Some(&value) = list.first().filter(|&&value| limit || value != 0.0) {
            stage.set(name, &single(&[factor * value]));
        }
    }
}

/// A name as USD has them.
fn identifier(name: &str) -> String {
    let low: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if low.starts_with(|c: char| c.is_ascii_digit()) || low.is_empty() { format!("_{low}") } else { low }
}

/// Everything that USD cannot hold, in the order of the description.
fn losses(robot: &Description) -> Vec<Loss> {
    let mut losses = Vec::new();
    let renamed = |what: &str, name: &str, taken: &mut Names| {
        let wish = identifier(name);
        (taken.fresh(&wish) != name).then(|| Loss { about: format!("{what} '{}'", name.escape_debug()), reason: Reason::Identifier })
    };
    losses.extend(renamed("robot", &robot.name, &mut Names::default()).filter(|_| !robot.name.is_empty()));
    let (mut bodies, mut joints) = (Names::default(), Names::default());
    for body in &robot.bodies {
        losses.extend(renamed("body", &body.name, &mut bodies));
        let about = || format!("joint '{}'", body.joint.name);
        if body.joint.kind != JointType::Free {
            losses.extend(renamed("joint", &body.joint.name, &mut joints));
        }
        losses.extend(joint_losses(body).into_iter().map(|reason| Loss { about: about(), reason }));
        if body.mass == 0.0 && body.inertia != [0.0; 6] {
            losses.push(Loss { about: format!("body '{}'", body.name), reason: Reason::InertiaAlone });
        }
        let sum = body.inertia[0] + body.inertia[3] + body.inertia[5];
        if [body.mass, sum].iter().any(|&x| x > 0.0 && !(x as f32).is_normal()) {
            losses.push(Loss { about: format!("body '{}'", body.name), reason: Reason::BeyondSingle });
        }
    }
    losses.extend(robot.frames.iter().map(|frame| Loss { about: format!("frame '{}'", frame.name), reason: Reason::Frame }));
    losses.extend(
        robot.loops.iter().map(|tie| Loss { about: format!("loop '{}'", tie.name), reason: Reason::Loop { kind: tie.kind.name() } }),
    );
    losses.extend(export::deforming(robot));
    losses.extend(export::residuals(robot));
    losses
}

fn joint_losses(body: &BodyDescription) -> Vec<Reason> {
    let joint = &body.joint;
    let missing = |advice| Some(Reason::JointType { kind: joint.kind.name(), advice });
    let mut reasons = Vec::from_iter(match joint.kind {
        JointType::Revolute { .. } | JointType::Prismatic { .. } | JointType::Spherical => None,
        JointType::Free => {
            let below = body.parent.is_some().then_some(Reason::FreeBelow);
            below.or_else(|| (joint.placement != Placement::default()).then_some(Reason::FreePlacement))
        }
        JointType::Helical { .. } => missing("keep the robot in the neutral format"),
        _ => missing("describe it as revolute and prismatic joints in a row, or keep the neutral format or MJCF"),
    });
    if joint.kind.nv() == 1 {
        reasons.extend((joint.lower.is_empty() != joint.upper.is_empty()).then_some(Reason::OneSided));
        return reasons;
    }
    let free = joint.kind == JointType::Free;
    for (field, list) in [("armature", &joint.armature), ("damping", &joint.damping), ("friction", &joint.friction)] {
        reasons.extend((free && list.iter().any(|&x| x != 0.0)).then_some(Reason::SeveralDofs { field }));
        reasons.extend((!free && list.iter().any(|x| *x != list[0])).then_some(Reason::Unequal { field }));
    }
    for (field, list) in [("lower", &joint.lower), ("upper", &joint.upper), ("velocity", &joint.velocity), ("effort", &joint.effort)] {
        reasons.extend((!list.is_empty()).then_some(Reason::SeveralDofs { field }));
    }
    reasons
}
