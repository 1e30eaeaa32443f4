//! The engines' coordinates against what each engine's numbers mean: the rates of its own q, the rates of its own v, and power.

use crate::common::{every_joint, largest, random_v};
use featherbench_rbd::{Convention, Robot};

const ALL: [Convention; 3] = [Convention::Pinocchio, Convention::MuJoCo, Convention::Drake];

/// A step for central differences: their error is about h² times a third derivative, and 1e-16/h from rounding.
const STEP: f64 = 1e-5;
/// Both are below 1e-9 with numbers of size one; the third derivatives here are below a hundred.
const DIFFERENCE: f64 = 1e-8;
/// A few roundings of numbers of size one.
const ROUNDING: f64 = 1e-14;

/// The robot with every joint that the engine has, on skew placements.
fn robot(convention: Convention) -> Robot {
    every_joint(convention != Convention::MuJoCo)
}

fn central(f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    f(STEP).iter().zip(f(-STEP)).map(|(ahead, behind)| (ahead - behind) / (2.0 * STEP)).collect()
}

#[test]
fn conversions_lead_back() {
    for convention in ALL {
        let robot = robot(convention);
        for seed in 0..5 {
            let q = robot.random(seed);
            let [v, a, tau] = [1, 2, 3].map(|stream| random_v(&robot, seed, stream));
            let back = robot.configuration_from(convention, &robot.configuration_to(convention, &q).unwrap()).unwrap();
            // Drake's pitch comes from an arc tangent whose derivative is large near ±90°: a random one stays away from that.
            assert!(largest(&robot.difference(&q, &back).unwrap()) < 1e-13, "{convention}");
            let near = |x: &[f64], y: &[f64]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < ROUNDING);
            let theirs = robot.velocity_to(convention, &q, &v).unwrap();
            assert!(near(&v, &robot.velocity_from(convention, &q, &theirs).unwrap()), "{convention}");
            let theirs = robot.acceleration_to(convention, &q, &v, &a).unwrap();
            assert!(near(&a, &robot.acceleration_from(convention, &q, &v, &theirs).unwrap()), "{convention}");
            let theirs = robot.force_to(convention, &q, &tau).unwrap();
            assert!(near(&tau, &robot.force_from(convention, &q, &theirs).unwrap()), "{convention}");
        }
    }
}

/// `a_e` is the rate of `v_e` on the way of `v` and `a`.
#[test]
fn accelerations_are_the_rates_of_velocities() {
    for convention in ALL {
        let robot = robot(convention);
        let q = robot.random(3);
        let (v, a) = (random_v(&robot, 3, 1), random_v(&robot, 3, 2));
        let rates = central(|h| {
            let step: Vec<f64> = v.iter().map(|v| h * v).collect();
            let faster: Vec<f64> = v.iter().zip(&a).map(|(v, a)| v + h * a).collect();
            robot.velocity_to(convention, &robot.integrate(&q, &step).unwrap(), &faster).unwrap()
        });
        let theirs = robot.acceleration_to(convention, &q, &v, &a).unwrap();
        for (dof, (theirs, rate)) in theirs.iter().zip(&rates).enumerate() {
            assert!((theirs - rate).abs() < DIFFERENCE, "{convention}, dof {dof}: {theirs} and {rate}");
        }
    }
}

#[test]
fn power_is_the_same() {
    for convention in ALL {
        let robot = robot(convention);
        let q = robot.random(4);
        let (v, tau) = (random_v(&robot, 4, 1), random_v(&robot, 4, 2));
        let power = |v: &[f64], tau: &[f64]| v.iter().zip(tau).map(|(v, tau)| v * tau).sum::<f64>();
        let theirs = power(&robot.velocity_to(convention, &q, &v).unwrap(), &robot.force_to(convention, &q, &tau).unwrap());
        assert!((theirs - power(&v, &tau)).abs() < ROUNDING * robot.nv() as f64, "{convention}");
    }
}

