//! Why two import results differ in a field, if the links of the body do not account for it. Hypotheses predict the field and are tested on
//! its numbers. A parser's own notes are shown beside them, but alone they name no cause.

use super::account::UNITS;
use super::fields::{Precision, distance, from_rpy, inertia_scale, norm, rpy};
use super::{Cause, Field};
use featherbench_bench::ImportNote;
use featherbench_model::BodyDescription;
use featherbench_spatial::{Mat3, Sym3, Vec3};
use std::f64::consts::PI;

/// The cause of a difference in a field that the links do not account for, with the parser's own note if there is one about it.
pub(super) fn cause(
    field: Field,
    ours: &BodyDescription,
    theirs: &BodyDescription,
    notes: &[&ImportNote],
    precision: Precision,
) -> (Cause, Option<String>) {
    let tested = precision.tested();
    let said = |code: &str| notes.iter().find(|note| note.cause == code);
    let sentence = |codes: &[&str]| codes.iter().find_map(|code| said(code)).map(|note| note.text.clone());
    let unread = |list: &[f64]| list.iter().all(|&x| x == 0.0);
    match field {
        // A note is shown beside a number that it does not account for, and names no cause.
        Field::Mass => (Cause::Number, sentence(&["mass_edited", "from_geometry"])),
        Field::Com => (Cause::Number, sentence(&["com_edited", "mass_edited", "from_geometry"])),
        Field::Inertia => (inertia(ours, theirs, tested), sentence(&["inertia_edited", "mass_edited", "from_geometry"])),
        Field::Axis => match (ours.joint.kind.axis(), theirs.joint.kind.axis()) {
            (Some(x), Some(y)) if distance(x, y.map(|y| -y)) <= tested => (Cause::Flipped, None),
            _ => (Cause::Number, None),
        },
        Field::Placement => (placement(ours, theirs, tested), None),
        Field::JointType if said("mimic").is_some() => (Cause::Mimic, sentence(&["mimic"])),
        Field::Armature if rotor(ours, theirs, notes, tested) => (Cause::RotorInertia, sentence(&["rotor_inertia"])),
        Field::Armature if unread(&theirs.joint.armature) => (Cause::Unsupported, None),
        Field::Damping if unread(&theirs.joint.damping) => (Cause::Unsupported, None),
        Field::Friction if unread(&theirs.joint.friction) => (Cause::Unsupported, None),
        Field::Armature if scaled(&ours.joint.armature, &theirs.joint.armature, tested) => (Cause::Unit, None),
        _ => (Cause::Number, None),
    }
}

/// Whether theirs is ours and the inertia of a rotor times the gear ratio squared, by the numbers that the parser tells of it.
fn rotor(ours: &BodyDescription, theirs: &BodyDescription, notes: &[&ImportNote], tested: f64) -> bool {
    notes.iter().filter(|note| note.cause == "rotor_inertia").any(|note| {
        match (note.numbers.as_slice(), theirs.joint.armature.as_slice()) {
            (&[inertia, gear], &[held]) => {
                let due = ours.joint.armature.first().copied().unwrap_or(0.0) + inertia * gear * gear;
                (held - due).abs() <= tested * due.abs()
            }
            _ => false,
        }
    })
}

/// The cause for an inertia whose links are not known one by one: the same principal moments in other axes, or three equal ones.
fn inertia(ours: &BodyDescription, theirs: &BodyDescription, tested: f64) -> Cause {
    let scale = inertia_scale(ours).max(inertia_scale(theirs));
    let [a, b] = [ours.inertia, theirs.inertia].map(Sym3::from_array);
    let [xx, _, _, yy, _, zz] = ours.inertia;
    let mean = (xx + yy + zz) / 3.0;
    let balanced = [mean, 0.0, 0.0, mean, 0.0, mean];
    if same_moments(a, b, scale, tested) {
        return match (diagonal(a, scale, tested), diagonal(b, scale, tested)) {
            (false, true) => Cause::InertialRotationLost,
            (true, false) => Cause::InertialRotationApplied,
            _ => Cause::InertiaTurned,
        };
    }
    if theirs.inertia.iter().zip(balanced).all(|(x, y)| (x - y).abs() <= tested * scale) { Cause::Balanced } else { Cause::Number }
}

