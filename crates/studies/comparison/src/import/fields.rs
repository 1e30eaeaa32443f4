//! The distance of two import results of one body, field by field, and the text of each field.

use super::Field;
use featherbench_bench::measure::worst;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType};
use featherbench_spatial::{Mat3, Vec3};

/// The largest distance that rounding may cause between two right import results of one link: 16 ε. Parsers turn Euler angles into
/// quaternions and those into matrices, and diagonalise inertias; each rounds about ten times. An edit by a parser is larger by many
/// decades.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// The unit of rounding in single precision over that in double.
const SINGLE: f64 = (f32::EPSILON as f64) / f64::EPSILON;

/// What the numbers of an engine are rounded to.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Precision {
    /// Numbers of 64 bits.
    #[default]
    Double,
    /// Numbers of 32 bits.
    Single,
}

impl Precision {
    /// That of a row: `f32`, or another.
    pub fn of(scalar: &str) -> Self {
        if scalar == "f32" { Self::Single } else { Self::Double }
    }

    /// How much larger rounding is than in double.
    pub(super) fn factor(self) -> f64 {
        match self {
            Self::Double => 1.0,
            Self::Single => SINGLE,
        }
    }

    /// The largest distance that rounding may cause: [`ROUNDING`], or that in single precision.
    pub(super) fn rounding(self) -> f64 {
        ROUNDING * self.factor()
    }

    /// Rounding of a prediction. Its numbers come from a few more operations than an import result.
    pub(super) fn tested(self) -> f64 {
        4.0 * self.rounding()
    }
}

/// The fields of a body, in the order of reports.
pub(super) const OF_A_BODY: [Field; 11] = [
    Field::JointType,
    Field::Axis,
    Field::Pitch,
    Field::Placement,
    Field::Mass,
    Field::Com,
    Field::Inertia,
    Field::Armature,
    Field::Damping,
    Field::Friction,
    Field::Limits,
];

/// The rounding of a body: each link that is fixed to it is rotated, shifted, added and diagonalised once more.
pub(super) fn rounding(description: &Description, body: usize, precision: Precision) -> f64 {
    let fixed = description.frames.iter().filter(|frame| frame.body == Some(body)).count();
    (1 + fixed) as f64 * precision.rounding()
}

/// Whether a size is more than rounding. A NaN differs.
pub(super) fn differs(size: f64, rounding: f64) -> bool {
    size.is_nan() || size > rounding
}

/// The robot's length scale: the longest path from the world along placements and to a centre of mass, m.
pub(super) fn reach(description: &Description) -> f64 {
    let mut along: Vec<f64> = Vec::with_capacity(description.bodies.len());
    let mut longest = 0.0_f64;
    for body in &description.bodies {
        let path = body.parent.map_or(0.0, |parent: usize| along[parent]) + norm(body.joint.placement.translation);
        longest = worst(longest, path + norm(body.com));
        along.push(path);
    }
    longest
}

