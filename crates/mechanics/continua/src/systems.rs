//! Rods with known answers, ready to compute with. Parameters are arguments: the same case runs with other numbers.

use crate::{Assembly, Continuum, Element, Masses, Refused, Rod, Tip};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};

/// A rod that is clamped to the world along x, without gravity, and its tip.
///
/// # Errors
/// [`Refused`] as [`Assembly::attach`].
pub fn cantilever(rod: &Rod, element: &Element) -> Result<(Continuum, Tip), Refused> {
    let mut assembly = Assembly::new(Description { name: "cantilever".into(), ..Description::default() });
    let tip = assembly.attach("rod", rod, element, None, Placement::default())?;
    Ok((assembly.build()?, tip))
}

/// A string of `count` links of length L/n, mass `mass` in all, that hangs along the gravity g: both are along x.
///
/// # Errors
/// [`Refused`] as [`Rod::new`] and [`Assembly::attach`].
pub fn hanging_string(count: usize, masses: Masses, length: f64, mass: f64, gravity: f64) -> Result<(Continuum, Tip), Refused> {
    let rod = Rod::textbook(1.0, mass / length, length)?;
    let mut assembly = Assembly::new(Description { name: "string".into(), gravity: [gravity, 0.0, 0.0], ..Description::default() });
    let tip = assembly.attach("string", &rod, &Element::String { count, masses, planar: true }, None, Placement::default())?;
    Ok((assembly.build()?, tip))
}

/// A free body of this mass and inertia about each axis, without gravity, that carries a rod along x from its centre: the rod's tip, and
/// the body's index.
///
/// # Errors
/// [`Refused`] as [`Assembly::attach`].
pub fn on_free_hub(mass: f64, inertia: f64, rod: &Rod, element: &Element) -> Result<(Assembly, Tip), Refused> {
    let mut assembly = Assembly::new(Description { name: "hub".into(), ..Description::default() });
    let joint = JointDescription { name: "hub.joint".into(), kind: JointType::Free, ..JointDescription::default() };
    let inertia = [inertia, 0.0, 0.0, inertia, 0.0, inertia];
    let hub = assembly.add(BodyDescription { name: "hub".into(), parent: None, mass, com: [0.0; 3], inertia, joint });
    let tip = assembly.attach("rod", rod, element, Some(hub), Placement::default())?;
    Ok((assembly, tip))
}

/// A rigid body of this mass and inertia about each axis that is fixed to a tip; gives its index.
pub fn carry(assembly: &mut Assembly, tip: &Tip, mass: f64, inertia: f64) -> usize {
    let joint = JointDescription { name: "carried.joint".into(), placement: tip.placement, ..JointDescription::default() };
    let inertia = [inertia, 0.0, 0.0, inertia, 0.0, inertia];
    assembly.add(BodyDescription { name: "carried".into(), parent: Some(tip.body), mass, com: [0.0; 3], inertia, joint })
}
