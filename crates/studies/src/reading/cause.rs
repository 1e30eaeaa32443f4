//! Why two readings of a field differ: hypotheses that are tested on the numbers. What a parser says about itself is evidence where the
//! numbers allow it, and never a cause alone.

use super::fields::{ROUNDING, distance, from_rpy, inertia_scale, norm, rpy};
use super::{Cause, Field};
use harness::ReadingNote;
use model::{BodyDescription, Description, Warning};
use spatial::{Sym3, Vec3};

/// Factors that a wrong unit leaves: lengths or masses by a thousand, areas by its square.
const UNITS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];
/// Rounding of a hypothesis: the numbers compared went through a few more operations than two readings, each with its factor.
const TESTED: f64 = 4.0 * ROUNDING;

/// The cause of a difference in a field, with the parser's own sentence where it has one about it.
pub(super) fn cause(field: Field, ours: &BodyDescription, theirs: &BodyDescription, notes: &[&ReadingNote]) -> (Cause, Option<String>) {
    let said = |code: &str| notes.iter().find(|note| note.cause == code);
    let sentence = |codes: &[&str]| codes.iter().find_map(|code| said(code)).map(|note| note.text.clone());
    let warned = notes.iter().find(|note| note.cause == "warning" && note.text.contains("inertia")).map(|note| note.text.clone());
    let unread = |list: &[f64]| list.iter().all(|&x| x == 0.0);
    match field {
        Field::Mass => match mass(ours.mass, theirs.mass, &said) {
            Cause::Number if said("mass_edited").is_some() => (Cause::Edited, sentence(&["mass_edited"])),
            cause => (cause, sentence(&["mass_edited", "bounds", "from_geometry"])),
        },
        Field::Com if ours.mass == 0.0 => (Cause::ZeroMass, sentence(&["mass_edited"])),
        Field::Com if said("from_geometry").is_some() => (Cause::Geometry, sentence(&["from_geometry"])),
        Field::Com => (if scaled(&ours.com, &theirs.com) { Cause::Unit } else { Cause::Number }, None),
        Field::Inertia => match inertia(ours, theirs) {
            Cause::Number if ours.mass == 0.0 && theirs.mass > 0.0 => (Cause::ZeroMass, sentence(&["inertia_edited", "mass_edited"])),
            Cause::Number if said("from_geometry").is_some() => (Cause::Geometry, sentence(&["from_geometry"])),
            Cause::Number if said("bounds").is_some() && trace(theirs) > trace(ours) => (Cause::Bounds, sentence(&["bounds"])),
            Cause::Number if said("inertia_edited").is_some() => (Cause::Edited, sentence(&["inertia_edited"])),
            Cause::Number if !physical(ours) && physical(theirs) => (Cause::Unphysical, None),
            // A link that is fixed to this one may be what it is about: its own inertia is not seen in the sum.
            Cause::Number if warned.is_some() => (Cause::Edited, warned),
            cause => (cause, sentence(&["balanceinertia", "inertia_edited"])),
        },
        Field::Axis => match (ours.joint.kind.axis(), theirs.joint.kind.axis()) {
            (Some(x), Some(y)) if distance(x, y.map(|y| -y)) <= TESTED => (Cause::Flipped, None),
            _ => (Cause::Number, None),
        },
        Field::Placement => (placement(ours, theirs), None),
        Field::JointType if said("mimic").is_some() => (Cause::Mimic, sentence(&["mimic"])),
        Field::Armature if unread(&theirs.joint.armature) => (Cause::Unsupported, None),
        Field::Damping if unread(&theirs.joint.damping) => (Cause::Unsupported, None),
        Field::Friction if unread(&theirs.joint.friction) => (Cause::Unsupported, None),
        Field::Armature if scaled(&ours.joint.armature, &theirs.joint.armature) => (Cause::Unit, None),
        _ => (Cause::Number, None),
    }
}

fn mass<'a>(ours: f64, theirs: f64, said: &impl Fn(&str) -> Option<&'a &'a ReadingNote>) -> Cause {
    if said("bounds").is_some_and(|note| raised(theirs - ours, &note.text)) {
        Cause::Bounds
    } else if said("from_geometry").is_some() && theirs > 0.0 {
        Cause::Geometry
    } else if ours == 0.0 {
        Cause::ZeroMass
    } else if scaled(&[ours], &[theirs]) {
        Cause::Unit
    } else {
        Cause::Number
    }
}

/// Whether a mass was raised to the least one that the sentence names, or the masses of a few links of one body.
fn raised(by: f64, sentence: &str) -> bool {
    let numbers = sentence.split(|c: char| c.is_whitespace() || c == ',').filter_map(|word| word.parse::<f64>().ok());
    let times = |least: f64| by / least;
    numbers.filter(|&least| least > 0.0).any(|least| {
        times(least) > 0.0 && times(least) < 1.0 + 1e-3 || {
            // Rounding of the sum, of which the bound is a small part.
            let off = (times(least) - times(least).round()).abs();
            times(least) >= 1.0 && times(least) < 100.0 && off < 1e-3
        }
    })
}

