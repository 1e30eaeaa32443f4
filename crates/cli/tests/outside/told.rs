//! `compare` on files that say more than a tree: what changes the physics is a difference, and what is not compared is told by name.

use crate::Outcome;
use crate::support::{Ended, Sandbox, project};
use featherbench_robots::Random;
use std::path::Path;
use std::process::Command;

/// Draws of each kind.
const DRAWN: u64 = 3;
const INERTIAL: &str = r#"<inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>"#;

fn compare(sandbox: &Sandbox, name: &str, text: &str) -> Ended {
    let file = sandbox.write(name, text);
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    command.current_dir(project()).env("NO_COLOR", "1").arg("compare").arg(file).args(["--engines", "pinocchio,mujoco", "--out"]);
    Ended::new(command.arg(sandbox.path(&format!("{name}-out"))).output().unwrap())
}

/// An arm of two hinges in MJCF, with more in its first joint and after its bodies.
fn arm(joint: &str, more: &str) -> String {
    format!(
        r#"<mujoco model="arm"><worldbody><body name="a"><joint name="hip" axis="0 0 1" {joint}/>{INERTIAL}
        <body name="b" pos=".3 0 0"><joint name="knee" axis="0 1 0"/>{INERTIAL}</body></body></worldbody>{more}</mujoco>"#
    )
}

/// The armature of a tendon or an actuator is a part of MuJoCo's M; springs, tendons and actuators are told; limits have numbers.
pub fn by_name(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    for k in 0..DRAWN {
        let mut random = Random::new(44, k);
        let (x, y) = (random.uniform(0.1, 2.0), random.uniform(-3.0, -0.5));
        let joints = format!(r#"<joint joint="hip" coef="1"/><joint joint="knee" coef="{y}"/>"#);
        let tendon = |more: &str| format!(r#"<tendon><fixed name="cable" {more}>{joints}</fixed></tendon>"#);
        let held = [
            ("cable", tendon(&format!(r#"armature="{x}""#))),
            ("servo", format!(r#"<actuator><motor name="servo" joint="knee" gear="{y}" armature="{x}"/></actuator>"#)),
        ];
        for (name, more) in held {
            compare(&sandbox, &format!("{name}{k}.xml"), &arm("", &more)).expect(1, &[&format!("{name}: armature [added armature]")]);
        }
        let more = tendon("") + r#"<actuator><motor name="servo" joint="knee"/></actuator>"#;
        let springy = arm(&format!(r#"stiffness="{x}""#), &more);
        compare(&sandbox, &format!("springy{k}.xml"), &springy)
            .expect(0, &["joint stiffness (hip)", "tendon fixed (cable)", "actuator motor (servo)"]);
        let bad = arm(&format!("\ndamping=\"{y}\""), "");
        compare(&sandbox, &format!("bad{k}.xml"), &bad).expect(0, &[&format!("joint 'hip' has damping=\"{y}\""), "no joint can have"]);
    }
    Ok(())
}

/// An engine that drops a mimic computes other physics, and the others are told by what they tie it.
pub fn mimics(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let link = |name: &str| {
        format!(
            r#"<link name="{name}"><inertial><mass value="1"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".03" iyz="0" izz=".04"/></inertial></link>"#
        )
    };
    for k in 0..DRAWN {
        let mut random = Random::new(45, k);
        let (offset, multiplier) = (random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0));
        let tie = format!(r#"<mimic joint="lead" multiplier="{multiplier}" offset="{offset}"/>"#);
        let joint = |name: &str, child: &str, more: &str| {
            format!(
                r#"<joint name="{name}" type="continuous"><parent link="stand"/><child link="{child}"/><axis xyz="0 0 1"/>{more}</joint>"#
            )
        };
        let (links, joints) = ([link("stand"), link("a"), link("b")], [joint("lead", "a", ""), joint("follow", "b", &tie)]);
        let text = format!(r#"<robot name="r">{}{}</robot>"#, links.concat(), joints.concat());
        compare(&sandbox, &format!("tied{k}.urdf"), &text).expect(
            1,
            &["b: mimic [mimic]: a joint of its own", "mimic follow: a joint of its own with an equality constraint", "as written"],
        );
    }
    Ok(())
}
