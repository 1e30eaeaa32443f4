//! Continua of descriptions: what fixed bodies do to them, who refuses them, and which material, section or element is none.

use crate::loops::body;
use featherbench_model::{
    Continuum, ContinuumDefect, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, ContinuumTip, Description,
    JointType, Malformed, Model, Placement,
};

fn finger() -> Continuum {
    Continuum {
        name: "finger".into(),
        body: Some(0),
        placement: Placement { translation: [0.0, 0.25, 0.0], ..Placement::default() },
        length: 0.1,
        material: ContinuumMaterial { young: 1e6, poisson: 0.48, density: 1070.0, damping: 0.01 },
        section: ContinuumSection::Circle { radius: 0.008 },
        element: ContinuumElement::Sections,
        count: 8,
        strains: vec![ContinuumStrain::BendY, ContinuumStrain::BendZ],
        tip: Some(ContinuumTip { mass: 0.1, com: [0.01, 0.0, 0.0], inertia: [1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6] }),
    }
}

/// A palm is fixed to an arm that comes last in the file.
fn robot() -> Description {
    let bodies = vec![
        body("palm", Some(1), JointType::Fixed, [1.0, 0.0, 0.0]),
        body("arm", None, JointType::Revolute { axis: [0.0, 0.0, 1.0] }, [0.0; 3]),
    ];
    Description { name: "robot".into(), bodies, continua: vec![finger()], ..Description::default() }
}

#[test]
fn a_root_on_a_fixed_body_is_on_what_carries_it() {
    let canonical = robot().canonical().unwrap();
    let finger = &canonical.continua[0];
    // (1, 0, 0), and a quarter along the palm's y: −x.
    assert_eq!((finger.body, finger.placement.translation), (Some(0), [0.75, 0.0, 0.0]));
    assert_eq!(finger.placement.rotation, robot().bodies[0].joint.placement.rotation);
    assert_eq!(canonical.canonical().as_ref(), Ok(&canonical), "a canonical description is its own canonical form");
}

#[test]
fn a_rigid_model_refuses_them_by_name() {
    let refused = Model::<f64>::build(&robot()).expect_err("it deforms");
    assert_eq!(refused, Malformed::Deforms { names: vec!["finger".into()] });
    assert!(refused.to_string().contains("finger"), "{refused}");
    assert!(Model::<f64>::build(&Description { continua: Vec::new(), ..robot() }).is_ok());
}

#[test]
fn malformed_continua_are_refused_by_name_and_field() {
    type Edit = fn(&mut Continuum);
    let cases: &[(Edit, &str)] = &[
        (|c| c.body = Some(9), "body: it is clamped to nothing: body 9 does not exist (there are 2 bodies"),
        (|c| c.placement.translation[1] = f64::NAN, "placement.translation is NaN"),
        (|c| c.placement.rotation[8] = -1.0, "placement: its rotation misses orthonormality"),
        (|c| c.placement.rotation[8] = f64::NAN, "placement.rotation is NaN"),
        (|c| c.length = 0.0, "length is 0; it must be positive"),
        (|c| c.length = f64::INFINITY, "length is inf"),
        (|c| c.material.young = -1e6, "material.young is -1000000; it must be positive"),
        (|c| c.material.young = f64::NAN, "material.young is NaN"),
        (|c| c.material.poisson = 0.6, "material.poisson is 0.6"),
        (|c| c.material.poisson = -1.0, "material.poisson is -1"),
        (|c| c.material.poisson = f64::NAN, "material.poisson is NaN"),
        (|c| c.material.density = 0.0, "material.density is 0"),
        (|c| c.material.damping = -0.1, "material.damping is -0.1; it cannot be negative"),
        (|c| c.section = ContinuumSection::Circle { radius: 0.0 }, "section.radius is 0; it must be positive"),
        (|c| c.section = ContinuumSection::Tube { inner: 0.02, outer: 0.01 }, "section.inner is 0.02 m, and section.outer is 0.01 m"),
        (|c| c.section = ContinuumSection::Tube { inner: -0.02, outer: 0.01 }, "section.inner is -0.02"),
        (|c| c.section = ContinuumSection::Tube { inner: 0.0, outer: f64::NAN }, "section.outer is NaN"),
        (|c| c.section = ContinuumSection::Rectangle { width: 0.01, height: 0.0 }, "section.height is 0"),
        (
            |c| c.section = ContinuumSection::General { area: 1e-4, second_moments: [1e-9, -1e-9], torsion: 1e-9, shear_factor: 0.8 },
            "section.second_moments is -0.000000001",
        ),
        (
            |c| c.section = ContinuumSection::General { area: 0.0, second_moments: [1e-9; 2], torsion: 1e-9, shear_factor: 0.8 },
            "section.area is 0",
        ),
        (
            |c| c.section = ContinuumSection::General { area: 1e-4, second_moments: [1e-9; 2], torsion: 0.0, shear_factor: 0.8 },
            "section.torsion is 0",
        ),
        (
            |c| c.section = ContinuumSection::General { area: 1e-4, second_moments: [1e-9; 2], torsion: 1e-9, shear_factor: 1.5 },
            "section.shear_factor is 1.5; it is at most 1",
        ),
        (|c| (c.element, c.strains) = (ContinuumElement::StringLinks, vec![ContinuumStrain::BendY]), "strains: a string turns about z"),
        (|c| c.count = 0, "count is 0"),
        (|c| c.strains.clear(), "strains: the list is empty"),
        (|c| c.strains.push(ContinuumStrain::BendY), "strains: 'bend_y' stands twice"),
        (
            |c| (c.element, c.strains) = (ContinuumElement::Modes, vec![ContinuumStrain::ShearZ]),
            "strains: 'shear_z' is none of a continuum of element 'modes'; it has twist, bend_y, bend_z, extension",
        ),
        (|c| c.tip = c.tip.map(|tip| ContinuumTip { mass: -1.0, ..tip }), "tip.mass is -1"),
        (|c| c.tip = c.tip.map(|tip| ContinuumTip { com: [f64::NAN; 3], ..tip }), "tip.com is NaN"),
        (|c| c.tip = c.tip.map(|tip| ContinuumTip { inertia: [f64::INFINITY; 6], ..tip }), "tip.inertia is inf"),
    ];
    for (edit, part) in cases {
        let mut robot = robot();
        let mut bad = Continuum { name: "bad".into(), ..finger() };
        edit(&mut bad);
        robot.continua.push(bad);
        let error = robot.canonical().expect_err(part);
        let text = error.to_string();
        assert!(text.starts_with("continua[1] 'bad': ") && text.contains(part), "{text}\n  lacks {part}");
        assert_eq!(error.about(), Some("bad"));
    }
    let mut twice = robot();
    twice.continua.push(finger());
    let due = Malformed::Continuum { name: "finger".into(), index: 1, defect: ContinuumDefect::DuplicateName };
    assert_eq!(twice.validate(), Err(due));
}

/// Every element has a strain, and each of its strains is accepted.
#[test]
fn every_element_takes_its_own_strains() {
    for element in ContinuumElement::ALL {
        assert!(!element.strains().is_empty());
        for strain in ContinuumStrain::ALL {
            let string = element.name().starts_with("string") && strain == ContinuumStrain::BendY;
            let strains = if string { vec![strain, ContinuumStrain::BendZ] } else { vec![strain] };
            let continuum = Continuum { element, strains, ..finger() };
            let accepted = Description { continua: vec![continuum], ..robot() }.validate().is_ok();
            assert_eq!(accepted, element.strains().contains(&strain), "{} {}", element.name(), strain.name());
        }
    }
}
