//! Mass properties of a body: its inertial element, or its shapes.

use super::element::{Element, axis, onto};
use super::error::{At, MjcfProblem};
use super::settings::Settings;
use crate::solid::{self, Solid};
use featherbench_spatial::{Mat3, RigidBodyInertia, Sym3, Transform, Vec3};

/// Density of shapes that do not say it, kg/m³.
const DENSITY: f64 = 1000.0;

/// Mass, centre of mass, and inertia about it (xx, xy, xz, yy, yz, zz), in the body's axes.
pub(super) type Inertial = (f64, [f64; 3], [f64; 6]);

/// An `<inertial>`.
pub(super) fn written(inertial: Element, settings: &Settings) -> Result<Inertial, At> {
    inertial.required("pos")?;
    inertial.required("mass")?;
    let com = inertial.numbers("pos")?.unwrap_or_default();
    let mass = inertial.number("mass")?.unwrap_or_default();
    let turn = inertial.orientation(settings)?;
    let six = match (inertial.numbers::<3>("diaginertia")?, inertial.numbers::<6>("fullinertia")?) {
        (_, Some([xx, yy, zz, xy, xz, yz])) => [xx, xy, xz, yy, yz, zz],
        (Some([x, y, z]), None) => [x, 0.0, 0.0, y, 0.0, z],
        (None, None) => return inertial.required("diaginertia").map(|_| (mass, com, [0.0; 6])),
    };
    let turned = turn.map_or(six, |turn| Sym3::from_array(six).rotate(turn).to_array());
    Ok((mass, com, turned))
}

/// All shapes of a body together.
pub(super) fn of_shapes<'a, 'd: 'a>(shapes: impl Iterator<Item = Element<'a, 'd>>, settings: &Settings) -> Result<Inertial, At> {
    let mut whole = RigidBodyInertia::<f64>::zero();
    for geom in shapes {
        let mass = geom.number("mass")?;
        let density = geom.number("density")?.unwrap_or(DENSITY);
        if mass == Some(0.0) || (mass.is_none() && density == 0.0) {
            continue;
        }
        if geom.flag("shellinertia")? == Some(true) {
            return Err(geom.problem(MjcfProblem::NotRead { what: format!("the shellinertia of a shape of {}", geom.owner) }));
        }
        let (place, (volume, moments)) = shape(geom, settings)?;
        let mass = mass.unwrap_or(density * volume);
        let [x, y, z] = moments.map(|moment| mass * moment);
        whole += RigidBodyInertia::from_com(mass, Vec3::zero(), Sym3::from_array([x, 0.0, 0.0, y, 0.0, z])).to_parent(&place);
    }
    let central = whole.central();
    Ok((central.mass, central.com.to_array(), central.rotational.to_array()))
}

/// A shape's placement in the body, and its solid.
fn shape(geom: Element, settings: &Settings) -> Result<(Transform<f64>, Solid), At> {
    let kind = geom.attribute("type").unwrap_or("sphere");
    let not_read = || geom.problem(MjcfProblem::NotRead { what: format!("the mass of a {kind} of {}", geom.owner) });
    if geom.attribute("mesh").is_some() || geom.attribute("fitscale").is_some() {
        return Err(not_read());
    }
    let pos = Vec3::from_array(geom.numbers("pos")?.unwrap_or_default());
    let turn = geom.orientation(settings)?.unwrap_or(Mat3::identity());
    let along = geom.numbers::<6>("fromto")?;
    let mut size = geom.some_numbers("size", 1, 3)?.unwrap_or_default();
    let mut place = Transform::new(turn, pos);
    if let Some([a, b, c, d, e, f]) = along {
        // The shape's z axis runs from one end to the other; MuJoCo lets it point from the second to the first, which is the same solid.
        let (from, to) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let way = to - from;
        let Some(z) = axis(way.to_array()) else {
            let (owner, value) = (geom.owner.to_owned(), geom.attribute("fromto").unwrap_or_default().to_owned());
            return Err(geom.problem(MjcfProblem::NoOrientation { owner, attribute: "fromto", value }));
        };
        place = Transform::new(onto(z), (from + to) * 0.5);
        // The half length has its own place in the size.
        let at = if matches!(kind, "box" | "ellipsoid") { 2 } else { 1 };
        size.resize(at, size.first().copied().unwrap_or_default());
        size.push(0.5 * way.norm());
    }
    let solid = match (kind, &size[..]) {
        ("sphere", &[r, ..]) => solid::ball(r),
        ("capsule", &[r, l, ..]) => solid::capsule(r, 2.0 * l),
        ("cylinder", &[r, l, ..]) => solid::cylinder(r, 2.0 * l),
        ("box", &[x, y, z]) => solid::cuboid([x, y, z].map(|x| 2.0 * x)),
        ("ellipsoid", &[x, y, z]) => solid::ellipsoid([x, y, z]),
        ("sphere" | "capsule" | "cylinder" | "box" | "ellipsoid", found) => {
            let (owner, value) = (geom.owner.to_owned(), found.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
            let expected = format!("the size of a {kind}");
            return Err(geom.problem(MjcfProblem::NotNumbers { owner, attribute: "size".into(), value, expected }));
        }
        _ => return Err(not_read()),
    };
    Ok((place, solid))
}
