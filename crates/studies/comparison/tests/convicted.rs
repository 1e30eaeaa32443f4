//! Engines fail that compute something else, answer nothing, or are missing.
//!
//! The mistakes are those of bindings and algorithms: exchanged frames and orders, signs, missing armature. Each must fail the gates of
//! `ci/gates.toml` in the quantities that it affects, and in no others.

use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_doubles::{
    Answer, Double, OVER_BEST, SHARPNESS, Twist, agreement, beside_native, doubles, gates, red, robot as robot_of, suite,
};
use featherbench_engines::Featherbench;
use featherbench_model::{Description, JointType, Model};
use featherbench_report::{Findings, Status};
use featherbench_results::{Culprit, Expectation, GateKind, Row, RunInfo, Verdict};
use featherbench_robots::StateBatch;
use std::collections::BTreeSet;

/// A robot with every kind of joint on a free base.
pub const FREE: &str = "joints:kind=mixed,base=free";
/// One with armature.
const ARMATURED: &str = "tree:n=12,joints=all,base=free,armature=true";

/// The quantities in which rows of the double fail.
fn failing(records: &[Row]) -> BTreeSet<&str> {
    doubles(records, Verdict::Fail).into_iter().map(|row| row.quantity.as_str()).collect()
}

/// Asserts that the gates fail for the double in exactly these quantities, and pass for our own kernels.
#[track_caller]
fn fails_in(robot: &Robot, double: Double, quantities: &[&str]) {
    let gates = gates("");
    let expected = suite(&beside_native(robot, &gates, Double::of(robot)));
    let records = beside_native(robot, &gates, double);
    assert_eq!(failing(&records), quantities.iter().copied().collect());
    assert!(doubles(&records, Verdict::Error).is_empty());
    let conditions = expected.conditions(&gates, &records, true);
    let unmet = red(&conditions);
    assert!(unmet.contains(&"rows outside their bound"), "{unmet:?}");
    for quantity in quantities {
        assert!(miscounted(&conditions, "double").contains(quantity), "{quantity}: {unmet:?}");
    }
    assert!(miscounted(&conditions, "featherbench").is_empty(), "our own kernels are innocent: {unmet:?}");
    first_names_the_double(&conditions, &records, GateKind::Bound, quantities);
}

/// Asserts that the report's first finding names the double, one of the quantities, and a robot or the study that misses rows.
#[track_caller]
pub fn first_names_the_double(conditions: &[Expectation], records: &[Row], gate: GateKind, quantities: &[&str]) {
    let run = RunInfo { expected: conditions.to_vec(), ..RunInfo::default() };
    let findings = Findings::of(&run, records);
    assert_eq!(findings.status, Status::Failed);
    let first = findings.red().next().unwrap();
    let Culprit { engine, quantity, robot, study, .. } = &first.culprit;
    assert_eq!((engine.as_str(), first.gate), ("double", gate), "{}", first.sentence());
    assert!(quantities.is_empty() || quantities.contains(&quantity.as_str()), "{}", first.sentence());
    assert!(!robot.is_empty() || !study.is_empty(), "{first:?}");
    assert!(findings.headline().starts_with("double"), "{}", findings.headline());
}

/// The quantities of which an engine has other cells or rows than are expected.
fn miscounted<'a>(conditions: &'a [Expectation], engine: &str) -> BTreeSet<&'a str> {
    let what = format!("cells and rows of {engine} in the study agreement");
    let counted: Vec<&Expectation> = conditions.iter().filter(|condition| condition.what.starts_with(&what)).collect();
    assert_eq!(counted.len(), 1, "{conditions:?}");
    counted[0].reason.split("; ").filter_map(|part| Some(part.split_once(':')?.0)).collect()
}

/// Asserts that a changed answer fails in exactly these quantities.
#[track_caller]
fn twisted(spec: &str, twist: Twist, quantities: &[&str]) {
    let robot = robot_of(spec);
    fails_in(&robot, Double::twisting(&robot, twist), quantities);
}

