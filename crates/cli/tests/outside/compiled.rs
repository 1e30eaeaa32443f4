//! MJCF files through MuJoCo's compiler: the description that `gen mjcf` writes, and the keyframes that become states.

use crate::Outcome;
use crate::support::{Ended, Sandbox, project};
use featherbench_constrained::systems::Ladder;
use featherbench_constrained::{Constrained, Kkt, Mechanism};
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
    Ok(())
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
    Ok(())
}

/// The parallelogram of rods of 1 kg and 1 m in MJCF. Its last hinge is a `connect`; the slider follows the first hinge.
const FOUR_BAR: &str = r#"<mujoco model="four_bar"><compiler angle="radian"/><worldbody>
<body name="crank0"><joint name="a" axis="0 1 0"/>
 <inertial pos="0 0 -.5" mass="1" diaginertia=".08333333333333333 .08333333333333333 1e-12"/>
 <body name="coupler" pos="0 0 -1"><joint name="b" axis="0 1 0"/>
  <inertial pos=".5 0 0" mass="1" diaginertia="1e-12 .08333333333333333 .08333333333333333"/></body></body>
<body name="crank1" pos="1 0 0"><joint name="c" axis="0 1 0"/>
 <inertial pos="0 0 -.5" mass="1" diaginertia=".08333333333333333 .08333333333333333 1e-12"/></body>
</worldbody><equality><connect name="pin" body1="crank1" body2="coupler" anchor="0 0 -1"/></equality></mujoco>"#;

/// A four-bar in MJCF moves as that of `systems`. Written as MJCF again, its loops are the same to the bit. A comparison is of its tree, and
/// says so.
pub fn loops(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let file = sandbox.write("four_bar.xml", FOUR_BAR);
    let read = |file: &Path| {
        let out = sandbox.path("four_bar.json");
        let ended = featherbench(&["gen", "mjcf", "--file"], file, &["--out", out.to_str().unwrap()]);
        ended.expect(
            0,
            &[
                "its loops (pin) are left out",
                "loops: 1 closed by joints; Grübler's count 0",
                "3 rows of rank 2, 1 degrees of freedom of 3",
            ],
        );
        featherbench_formats::neutral::read(&out).unwrap()
    };
    let robot = read(&file);
    let mechanism = Mechanism::of(&robot).unwrap();
    let ladder = Ladder { gravity: 9.81, ..Ladder::default() };
    let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
    for (theta, rate) in [(0.5, 0.0), (-1.0, 2.0), (0.1, -1.0)] {
        let found = dynamics.run(&ladder.spread(theta), &ladder.spread(rate), &[0.0; 3], &Kkt::default()).unwrap().acceleration;
        let error = (found[0] - ladder.acceleration(theta)).abs();
        // As in the tests of files with loops. The thickness of the rods does not turn.
        assert!(error <= 1e-11 * (1.0 + rate * rate), "{error:e} at {theta}");
    }

    let (text, losses) = featherbench_formats::mjcf::to_string(&robot, featherbench_formats::OnLoss::Refuse).unwrap();
    assert_eq!(losses, []);
    let again = read(&sandbox.write("again.xml", &text));
    let ends = |robot: &featherbench_model::Description| robot.loops[0].ends().unwrap().map(|end| (end.body, end.placement));
    assert_eq!((again.loops.len(), ends(&again)), (1, ends(&robot)));

    let out = sandbox.path("out");
    featherbench(&["compare"], &file, &["--engines", "mujoco", "--out", out.to_str().unwrap()])
        .expect(0, &["its loops (pin) are left out"]);
    Ok(())
}