/// The distance of two import results of a body in a field, free of units: at most about two.
pub(super) fn size(field: Field, ours: &BodyDescription, theirs: &BodyDescription, reach: f64) -> f64 {
    let (a, b) = (&ours.joint, &theirs.joint);
    let same_kind = a.kind.name() == b.kind.name();
    match field {
        Field::JointType => f64::from(u8::from(!same_kind)),
        Field::Axis => match (a.kind.axis(), b.kind.axis()) {
            (Some(x), Some(y)) if same_kind => distance(x, y),
            _ => 0.0,
        },
        Field::Pitch => match (a.kind, b.kind) {
            (JointType::Helical { pitch: x, .. }, JointType::Helical { pitch: y, .. }) => relative(&[x], &[y]),
            _ => 0.0,
        },
        Field::Placement => {
            let turned = largest(a.placement.rotation.iter().zip(&b.placement.rotation).map(|(x, y)| x - y));
            let far = norm(a.placement.translation).max(norm(b.placement.translation)).max(reach);
            worst(turned, over(distance(a.placement.translation, b.placement.translation), far))
        }
        Field::Mass => relative(&[ours.mass], &[theirs.mass]),
        // A body without mass has no centre of mass.
        Field::Com if ours.mass == 0.0 || theirs.mass == 0.0 => 0.0,
        Field::Com => over(distance(ours.com, theirs.com), norm(ours.com).max(norm(theirs.com)).max(reach)),
        Field::Inertia => {
            let difference = largest(ours.inertia.iter().zip(&theirs.inertia).map(|(x, y)| x - y));
            over(difference, inertia_scale(ours).max(inertia_scale(theirs)))
        }
        Field::Armature => {
            if same_kind {
                per_dof(&a.armature, &b.armature)
            } else {
                0.0
            }
        }
        Field::Damping => {
            if same_kind {
                per_dof(&a.damping, &b.damping)
            } else {
                0.0
            }
        }
        Field::Friction => {
            if same_kind {
                per_dof(&a.friction, &b.friction)
            } else {
                0.0
            }
        }
        Field::Limits => {
            if same_kind {
                worst(limits(&a.lower, &b.lower), limits(&a.upper, &b.upper))
            } else {
                0.0
            }
        }
        Field::Body | Field::Parent | Field::Gravity | Field::DofOrder | Field::Mimic => 0.0,
    }
}

/// Trace of the inertia about the body's origin, where engines store it.
pub(super) fn inertia_scale(body: &BodyDescription) -> f64 {
    let [xx, _, _, yy, _, zz] = body.inertia;
    xx.abs() + yy.abs() + zz.abs() + 2.0 * body.mass * norm(body.com).powi(2)
}

/// Copies one field from a body to another.
pub(super) fn copy(field: Field, from: &BodyDescription, to: &mut BodyDescription) {
    let joint = &from.joint;
    match field {
        Field::JointType | Field::Axis | Field::Pitch => to.joint.kind = joint.kind,
        Field::Placement => to.joint.placement = joint.placement,
        Field::Mass => to.mass = from.mass,
        Field::Com => to.com = from.com,
        Field::Inertia => to.inertia = from.inertia,
        Field::Armature => to.joint.armature.clone_from(&joint.armature),
        Field::Damping => to.joint.damping.clone_from(&joint.damping),
        Field::Friction => to.joint.friction.clone_from(&joint.friction),
        Field::Limits => {
            to.joint.lower.clone_from(&joint.lower);
            to.joint.upper.clone_from(&joint.upper);
        }
        Field::Body | Field::Parent | Field::Gravity | Field::DofOrder | Field::Mimic => {}
    }
}

/// A field of a body in words, with enough digits to show a difference of this size.
pub(super) fn written(field: Field, body: &BodyDescription, size: f64) -> String {
    let joint = &body.joint;
    let list = |numbers: &[f64]| match numbers {
        [] => "none".to_owned(),
        [one] => digits(*one, size),
        many => format!("({})", many.iter().map(|&x| digits(x, size)).collect::<Vec<_>>().join(", ")),
    };
    match field {
        Field::JointType => joint.kind.name().to_owned(),
        Field::Axis => joint.kind.axis().map_or_else(|| "none".into(), |axis| list(&axis)),
        Field::Pitch => match joint.kind {
            JointType::Helical { pitch, .. } => format!("{} m/rad", list(&[pitch])),
            _ => "none".into(),
        },
        Field::Placement => {
            let rpy = rpy(joint.placement.rotation);
            let turned = if rpy == [0.0; 3] { String::new() } else { format!(", rpy {} rad", list(&rpy)) };
            format!("{} m{turned}", list(&joint.placement.translation))
        }
        Field::Mass => format!("{} kg", list(&[body.mass])),
        Field::Com => format!("{} m", list(&body.com)),
        Field::Inertia => format!("{} kg·m²", list(&body.inertia)),
        Field::Armature => list(&joint.armature),
        Field::Damping => list(&joint.damping),
        Field::Friction => list(&joint.friction),
        Field::Limits => limits_written(joint, size),
        Field::Body | Field::Parent | Field::Gravity | Field::DofOrder | Field::Mimic => String::new(),
    }
}