#[test]
fn an_honest_double_passes_everywhere() {
    for spec in [FREE, ARMATURED, "humanoid", "chain:n=10,layout=spatial"] {
        let robot = robot_of(spec);
        let records = beside_native(&robot, &gates(""), Double::of(&robot));
        let judged: Vec<&Row> = records.iter().filter(|row| row.relation.is_some()).collect();
        assert!(!judged.is_empty());
        assert!(judged.iter().all(|row| row.verdict == Verdict::Pass));
        assert!(records.iter().all(|row| matches!(row.verdict, Verdict::Pass | Verdict::Info)));
    }
}

/// The free joint's τ as [angular; linear].
#[test]
fn halves_of_the_free_joint_swapped() {
    twisted(
        FREE,
        |answer| {
            if answer.quantity == Quantity::InverseDynamics {
                answer.values[..6].rotate_left(3)
            }
        },
        &["id"],
    );
}

/// The free joint's τ in world axes.
#[test]
fn world_axes_for_body_axes() {
    let twist = |Answer { robot, quantity, state, values, .. }: Answer| {
        if quantity == Quantity::InverseDynamics {
            let x = robot.model.joint_transform(0, robot.states.q(state));
            let world = |v: &[f64]| (x.rotation * featherbench_spatial::Vec3::new(v[0], v[1], v[2])).to_array();
            let (force, moment) = (world(&values[..3]), world(&values[3..6]));
            values[..3].copy_from_slice(&force);
            values[3..6].copy_from_slice(&moment);
        }
    };
    twisted(FREE, twist, &["id"]);
}

#[test]
fn one_sign_of_one_force() {
    twisted(
        FREE,
        |answer| {
            if answer.quantity == Quantity::Bias {
                answer.values[7] *= -1.0
            }
        },
        &["bias"],
    );
    twisted(
        "humanoid",
        |answer| {
            if answer.quantity == Quantity::InverseDynamics {
                answer.values[35] *= -1.0
            }
        },
        &["id"],
    );
}

/// 6 × nv numbers in column-major order.
#[test]
fn a_jacobian_column_by_column() {
    let twist = |Answer { quantity, values, .. }: Answer| {
        if quantity == Quantity::BodyJacobian {
            let (columns, rows) = (values.len() / 6, values.to_vec());
            values.iter_mut().enumerate().for_each(|(k, x)| *x = rows[(k % 6) * columns + k / 6]);
        }
    };
    twisted(FREE, twist, &["body_jacobian"]);
}

/// Only the lower triangle of M.
#[test]
fn half_a_mass_matrix() {
    let twist = |Answer { robot, quantity, values, .. }: Answer| {
        if quantity == Quantity::MassMatrix {
            let n = robot.states.nv;
            (0..n).for_each(|i| values[i * n + i + 1..(i + 1) * n].fill(0.0));
        }
    };
    twisted(FREE, twist, &["mass_matrix"]);
}

/// Angular momentum about the world's origin instead of the centre of mass.
#[test]
fn momentum_about_another_point() {
    let twist = |Answer { quantity, values, .. }: Answer| {
        if quantity == Quantity::Momentum {
            let (l, p) = values.split_at_mut(3);
            l[0] += 0.5 * p[2];
            l[2] -= 0.5 * p[0];
        }
    };
    twisted(FREE, twist, &["momentum"]);
}

/// Spatial instead of classical acceleration: without ω × v.
#[test]
fn spatial_acceleration_for_classical() {
    let twist = |Answer { robot, quantity, state, values, .. }: Answer| {
        if quantity == Quantity::BodyAcceleration {
            let states = &robot.states;
            let motion =
                featherbench_dynamics::forward_kinematics(&robot.model, states.q(state), states.v(state), states.a(state)).unwrap();
            for (a, &body) in values.chunks_exact_mut(6).zip(&robot.model.described) {
                let v = motion.body(body).unwrap().velocity;
                a.iter_mut().skip(3).zip(v.ang.cross(v.lin).to_array()).for_each(|(a, term)| *a -= term);
            }
        }
    };
    twisted(FREE, twist, &["body_acceleration"]);
}

/// All quantities that depend on forces, and no others.
#[test]
fn gravity_upside_down() {
    let robot = robot_of(FREE);
    let double = Double::altered(&robot, |description| description.gravity = description.gravity.map(|g| -g));
    fails_in(&robot, double, &["id", "id_wrench", "bias", "fd", "potential_energy"]);
}

