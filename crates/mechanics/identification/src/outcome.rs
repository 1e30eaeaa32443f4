//! The robot with identified parameters, and what changed.

use crate::{Consistency, IdentificationError, Kind, LinearModel, PseudoInertia};
use featherbench_dynamics::PARAMETERS;
use featherbench_model::Description;

/// A number of the description that changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The body or joint.
    pub of: String,
    /// The field, such as `mass` or `com[0]`.
    pub field: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the description says.
    pub before: f64,
    /// What was identified.
    pub after: f64,
}

/// Whether each body can exist, in canonical order.
pub fn consistency(linear: &LinearModel, theta: &[f64]) -> Vec<Consistency> {
    let of = |body: usize| {
        PseudoInertia::of(&std::array::from_fn(|k| theta.get(PARAMETERS * body + k).copied().unwrap_or(f64::NAN))).consistency()
    };
    (0..linear.description().bodies.len()).map(of).collect()
}

/// The description with the parameters θ. Offsets of torques have no place in it.
///
/// # Errors
/// [`IdentificationError::Unphysical`] when a body cannot exist, or a friction is negative: no engine would take it.
pub fn described(linear: &LinearModel, theta: &[f64]) -> Result<Description, IdentificationError> {
    if theta.len() != linear.unknowns().len() {
        let (found, expected) = (theta.len(), linear.unknowns().len());
        return Err(IdentificationError::Length { array: "theta", found, samples: 1, expected });
    }
    let mut description = linear.description().clone();
    for ((body, consistency), pi) in description.bodies.iter_mut().zip(consistency(linear, theta)).zip(theta.chunks_exact(PARAMETERS)) {
        if !consistency.is_consistent() {
            let defect =
                format!("its pseudo-inertia has the eigenvalue {:.2e} (largest {:.2e})", consistency.smallest, consistency.largest);
            return Err(IdentificationError::Unphysical { body: body.name.clone(), defect });
        }
        (body.mass, body.com, body.inertia) = PseudoInertia::of(&std::array::from_fn(|k| pi[k])).central();
    }
    for (unknown, &value) in linear.unknowns().iter().zip(theta) {
        let Some(dof) = linear.dofs().get(unknown.of).filter(|_| !matches!(unknown.kind, Kind::Inertial(_) | Kind::Offset)) else {
            continue;
        };
        let body = &mut description.bodies[dof.body];
        if value < 0.0 {
            let defect = format!("the {} of joint '{}' is {value:.2e}", field(unknown.kind), dof.name);
            return Err(IdentificationError::Unphysical { body: body.name.clone(), defect });
        }
        let nv = body.joint.kind.nv();
        let values = match unknown.kind {
            Kind::Armature => &mut body.joint.armature,
            Kind::Viscous => &mut body.joint.damping,
            _ => &mut body.joint.friction,
        };
        values.resize(nv, 0.0);
        values[dof.within] = value;
    }
    Ok(description)
}

fn field(kind: Kind) -> &'static str {
    match kind {
        Kind::Inertial(_) => "inertia",
        Kind::Armature => "armature",
        Kind::Viscous => "damping",
        Kind::Coulomb => "friction",
        Kind::Offset => "offset",
    }
}

/// What changed, body after body: numbers that differ by more than 1e-9 of the larger one and 1e-12 of its unit.
pub fn changes(before: &Description, after: &Description) -> Vec<Change> {
    const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let mut changes = Vec::new();
    for (before, after) in before.bodies.iter().zip(&after.bodies) {
        let mut add = |of: &str, field: String, unit, before: f64, after: f64| {
            if (before - after).abs() > 1e-9 * before.abs().max(after.abs()) + 1e-12 {
                changes.push(Change { of: of.into(), field, unit, before, after });
            }
        };
        add(&before.name, "mass".into(), "kg", before.mass, after.mass);
        for k in 0..3 {
            add(&before.name, format!("com[{k}]"), "m", before.com[k], after.com[k]);
        }
        for (k, name) in INERTIA.iter().enumerate() {
            add(&before.name, (*name).into(), "kg·m²", before.inertia[k], after.inertia[k]);
        }
        let joint = if before.joint.name.is_empty() { &before.name } else { &before.joint.name };
        let lists = [
            ("armature", "kg·m²", &before.joint.armature, &after.joint.armature),
            ("damping", "N·m·s", &before.joint.damping, &after.joint.damping),
            ("friction", "N·m", &before.joint.friction, &after.joint.friction),
        ];
        for (name, unit, old, new) in lists {
            for (k, &value) in new.iter().enumerate() {
                let field = if new.len() == 1 { name.to_owned() } else { format!("{name}[{k}]") };
                add(joint, field, unit, old.get(k).copied().unwrap_or(0.0), value);
            }
        }
    }
    changes
}
