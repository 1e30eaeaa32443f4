//! What is refused, by name.

use crate::common::model;
use featherbench_constrained::{Attachment, Constraint, Constraints, Defect, Error, Law, Rows};
use featherbench_spatial::Mat3;

fn defect(law: Law) -> Defect {
    let model = model("joints:kind=all,base=free");
    let error = Constraints::new(&model.topology, vec![Constraint { name: "pin".into(), law }]).unwrap_err();
    assert!(error.to_string().contains("'pin'"), "{error}");
    error.defect
}

#[test]
fn bad_constraints_are_refused_by_name() {
    let (world, body) = (Attachment::world([0.0; 3]), Attachment::point(2, [0.0; 3]));
    let point = |first, second| Law::Point { first, second, axes: [true; 3] };
    assert!(matches!(defect(point(world, Attachment::point(999, [0.0; 3]))), Defect::NoBody { side: "second", body: 999, .. }));
    assert!(matches!(defect(point(world, Attachment::point(2, [f64::NAN, 0.0, 0.0]))), Defect::NotFinite { field: "placement", .. }));
    assert!(matches!(defect(point(body.with_axes(Mat3::zero()), world)), Defect::NotARotation { side: "first", .. }));
    let mirror = Mat3::from_array([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0]);
    assert!(matches!(defect(point(world, body.with_axes(mirror))), Defect::NotARotation { .. }));
    assert_eq!(defect(point(body, body)), Defect::SameBody);
    assert_eq!(defect(point(world, world)), Defect::SameBody);
    assert_eq!(defect(Law::Point { first: world, second: body, axes: [false; 3] }), Defect::NoAxis);
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(defect(Law::Distance { first: world, second: body, length }), Defect::Length { .. }), "{length}");
    }
    // Dof 0 is of the free base.
    assert_eq!(defect(Law::Gear { terms: vec![(6, 1.0), (0, 1.0)], offset: 0.0 }), Defect::NoCoordinate { dof: 0 });
    assert_eq!(defect(Law::Gear { terms: vec![(6, 1.0)], offset: 0.0 }), Defect::FewTerms { found: 1 });
    assert_eq!(defect(Law::Gear { terms: vec![(6, 1.0), (6, 1.0)], offset: 0.0 }), Defect::RepeatedDof { dof: 6 });
    assert_eq!(defect(Law::Gear { terms: vec![(6, 0.0), (7, 1.0)], offset: 0.0 }), Defect::ZeroCoefficient { dof: 6 });
    assert!(matches!(defect(Law::Gear { terms: vec![(6, 1.0), (7, 1.0)], offset: f64::INFINITY }), Defect::NotFinite { .. }));
    assert!(matches!(defect(Law::Mimic { follower: 6, leader: 9999, polynomial: [0.0; 5] }), Defect::NoDof { dof: 9999, .. }));
    assert_eq!(defect(Law::Mimic { follower: 6, leader: 6, polynomial: [0.0; 5] }), Defect::RepeatedDof { dof: 6 });

    let model = model("chain:n=3");
    let twice = vec![Constraint::point("a", world, body), Constraint::weld("a", world, body)];
    assert_eq!(Constraints::new(&model.topology, twice).unwrap_err().defect, Defect::DuplicateName);
}

#[test]
fn bad_states_are_refused_by_name() {
    let model = model("chain:n=3");
    let held = Constraint::weld("grip", Attachment::world([0.0; 3]), Attachment::point(2, [0.0; 3]));
    let constraints = Constraints::new(&model.topology, vec![held]).unwrap();
    let mut rows = Rows::new(&constraints);
    let zero = [0.0; 3];
    assert!(matches!(rows.run(&model, &constraints, &[0.0; 2], &zero), Err(Error::Dimension(_))));
    assert!(matches!(rows.run(&model, &constraints, &zero, &[0.0; 4]), Err(Error::Dimension(_))));
    let found = rows.run(&model, &constraints, &[0.0, f64::NAN, 0.0], &zero);
    assert_eq!(found, Err(Error::NotFinite { what: "configuration q", index: 1 }));
    let found = rows.run(&model, &constraints, &zero, &[f64::INFINITY, 0.0, 0.0]);
    assert_eq!(found, Err(Error::NotFinite { what: "velocity v", index: 0 }));
    let other = crate::common::model("chain:n=4");
    assert_eq!(rows.run(&other, &constraints, &[0.0; 4], &[0.0; 4]), Err(Error::OtherTree));
}

/// A hinge about one axis, turned by half a turn against its weld.
#[test]
fn a_weld_half_a_turn_off_is_refused() {
    let model = model("chain:n=1");
    let body = Attachment::point(0, [0.0; 3]);
    // At home the frames agree: what the world's has is the body's placement.
    let home = model.joint_transform(0, &[0.0]);
    let described = model.labels[0].rotation_to_described(home.rotation);
    let world = Attachment::world(home.translation.to_array()).with_axes(described);
    let constraints = Constraints::new(&model.topology, vec![Constraint::weld("grip", world, body)]).unwrap();
    let mut rows = Rows::new(&constraints);
    rows.run(&model, &constraints, &[0.0], &[0.0]).unwrap();
    assert!(rows.residuals().all(|residual: f64| residual.abs() < 1e-15));
    let found = rows.run(&model, &constraints, &[std::f64::consts::PI], &[0.0]);
    assert_eq!(found, Err(Error::HalfTurn { constraint: "grip".into() }));
}
