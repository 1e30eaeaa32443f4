//! What is no rod is refused by name.

use crate::beams::{links, rod};
use featherbench_continua::{
    Assembly, Basis, Defect, Element, Hinges, Load, Material, Rod, Section, Settings, SolveError, Strain, equilibrium, generalized, systems,
};
use featherbench_model::Placement;
use nalgebra::DMatrix;

const STEEL: Material = Material { young: 2.1e11, poisson: 0.3, density: 7850.0, damping: 0.0 };

fn refused(material: Material, section: Section, length: f64) -> (String, String) {
    let error = Rod::new(material, section, length).unwrap_err();
    (error.field.clone(), error.to_string())
}

#[test]
fn bad_materials_sections_and_lengths_are_named() {
    let round = Section::circle(0.01);
    let cases = [
        (Material { young: -1.0, ..STEEL }, round, 1.0, "material.young"),
        (Material { young: f64::NAN, ..STEEL }, round, 1.0, "material.young"),
        (Material { poisson: 0.5001, ..STEEL }, round, 1.0, "material.poisson"),
        (Material { poisson: -1.0, ..STEEL }, round, 1.0, "material.poisson"),
        (Material { poisson: f64::NAN, ..STEEL }, round, 1.0, "material.poisson"),
        (Material { density: 0.0, ..STEEL }, round, 1.0, "material.density"),
        (Material { damping: -1e-9, ..STEEL }, round, 1.0, "material.damping"),
        (STEEL, Section { area: 0.0, ..round }, 1.0, "section.area"),
        (STEEL, Section { second_moments: [0.0, 1.0], ..round }, 1.0, "section.second_moments[0]"),
        (STEEL, Section { second_moments: [1.0, -1.0], ..round }, 1.0, "section.second_moments[1]"),
        (STEEL, Section { torsion: f64::INFINITY, ..round }, 1.0, "section.torsion"),
        (STEEL, Section { shear_factor: 1.1, ..round }, 1.0, "section.shear_factor"),
        (STEEL, Section::circle(0.0), 1.0, "section.area"),
        (STEEL, round, -1.0, "length"),
    ];
    for (material, section, length, field) in cases {
        let (name, text) = refused(material, section, length);
        assert_eq!(name, field);
        assert!(text.contains(field), "{text}");
    }
    // The bounds themselves: rubber, and a material that grows no thinner.
    for poisson in [0.5, 0.0, -0.99] {
        assert!(Rod::new(Material { poisson, ..STEEL }, round, 1.0).is_ok());
    }
}

#[test]
fn a_rod_clamped_to_nothing_is_refused() {
    let mut assembly = Assembly::new(Default::default());
    let error = assembly.attach("rod", &rod(), &links(3, Hinges::Middle), Some(0), Placement::default()).unwrap_err();
    assert_eq!(error.defect, Defect::ClampedToNothing { body: 0, bodies: 0 });
    assert!(error.to_string().contains("clamped to nothing"));
    // Nothing was added.
    assert!(assembly.description().bodies.is_empty());
    assert!(matches!(assembly.build().unwrap_err().defect, Defect::Tree { .. }));
}

#[test]
fn elements_without_parts_are_refused() {
    let bend = vec![Strain::BendZ];
    let elements = [
        (links(0, Hinges::Start), "element.count"),
        (Element::Links { count: 1, hinges: Hinges::Start, strains: vec![] }, "element.strains"),
        (Element::Links { count: 1, hinges: Hinges::Start, strains: vec![Strain::Twist; 2] }, "element.strains"),
        (Element::Ritz { basis: Basis::Hermite(0), strains: bend.clone() }, "element.basis"),
        (Element::Ritz { basis: Basis::Modes(1), strains: vec![Strain::ShearY] }, "element.strains"),
        (Element::Sections { count: 1, strains: bend.clone(), points: 1 }, "element.points"),
        (Element::Sections { count: 0, strains: bend, points: 2 }, "element.count"),
    ];
    for (element, field) in elements {
        let error = Assembly::default().attach("rod", &rod(), &element, None, Placement::default()).unwrap_err();
        assert_eq!(error.field, field, "{element:?}");
    }
}

#[test]
fn loads_on_no_body_and_states_of_another_size_are_errors() {
    let (beam, _) = systems::cantilever(&rod(), &links(3, Hinges::Middle)).unwrap();
    // Body 0 is the half element that is part of the wall.
    for body in [0, 99] {
        let load = Load::force(body, [0.0; 3], [1.0, 0.0, 0.0]);
        let error = equilibrium(&beam, &[load], &Settings::default()).unwrap_err();
        assert!(matches!(error, SolveError::Refused(_)), "{error}");
    }
    let start = Some(vec![0.0; 99]);
    assert!(equilibrium(&beam, &[], &Settings { start, ..Settings::default() }).is_err());
    let (one, nan) = (DMatrix::identity(2, 2), DMatrix::from_element(2, 2, f64::NAN));
    for (stiffness, mass) in [(&nan, &one), (&one, &nan), (&one, &-one.clone())] {
        assert!(matches!(generalized(stiffness, mass), Err(SolveError::NotPositiveDefinite { .. })));
    }
    assert!(beam.elastic_energy(&[0.0]).is_err() && beam.shape(&[0.0]).is_err());
}

#[test]
fn sections_have_the_constants_of_tables() {
    // Saint-Venant: J = β a b³ with β = 0.140577 for a square, 0.228682 for 2:1, and → 1/3 for a thin strip with 1 − 0.630 b/a.
    let torsion = |a: f64, b: f64| Section::rectangle(a, b).torsion / (a.max(b) * a.min(b).powi(3));
    assert!((torsion(1.0, 1.0) - 0.140577).abs() < 1e-6 && (torsion(2.0, 1.0) - 0.228682).abs() < 1e-6);
    assert!((torsion(0.01, 1.0) * 3.0 - (1.0 - 0.630249 * 0.01)).abs() < 1e-7);
    assert_eq!(torsion(3.0, 1.0), torsion(1.0, 3.0));
    let rectangle = Section::rectangle(0.2, 0.3);
    assert!(
        (rectangle.second_moments[0] - 0.2 * 0.027 / 12.0).abs() < 1e-18
            && (rectangle.second_moments[1] - 0.3 * 0.008 / 12.0).abs() < 1e-18
    );
}
