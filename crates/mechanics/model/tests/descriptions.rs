//! Descriptions: what is an error, what is a warning, and what the canonical form does.

use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Label, Malformed, Model, Placement, Warning};
use featherbench_spatial::{Mat3, Quaternion, RigidBodyInertia, Sym3, Transform, Vec3};

const REVOLUTE: JointType = JointType::Revolute { axis: [0.0, 0.0, 1.0] };

fn body(name: &str, parent: Option<usize>, kind: JointType) -> BodyDescription {
    BodyDescription {
        name: name.to_owned(),
        parent,
        mass: 2.0,
        com: [0.1, -0.2, 0.3],
        inertia: [0.02, 0.001, -0.002, 0.03, 0.003, 0.025],
        joint: JointDescription { name: format!("{name}_joint"), kind, ..JointDescription::default() },
    }
}

fn robot(bodies: Vec<BodyDescription>) -> Description {
    Description { name: "robot".to_owned(), gravity: [0.0, 0.0, -9.81], bodies, ..Description::default() }
}

/// A robot of two bodies, the second one changed.
fn changed(change: impl FnOnce(&mut BodyDescription)) -> Description {
    let mut second = body("second", Some(0), REVOLUTE);
    change(&mut second);
    robot(vec![body("first", None, REVOLUTE), second])
}

fn refused(robot: &Description) -> Malformed {
    let error = robot.validate().expect_err("must be refused");
    // NaN is not equal to itself: compare what is written.
    assert_eq!(robot.canonical().map_err(|e| e.to_string()), Err(error.to_string()));
    assert_eq!(Model::<f64>::build(robot).map(|_| ()).map_err(|e| e.to_string()), Err(error.to_string()));
    error
}

#[test]
fn malformed_descriptions_are_refused_by_name() {
    let named = || ("second".to_owned(), "second_joint".to_owned());
    let nan = refused(&changed(|b| b.inertia[3] = f64::NAN));
    assert!(matches!(nan, Malformed::NotFinite { ref body, field: "inertia", .. } if body == "second"), "{nan}");
    for change in [
        (|b| b.mass = f64::INFINITY) as fn(&mut BodyDescription),
        |b| b.com[2] = f64::NAN,
        |b| b.joint.placement.rotation[0] = f64::NAN,
        |b| b.joint.placement.translation[0] = f64::NEG_INFINITY,
        |b| b.joint.kind = JointType::Prismatic { axis: [f64::NAN, 0.0, 0.0] },
        |b| b.joint.kind = JointType::Helical { axis: [0.0, 0.0, 1.0], pitch: f64::NAN },
        |b| b.joint.armature = vec![f64::NAN],
        |b| b.joint.upper = vec![f64::INFINITY],
    ] {
        assert!(matches!(refused(&changed(change)), Malformed::NotFinite { .. }));
    }
    let mut skew = changed(|_| ());
    skew.gravity[1] = f64::NAN;
    assert!(matches!(refused(&skew), Malformed::NotFinite { field: "gravity", .. }));

    let (name, joint) = named();
    assert_eq!(refused(&changed(|b| b.mass = -1.0)), Malformed::NegativeMass { body: name, mass: -1.0 });
    assert_eq!(refused(&changed(|b| b.parent = Some(7))), Malformed::Orphan { body: "second".to_owned(), parent: 7, count: 2 });
    assert!(matches!(refused(&changed(|b| b.parent = Some(1))), Malformed::Cycle { ref body } if body == "second"));
    let mut loop_of_two = changed(|_| ());
    loop_of_two.bodies[0].parent = Some(1);
    assert!(matches!(refused(&loop_of_two), Malformed::Cycle { .. }));
    assert_eq!(refused(&changed(|b| b.name = "first".to_owned())), Malformed::DuplicateName { body: "first".to_owned() });

    let long = refused(&changed(|b| b.joint.kind = JointType::Revolute { axis: [0.0, 3.0, 4.0] }));
    assert_eq!(long, Malformed::NonUnitAxis { body: "second".to_owned(), joint, length: 5.0 });
    let scaled = refused(&changed(|b| b.joint.placement.rotation[8] = 1.1));
    assert!(matches!(scaled, Malformed::NotARotation { error, .. } if (error - 0.21).abs() < 1e-12), "{scaled}");
    let mirrored = refused(&changed(|b| b.joint.placement.rotation[8] = -1.0));
    assert!(matches!(mirrored, Malformed::NotARotation { error: 2.0, .. }), "{mirrored}");

    let lists: [fn(&mut JointDescription) -> &mut Vec<f64>; 7] = [
        |j| &mut j.armature,
        |j| &mut j.damping,
        |j| &mut j.friction,
        |j| &mut j.lower,
        |j| &mut j.upper,
        |j| &mut j.velocity,
        |j| &mut j.effort,
    ];
    for (k, list) in lists.into_iter().enumerate() {
        let error = refused(&changed(|b| *list(&mut b.joint) = vec![0.5; 2]));
        assert!(matches!(error, Malformed::WrongLength { found: 2, expected: 1, kind: "revolute", .. }), "{error}");
        let negative = changed(|b| *list(&mut b.joint) = vec![-0.5]);
        // Position limits may be negative, the other lists may not.
        match k {
            3 | 4 => assert_eq!(negative.validate(), Ok(())),
            _ => assert!(matches!(refused(&negative), Malformed::Negative { value: -0.5, .. })),
        }
    }
    let crossed = refused(&changed(|b| (b.joint.lower, b.joint.upper) = (vec![1.0], vec![-1.0])));
    assert!(matches!(crossed, Malformed::CrossedLimits { lower: 1.0, upper: -1.0, .. }));
    let free = changed(|b| (b.joint.kind, b.joint.armature) = (JointType::Free, vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0]));
    assert!(matches!(refused(&free), Malformed::ArmatureOnFreeJoint { .. }));
    let mut framed = changed(|_| ());
    framed.frames.push(Frame { name: "tool".to_owned(), body: Some(2), placement: Placement::default() });
    assert_eq!(refused(&framed), Malformed::FrameOrphan { frame: "tool".to_owned(), body: 2 });
    framed.frames[0] = Frame { name: "tool".to_owned(), body: Some(0), placement: Placement::default() };
    framed.frames[0].placement.rotation[8] = 1.0 + 1e-3;
    assert!(matches!(refused(&framed), Malformed::FrameNotARotation { frame, error } if frame == "tool" && error > 1e-3));
}

