//! Two soft robots as descriptions: `datasets/models/soft` has them as files, and `crates/studies/registry/examples/soft_robots.rs` writes those.

use featherbench_model::{
    BodyDescription, Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, ContinuumTip, Description,
    JointDescription, JointType, Placement,
};

/// The root of a rod that hangs: x down, y along the parent's x, z along −y.
const HANGING: [f64; 9] = [0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0];

/// A gripper of two soft fingers of silicone, 10 cm long, that hang from a palm on a wrist. Fingers bend in the plane x z.
pub fn gripper() -> Description {
    let finger = |name: &str, x: f64| Continuum {
        name: name.into(),
        body: Some(0),
        placement: Placement { rotation: HANGING, translation: [x, 0.0, 0.0] },
        length: 0.1,
        material: ContinuumMaterial { young: 1e6, poisson: 0.48, density: 1070.0, damping: 0.01 },
        section: ContinuumSection::Rectangle { width: 0.012, height: 0.016 },
        element: ContinuumElement::Sections,
        count: 12,
        strains: vec![ContinuumStrain::BendZ],
        tip: Some(ContinuumTip { mass: 0.002, com: [0.003, 0.0, 0.0], inertia: [1e-7, 0.0, 0.0, 1e-7, 0.0, 1e-7] }),
    };
    Description {
        name: "soft_gripper".into(),
        gravity: [0.0, 0.0, -9.81],
        bodies: vec![link("palm", None, [0.0, 0.0, 1.0], [0.0; 3], 0.2, 0.02)],
        continua: vec![finger("left", -0.04), finger("right", 0.04)],
        ..Description::default()
    }
}

/// An arm of two links, 0.5 m and 0.4 m long along x, that turn about y. A cable of 0.6 m with a load hangs from its end.
pub fn cable_arm() -> Description {
    let cable = Continuum {
        name: "cable".into(),
        body: Some(1),
        placement: Placement { rotation: HANGING, translation: [0.4, 0.0, 0.0] },
        length: 0.6,
        material: ContinuumMaterial { young: 1e11, poisson: 0.3, density: 7850.0, damping: 0.0 },
        section: ContinuumSection::Circle { radius: 0.002 },
        element: ContinuumElement::StringLinks,
        count: 12,
        strains: vec![ContinuumStrain::BendZ],
        tip: Some(ContinuumTip { mass: 0.2, com: [0.0; 3], inertia: [5e-5, 0.0, 0.0, 5e-5, 0.0, 5e-5] }),
    };
    let y = [0.0, 1.0, 0.0];
    Description {
        name: "cable_arm".into(),
        gravity: [0.0, 0.0, -9.81],
        bodies: vec![link("upper", None, y, [0.0; 3], 2.0, 0.5), link("fore", Some(0), y, [0.5, 0.0, 0.0], 1.2, 0.4)],
        continua: vec![cable],
        ..Description::default()
    }
}

/// A rod-like link along x on a hinge.
fn link(name: &str, parent: Option<usize>, axis: [f64; 3], translation: [f64; 3], mass: f64, length: f64) -> BodyDescription {
    let placement = Placement { translation, ..Placement::default() };
    let kind = JointType::Revolute { axis };
    let joint = JointDescription { name: format!("{name}_joint"), kind, placement, ..JointDescription::default() };
    // A rod of this length, as thick as a tenth of it.
    let (across, along) = (mass * length * length / 12.0, mass * length * length / 800.0);
    BodyDescription {
        name: name.into(),
        parent,
        mass,
        com: [0.5 * length, 0.0, 0.0],
        inertia: [along, 0.0, 0.0, across, 0.0, across],
        joint,
    }
}