#[test]
fn gravity_off_by_little() {
    let robot = robot_of("humanoid");
    let double = Double::altered(&robot, |description| description.gravity[2] *= 1.0 + 1e-10);
    fails_in(&robot, double, &["id", "id_wrench", "bias", "fd", "potential_energy"]);
}

#[test]
fn armature_forgotten() {
    let robot = robot_of(ARMATURED);
    let double = Double::altered(&robot, |description| description.bodies.iter_mut().for_each(|body| body.joint.armature.clear()));
    fails_in(&robot, double, &["id", "id_wrench", "mass_matrix", "fd", "kinetic_energy"]);
}

/// Inertia about the body's origin used as inertia about the centre of mass.
#[test]
fn inertia_about_another_point() {
    let robot = robot_of("quadruped");
    let double = Double::altered(&robot, |description| {
        for body in &mut description.bodies {
            let (m, [x, y, z]) = (body.mass, body.com);
            let steiner = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
            body.inertia.iter_mut().zip(steiner).for_each(|(entry, s)| *entry += m * s);
        }
    });
    fails_in(&robot, double, &["id", "id_wrench", "bias", "mass_matrix", "fd", "kinetic_energy", "momentum"]);
}

/// Transposed placements: child from parent instead of parent from child.
#[test]
fn rotations_the_other_way() {
    let robot = robot_of(FREE);
    let double = Double::altered(&robot, |description: &mut Description| {
        for body in description.bodies.iter_mut().skip(1) {
            let r = body.joint.placement.rotation;
            body.joint.placement.rotation = std::array::from_fn(|k| r[3 * (k % 3) + k / 3]);
        }
    });
    fails_in(&robot, double, &EVERYTHING);
}

/// Every quantity that depends on the configuration of a moving robot.
pub const EVERYTHING: [&str; 14] = [
    "id",
    "id_wrench",
    "bias",
    "mass_matrix",
    "fd",
    "kinetic_energy",
    "potential_energy",
    "com",
    "momentum",
    "body_placement",
    "body_velocity",
    "body_acceleration",
    "body_jacobian",
    "body_jacobians",
];

/// Quaternions interpreted as w, x, y, z.
#[test]
fn quaternion_order() {
    let robot = robot_of(FREE);
    let double = Double::misreading(&robot, |states| quaternions(&robot.model, states, |quaternion| quaternion.rotate_right(1)));
    fails_in(&robot, double, &EVERYTHING);
}

/// Quaternions of the opposite rotation.
#[test]
fn quaternion_conjugated() {
    let robot = robot_of(FREE);
    let double = Double::misreading(&robot, |states| quaternions(&robot.model, states, |quaternion| quaternion[3] *= -1.0));
    fails_in(&robot, double, &EVERYTHING);
}

fn quaternions(model: &Model<f64>, states: &mut StateBatch, change: impl Fn(&mut [f64])) {
    for q in states.q.chunks_exact_mut(states.nq) {
        for joint in model.topology.joints() {
            match joint.kind {
                featherbench_model::JointKind::Free => change(&mut q[joint.q + 3..joint.q + 7]),
                featherbench_model::JointKind::Spherical => change(&mut q[joint.q..joint.q + 4]),
                _ => (),
            }
        }
    }
}

/// Two joints of one parent in the other order, as in engines that sort by name.
#[test]
fn siblings_swapped() {
    let robot = robot_of("quadruped");
    let legs: Vec<usize> = (0..robot.description.bodies.len()).filter(|&body| robot.description.bodies[body].parent == Some(0)).collect();
    assert!(robot.description.bodies[0].joint.kind == JointType::Free && legs[..2] == [1, 4], "trunk and legs of three");
    let double = Double::misreading(&robot, |states| {
        let (nq, nv) = (states.nq, states.nv);
        for q in states.q.chunks_exact_mut(nq) {
            q[7..13].rotate_left(3);
        }
        for v in [&mut states.v, &mut states.a, &mut states.tau].into_iter().flat_map(|all| all.chunks_exact_mut(nv)) {
            v[6..12].rotate_left(3);
        }
    });
    fails_in(&robot, double, &EVERYTHING);
}