fn placement(ours: &BodyDescription, theirs: &BodyDescription, tested: f64) -> Cause {
    let (a, b) = (&ours.joint.placement, &theirs.joint.placement);
    let same_rotation = close(&a.rotation, &b.rotation, tested);
    if same_rotation {
        return if scaled(&a.translation, &b.translation, tested) { Cause::Unit } else { Cause::Number };
    }
    let far = norm(a.translation).max(norm(b.translation));
    if distance(a.translation, b.translation) > tested * far {
        return Cause::Number;
    }
    if close(&Mat3::from_array(a.rotation).transpose().to_array(), &b.rotation, tested) {
        return Cause::Transposed;
    }
    let [x, y] = [rpy(a.rotation), rpy(b.rotation)];
    // The smaller angles are those of the file, once taken in the wrong unit.
    let degrees = |small: [f64; 3], large: &[f64; 9]| close(&from_rpy(small.map(f64::to_degrees)), large, tested);
    if degrees(x, &b.rotation) || degrees(y, &a.rotation) {
        return Cause::Degrees;
    }
    if in_default_sequence(a.rotation).any(|read| close(&read, &b.rotation, tested)) { Cause::EulerSequence } else { Cause::Number }
}

/// The rotations that a parser makes of an MJCF's `euler`, if the file's `eulerseq` gave this rotation and the parser takes `xyz`. There is
/// one for each of the six orders of three axes, about moving axes and about fixed ones.
fn in_default_sequence(rotation: [f64; 9]) -> impl Iterator<Item = [f64; 9]> {
    let entry = move |i: usize, j: usize| rotation[3 * i + j];
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    orders.into_iter().flat_map(move |[i, j, k]: [usize; 3]| {
        // R = Rᵢ(a) Rⱼ(b) Rₖ(c); the sign is that of the permutation.
        let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
        let (a, c) = ((-sign * entry(j, k)).atan2(entry(k, k)), (-sign * entry(i, j)).atan2(entry(i, i)));
        let b = (sign * entry(i, k)).atan2(entry(i, i).hypot(entry(i, j)));
        // The same rotation by the other triple of angles.
        let twice = [[a, b, c], [a + PI, PI - b, c + PI]];
        twice.into_iter().flat_map(|[a, b, c]| [[a, b, c], [c, b, a]]).map(from_xyz)
    })
}

/// Rx(a) Ry(b) Rz(c).
fn from_xyz([a, b, c]: [f64; 3]) -> [f64; 9] {
    Mat3::from_array(from_rpy([-a, -b, -c])).transpose().to_array()
}

/// Whether two rotations are the same; an angle of many turns has lost digits in proportion.
fn close(a: &[f64; 9], b: &[f64; 9], tested: f64) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 64.0 * tested)
}

/// Whether one list is the other times the factor of a unit.
fn scaled(ours: &[f64], theirs: &[f64], tested: f64) -> bool {
    let size = |list: &[f64]| list.iter().map(|x| x.abs()).fold(0.0, featherbench_bench::measure::worst);
    let by = |unit: f64| ours.iter().zip(theirs).all(|(x, y)| (x * unit - y).abs() <= tested * size(theirs));
    size(ours) > 0.0 && size(theirs) > 0.0 && ours.len() == theirs.len() && UNITS.into_iter().any(by)
}

fn diagonal(inertia: Sym3<f64>, scale: f64, tested: f64) -> bool {
    [inertia.xy, inertia.xz, inertia.yz].into_iter().all(|product| product.abs() <= tested * scale)
}

/// Whether two inertias have the same principal moments: the same coefficients of the characteristic polynomial.
fn same_moments(a: Sym3<f64>, b: Sym3<f64>, scale: f64, tested: f64) -> bool {
    let coefficients = |m: Sym3<f64>| {
        let [xx, xy, xz, yy, yz, zz] = m.to_array().map(|x| x / scale);
        let minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
        let (x, y, z) = (Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz));
        [xx + yy + zz, minors, x.dot(y.cross(z))]
    };
    scale > 0.0 && coefficients(a).iter().zip(coefficients(b)).all(|(x, y)| (x - y).abs() <= tested)
}