fn inertia(ours: &BodyDescription, theirs: &BodyDescription) -> Cause {
    let scale = inertia_scale(ours).max(inertia_scale(theirs));
    let [a, b] = [ours.inertia, theirs.inertia].map(Sym3::from_array);
    let mean = trace(ours) / 3.0;
    let balanced = [mean, 0.0, 0.0, mean, 0.0, mean];
    if same_moments(a, b, scale) {
        return match (diagonal(a, scale), diagonal(b, scale)) {
            (false, true) => Cause::InertialRotationLost,
            (true, false) => Cause::InertialRotationApplied,
            _ => Cause::InertiaTurned,
        };
    }
    if theirs.inertia.iter().zip(balanced).all(|(x, y)| (x - y).abs() <= TESTED * scale) {
        return Cause::Balanced;
    }
    if scaled(&ours.inertia, &theirs.inertia) {
        Cause::Unit
    } else if less_a_body(ours, theirs, scale) {
        Cause::MasslessLink
    } else {
        Cause::Number
    }
}

/// Whether theirs is ours less an inertia that a body could have, with the same mass and centre of mass.
fn less_a_body(ours: &BodyDescription, theirs: &BodyDescription, scale: f64) -> bool {
    let missing: [f64; 6] = std::array::from_fn(|k| ours.inertia[k] - theirs.inertia[k]);
    let body = BodyDescription { inertia: missing, ..ours.clone() };
    let same = |a: f64, b: f64, size: f64| (a - b).abs() <= TESTED * size;
    let same_com = distance(ours.com, theirs.com) <= TESTED * norm(ours.com);
    same(ours.mass, theirs.mass, ours.mass) && same_com && trace(&body) > TESTED * scale && physical(&body)
}

fn placement(ours: &BodyDescription, theirs: &BodyDescription) -> Cause {
    let (a, b) = (&ours.joint.placement, &theirs.joint.placement);
    let same_rotation = close(&a.rotation, &b.rotation);
    if same_rotation {
        return if scaled(&a.translation, &b.translation) { Cause::Unit } else { Cause::Number };
    }
    let far = norm(a.translation).max(norm(b.translation));
    let same_place = distance(a.translation, b.translation) <= TESTED * far;
    let [x, y] = [rpy(a.rotation), rpy(b.rotation)];
    // The smaller angles are the numbers of the file, read once as what they are not.
    let degrees = |small: [f64; 3], large: &[f64; 9]| close(&from_rpy(small.map(f64::to_degrees)), large);
    if same_place && (degrees(x, &b.rotation) || degrees(y, &a.rotation)) { Cause::Degrees } else { Cause::Number }
}

/// Whether two rotations are the same; an angle of many turns has lost digits in proportion.
fn close(a: &[f64; 9], b: &[f64; 9]) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 64.0 * TESTED)
}

/// Whether one list is the other times the factor of a unit.
fn scaled(ours: &[f64], theirs: &[f64]) -> bool {
    let size = |list: &[f64]| list.iter().map(|x| x.abs()).fold(0.0, harness::measure::worst);
    let by = |unit: f64| ours.iter().zip(theirs).all(|(x, y)| (x * unit - y).abs() <= TESTED * size(theirs));
    size(ours) > 0.0 && size(theirs) > 0.0 && ours.len() == theirs.len() && UNITS.into_iter().any(by)
}

/// Whether some distribution of mass has this inertia: no moment is larger than the sum of the two others, about any axes.
fn physical(body: &BodyDescription) -> bool {
    let alone = Description { bodies: vec![body.clone()], ..Description::default() };
    !alone.warnings().iter().any(|warning| matches!(warning, Warning::Unphysical { .. }))
}

fn trace(body: &BodyDescription) -> f64 {
    let [xx, _, _, yy, _, zz] = body.inertia;
    xx + yy + zz
}

fn diagonal(inertia: Sym3<f64>, scale: f64) -> bool {
    [inertia.xy, inertia.xz, inertia.yz].into_iter().all(|product| product.abs() <= TESTED * scale)
}

/// Whether two inertias have the same principal moments: the same coefficients of the characteristic polynomial.
fn same_moments(a: Sym3<f64>, b: Sym3<f64>, scale: f64) -> bool {
    let coefficients = |m: Sym3<f64>| {
        let [xx, xy, xz, yy, yz, zz] = m.to_array().map(|x| x / scale);
        let minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
        let (x, y, z) = (Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz));
        [xx + yy + zz, minors, x.dot(y.cross(z))]
    };
    scale > 0.0 && coefficients(a).iter().zip(coefficients(b)).all(|(x, y)| (x - y).abs() <= TESTED)
}
