//! Reading MJCF: what our writer writes comes back, other ways to say the same make the same robot, and every bad file is named.
//! MuJoCo's own reading of real files is compared in `python/tests/test_mjcf.py`.

use crate::support::{Change, assert_named};
use featherbench_formats::mjcf::{self, MjcfProblem};
use featherbench_formats::{OnLoss, neutral};
use featherbench_model::{Description, JointType};
use featherbench_robots::Family;
use featherbench_spatial::larger;

fn read(text: &str) -> Description {
    mjcf::import(text, "f.xml").unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// A file of one body that hangs on another.
fn two(compiler: &str, defaults: &str, upper: &str, lower: &str) -> Description {
    let inertial = r#"<inertial pos="0.1 0 -0.2" mass="2" diaginertia="0.1 0.2 0.25"/>"#;
    read(&format!(
        r#"<mujoco model="two"><compiler {compiler}/>{defaults}<worldbody><body name="upper" pos="0 0 1">{inertial}{upper}
        <body name="lower" {lower}</body></body></worldbody></mujoco>"#
    ))
}

#[test]
fn what_is_written_is_read_again() {
    for family in
        ["chain:n=5,layout=spatial", "humanoid", "quadruped", "hand", "tree:n=40,joints=revolute", "chain:n=12,layout=spatial,base=free"]
    {
        let robot = Family::parse(family).unwrap().generate().unwrap().canonical().unwrap();
        let (text, _) = mjcf::to_string(&robot, OnLoss::LeaveOut).unwrap();
        let again = read(&text);
        assert_eq!((again.nq(), again.nv(), again.gravity), (robot.nq(), robot.nv(), robot.gravity), "{family}");
        for (a, b) in again.bodies.iter().zip(&robot.bodies) {
            assert_eq!((&a.name, a.parent, a.mass, a.com, a.inertia), (&b.name, b.parent, b.mass, b.com, b.inertia), "{family}");
            assert_eq!((&a.joint.name, a.joint.kind.name()), (&b.joint.name, b.joint.kind.name()), "{family}");
            assert_eq!(a.joint.placement.translation, b.joint.placement.translation, "{family}");
            // The writer's quaternions give rotations within 8 ε (its documentation).
            let errors = a.joint.placement.rotation.iter().zip(b.joint.placement.rotation).map(|(x, y)| (x - y).abs());
            let worst = errors.fold(0.0, larger);
            assert!(worst <= 8.0 * f64::EPSILON, "{family}: {worst:e}");
        }
        assert_eq!(mjcf::to_string(&again, OnLoss::LeaveOut).unwrap().0, text, "{family}: a second trip changes nothing");
    }
}

#[test]
fn joints_of_several_parts_come_back_as_chains_of_the_same_size() {
    let robot = Family::parse("joints:base=free").unwrap().generate();
    let robot = robot.unwrap_or_else(|error| panic!("{error}")).canonical().unwrap();
    let (text, _) = mjcf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    let again = read(&text);
    let helical = robot.bodies.iter().filter(|body| matches!(body.joint.kind, JointType::Helical { .. })).count();
    assert_eq!(again.nv(), robot.nv() - helical, "MJCF has no helical joints");
    let mass = |robot: &Description| robot.bodies.iter().map(|body| body.mass).sum::<f64>();
    assert!((mass(&again) - mass(&robot)).abs() < 1e-12 * mass(&robot), "{} {}", mass(&again), mass(&robot));
}

/// The placement of the second body, whatever its orientation is given by.
#[test]
fn all_orientations_mean_the_same() {
    let inside = r#"><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#;
    let turned = |compiler: &str, orientation: &str| {
        let robot = two(compiler, "", r#"<joint name="a"/>"#, &format!(r#"pos="0 0 1" {orientation} {inside}"#));
        robot.bodies[1].joint.placement.rotation
    };
    // A quarter turn about x: y becomes z, z becomes −y.
    let due = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0];
    for (compiler, orientation) in [
        ("", r#"quat="1 1 0 0""#),
        ("", r#"quat="-3 -3 0 0""#),
        ("", r#"axisangle="2 0 0 90""#),
        (r#"angle="radian""#, r#"axisangle="1 0 0 1.5707963267948966""#),
        ("", r#"euler="90 0 0""#),
        ("", r#"xyaxes="1 0 0 0 0 5""#),
        ("", r#"xyaxes="2 0 0 1 0 3""#),
        ("", r#"zaxis="0 -1 0""#),
        (r#"eulerseq="zyx""#, r#"euler="0 0 90""#),
        // About z and then the moved x, or about x and then the fixed z.
        (r#"eulerseq="zxz""#, r#"euler="-90 0 90" quat="1 1 0 0""#),
    ] {
        let found = turned(compiler, orientation);
        assert!(found.iter().zip(due).all(|(x, y)| (x - y).abs() < 1e-15), "{compiler} {orientation}: {found:?}");
    }
    let moved = turned(r#"eulerseq="xyz""#, r#"euler="30 40 50""#);
    let fixed = turned(r#"eulerseq="ZYX""#, r#"euler="50 40 30""#);
    assert!(moved.iter().zip(fixed).all(|(x, y)| (x - y).abs() < 1e-15), "{moved:?} {fixed:?}");
    assert_eq!(turned("", r#"zaxis="0 0 -2""#), [1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0]);
}

#[test]
fn classes_give_what_elements_do_not_say() {
    let defaults = r#"<default class="all"><joint damping="1" armature="0.5" axis="0 1 0"/>
        <default class="slow"><joint damping="3"/><default class="limited"><joint range="-90 90"/></default></default></default>"#;
    let robot = two(
        "",
        defaults,
        r#"<joint name="a"/>"#,
        r#"childclass="slow"><joint name="b" class="limited"/><joint name="c" armature="0.25"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#,
    );
    let of = |name: &str| &robot.bodies.iter().find(|body| body.joint.name == name).unwrap().joint;
    assert_eq!((&of("a").damping[..], &of("a").armature[..]), (&[1.0][..], &[0.5][..]));
    assert_eq!(of("a").kind, JointType::Revolute { axis: [0.0, 1.0, 0.0] });
    assert_eq!((&of("b").damping[..], &of("b").armature[..]), (&[3.0][..], &[0.5][..]));
    assert_eq!((of("b").lower[0], of("b").upper[0]), (-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2));
    assert_eq!((&of("c").damping[..], &of("c").armature[..], of("c").lower.len()), (&[3.0][..], &[0.25][..], 0));
    let unlimited =
        two(r#"autolimits="false""#, "", r#"<joint range="-1 1"/>"#, r#"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#);
    assert!(unlimited.bodies[0].joint.lower.is_empty());
}

/// A hinge at an anchor is a hinge at the origin of a body that is moved by it.
#[test]
fn an_anchor_is_the_origin_of_the_joint() {
    let robot = two(
        "",
        "",
        r#"<joint name="a" pos="0.5 0 0"/>"#,
        r#"pos="1 0 0"><joint name="b"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#,
    );
    assert_eq!(robot.bodies[0].joint.placement.translation, [0.5, 0.0, 1.0]);
    assert_eq!(robot.bodies[0].com, [-0.4, 0.0, -0.2]);
    assert_eq!(robot.bodies[1].joint.placement.translation, [0.5, 0.0, 0.0]);
    let frame = robot.frames.iter().find(|frame| frame.name == "upper").unwrap();
    assert_eq!((frame.body, frame.placement.translation), (Some(0), [-0.5, 0.0, 0.0]));
    // A slide's anchor moves nothing.
    let slide = two("", "", r#"<joint type="slide" pos="9 9 9"/>"#, r#"pos="1 0 0"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#);
    assert_eq!((slide.bodies[0].joint.placement.translation, slide.bodies.len()), ([0.0, 0.0, 1.0], 1));
}

#[test]
fn at_its_reference_a_joint_is_where_the_file_draws_it() {
    let inside = r#"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#;
    let slide = two("", "", r#"<joint type="slide" axis="0 0 2" ref="0.25"/>"#, inside);
    assert_eq!(slide.bodies[0].joint.placement.translation, [0.0, 0.0, 0.75]);
    let hinge = two("", "", r#"<joint axis="0 0 1" ref="90"/>"#, inside);
    let due = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    assert!(hinge.bodies[0].joint.placement.rotation.iter().zip(due).all(|(x, y)| (x - y).abs() < 1e-15));
}

/// Shapes of one density, against the closed forms and against each other.
#[test]
fn shapes_have_the_masses_of_their_solids() {
    let of = |geom: &str| {
        let robot = read(&format!("<mujoco><worldbody><body><joint/>{geom}</body></worldbody></mujoco>"));
        (robot.bodies[0].mass, robot.bodies[0].com, robot.bodies[0].inertia)
    };
    let near = |(m, c, i): (f64, [f64; 3], [f64; 6]), (n, d, j): (f64, [f64; 3], [f64; 6])| {
        // Products of a few doubles, and the axes of one shape turned once.
        let close = |x: &[f64], y: &[f64], size: f64| x.iter().zip(y).all(|(x, y)| (x - y).abs() <= 1e-14 * size);
        assert!(close(&[m], &[n], n) && close(&c, &d, 1.0) && close(&i, &j, n), "{m} {c:?} {i:?}; due {n} {d:?} {j:?}");
    };
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 1e-3 * 1000.0;
    let moment = 0.4 * ball * 0.01;
    near(of(r#"<geom size="0.1" pos="1 2 3"/>"#), (ball, [1.0, 2.0, 3.0], [moment, 0.0, 0.0, moment, 0.0, moment]));
    near(of(r#"<geom type="ellipsoid" size="0.1 0.1 0.1"/>"#), of(r#"<geom type="sphere" size="0.1"/>"#));
    near(of(r#"<geom type="box" size="0.1 0.2 0.3" density="500"/>"#), (24.0, [0.0; 3], [1.04, 0.0, 0.0, 0.8, 0.0, 0.4]));
    for kind in ["capsule", "cylinder"] {
        let placed = of(&format!(r#"<geom type="{kind}" size="0.1 0.5" pos="0.5 0 0" zaxis="1 0 0" mass="2"/>"#));
        near(of(&format!(r#"<geom type="{kind}" size="0.1" fromto="0 0 0 1 0 0" mass="2"/>"#)), placed);
        near(of(&format!(r#"<geom type="{kind}" size="0.1" fromto="1 0 0 0 0 0" mass="2"/>"#)), placed);
    }
    let (halves, _, _) = of(r#"<geom type="box" size="1 1 0.5" pos="0 0 0.5"/><geom type="box" size="1 1 0.5" pos="0 0 -0.5"/>"#);
    near(
        of(r#"<geom type="box" size="1 1 1"/>"#),
        of(r#"<geom type="box" size="1 1 0.5" pos="0 0 0.5"/><geom type="box" size="1 1 0.5" pos="0 0 -0.5"/>"#),
    );
    assert_eq!(halves, 8000.0);
    // An inertial counts, and shapes do not, unless the compiler says otherwise; a shape without mass is none.
    let both = |compiler: &str| {
        let text = r#"<body><joint/><inertial pos="0 0 0" mass="7" diaginertia="1 1 1"/><geom size="0.1"/><geom type="mesh" mesh="m" mass="0"/></body>"#;
        read(&format!("<mujoco><compiler {compiler}/><worldbody>{text}</worldbody></mujoco>")).bodies[0].mass
    };
    assert_eq!(both(""), 7.0);
    assert!((both(r#"inertiafromgeom="true""#) - ball).abs() < 1e-14);
}

#[test]
fn bad_files_are_named() {
    let good = r#"<mujoco model="m">
  <compiler angle="radian"/>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="hand"><joint name="wrist"/><geom size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>"#;
    assert!(mjcf::import(good, "f.xml").is_ok());
    let changes: &[Change<'_>] = &[
        ("</mujoco>", "", &["f.xml:", "not well-formed XML"]),
        ("<mujoco model=\"m\">", "<!DOCTYPE m><mujoco model=\"m\">", &["f.xml:1:1", "document type"]),
        ("<worldbody>", "<include file=\"a.xml\"/><worldbody>", &["f.xml:3:3", "<include>", "gen mjcf"]),
        ("<body name=\"hand\">", "<frame/><body name=\"hand\">", &["f.xml:7:7", "<frame>"]),
        ("<body name=\"hand\">", "<replicate/><body name=\"hand\">", &["f.xml:7:7", "<replicate>"]),
        ("pos=\"0 0 1\"", "pos=\"0 0\"", &["f.xml:4:5", "pos=\"0 0\" of body 'arm' is not 3 numbers"]),
        ("pos=\"0 0 1\"", "pos=\"0 0 nan\"", &["f.xml:4:5", "body 'arm' is not finite"]),
        ("pos=\"0 0 1\"", "quat=\"0 0 0 0\"", &["f.xml:4:5", "body 'arm' gives no orientation"]),
        ("pos=\"0 0 1\"", "xyaxes=\"1 0 0 2 0 0\"", &["f.xml:4:5", "two are parallel"]),
        ("pos=\"0 0 1\"", "mocap=\"true\"", &["f.xml:4:5", "mocap"]),
        ("axis=\"0 1 0\"", "axis=\"0 0 0\"", &["f.xml:5:7", "axis=\"0 0 0\" of body 'arm'"]),
        ("axis=\"0 1 0\"", "type=\"screw\"", &["f.xml:5:7", "type=\"screw\"", "hinge, slide, ball, free"]),
        ("axis=\"0 1 0\"", "class=\"fast\"", &["f.xml:5:7", "class 'fast'"]),
        ("axis=\"0 1 0\"", "limited=\"maybe\"", &["f.xml:5:7", "true, false, auto"]),
        ("name=\"wrist\"", "type=\"free\"", &["f.xml:7:", "body 'hand'", "below another body"]),
        ("<joint name=\"hinge\"", "<freejoint/><joint name=\"hinge\"", &["f.xml:4:5", "beside another joint"]),
        ("name=\"wrist\"", "name=\"hinge\"", &["f.xml:", "hinge"]),
        ("name=\"hand\"", "name=\"arm\"", &["f.xml:", "arm"]),
        (" mass=\"1\"", "", &["f.xml:6:7", "<inertial> of body 'arm' has no attribute 'mass'"]),
        (" diaginertia=\"1 1 1\"", "", &["f.xml:6:7", "no attribute 'diaginertia'"]),
        ("<geom size=\"0.1\"/>", "", &["f.xml:7:", "body 'hand' moves and has no mass"]),
        ("<geom size=\"0.1\"/>", "<geom type=\"mesh\" mesh=\"m\"/>", &["f.xml:7:", "the mass of a mesh of body 'hand'"]),
        ("<geom size=\"0.1\"/>", "<geom type=\"box\" size=\"0.1\"/>", &["f.xml:7:", "the size of a box"]),
        ("<geom size=\"0.1\"/>", "<geom size=\"0.1\" type=\"capsule\" fromto=\"0 0 0 0 0 0\"/>", &["f.xml:7:", "fromto"]),
        ("angle=\"radian\"", "angle=\"grad\"", &["f.xml:2:3", "radian, degree"]),
        ("angle=\"radian\"", "eulerseq=\"xyw\"", &["f.xml:2:3", "three letters"]),
        ("angle=\"radian\"", "balanceinertia=\"true\"", &["f.xml:2:3", "balanceinertia"]),
        ("angle=\"radian\"", "settotalmass=\"3\"", &["f.xml:2:3", "settotalmass"]),
        ("angle=\"radian\"", "boundmass=\"x\"", &["f.xml:2:3", "boundmass=\"x\" of the compiler is not a number"]),
    ];
    assert_named(good, changes, |text| mjcf::import(text, "f.xml").map(|_| ()).expect_err(text).to_string());
    let error = mjcf::import("<robot/>", "f.xml").unwrap_err();
    assert!(matches!(*error.problem, MjcfProblem::NotMujoco { .. }), "{error}");
    assert!(mjcf::import("", "f.xml").unwrap_err().to_string().contains("is empty"));
    assert!(mjcf::read("no_such.xml").unwrap_err().to_string().starts_with("no_such.xml: the file cannot be read"));
}

#[test]
fn what_is_left_out_is_noted() {
    let text = r#"<mujoco>
<worldbody><body name="a" gravcomp="1"><joint name="j" stiffness="3"/><geom size="0.1"/><site/></body></worldbody>
<actuator><motor joint="j"/></actuator><sensor/>
</mujoco>"#;
    let (robot, notes) = mjcf::import(text, "folder/name.xml").unwrap();
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "line 2: the gravity compensation of body 'a' is left out",
            "line 2: the spring of joint 'j' is left out",
            "line 3: <actuator> is left out: elements 1",
        ]
    );
    assert_eq!(robot.name, "name");
    assert!(neutral::to_string(&robot).is_ok());
    let weightless = read(&text.replacen("<worldbody>", r#"<option gravity="0 0 -1"><flag gravity="disable"/></option><worldbody>"#, 1));
    assert_eq!(weightless.gravity, [0.0; 3]);
}

/// Nesting uses no stack.
#[test]
fn a_deep_chain_is_read() {
    let n = 20_000;
    let body = r#"<body pos="0 0 1"><joint/><geom size="0.1"/>"#;
    let text = format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", body.repeat(n), "</body>".repeat(n));
    // The parser refuses what is nested too deeply for it, by name; what it takes is read whole.
    match mjcf::import(&text, "deep.xml") {
        Ok((robot, _)) => assert_eq!(robot.nv(), n),
        Err(error) => assert!(matches!(*error.problem, MjcfProblem::Xml { .. }), "{error}"),
    }
    let (n, text) = (500, format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", body.repeat(500), "</body>".repeat(500)));
    assert_eq!(read(&text).nv(), n);
}

/// Writes files into a new folder.
fn files(of: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in of {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

#[test]
fn included_files_take_the_place_of_the_include() {
    let arm = |leaf: &str| format!("<body name='arm'><joint name='j'/><geom size='0.1'/>{leaf}</body>");
    let leaf = "<body name='leaf'><joint name='k'/><geom size='0.2'/></body>";
    let settings = "<compiler angle='radian'/><default><geom density='500'/></default>";
    let whole = read(&format!("<mujoco model='m'>{settings}<worldbody>{}{leaf}</worldbody></mujoco>", arm("")));
    // Part by part: in the root and in a body, a file that includes another, in the folder of the first and in that of the naming one.
    let folder = files(&[
        (
            "main.xml",
            &format!(
                "<mujoco model='m'><include file='sub/settings.xml'/><worldbody>{}<include file=\"sub/leaf.xml\"/></worldbody></mujoco>",
                arm("")
            ),
        ),
        ("sub/settings.xml", "\u{feff}<?xml version='1.0'?><anything><compiler angle='radian'/><include file='sub/deep.xml'/></anything>"),
        ("sub/deep.xml", "<a><include file='density.xml'/></a>"),
        ("sub/density.xml", "<a><default><geom density='500'/></default></a>"),
        ("sub/leaf.xml", &format!("<a><!-- a leaf -->{leaf}</a>")),
    ]);
    assert_eq!(mjcf::read(folder.path().join("main.xml")).unwrap().0, whole);
    // The folder of the first file comes first.
    std::fs::write(folder.path().join("density.xml"), "<a><default><geom density='1'/></default></a>").unwrap();
    let other = mjcf::read(folder.path().join("main.xml")).unwrap().0;
    assert!((other.bodies[0].mass * 500.0 - whole.bodies[0].mass).abs() < 1e-12, "a product of densities that are exact");
}

#[test]
fn bad_includes_are_named_with_their_file() {
    let body = "<body name='leaf'><joint name='k'/><geom size='0.2'/></body>";
    let cases: &[(&str, &str, &str)] = &[
        ("<mujoco>\n <include file='no.xml'/></mujoco>", "", "main.xml:2:2: the included file "),
        ("<mujoco>\n <include/></mujoco>", "", "main.xml:2:2: <include> of the file has no attribute 'file'"),
        ("<mujoco>\n <include file='main.xml'/></mujoco>", "", "main.xml:2:2: main.xml is included already"),
        ("<mujoco>\n <include file='a.xml'><size/></include></mujoco>", "<a><b/></a>", "main.xml:2:2: <include> has elements of its own"),
        ("<mujoco><include file='a.xml'/>\n<include file='a.xml'/></mujoco>", "<a><b/></a>", "main.xml:2:1: a.xml is included already"),
        ("<mujoco><include file='a.xml'/></mujoco>", "\n<a></a>", "a.xml:2:1: this file is included, and its root has no elements"),
        ("<mujoco><include file='a.xml'/></mujoco>", "<a>\n<b></a>", "a.xml:2:4: this is not well-formed XML"),
        ("<mujoco><include file='a.xml'/></mujoco>", "<!DOCTYPE a><a><b/></a>", "a.xml:1:1: the file declares a document type"),
        ("<mujoco><include file='a.xml'/></mujoco>", "", "main.xml:1:9: the included file "),
        ("<mujoco><include file='a.xml'/></mujoco>", "<a>\n <include file='a.xml'/></a>", "a.xml:2:2: a.xml is included already"),
        (
            "<mujoco><worldbody><include file='a.xml'/></worldbody></mujoco>",
            "<a>\n\n  <body name='b'><joint axis='0 0 0'/><geom size='1'/></body></a>",
            "a.xml:3:18: axis=\"0 0 0\" of body 'b'",
        ),
    ];
    for (main, part, due) in cases {
        let folder = files(&[("main.xml", main), ("a.xml", part)]);
        let error = mjcf::read(folder.path().join("main.xml")).expect_err(main).to_string();
        let told = error.strip_prefix(&format!("{}/", folder.path().display())).unwrap_or_else(|| panic!("{error}"));
        assert!(told.starts_with(due), "{told}; due {due}");
    }
    // What is left out of an included file says which.
    let folder = files(&[
        ("main.xml", &format!("<mujoco><include file='a.xml'/>\n<worldbody>{body}</worldbody><sensor><clock/></sensor></mujoco>")),
        ("a.xml", "<a>\n\n<actuator><motor joint='k'/></actuator></a>"),
    ]);
    let notes = mjcf::read(folder.path().join("main.xml")).unwrap().1;
    assert_eq!((notes[0].line, notes[1].line), (3, 2));
    assert!(notes[0].text.ends_with("a.xml)") && !notes[1].text.contains("main.xml"), "{notes:?}");
    // A text is in no folder.
    let error = mjcf::import("<mujoco><include file='a.xml'/></mujoco>", "f.xml").unwrap_err();
    assert!(error.to_string().starts_with("f.xml:1:9: <include> is not read here"), "{error}");
}