#[test]
fn not_a_number_is_an_error() {
    let robot = robot_of(FREE);
    let gates = gates("");
    let expected = suite(&beside_native(&robot, &gates, Double::of(&robot)));
    // One NaN in one number of the last state: it must not be lost when the worst value is taken.
    let twist = |Answer { quantity, state, values, .. }: Answer| {
        if quantity != Quantity::Readback && state + 1 == featherbench_doubles::STATES {
            values[0] = f64::NAN;
        }
    };
    let records = beside_native(&robot, &gates, Double::twisting(&robot, twist));
    let errors: BTreeSet<&str> = doubles(&records, Verdict::Error).into_iter().map(|row| row.quantity.as_str()).collect();
    assert_eq!(errors, EVERYTHING.into_iter().collect());
    assert!(doubles(&records, Verdict::Fail).is_empty());
    let conditions = expected.conditions(&gates, &records, true);
    let unmet = red(&conditions);
    assert!(unmet.contains(&"rows without a value that was due"), "{unmet:?}");
    first_names_the_double(&conditions, &records, GateKind::Answer, &EVERYTHING);
    for partial in [false, true] {
        assert!(!red(&expected.conditions(&gates, &records, !partial)).is_empty());
    }
}

/// Answers for only some of the states, or for none, are errors.
#[test]
fn too_few_numbers_are_an_error() {
    let robot = robot_of(FREE);
    let some: Twist = |answer| answer.values.truncate(if answer.state > 2 { 0 } else { usize::MAX });
    let none: Twist = |answer| answer.values.clear();
    let one_more: Twist = |answer| answer.values.push(0.0);
    for twist in [some, none, one_more] {
        let records = beside_native(&robot, &gates(""), Double::twisting(&robot, twist));
        let errors: BTreeSet<&str> = doubles(&records, Verdict::Error).into_iter().map(|row| row.quantity.as_str()).collect();
        assert_eq!(errors, EVERYTHING.into_iter().collect());
    }
}

#[test]
fn a_missing_engine_does_not_pass_unnoticed() {
    let robot = robot_of(FREE);
    let gates = gates("");
    let expected = suite(&beside_native(&robot, &gates, Double::of(&robot)));
    let alone = agreement(&robot, &gates, &[Box::new(featherbench_engines::Featherbench::new())]);
    assert!(alone.iter().all(|row| matches!(row.verdict, Verdict::Pass | Verdict::Info)), "nothing is wrong with what is there");
    let conditions = expected.conditions(&gates, &alone, true);
    let unmet = red(&conditions);
    assert!(unmet.iter().all(|what| what.starts_with("cells and rows of ")), "{unmet:?}");
    let mut due: BTreeSet<&str> = EVERYTHING.into_iter().collect();
    assert!(due.insert("readback"), "the read-back is demanded as well");
    assert_eq!(miscounted(&conditions, "double"), due);
    first_names_the_double(&conditions, &alone, GateKind::Counts, &due.into_iter().collect::<Vec<_>>());
}

#[test]
fn nothing_at_all_is_not_green() {
    let gates = gates("");
    let conditions = suite(&[]).conditions(&gates, &[], true);
    assert_eq!(red(&conditions), ["rows at all"]);
    // Each quantity has a condition on a mean and one on a largest value; without rows neither is met.
    let over_best: Vec<_> = conditions.iter().filter(|condition| condition.what.contains(OVER_BEST)).collect();
    assert!(over_best.len() >= 24 && over_best.iter().all(|condition| condition.verdict == Verdict::Fail), "{over_best:?}");
}

/// One robot whose forward bounds are too wide to find errors, and one with sharp ones.
#[test]
fn blind_bounds_are_red() {
    let gates = gates("");
    // Every method of the double, and our own methods except the first.
    let compared = 2 * Featherbench::new().methods(Quantity::ForwardDynamics).len() - 1;
    let blunt = |spec: &str| {
        let robot = robot_of(spec);
        let records = beside_native(&robot, &gates, Double::of(&robot));
        let conditions = suite(&records).conditions(&gates, &records, true);
        let sharpness: Vec<_> = conditions.into_iter().filter(|condition| condition.what.starts_with(SHARPNESS)).collect();
        assert_eq!(sharpness.len(), compared, "{spec}");
        sharpness.into_iter().filter(|condition| condition.verdict != Verdict::Pass).count()
    };
    assert_eq!(blunt("chain:n=20,layout=planar"), compared);
    assert_eq!(blunt("chain:n=1"), 0);
}
