//! Joints of a body.

use super::element::{Element, about, axis};
use super::error::{At, MjcfProblem};
use super::settings::Settings;
use featherbench_model::{JointDescription, JointType};
use featherbench_spatial::{Mat3, Transform, Vec3};

/// A joint, with its frame in the body's.
pub(super) struct Joint {
    /// All but its placement on the parent.
    pub described: JointDescription,
    /// The joint's frame in the body's: a hinge and a ball are at their anchor, a slide is at the body's origin.
    pub here: Transform<f64>,
    /// The motion from the coordinate `ref`, at which the file draws the body, to 0.
    pub back: Transform<f64>,
    /// What is left out because a description does not have it.
    pub left_out: Vec<&'static str>,
}

/// A `<joint>` or `<freejoint>`.
pub(super) fn read(joint: Element, name: String, settings: &Settings) -> Result<Joint, At> {
    if joint.node.has_tag_name("freejoint") || joint.attribute("type") == Some("free") {
        if joint.flag_or_auto("align")? == Some(true) {
            return Err(joint.problem(MjcfProblem::NotRead { what: format!("the aligned free joint of {}", joint.owner) }));
        }
        let described = JointDescription { name, kind: JointType::Free, ..JointDescription::default() };
        let mut left_out = Vec::new();
        for attribute in ["armature", "damping", "frictionloss", "stiffness"] {
            if has(joint, attribute)? {
                left_out.push(attribute);
            }
        }
        return Ok(Joint { described, here: Transform::identity(), back: Transform::identity(), left_out });
    }
    let words = [("hinge", 'h'), ("slide", 's'), ("ball", 'b')];
    let kind = joint.word("type", &words, "hinge, slide, ball, free")?.unwrap_or('h');
    let along = joint.numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]);
    let no_axis = || {
        let (owner, value) = (joint.owner.to_owned(), joint.attribute("axis").unwrap_or_default().to_owned());
        joint.problem(MjcfProblem::NoOrientation { owner, attribute: "axis", value })
    };
    let unit = axis(along).ok_or_else(no_axis)?;
    // A description's axes have length one within rounding: then the written numbers are kept.
    let length = Vec3::from_array(along).norm();
    let along = if (length - 1.0).abs() <= 4.0 * f64::EPSILON { along } else { unit.to_array() };
    let anchor = Vec3::from_array(joint.numbers("pos")?.unwrap_or_default());
    let zero = joint.number("ref")?.unwrap_or(0.0);
    let angle = |x: f64| if kind == 's' { x } else { settings.angle(x) };
    let (here, at) = match kind {
        's' => (Vec3::zero(), JointType::Prismatic { axis: along }),
        'b' => (anchor, JointType::Spherical),
        _ => (anchor, JointType::Revolute { axis: along }),
    };
    let back = match kind {
        's' => Transform::new(Mat3::identity(), unit * -zero),
        'h' if zero != 0.0 => Transform::new(about(unit, -angle(zero)), Vec3::zero()),
        _ => Transform::identity(),
    };
    let mut left_out = Vec::new();
    // Of several numbers (a polynomial of the speed) the first is the linear part.
    let every = |name: &str, most: usize| -> Result<Vec<f64>, At> {
        let first = joint.some_numbers(name, 1, most)?.map_or(0.0, |numbers| numbers[0]);
        Ok(if first == 0.0 { Vec::new() } else { vec![first; at.nv()] })
    };
    let mut described = JointDescription {
        name,
        kind: at,
        armature: every("armature", 1)?,
        damping: every("damping", 3)?,
        friction: every("frictionloss", 1)?,
        ..JointDescription::default()
    };
    let range = joint.numbers::<2>("range")?;
    let limited = joint.flag_or_auto("limited")?.unwrap_or(settings.autolimits && range.is_some_and(|[a, b]| a != 0.0 || b != 0.0));
    if kind == 'b' && limited {
        left_out.push("limit");
    } else if let (true, Some([lower, upper])) = (limited, range) {
        (described.lower, described.upper) = (vec![angle(lower)], vec![angle(upper)]);
    }
    let force = joint.numbers::<2>("actuatorfrcrange")?;
    let bounded = joint.flag_or_auto("actuatorfrclimited")?.unwrap_or(settings.autolimits && force.is_some());
    // A description has one bound for both directions.
    match force {
        Some([low, high]) if bounded && kind != 'b' && low == -high && high > 0.0 => described.effort = vec![high],
        Some(_) if bounded => left_out.push("bound of the actuators' force"),
        _ => {}
    }
    if joint.some_numbers("damping", 1, 3)?.is_some_and(|numbers| numbers[1..].iter().any(|x| *x != 0.0)) {
        left_out.push("damping after its first number");
    }
    if has(joint, "stiffness")? {
        left_out.push("spring");
    }
    Ok(Joint { described, here: Transform::new(Mat3::identity(), here), back, left_out })
}

/// Whether any of the one to three numbers of an attribute is not zero.
fn has(joint: Element, attribute: &str) -> Result<bool, At> {
    Ok(joint.some_numbers(attribute, 1, 3)?.is_some_and(|numbers| numbers.iter().any(|x| *x != 0.0)))
}
