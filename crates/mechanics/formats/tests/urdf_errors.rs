//! URDF: every bad file gives an error that names the position and the element.

use crate::share::one_of;
use crate::support::{Change, assert_named, edited, edits};
use featherbench_formats::urdf::{self, Base, Options, UrdfProblem};
use featherbench_robots::Random;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const GOOD: &str = r#"<?xml version="1.0"?>
<robot name="r">
  <link name="base"/>
  <link name="arm">
    <inertial>
      <origin xyz="0.5 0 0" rpy="0 0 0"/>
      <mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.08" iyz="0" izz="0.08"/>
    </inertial>
  </link>
  <link name="hand">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 1"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="5"/>
    <dynamics damping="0.1"/>
  </joint>
  <joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/></joint>
</robot>
"#;

fn refused(text: &str, options: &Options) -> String {
    urdf::import(text, "f.urdf", options).map(|_| ()).expect_err(text).to_string()
}

#[test]
fn bad_files_are_named() {
    assert!(urdf::import(GOOD, "f.urdf", &Options::default()).is_ok());
    let changes: &[Change<'_>] = &[
        // XML
        ("</robot>", "", &["f.urdf:", "not well-formed XML"]),
        ("<link name=\"base\"/>", "<link name=\"base\">", &["f.urdf:21:1", "not well-formed XML", "robot"]),
        ("name=\"base\"", "name=base", &["f.urdf:3:14", "not well-formed XML"]),
        ("name=\"base\"", "name=\"base\" name=\"other\"", &["f.urdf:3:", "name"]),
        ("<robot name=\"r\">", "<!DOCTYPE robot [<!ENTITY a \"b\">]><robot name=\"r\">", &["f.urdf:2:1", "document type"]),
        ("name=\"base\"", "name=\"&boom;\"", &["f.urdf:3:", "boom"]),
        (
            "<robot name=\"r\">",
            "<robot name=\"r\"><xacro:include filename=\"x\"/>",
            &["f.urdf:2:", "this is a xacro file", "expand it first: xacro"],
        ),
        (
            "<robot name=\"r\">",
            "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:property name=\"m\" value=\"1\"/>",
            &["f.urdf:2:", "it has <xacro:property>", "expand it first"],
        ),
        ("<mass value=\"1\"/>", "<mass value=\"${m}\"/>", &["f.urdf:7:7: this is a xacro file (it has value=\"${m}\")"]),
        (
            "<mass value=\"1\"/>",
            "<mass value=\"1,5\"/>",
            &["f.urdf:7:7: value=\"1,5\" of link 'arm' is not a number (decimals have a point"],
        ),
        ("xyz=\"0.5 0 0\"", "xyz=\"0,5 0 0\"", &["f.urdf:6:7: xyz=\"0,5 0 0\" of link 'arm' is not three numbers (decimals have a point"]),
        // names and tree
        ("<link name=\"base\"/>", "<link/>", &["f.urdf:3:3: <link> of the robot has no attribute 'name'"]),
        ("name=\"hand\"", "name=\"arm\"", &["f.urdf:11:3: two links are named 'arm'"]),
        ("name=\"wrist\"", "name=\"shoulder\"", &["f.urdf:20:3: two joints are named 'shoulder'"]),
        ("<parent link=\"base\"/>", "<parent link=\"bse\"/>", &["f.urdf:14:3: joint 'shoulder' names 'bse' as its parent"]),
        ("<child link=\"hand\"/>", "<child link=\"finger\"/>", &["f.urdf:20:3: joint 'wrist' names 'finger' as its child"]),
        (
            "<child link=\"hand\"/>",
            "<child link=\"arm\"/>",
            &["f.urdf:20:3: link 'arm' is the child of two joints, 'shoulder' and 'wrist'"],
        ),
        ("<parent link=\"base\"/>", "<parent link=\"hand\"/>", &["f.urdf:", "return to itself", "cut the cycle"]),
        (
            "<parent link=\"base\"/>",
            "<parent link=\"arm\"/>",
            &["f.urdf:14:3: the parents of link 'arm' return to itself (joint 'shoulder')"],
        ),
        (
            "<link name=\"base\"/>",
            "<link name=\"base\"/><link name=\"lost\"/>",
            &["links 'base' and 'lost' have no parent", "connected to nothing"],
        ),
        (
            "<joint name=\"wrist\" type=\"fixed\"><parent link=\"arm\"/><child link=\"hand\"/></joint>",
            "",
            &["f.urdf:11:3: links 'base' and 'hand' have no parent"],
        ),
        ("<parent link=\"base\"/>", "", &["f.urdf:14:3: joint 'shoulder' has no <parent>"]),
        ("<parent link=\"base\"/>", "<parent/>", &["f.urdf:15:5: <parent> of joint 'shoulder' has no attribute 'link'"]),
        ("<child link=\"hand\"/>", "<child link=\"hand\"/><child link=\"arm\"/>", &["joint 'wrist' has more than one <child>"]),
        // joints
        ("type=\"revolute\"", "type=\"rotary\"", &["f.urdf:14:3: joint 'shoulder' has the unknown type 'rotary'"]),
        (" type=\"revolute\"", "", &["<joint> of joint 'shoulder' has no attribute 'type'"]),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", &["f.urdf:16:5: joint 'shoulder' has the axis 0 0 0"]),
        ("<axis xyz=\"0 1 0\"/>", "<axis/>", &["f.urdf:16:5: <axis> of joint 'shoulder' has no attribute 'xyz'"]),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 x 0\"/>", &["xyz=\"0 1 x 0\" of joint 'shoulder' is not three numbers"]),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1\"/>", &["xyz=\"0 1\" of joint 'shoulder' is not three numbers"]),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 nan 0\"/>", &["f.urdf:16:5: xyz=\"0 nan 0\" of joint 'shoulder' is not finite"]),
        (
            "<axis xyz=\"0 1 0\"/>",
            "<mimic joint=\"other\"/>",
            &["f.urdf:16:5: joint 'shoulder' mimics joint 'other', which is not there; remove its <mimic>"],
        ),
        ("<origin xyz=\"0 0 1\"/>", "<origin quat_xyzw=\"0 0 1\"/>", &["f.urdf:15:45: quat_xyzw=\"0 0 1\" of joint 'shoulder'"]),
        ("lower=\"-1\"", "lower=\"low\"", &["f.urdf:17:5: lower=\"low\" of joint 'shoulder' is not a number"]),
        ("lower=\"-1\"", "lower=\"2\"", &["f.urdf:14:3: body 'arm': joint 'shoulder' has lower limit 2 above upper limit 1"]),
        ("effort=\"10\"", "effort=\"-10\"", &["f.urdf:14:3", "effort of joint 'shoulder' is negative (-10)"]),
        ("damping=\"0.1\"", "damping=\"inf\"", &["f.urdf:18:5: damping=\"inf\" of joint 'shoulder' is not finite"]),
        // inertia
        ("<mass value=\"1\"/>", "<mass value=\"-1\"/>", &["f.urdf:7:7: link 'arm' has the mass -1 kg"]),
        ("<mass value=\"1\"/>", "<mass value=\"NaN\"/>", &["f.urdf:7:7: value=\"NaN\" of link 'arm' is not finite"]),
        ("<mass value=\"1\"/>", "<mass value=\"1 kg\"/>", &["value=\"1 kg\" of link 'arm' is not a number"]),
        ("<mass value=\"1\"/>", "<mass value=\"\"/>", &["value=\"\" of link 'arm' is not a number"]),
        ("<mass value=\"1\"/>", "", &["f.urdf:5:5: link 'arm' has no <mass>"]),
        (" iyz=\"0\" izz=\"0.08\"", "", &["f.urdf:8:7: <inertia> of link 'arm' has no attribute 'iyz'"]),
        ("<link name=\"base\"/>", "", &["joint 'shoulder' names 'base' as its parent"]),
    ];
    assert_named(GOOD, changes, |text| refused(text, &Options::default()));
    let plain: &[(&str, &str)] = &[
        ("", "f.urdf: the file is empty"),
        (" \n\t", "f.urdf: the file is empty"),
        ("hello", "not well-formed XML"),
        ("<rowboat/>", "f.urdf:1:1: the root element is <rowboat>, not <robot>"),
        ("<mujoco/>", "f.urdf:1:1: this is an MJCF file, not URDF"),
        ("<COLLADA xmlns='x' version='1.4.1'/>", "f.urdf:1:1: this is a COLLADA mesh, not URDF"),
        ("solid part\n facet normal 0 0 1\n", "f.urdf:1:1: this is an STL mesh, not URDF"),
        ("# Blender\no Cube\nv 1 1 1\n", "f.urdf:1:1: this is an OBJ mesh, not URDF"),
        ("{\"format\":1}", "f.urdf:1:1: this is JSON, not URDF"),
        ("<robot/>", "f.urdf:1:1: the robot has no <link>"),
        ("<robot><link name='a'/></robot>", "no moving body"),
        ("<robot>\u{1}</robot>", "not well-formed XML"),
    ];
    for (text, part) in plain {
        let error = refused(text, &Options::default());
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn moving_links_need_mass() {
    let bare = GOOD.replace("<inertial>", "<visual>").replace("</inertial>", "</visual>");
    let error = refused(&bare, &Options::default());
    assert!(
        error.starts_with("f.urdf:4:3: link 'arm' moves (joint 'shoulder') but has no <inertial>, nor has anything fixed to it mass"),
        "{error}"
    );
    let zero = GOOD.replace("mass value=\"1\"", "mass value=\"0\"").replace("mass value=\"0.5\"", "mass value=\"0\"");
    assert!(refused(&zero, &Options::default()).contains("link 'arm' moves (joint 'shoulder') but has no mass"));
    // The mass of a link that is fixed to it counts.
    let hand_only = GOOD.replacen("<inertial>", "<visual>", 1).replacen("</inertial>", "</visual>", 1);
    let (robot, _) = urdf::import(&hand_only, "f.urdf", &Options::default()).expect("the hand has mass");
    assert_eq!(robot.bodies[0].mass, 0.5);
    // Only on request.
    let (robot, notes) = urdf::import(&bare, "f.urdf", &Options { allow_massless: true, ..Options::default() }).expect("allowed");
    assert_eq!(robot.warnings().len(), 1);
    assert!(notes.iter().any(|note| note.to_string() == "line 4: link 'arm' moves and has no mass"), "{notes:?}");
    // A massless root that floats moves too.
    let error = refused(GOOD, &Options { base: Base::Floating, ..Options::default() });
    assert!(error.ends_with("(or import it with a fixed base)"), "{error}");
    assert!(error.contains("link 'base' moves (joint 'root_joint') but has no <inertial>"), "{error}");
}

#[test]
fn size_depth_and_entities_are_bounded() {
    let big = format!("<robot>{}</robot>", " ".repeat(urdf::LIMIT));
    let error = urdf::import(&big, "big.urdf", &Options::default()).expect_err("too big");
    assert!(matches!(*error.problem, UrdfProblem::Text(_)) && error.to_string().contains("is larger than 10485760 bytes"), "{error}");

    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(900_000), "</a>".repeat(900_000));
    assert!(refused(&deep, &Options::default()).contains("no <link>"), "deep nesting costs no stack");
    let unclosed = "<a>".repeat(1_500_000);
    assert!(refused(&unclosed, &Options::default()).contains("not well-formed XML"));
    let wide = format!("<robot>{}</robot>", "<a/>".repeat(1_500_000));
    assert!(refused(&wide, &Options::default()).contains("odes"), "too many nodes");

    let laughs = (1..10).fold(String::from("<!ENTITY l0 \"ha\">"), |text, k| {
        let previous = format!("&l{};", k - 1).repeat(10);
        format!("{text}<!ENTITY l{k} \"{previous}\">")
    });
    let error = refused(&format!("<!DOCTYPE r [{laughs}]><robot name=\"&l9;\"/>"), &Options::default());
    assert!(error.contains("document type"), "{error}");

    // Ten thousand links in a chain: nothing recurses.
    let chain: String = (1..10_000)
        .map(|k| {
            format!("<link name='l{k}'/><joint name='j{k}' type='continuous'><parent link='l{}'/><child link='l{k}'/></joint>\n", k - 1)
        })
        .collect();
    let (robot, _) = urdf::import(
        &format!("<robot><link name='l0'/>{chain}</robot>"),
        "chain.urdf",
        &Options { allow_massless: true, ..Options::default() },
    )
    .expect("long, but a tree");
    assert_eq!(robot.depth(), 9_999);
}

