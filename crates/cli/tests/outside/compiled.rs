//! MJCF files through MuJoCo's compiler: the description that `gen mjcf` writes, and the keyframes that become states.

use crate::Outcome;
use crate::support::{Ended, Sandbox, project};
use std::path::Path;
use std::process::Command;

/// Defaults, an included part, two joints in one body, an actuator, and a keyframe whose quaternion has length two.
const SCENE: &str = r#"<mujoco model="scene"><include file="part.xml"/>
<worldbody><body name="base"><freejoint/><geom size=".1"/>
<body name="arm" pos="0 0 1"><joint name="a" axis="1 0 0"/><joint name="b" axis="0 1 0" pos="0 0 .2" armature=".5"/><geom size=".1"/></body>
</body></worldbody>
<actuator><motor joint="a"/></actuator>
<keyframe><key name="home" qpos=".1 .2 1 0 0 0 2 .5 1"/></keyframe></mujoco>"#;
const PART: &str = r#"<mujocoinclude><default><geom type="sphere" density="500"/><joint armature=".25"/></default></mujocoinclude>"#;

fn scene() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("scene.xml", SCENE);
    sandbox.write("part.xml", PART);
    sandbox
}

/// The command, with the installed engines.
fn featherbench(arguments: &[&str], file: &Path, more: &[&str]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    command.current_dir(project()).env("NO_COLOR", "1").args(arguments).arg(file).args(more);
    Ended::new(command.output().unwrap())
}

/// Defaults and includes are in the description; what it cannot hold is noted; a file that MuJoCo refuses gives exit code 2.
pub fn gen_mjcf(_: &Path) -> Outcome {
    let sandbox = scene();
    let out = sandbox.path("scene.json");
    let generate = ["gen", "mjcf", "--file"];
    let ended = featherbench(&generate, &sandbox.path("scene.xml"), &["--out", out.to_str().unwrap()]);
    ended.expect(0, &["3 bodies, 8 dofs", "actuator", "keyframes", "compare"]);
    let robot = featherbench_formats::neutral::read(&out).unwrap();
    let names: Vec<_> = robot.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["base", "arm/a", "arm"]);
    assert_eq!(
        (robot.bodies[1].mass, &robot.bodies[1].joint.armature[..], &robot.bodies[2].joint.armature[..]),
        (0.0, &[0.25][..], &[0.5][..])
    );
    assert_eq!(robot.bodies[2].joint.placement.translation, [0.0, 0.0, 0.2]);
    let sphere = 500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-3;
    assert!((robot.bodies[2].mass / sphere - 1.0).abs() < 1e-14, "a few roundings of a sphere's mass");

    let deep = format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(600), "</body>".repeat(600));
    let cases: [(&str, &str, &str); 5] = [
        ("loop.xml", r#"<mujoco><include file="loop.xml"/></mujoco>"#, "includ"),
        ("lost.xml", r#"<mujoco><include file="nowhere.xml"/></mujoco>"#, "nowhere.xml"),
        ("deep.xml", &deep, "500"),
        ("open.xml", "<mujoco><worldbody>", "open.xml"),
        ("word.xml", r#"<mujoco><worldbody><body name="x"><wheel/></body></worldbody></mujoco>"#, "wheel"),
    ];
    for (name, text, word) in cases {
        featherbench(&generate, &sandbox.write(name, text), &[]).expect(2, &[name, word]);
    }
    Outcome::Passed
}

/// A comparison asks at the keyframe too. MuJoCo imports both joints of the arm as they are, and agrees there.
pub fn keyframes(_: &Path) -> Outcome {
    let sandbox = scene();
    let out = sandbox.path("out");
    featherbench(&["compare"], &sandbox.path("scene.xml"), &["--engines", "mujoco", "--out", out.to_str().unwrap()])
        .expect(0, &["report:"]);
    let rows = std::fs::read_to_string(out.join("rows.csv")).unwrap();
    for quantity in ["id", "mass_matrix", "fd", "com"] {
        let at_keyframe = rows.lines().filter(|row| row.contains(",keyframe,") && row.contains(&format!(",{quantity},")));
        assert!(at_keyframe.clone().count() > 0, "{quantity}");
        assert!(at_keyframe.clone().all(|row| !row.contains(",fail,")), "{quantity}: {:?}", at_keyframe.collect::<Vec<_>>());
    }
    Outcome::Passed
}