#[test]
fn a_robot_that_cannot_move_is_empty() {
    assert_eq!(robot(Vec::new()).canonical(), Err(Malformed::Empty));
    assert_eq!(robot(vec![body("pedestal", None, JointType::Fixed)]).canonical(), Err(Malformed::Empty));
}

#[test]
fn unusual_bodies_are_remarked_upon() {
    let remarks = |inertia: [f64; 6]| changed(|b| b.inertia = inertia).warnings();
    assert_eq!(remarks([0.02, 0.0, 0.0, 0.02, 0.0, 0.02]), []);
    // A thin rod and a point are limits of real bodies.
    assert_eq!(remarks([0.0, 0.0, 0.0, 0.02, 0.0, 0.02]), []);
    assert_eq!(remarks([0.0; 6]), []);
    // diag(1, 1, 3) is positive definite, and still no body has it: its second moments are 1.5, 1.5, −0.5.
    match remarks([1.0, 0.0, 0.0, 1.0, 0.0, 3.0])[..] {
        [Warning::Unphysical { ref body, least, scale }] => {
            assert_eq!((body.as_str(), scale), ("second", 5.0));
            // The eigenvalue formula is good to about 1e-8 of the scale.
            assert!((least + 0.5).abs() < 5e-8, "{least}");
        }
        ref other => panic!("{other:?}"),
    }
    assert!(matches!(remarks([-0.1, 0.0, 0.0, 0.02, 0.0, 0.02])[..], [Warning::Unphysical { .. }]));
    let massless = changed(|b| (b.mass, b.inertia) = (0.0, [0.0; 6]));
    assert_eq!(massless.warnings(), [Warning::Massless { body: "second".to_owned() }]);
    assert_eq!(Model::<f64>::build(&massless).map(|model| model.warnings), Ok(massless.warnings()));
    // A fixed body without mass is only a frame.
    assert_eq!(changed(|b| (b.mass, b.joint.kind) = (0.0, JointType::Fixed)).warnings(), []);
}