#[test]
fn files_that_are_no_text_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("robot.urdf");
    let read = || urdf::read(&path, &Options::default()).map(|_| ()).map_err(|error| error.to_string());
    assert!(read().is_err_and(|error| error.contains("robot.urdf: the file cannot be read")));
    std::fs::write(&path, b"<robot>\xff\xfe</robot>").expect("writable");
    assert!(read().is_err_and(|error| error.contains("is not UTF-8 text (byte 7")));
    std::fs::write(&path, "").expect("writable");
    assert!(read().is_err_and(|error| error.contains("is empty")));
    std::fs::write(&path, GOOD).expect("writable");
    assert_eq!(read(), Ok(()));
    assert!(urdf::read(folder.path(), &Options::default()).is_err(), "a folder is no file");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A file with characters changed, removed or doubled is imported or gives an error, never a panic. The result is canonical.
    #[test]
    fn mutated_files_never_panic(edits in edits(6), allow in any::<[bool; 3]>()) {
        let text = edited(GOOD, edits, 60);
        let base = if allow[0] { Base::Floating } else { Base::Fixed };
        match urdf::import(&text, "mutated.urdf", &Options { base, allow_massless: allow[1], independent_mimics: allow[2] }) {
            Ok((robot, _)) => prop_assert!(robot.canonical().is_ok_and(|again| again == robot)),
            Err(error) => prop_assert!(error.to_string().starts_with("mutated.urdf")),
        }
    }
}