/// A number with enough digits to show a relative difference of this size, at least four.
pub(super) fn digits(x: f64, size: f64) -> String {
    let needed = if size > 0.0 { (3.0 - size.log10()).ceil().clamp(4.0, 17.0) as usize } else { 4 };
    let rounded: f64 = format!("{x:.*e}", needed - 1).parse().unwrap_or(x);
    // A zero has no minus sign.
    format!("{:?}", rounded + 0.0).trim_end_matches(".0").to_owned()
}

/// Roll, pitch and yaw of a rotation matrix, R = Rz(yaw)·Ry(pitch)·Rx(roll).
pub(super) fn rpy(rotation: [f64; 9]) -> [f64; 3] {
    let r = rotation;
    let across = r[0].hypot(r[3]);
    if across > ROUNDING {
        [r[7].atan2(r[8]), (-r[6]).atan2(across), r[3].atan2(r[0])]
    } else {
        [(-r[5]).atan2(r[4]), (-r[6]).atan2(across), 0.0]
    }
}

/// The rotation matrix of roll, pitch and yaw.
pub(super) fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> [f64; 9] {
    let about =
        |axis: [f64; 3], angle: f64| featherbench_spatial::Transform::axis_rotation(Vec3::from_array(axis), angle.sin(), angle.cos());
    let turned: Mat3<f64> = about([0.0, 0.0, 1.0], yaw) * about([0.0, 1.0, 0.0], pitch) * about([1.0, 0.0, 0.0], roll);
    turned.to_array()
}

pub(super) fn norm(v: [f64; 3]) -> f64 {
    Vec3::from_array(v).norm()
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(std::array::from_fn(|k| a[k] - b[k]))
}

fn largest(differences: impl Iterator<Item = f64>) -> f64 {
    differences.map(f64::abs).fold(0.0, worst)
}

/// A difference over its scale; zero over zero is zero.
fn over(difference: f64, scale: f64) -> f64 {
    featherbench_bench::measure::ratio(difference, scale)
}

/// The largest difference over the larger of the two numbers.
pub(super) fn relative(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| over(x - y, x.abs().max(y.abs()))).fold(0.0, worst)
}

/// The same per degree of freedom; a missing list means zeros.
fn per_dof(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().max(b.len());
    let whole = |list: &[f64]| -> Vec<f64> { (0..count).map(|k| list.get(k).copied().unwrap_or(0.0)).collect() };
    relative(&whole(a), &whole(b))
}

/// One end of a range, if it is a limit: more than a million radians or metres is none.
fn limited(list: &[f64], k: usize) -> Option<f64> {
    list.get(k).copied().filter(|x| x.abs() < 1e6)
}

/// The ranges of a joint with their unit.
fn limits_written(joint: &JointDescription, size: f64) -> String {
    let end = |list: &[f64], k: usize| limited(list, k).map_or("no limit".to_owned(), |x| digits(x, size));
    let range = |k: usize| format!("{} to {}", end(&joint.lower, k), end(&joint.upper, k));
    let unit = match joint.kind {
        JointType::Prismatic { .. } => "m",
        JointType::Revolute { .. } | JointType::Helical { .. } => "rad",
        _ => "(rad and m)",
    };
    let ranges: Vec<String> = (0..joint.lower.len().max(joint.upper.len())).map(range).collect();
    if ranges.is_empty() { "no limits".to_owned() } else { format!("{} {unit}", ranges.join(", ")) }
}

/// The same for limits.
fn limits(a: &[f64], b: &[f64]) -> f64 {
    let one = |k: usize| match (limited(a, k), limited(b, k)) {
        (None, None) => 0.0,
        (Some(x), Some(y)) => relative(&[x], &[y]),
        _ => 1.0,
    };
    (0..a.len().max(b.len())).map(one).fold(0.0, worst)
}