/// The rates of each engine's q, by the engine's own law from its v (rows `free v`, `spherical v` and `planar v` of CONVENTIONS.md).
#[test]
fn velocities_are_what_moves_the_engines_configuration() {
    for convention in ALL {
        let robot = robot(convention);
        let q = robot.random(5);
        let v = random_v(&robot, 5, 1);
        let rates = central(|h| {
            let step: Vec<f64> = v.iter().map(|v| h * v).collect();
            robot.configuration_to(convention, &robot.integrate(&q, &step).unwrap()).unwrap()
        });
        let (theirs, moving) = (robot.configuration_to(convention, &q).unwrap(), robot.velocity_to(convention, &q, &v).unwrap());
        let (mut at, mut cases) = (0, 0);
        for joint in robot.joints() {
            let (v, kind) = (&moving[joint.v.clone()], joint.kind.name());
            let law: Vec<f64> = match (convention, kind) {
                // ẋ, ẏ turned from body axes; the rates of cosine and sine
                (Convention::Pinocchio, "planar") => {
                    let (c, s) = (theirs[at + 2], theirs[at + 3]);
                    vec![c * v[0] - s * v[1], s * v[0] + c * v[1], -s * v[2], c * v[2]]
                }
                // Pinocchio's free joint is ours: [linear; angular] in body axes, xyzw
                (Convention::Pinocchio, "free") => {
                    let [w, x, y, z] = [theirs[at + 6], theirs[at + 3], theirs[at + 4], theirs[at + 5]];
                    let mut law = rotate([w, x, y, z], [v[0], v[1], v[2]]).to_vec();
                    let [w, x, y, z] = product([w, x, y, z], half([v[3], v[4], v[5]]));
                    law.extend([x, y, z, w]);
                    law
                }
                (Convention::Pinocchio, "spherical") => {
                    let [w, x, y, z] = product([theirs[at + 3], theirs[at], theirs[at + 1], theirs[at + 2]], half([v[0], v[1], v[2]]));
                    vec![x, y, z, w]
                }
                // linear in world axes; angular in body axes, on the right of the quaternion
                (Convention::MuJoCo, "free") => {
                    let turn = product(four(&theirs[at + 3..]), half([v[3], v[4], v[5]]));
                    [v[0], v[1], v[2]].into_iter().chain(turn).collect()
                }
                (Convention::MuJoCo, "spherical") => product(four(&theirs[at..]), half([v[0], v[1], v[2]])).to_vec(),
                // angular in the parent's axes, on the left of the quaternion; linear in the parent's axes
                (Convention::Drake, "free") => {
                    let turn = product(half([v[0], v[1], v[2]]), four(&theirs[at..]));
                    turn.into_iter().chain([v[3], v[4], v[5]]).collect()
                }
                // ω = yaw' z + Rz(yaw) (pitch' y + Ry(pitch) roll' x)
                (Convention::Drake, "spherical") => {
                    let [_, pitch, yaw] = [theirs[at], theirs[at + 1], theirs[at + 2]];
                    let along = yaw.cos() * v[0] + yaw.sin() * v[1];
                    let roll = along / pitch.cos();
                    vec![roll, -yaw.sin() * v[0] + yaw.cos() * v[1], v[2] + roll * pitch.sin()]
                }
                _ => v.to_vec(),
            };
            for (k, (law, rate)) in law.iter().zip(&rates[at..]).enumerate() {
                assert!((law - rate).abs() < DIFFERENCE, "{convention}, {kind}, number {k}: {law} and {rate}");
            }
            (at, cases) = (at + law.len(), cases + 1);
        }
        assert_eq!((at, cases), (robot.nq_of(convention).unwrap(), robot.joints().len()));
    }
}

