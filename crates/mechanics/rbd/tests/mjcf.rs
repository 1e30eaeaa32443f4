//! An arm in MJCF, and the same arm in URDF.

use crate::common::random_v;
use featherbench_rbd::{Error, Robot};

const URDF: &str = r#"<robot name="arm"><link name="world"/>
    <link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
        <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="-0.002" izz="0.02"/></inertial></link>
    <link name="lower"><inertial><origin xyz="0.01 0 -0.15"/><mass value="1"/>
        <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.015"/></inertial></link>
    <link name="tool"/>
    <joint name="shoulder" type="revolute"><origin xyz="0 0 1"/><parent link="world"/><child link="upper"/><axis xyz="0 1 0"/>
        <limit lower="-1.5" upper="2" effort="10" velocity="3"/></joint>
    <joint name="elbow" type="prismatic"><origin xyz="0 0.1 -0.4"/><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/>
        <limit lower="-0.25" upper="0.5" effort="20" velocity="3"/></joint>
    <joint name="mount" type="fixed"><origin xyz="0 0 -0.3"/><parent link="lower"/><child link="tool"/></joint></robot>"#;

const MJCF: &str = r#"<mujoco model="arm"><compiler angle="radian"/><worldbody>
    <body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0" range="-1.5 2"/>
        <inertial pos="0 0 -0.2" mass="2" fullinertia="0.02 0.03 0.02 0.001 0 -0.002"/>
        <body name="lower" pos="0 0.1 -0.4"><joint name="elbow" type="slide" axis="1 0 0" range="-0.25 0.5"/>
            <inertial pos="0.01 0 -0.15" mass="1" diaginertia="0.01 0.01 0.015"/>
            <body name="tool" pos="0 0 -0.3"/></body></body></worldbody></mujoco>"#;

/// Both files hold the same decimals, and neither reader computes with them. So each quantity is the same to the bit.
#[test]
fn an_arm_in_mjcf_is_the_arm_in_urdf() {
    let urdf = Robot::from_urdf_text(URDF, "arm.urdf", false).unwrap();
    let mjcf = Robot::from_mjcf_text(MJCF, "arm.xml").unwrap();
    assert_eq!(mjcf.bodies(), urdf.bodies());
    assert_eq!(mjcf.joints(), urdf.joints());
    for seed in 0..8 {
        let q = urdf.random(seed);
        assert_eq!(mjcf.random(seed), q);
        let (v, a) = (random_v(&urdf, seed, 1), random_v(&urdf, seed, 2));
        assert_eq!(mjcf.inverse_dynamics(&q, &v, &a).unwrap(), urdf.inverse_dynamics(&q, &v, &a).unwrap());
        assert_eq!(mjcf.forward_dynamics(&q, &v, &a).unwrap(), urdf.forward_dynamics(&q, &v, &a).unwrap());
        assert_eq!(mjcf.placement(&q, "tool").unwrap(), urdf.placement(&q, "tool").unwrap());
    }
}

/// A file is read by the ending of its name, in any case, and an error names the file.
#[test]
fn files_are_read_by_the_ending_of_their_names() {
    let folder = std::env::temp_dir().join(format!("featherbench-rbd-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let json = Robot::from_mjcf_text(MJCF, "arm.xml").unwrap().to_json().unwrap();
    for (name, text) in [("arm.urdf", URDF), ("arm.xml", MJCF), ("arm.MJCF", MJCF), ("arm.json", &json)] {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        assert_eq!(Robot::from_file(&path).unwrap_or_else(|error| panic!("{name}: {error}")).nv(), 2);
    }
    let wrong = folder.join("wrong.xml");
    std::fs::write(&wrong, MJCF.replace("mass=\"1\"", "mass=\"heavy\"")).unwrap();
    let error = Robot::from_file(&wrong).unwrap_err();
    assert!(matches!(&error, Error::Mjcf(found) if found.place.position.is_some_and(|(line, _)| line == 5)), "{error}");
    assert!(error.to_string().contains("wrong.xml:5:") && error.to_string().contains("mass=\"heavy\" of body 'lower'"), "{error}");
    assert!(matches!(Robot::from_file(folder.join("arm.sdf")), Err(Error::UnknownEnding { .. })));
    std::fs::remove_dir_all(&folder).unwrap();
}