#[test]
fn bodies_are_put_in_depth_first_order() {
    let bodies = vec![
        body("tip_b", Some(3), REVOLUTE),
        body("root", None, REVOLUTE),
        body("tip_a", Some(4), REVOLUTE),
        body("arm_b", Some(1), REVOLUTE),
        body("arm_a", Some(1), REVOLUTE),
        body("other", None, REVOLUTE),
    ];
    let canonical = robot(bodies).canonical().expect("a forest");
    let names: Vec<&str> = canonical.bodies.iter().map(|body| body.name.as_str()).collect();
    // Siblings keep their given order.
    assert_eq!(names, ["root", "arm_b", "tip_b", "arm_a", "tip_a", "other"]);
    let parents: Vec<Option<usize>> = canonical.bodies.iter().map(|body| body.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(1), Some(0), Some(3), None]);
    assert_eq!(canonical.canonical().as_ref(), Ok(&canonical));
}

fn skew(x: f64) -> Placement {
    let rotation = Quaternion::from_array([0.1 + x, -0.4, 0.2, 0.7]).to_rotation().to_array();
    Placement { rotation, translation: [0.3, -0.2 * x, 0.1 + x] }
}

fn inertia(body: &BodyDescription) -> RigidBodyInertia<f64> {
    RigidBodyInertia::from_com(body.mass, Vec3::from_array(body.com), Sym3::from_array(body.inertia))
}

/// Merging fixed joints keeps total mass, first moment and inertia of the composite.
#[test]
fn merging_fixed_joints_conserves_the_inertia() {
    let mut bodies = vec![
        body("base", None, JointType::Fixed),
        body("arm", Some(0), REVOLUTE),
        body("bracket", Some(1), JointType::Fixed),
        body("camera", Some(2), JointType::Fixed),
        body("tool_mount", Some(1), JointType::Fixed),
        body("finger", Some(4), REVOLUTE),
    ];
    for (k, body) in bodies.iter_mut().enumerate() {
        body.joint.placement = skew(0.2 * k as f64);
        body.mass += k as f64;
    }
    bodies[4].mass = 0.0;
    bodies[4].inertia = [0.0; 6];
    let mut given = robot(bodies);
    given.frames.push(Frame { name: "lens".to_owned(), body: Some(3), placement: skew(1.0) });
    let canonical = given.canonical().expect("a tree");
    assert_eq!(canonical.bodies.len(), 2);

    let at = |k: usize| given.bodies[k].joint.placement.to_transform();
    let camera = at(2).compose(&at(3));
    let expected = inertia(&given.bodies[1]) + inertia(&given.bodies[2]).to_parent(&at(2)) + inertia(&given.bodies[3]).to_parent(&camera);
    let found = inertia(&canonical.bodies[0]);
    // Entries are below 10 and formed by some tens of rounded operations: 1e-14 is a few ulps of them.
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-14);
    assert_eq!(found.mass, expected.mass);
    assert!(close(&found.first_moment.to_array(), &expected.first_moment.to_array()), "{found:?} {expected:?}");
    assert!(close(&found.rotational.to_array(), &expected.rotational.to_array()), "{found:?} {expected:?}");

    // Products of doubles differ from those with 32 digits by a few ulps of numbers below one.
    let same = |found: Placement, due: Transform<f64>| {
        assert!(
            close(&found.rotation, &due.rotation.to_array()) && close(&found.translation, &due.translation.to_array()),
            "{found:?} {due:?}"
        );
    };

    // The base became part of the world, and its placement part of the arm's.
    assert_eq!(canonical.bodies[0].parent, None);
    same(canonical.bodies[0].joint.placement, at(0).compose(&at(1)));
    assert_eq!(canonical.bodies[1].parent, Some(0));
    same(canonical.bodies[1].joint.placement, at(4).compose(&at(5)));

    // Each merged body leaves a frame; a frame on a merged body moves with it.
    let frame = |name: &str| canonical.frames.iter().find(|frame| frame.name == name).unwrap_or_else(|| panic!("no frame {name}"));
    assert_eq!((frame("base").body, frame("base").placement), (None, Placement::from_transform(&at(0))));
    assert_eq!((frame("camera").body, frame("lens").body), (Some(0), Some(0)));
    same(frame("camera").placement, camera);
    same(frame("lens").placement, camera.compose(&skew(1.0).to_transform()));
    assert_eq!(canonical.canonical().as_ref(), Ok(&canonical));
}