/// MuJoCo's free joint has the pose in the world, whatever its placement: the body's origin and axes as our kinematics has them.
#[test]
fn mujocos_free_joint_has_the_pose_in_the_world() {
    let robot = every_joint(false);
    let q = robot.random(6);
    let theirs = robot.to_mujoco(&q).unwrap();
    let joint = robot.joints().iter().find(|joint| joint.kind.name() == "free").unwrap();
    assert_eq!(joint.q.start, 0, "its numbers are the first in both");
    let placed = robot.placement(&q, &joint.body).unwrap();
    assert!(placed.translation.to_array().iter().zip(&theirs).all(|(p, theirs)| (p - theirs).abs() < ROUNDING));
    let x = rotate(four(&theirs[3..]), [1.0, 0.0, 0.0]);
    let rotation = placed.rotation.to_array();
    assert!((0..3).all(|i| (x[i] - rotation[3 * i]).abs() < ROUNDING));
}

#[test]
fn what_an_engine_lacks_is_named() {
    let robot = every_joint(true);
    let text = robot.to_mujoco(&robot.neutral()).unwrap_err().to_string();
    assert!(text.contains("MuJoCo has no coordinates of joint") && text.contains("helical"), "{text}");
}

fn four(q: &[f64]) -> [f64; 4] {
    [q[0], q[1], q[2], q[3]]
}

/// The quaternion (0, ω/2), the scalar first.
fn half([x, y, z]: [f64; 3]) -> [f64; 4] {
    [0.0, x / 2.0, y / 2.0, z / 2.0]
}

/// Hamilton's product, the scalar first.
fn product([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e]
}

/// q v q⁻¹.
fn rotate([w, x, y, z]: [f64; 4], [a, b, c]: [f64; 3]) -> [f64; 3] {
    let [_, x, y, z] = product(product([w, x, y, z], [0.0, a, b, c]), [w, -x, -y, -z]);
    [x, y, z]
}

/// Pinocchio's own parser sorts siblings and gives continuous joints two numbers: then nothing is converted. A robot with the same order, and one
/// that no URDF is of, are.
#[test]
fn a_urdf_that_pinocchio_reads_otherwise_is_not_converted() {
    let link = |name: &str| {
        let inertial = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;
        format!("<link name=\"{name}\">{inertial}</link>")
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str| {
        let limit = if kind == "continuous" { "" } else { r#"<limit lower="-1" upper="1" effort="1" velocity="1"/>"# };
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 0 1\"/>{limit}</joint>"
        )
    };
    let robot = |joints: [String; 2]| {
        let text = format!("<robot name=\"r\"><link name=\"world\"/>{}{}{}</robot>", link("a"), link("b"), joints.concat());
        Robot::from_urdf_text(&text, "r.urdf", false).unwrap()
    };
    let chain = |kind: &str| robot([joint("first", kind, "world", "a"), joint("second", "revolute", "a", "b")]);
    let fork = |one: &str, other: &str| robot([joint(one, "revolute", "world", "a"), joint(other, "prismatic", "world", "b")]);
    let refused =
        [(chain("continuous"), "'first' a cosine and a sine"), (fork("right", "left"), "'left' stands where 'right' stands here")];
    for (robot, words) in refused {
        let (q, v) = (robot.neutral(), vec![0.0; robot.nv()]);
        let refused = [
            robot.to_pinocchio(&q),
            robot.from_pinocchio(&q),
            robot.velocity_to(Convention::Pinocchio, &q, &v),
            robot.acceleration_from(Convention::Pinocchio, &q, &v, &v),
            robot.force_to(Convention::Pinocchio, &q, &v),
        ];
        for refused in refused {
            assert!(refused.unwrap_err().to_string().contains(words));
        }
        assert_eq!(robot.to_drake(&q).unwrap(), q, "other parsers keep the order");
        let described = Robot::from_description(robot.description()).unwrap();
        assert_eq!(described.to_pinocchio(&q).unwrap(), q, "a model with this order of joints");
    }
    for robot in [chain("revolute"), fork("left", "right")] {
        assert_eq!(robot.to_pinocchio(&robot.neutral()).unwrap(), robot.neutral());
    }
}