/// A damping or friction that no joint can have is told with its line and joint, and zeros in its place leave a file that is read. The import
/// itself refuses it.
#[test]
fn a_bad_value_is_told_where_it_stands() {
    const DRAWN: u64 = 240;
    let mut random = Random::new(44, 3);
    for k in 0..DRAWN {
        let count = 1 + random.below(4);
        let wrong = random.below(count);
        let attribute = ["damping", "friction"][random.below(2)];
        let value = match random.below(4) {
            0 => ["nan", "inf", "-inf"][random.below(3)].to_owned(),
            _ => format!("{}", -random.uniform(1e-9, 9.0)),
        };
        let mut text = String::from("<robot name=\"r\"><link name=\"l\"/>\n");
        for i in 0..count {
            let parent = if i == 0 { "l".to_owned() } else { format!("l{}", i - 1) };
            let said = if i == wrong { format!("{attribute}=\"{value}\"") } else { String::new() };
            text += &format!(
                "<link name=\"l{i}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n\
                 <joint name=\"j{i}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"l{i}\"/>\n<dynamics {said}/></joint>\n"
            );
        }
        text += "</robot>";
        let parsed = urdf::Parsed::of(text.as_bytes(), "bad.urdf").unwrap();
        let found = parsed.bad_values();
        assert_eq!(found.len(), 1, "{k}: {found:?}");
        assert_eq!(&text[found[0].range.clone()], value, "{k}");
        let line = 4 + 3 * wrong;
        assert!(found[0].text.starts_with(&format!("line {line}: joint 'j{wrong}' has {attribute}=\"{value}\"")), "{k}: {found:?}");
        assert!(parsed.import(&Options::default()).is_err(), "{k}");
        text.replace_range(found[0].range.clone(), &"0".repeat(found[0].range.len()));
        let repaired = urdf::Parsed::of(text.as_bytes(), "bad.urdf").unwrap();
        assert!(repaired.bad_values().is_empty() && repaired.import(&Options::default()).is_ok(), "{k}");
    }
}
