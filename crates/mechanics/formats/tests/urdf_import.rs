//! URDF: what a good file becomes.

use featherbench_formats::urdf::{self, Base, Options};
use featherbench_model::{Description, JointType, Model, Placement, Warning};
use featherbench_robots::{Chain, Family, Layout};
use featherbench_spatial::{Mat3, Sym3, Transform, Vec3};
use std::fmt::Write;

fn import(text: &str, options: Options) -> (Description, Vec<String>) {
    let (robot, notes) = urdf::import(text, "robot.urdf", &options).unwrap_or_else(|error| panic!("{error}"));
    (robot, notes.iter().map(ToString::to_string).collect())
}

fn floating() -> Options {
    Options { base: Base::Floating, ..Options::default() }
}

const INERTIAL: &str =
    r#"<inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.1"/></inertial>"#;

/// A robot of a base and one link on this joint.
fn one_joint(kind: &str, inside: &str) -> String {
    format!(
        r#"<robot name="r"><link name="base"/><link name="tip">{INERTIAL}</link>
<joint name="j" type="{kind}"><parent link="base"/><child link="tip"/>{inside}</joint></robot>"#
    )
}

/// A description without turned frames, written as URDF.
fn write_urdf(robot: &Description) -> String {
    let mut text = format!("<robot name=\"{}\">\n<link name=\"world\"/>\n", robot.name);
    for body in &robot.bodies {
        let ([x, y, z], [xx, xy, xz, yy, yz, zz]) = (body.com, body.inertia);
        let inertia = format!(r#"<inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/>"#);
        let inertial = format!(r#"<inertial><origin xyz="{x} {y} {z}"/><mass value="{}"/>{inertia}</inertial>"#, body.mass);
        let parent = body.parent.map_or("world", |parent| &robot.bodies[parent].name);
        let ([tx, ty, tz], [ax, ay, az]) = (body.joint.placement.translation, body.joint.kind.axis().unwrap_or_default());
        let joint = format!(
            r#"<joint name="{}" type="continuous"><origin xyz="{tx} {ty} {tz}"/><parent link="{parent}"/><child link="{}"/><axis xyz="{ax} {ay} {az}"/></joint>"#,
            body.joint.name, body.name
        );
        writeln!(text, "<link name=\"{}\">{inertial}</link>\n{joint}", body.name).expect("strings grow");
    }
    text + "</robot>"
}

#[test]
fn a_chain_is_read_to_the_bit() {
    let chain = Chain { n: 8, layout: Layout::Spatial, tip_scale: 3.7, base_offset: 0.1, ..Chain::default() };
    let expected = Family::Chain(chain).generate().expect("in range");
    let (robot, notes) = import(&write_urdf(&expected), Options::default());
    assert_eq!(robot.bodies, expected.bodies);
    assert_eq!(robot.name, expected.name);
    assert_eq!(robot.gravity, [0.0, 0.0, -9.81]);
    assert_eq!(notes, Vec::<String>::new());
    let names: Vec<_> = robot.frames.iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(names, ["world"], "the fixed root is a frame of the world");
}

#[test]
fn rotations_turn_about_z_then_y_then_x() {
    let turned = one_joint(
        "revolute",
        r#"<origin rpy="0.4 -0.7 1.9" xyz="1 2 3"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="6"/>"#,
    );
    let (robot, _) = import(&turned, Options::default());
    let about = |axis, angle: f64| Transform::axis_rotation(Vec3::from_array(axis), angle.sin(), angle.cos());
    let expected = about([0.0, 0.0, 1.0], 1.9) * about([0.0, 1.0, 0.0], -0.7) * about([1.0, 0.0, 0.0], 0.4);
    let joint = &robot.bodies[0].joint;
    // Three rounded products each: two ulps of one.
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 4.5e-16);
    assert!(close(&joint.placement.rotation, &expected.to_array()), "{:?} {expected:?}", joint.placement.rotation);
    assert_eq!(joint.placement.translation, [1.0, 2.0, 3.0]);
    assert_eq!(
        (&joint.lower[..], &joint.upper[..], &joint.effort[..], &joint.velocity[..]),
        (&[-1.0][..], &[1.0][..], &[5.0][..], &[6.0][..])
    );

    // The inertial frame rotates the tensor into link axes, and keeps the centre.
    let inertial = turned.replace(r#"<origin xyz="0.1 0.2 0.3"/>"#, r#"<origin xyz="0.1 0.2 0.3" rpy="0.4 -0.7 1.9"/>"#);
    let body = &import(&inertial, Options::default()).0.bodies[0];
    let tensor = Sym3::from_array([0.3, 0.0, 0.0, 0.2, 0.0, 0.1]).rotate(expected);
    assert!(close(&body.inertia, &tensor.to_array()), "{:?} {tensor:?}", body.inertia);
    assert_eq!((body.mass, body.com), (2.0, [0.1, 0.2, 0.3]));
}

#[test]
fn joint_types_are_mapped() {
    let kind = |text: &str| import(text, Options::default()).0.bodies[0].joint.kind;
    assert_eq!(kind(&one_joint("continuous", "")), JointType::Revolute { axis: [1.0, 0.0, 0.0] }, "the default axis is x");
    assert_eq!(kind(&one_joint("prismatic", r#"<axis xyz="0 -1 0"/>"#)), JointType::Prismatic { axis: [0.0, -1.0, 0.0] });
    assert_eq!(kind(&one_joint("floating", "")), JointType::Free);
    assert_eq!(kind(&one_joint("planar", r#"<axis xyz="0 0 1"/>"#)), JointType::Planar);
    let (robot, notes) = import(&one_joint("revolute", r#"<axis xyz="3 0 4"/><limit effort="1" velocity="inf"/>"#), Options::default());
    assert_eq!(robot.bodies[0].joint.kind, JointType::Revolute { axis: [0.6, 0.0, 0.8] });
    assert_eq!(
        notes,
        ["line 2: the axis of joint 'j' has length 5; it is normalised", "line 2: joint 'j' gives no position limits and has none"]
    );
    // romeo's axis: ½·(4.37114e-8)² too long
    let text = one_joint("continuous", r#"<axis xyz="0 -1 -4.37114e-08"/>"#);
    let (near, notes) = urdf::import(&text, "robot.urdf", &Options::default()).expect("a robot");
    let JointType::Revolute { axis } = near.bodies[0].joint.kind else { panic!("revolute") };
    assert_eq!(axis, [0.0, -0.999_999_999_999_999, -4.371_139_999_999_996e-8]);
    let [note] = &notes[..] else { panic!("{notes:?}") };
    assert!(matches!(note.warning, Some(Warning::Normalised { by, .. }) if (by - 9.5534e-16).abs() < 1e-19), "{note:?}");
    assert!(note.text.contains("the axis of joint 'j' misses unit length by 9.55"), "{note}");
    let joint = &robot.bodies[0].joint;
    assert_eq!((joint.effort.len(), joint.velocity.len(), joint.lower.len()), (1, 0, 0));
    let (robot, _) = import(
        &one_joint("revolute", r#"<limit upper="2" effort="1" velocity="1"/><dynamics damping="0.5" friction="0.25"/>"#),
        Options::default(),
    );
    let joint = &robot.bodies[0].joint;
    assert_eq!([&joint.lower, &joint.upper, &joint.damping, &joint.friction], [&[0.0], &[2.0], &[0.5], &[0.25]]);
}

/// A planar joint moves in the plane normal to its axis: the origin stays in that plane, and at q = 0 the link is at its origin.
#[test]
fn planar_joints_move_normal_to_their_axis() {
    let axis = Vec3::from_array([0.6, 0.0, 0.8]);
    let (robot, _) = import(&one_joint("planar", r#"<origin xyz="1 2 3"/><axis xyz="0.6 0 0.8"/>"#), Options::default());
    assert_eq!((robot.bodies.len(), robot.bodies[0].joint.kind, robot.bodies[0].mass), (1, JointType::Planar, 2.0));
    let model = Model::<f64>::build(&robot).expect("a tree");
    let frame = robot.frames.iter().find(|frame| frame.name == "tip").expect("the link is a frame");
    let place = |q: &[f64; 3]| {
        let body = (0..3).fold(Transform::identity(), |x, i| x.compose(&model.joint_transform(i, q)));
        body.compose(&frame.placement.to_transform())
    };
    let close = |a: Vec3<f64>, b: Vec3<f64>| (a - b).norm() < 1e-15 * 8.0; // a few ulps of numbers up to 4
    let rest = place(&[0.0; 3]);
    assert!(close(rest.translation, Vec3::new(1.0, 2.0, 3.0)));
    assert!((0..9).all(|k| (rest.rotation.to_array()[k] - Mat3::<f64>::identity().to_array()[k]).abs() < 1e-15));
    let moved = place(&[0.5, -1.25, 0.7]);
    let step = moved.translation - rest.translation;
    assert!(step.dot(axis).abs() < 1e-15 && (step.norm() - 0.5_f64.hypot(1.25)).abs() < 1e-15, "{step:?}");
    assert!(close(moved.rotation * axis, axis), "it turns about its axis");
}

#[test]
fn the_root_stands_or_floats() {
    let text = format!(
        r#"<robot name="r"><link name="dummy"/><link name="trunk">{INERTIAL}</link><link name="leg">{INERTIAL}</link>
<joint name="weld" type="fixed"><parent link="dummy"/><child link="trunk"/><origin xyz="0 0 1"/></joint>
<joint name="hip" type="continuous"><parent link="trunk"/><child link="leg"/></joint></robot>"#
    );
    let (fixed, _) = import(&text, Options::default());
    assert_eq!((fixed.nv(), fixed.bodies.len()), (1, 1));
    assert_eq!(fixed.bodies[0].joint.placement.translation, [0.0, 0.0, 1.0]);
    let (floating, _) = import(&text, floating());
    assert_eq!((floating.nv(), floating.bodies.len()), (7, 2));
    let root = &floating.bodies[0];
    assert_eq!((root.name.as_str(), root.joint.name.as_str(), root.joint.kind), ("dummy", "root_joint", JointType::Free));
    assert_eq!((root.mass, root.com), (2.0, [0.1, 0.2, 1.3]), "the dummy takes over the trunk");
    assert_eq!(floating.bodies[1].name, "leg");
}

/// A file whose robot floats on a link without inertia gets one floating base, with either option.
#[test]
fn a_base_that_floats_already_floats_once() {
    let text = one_joint("floating", r#"<origin xyz="0 0 1"/>"#);
    let (fixed, _) = import(&text, Options::default());
    let (robot, notes) = import(&text, floating());
    assert_eq!(robot, fixed);
    assert_eq!((robot.nv(), robot.bodies[0].joint.name.as_str()), (6, "j"));
    assert_eq!(notes, ["line 2: link 'base' has no inertia and carries the robot on the floating joint 'j': that joint is the base's"]);
    // A root with inertia gets its own floating base; the `floating` joint on it stays.
    let own = text.replace(r#"<link name="base"/>"#, &format!(r#"<link name="base">{INERTIAL}</link>"#));
    assert_eq!(import(&own, floating()).0.nv(), 12);
}

/// The declaration of xacro's namespace stays in expanded files.
#[test]
fn expanded_xacro_and_names_of_any_script_are_read() {
    let text =
        one_joint("continuous", "").replace("<robot ", r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro" "#).replace("tip", "Hüfte 左");
    assert_eq!(import(&text, Options::default()).0.bodies[0].name, "Hüfte 左");
}

#[test]
fn siblings_keep_the_order_of_their_joints() {
    let link = |name: &str| format!(r#"<link name="{name}">{INERTIAL}</link>"#);
    let joint = |name: &str, parent: &str, child: &str| {
        format!(r#"<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/></joint>"#)
    };
    let text = format!(
        "<robot name='r'>{}{}{}{}{}{}{}{}</robot>",
        joint("z", "base", "first"),
        link("second"),
        link("tip"),
        joint("m", "first", "tip"),
        joint("a", "base", "second"),
        link("first"),
        link("base"),
        ""
    );
    let (robot, _) = import(&text, Options::default());
    let names: Vec<_> = robot.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["first", "tip", "second"]);
    assert_eq!(robot.canonical().as_ref(), Ok(&robot), "the import is canonical");
}

#[test]
fn what_is_left_out_is_noted() {
    let text = one_joint("continuous", r#"<safety_controller k_velocity="1"/><mimic joint="other"/><calibration rising="0"/>"#)
        .replace(
            "</inertial>",
            r#"</inertial><visual><geometry><mesh filename="package://no/such.dae"/></geometry></visual><collision/><collision/>"#,
        )
        .replace("</robot>", "<gazebo/><transmission/>\n<gazebo reference='tip'/></robot>");
    let (_, notes) = import(&text, Options { independent_mimics: true, ..Options::default() });
    let expected = [
        "line 1: <visual> in <link> is not read",
        "line 1: <collision> in <link> is not read (2 times)",
        "line 2: <safety_controller> in <joint> is not read",
        "line 2: joint 'j' mimics 'other' and is read as a joint of its own",
        "line 2: joint 'j' mimics 'other', which is not there",
        "line 2: <calibration> in <joint> is not read",
        "line 2: <gazebo> is not read (2 times)",
        "line 2: <transmission> is not read",
    ];
    assert_eq!(notes, expected);
}

/// Another parser (urdf-rs) gets the same numbers.
#[test]
fn a_second_reader_agrees() {
    let text = format!(
        r#"<?xml version="1.0"?><robot name="two"><!-- a comment --><link name="base">{INERTIAL}</link><link name="arm">{INERTIAL}</link><link name="hand">{INERTIAL}</link>
<joint name="a" type="revolute"><origin xyz="0.125 -1e-3 .5" rpy="0 0 0"/><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1.5" upper="2.25" effort="30" velocity="4"/><dynamics damping="0.1" friction="0.2"/></joint>
<joint name="b" type="prismatic"><origin xyz="1 2 3"/><parent link="arm"/><child link="hand"/><axis xyz="0 0 -1"/><limit lower="0" upper="0.25" effort="30" velocity="4"/></joint></robot>"#
    );
    let theirs = urdf_rs::read_from_string(&text).expect("urdf-rs reads it");
    let (ours, _) = import(&text, Options::default());
    for (body, (link, joint)) in ours.bodies.iter().zip(theirs.links[1..].iter().zip(&theirs.joints)) {
        let inertial = &link.inertial;
        assert_eq!((&body.name, body.mass, body.com), (&link.name, inertial.mass.value, *inertial.origin.xyz));
        let i = &inertial.inertia;
        assert_eq!(body.inertia, [i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz]);
        assert_eq!(
            (body.joint.placement, body.joint.kind.axis()),
            (Placement { translation: *joint.origin.xyz, ..Placement::default() }, Some(*joint.axis.xyz))
        );
        assert_eq!((body.joint.lower[0], body.joint.upper[0]), (joint.limit.lower, joint.limit.upper));
        assert_eq!((body.joint.effort[0], body.joint.velocity[0]), (joint.limit.effort, joint.limit.velocity));
        assert_eq!(body.joint.damping.first().copied(), joint.dynamics.as_ref().map(|dynamics| dynamics.damping));
    }
}

/// Joints that mimic a missing joint, or each other, are noted: engines leave them out without a message.
#[test]
fn mimics_that_nothing_drives_are_noted() {
    let joint = |name: &str, parent: &str, child: &str, of: &str| {
        format!(
            r#"<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/><mimic joint="{of}"/></joint>"#
        )
    };
    let text = |of: [&str; 3]| {
        let inertial = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;
        let links: String = ["a", "b", "c"].map(|name| format!(r#"<link name="{name}">{inertial}</link>"#)).concat();
        let joints = joint("i", "w", "a", of[0]) + &joint("j", "a", "b", of[1]) + &joint("k", "b", "c", of[2]);
        format!(r#"<robot name="r"><link name="w"/>{links}{joints}</robot>"#)
    };
    let circles = |of: [&str; 3]| -> Vec<String> {
        let (_, notes) = import(&text(of), Options { independent_mimics: true, ..Options::default() });
        let told = notes.into_iter().filter(|note| !note.contains("joint of its own"));
        told.map(|note| note.split_once(": ").unwrap().1.to_owned()).collect()
    };
    assert_eq!(circles(["k", "i", "j"]), ["the joints 'i' → 'k' → 'j' → 'i' mimic each other in a circle: nothing drives them"]);
    assert_eq!(circles(["j", "j", "j"]), ["the joints 'j' → 'j' mimic each other in a circle: nothing drives them"]);
    assert_eq!(circles(["nowhere", "i", "i"]), ["joint 'i' mimics 'nowhere', which is not there"]);
}