#[test]
fn merging_into_a_massless_body_keeps_the_centre_of_mass() {
    let mut bodies = vec![body("dummy", None, JointType::Free), body("trunk", Some(0), JointType::Fixed)];
    bodies[0].mass = 0.0;
    bodies[0].inertia = [0.0; 6];
    let canonical = robot(bodies.clone()).canonical().expect("a tree");
    assert_eq!(canonical.bodies.len(), 1);
    assert_eq!((canonical.bodies[0].mass, canonical.bodies[0].com), (bodies[1].mass, bodies[1].com));
    assert_eq!(canonical.warnings(), []);
}

#[test]
fn composed_joints_become_primitives_with_massless_bodies_between() {
    let bodies = vec![
        body("cart", None, JointType::Planar),
        body("fork", Some(0), JointType::Universal),
        body("ball", Some(0), JointType::Spherical),
        body("gantry", Some(0), JointType::Translation),
        body("piston", Some(3), JointType::Cylindrical { axis: [0.0, 0.6, 0.8] }),
        body("wrist", Some(3), JointType::EulerZyx),
    ];
    let model = Model::<f64>::build(&robot(bodies)).expect("a tree");
    assert_eq!(model.described, [2, 4, 5, 8, 10, 13]);
    assert_eq!((model.topology.nq(), model.topology.nv(), model.topology.bodies()), (17, 16, 14));
    assert_eq!(model.topology.joints()[5].parent, Some(2));
    assert_eq!([9, 11].map(|first| model.topology.joints()[first].parent), [Some(8); 2]);
    let masses: Vec<f64> = model.inertias.iter().map(|inertia| inertia.mass).collect();
    assert_eq!(masses, [0.0, 0.0, 2.0, 0.0, 2.0, 2.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
    assert_eq!(model.labels[..3], [Label::X, Label::Y, Label::Z]);
    assert_eq!(model.labels[0].rotation_to_described(model.placements[0].rotation), Mat3::identity());
    // The described axes of the second body are those of the first, which the compiled model calls z, x, y.
    let rotation = model.labels[1].rotation_to_described(model.placements[1].rotation);
    assert_eq!(Label::X.rotation_to_described(rotation.transpose()), Mat3::identity());
    assert_eq!(model.warnings, []);
}

/// The placement of the body of each composed joint, by hand. A quarter turn takes x to y, y to z, or z to x about the remaining axis.
#[test]
fn composed_joints_move_their_body_as_they_say() {
    let at = |kind: JointType, q: &[f64]| {
        let model = Model::<f64>::build(&robot(vec![body("only", None, kind)])).expect("a tree");
        let bodies = 0..model.topology.bodies();
        let pose = bodies.fold(Transform::identity(), |pose: Transform<f64>, i| pose.compose(&model.joint_transform(i, q)));
        Transform::new(model.labels.last().expect("a body").rotation_to_described(pose.rotation), pose.translation)
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    // The sine and cosine of a quarter turn are good to 1e-16.
    let close = |found: &[f64], expected: &[f64]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15);
    let moved = at(JointType::Translation, &[1.0, 2.0, 3.0]);
    assert_eq!(moved, Transform::new(Transform::identity().rotation, Vec3::new(1.0, 2.0, 3.0)));
    let screwed = at(JointType::Cylindrical { axis: [0.0, 0.0, 1.0] }, &[quarter, 0.75]);
    assert!(close(&screwed.rotation.to_array(), &[0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]), "{screwed:?}");
    assert!(close(&screwed.translation.to_array(), &[0.0, 0.0, 0.75]), "{screwed:?}");
    // Rz Ry = [0 −1 0; 1 0 0; 0 0 1][0 0 1; 0 1 0; −1 0 0]: in the other order it would be [0 0 1; 1 0 0; 0 1 0].
    let turned = at(JointType::EulerZyx, &[quarter, quarter, 0.0]);
    assert!(close(&turned.rotation.to_array(), &[0.0, -1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0]), "{turned:?}");
    // Ry Rx = [0 0 1; 0 1 0; −1 0 0][1 0 0; 0 0 −1; 0 1 0].
    let turned = at(JointType::EulerZyx, &[0.0, quarter, quarter]);
    assert!(close(&turned.rotation.to_array(), &[0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0]), "{turned:?}");
}
